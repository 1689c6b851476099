// SPDX-License-Identifier: BSD-3-Clause
// Where the words of a verb go that writes rows.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <string>

#include "framework/tools/program/commands.h"

namespace lockstep {

/// Nowhere with --quiet and --json; to standard error where standard output takes the rows (--record -).
class Words {
 public:
  /// Throws UsageError where rows and JSON would go to standard output together.
  explicit Words(const Arguments& args)
      : to_(args.has("--quiet") || args.has("--json") ? nullptr
            : args["--record"] == "-"                 ? stderr
                                                      : stdout) {
    if (args.has("--json") && args["--record"] == "-")
      throw UsageError("--json: standard output takes the rows (--record -); let one of the two go to a file");
  }
  explicit operator bool() const { return to_ != nullptr; }
  /// Throws nothing where the stream cannot be written: what is left of the verb is done, and its exit code tells.
  template <class... Args>
  void say(fmt::format_string<Args...> format, Args&&... args) const {
    if (to_ == nullptr) return;
    const std::string words = fmt::format(format, std::forward<Args>(args)...);
    std::fwrite(words.data(), 1, words.size(), to_);
    std::fflush(to_);
  }

 private:
  std::FILE* to_;
};

}  // namespace lockstep
