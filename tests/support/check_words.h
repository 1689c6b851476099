// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file What a report of check_lock(), check_force(), ... says.

#include <string>

#include <lockstep/author/check.h>

namespace lockstep::test {

inline bool says(const CheckReport& report, const std::string& words) {
  return report.text().find(words) != std::string::npos;
}

}  // namespace lockstep::test
