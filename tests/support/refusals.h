// SPDX-License-Identifier: BSD-3-Clause
// Calls that are refused, and the words of their errors.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace lockstep::testing {

/// A call, and words that its error has.
struct Refused {
  const char* what;
  std::function<void()> call;
  std::vector<std::string> words;
};

inline void check_refusals(const std::vector<Refused>& all) {
  for (const Refused& one : all) {
    INFO(one.what);
    check_words(message_of<Error>(one.call), one.words);
  }
}

}  // namespace lockstep::testing
