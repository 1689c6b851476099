// SPDX-License-Identifier: BSD-3-Clause
// Findings as the program prints them, and the exit code that they give.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/finding.h>
#include "framework/tools/program/commands.h"

namespace lockstep {

/// An object for each: severity, code, thing, message, advice, value, limit, unit, t, place; what does not apply is absent.
nlohmann::ordered_json findings_json(const std::vector<Finding>&);

/// The findings of the command under way: those that are reported as long as it exists, and those that are added, which are
/// not logged.
class CommandFindings {
 public:
  CommandFindings();
  ~CommandFindings();
  static void add(Finding);
  static void add(const std::vector<Finding>&);
  static const std::vector<Finding>& all();  ///< none outside of a command

 private:
  FindingScope scope_{true};
};

/// Null if no finding has this code.
const FindingKind* find_kind(std::string_view code);
/// Lines: code and severity, cause, cure.
std::string text_of(const FindingKind&);
/// The page of all kinds, in Markdown.
std::string findings_page();

/// 9 if one is wrong, 11 if one is a doubt and doubts count (`strict`), else 0.
Exit exit_code_of(const std::vector<Finding>&, bool strict);

}  // namespace lockstep
