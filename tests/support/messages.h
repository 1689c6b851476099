// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file Error messages under test: what was thrown, and whether its words are there.

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/catch.h"

namespace lockstep::testing {

/// The message of the E that `act` throws, or "no error". Any other exception fails the test.
template <class E, class F>
std::string message_of(F&& act) {
  try {
    std::forward<F>(act)();
  } catch (const E& error) {
    return error.what();
  }
  return "no error";
}

/// Whether all parts stand in the text.
inline bool says(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts)
    if (text.find(part) == std::string::npos) return false;
  return true;
}

/// Every part stands in the message.
inline void check_words(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    INFO("message: " << message);
    INFO("missing: " << part);
    CHECK(message.find(part) != std::string::npos);
  }
}

}  // namespace lockstep::testing
