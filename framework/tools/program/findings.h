// SPDX-License-Identifier: BSD-3-Clause
// Findings as the program prints them, and the exit code that they give.
#pragma once

#include <string>
#include <vector>

#include <lockstep/finding.h>
#include "framework/tools/program/result.h"

namespace lockstep {

/// A finding as a result; fields that do not apply are absent.
inline const Fields<Finding> kFindingFields{
    {"severity", "", "", [](const Finding& f) { return to_string(f.severity()); }},
    {"code", "", "", &Finding::code},
    {"thing", "", "", &Finding::thing, kUnlessEmpty},
    {"message", "", "", &Finding::message, kUnlessEmpty},
    {"advice", "", "", &Finding::advice, kUnlessEmpty},
    {"value", "", "", &Finding::value, kUnlessEmpty},
    {"limit", "", "", &Finding::limit, kUnlessEmpty},
    {"unit", "", "", &Finding::unit, kUnlessEmpty},
    {"t", "s", "", &Finding::t, kUnlessEmpty},
    {"place", "", "", &Finding::place, kUnlessEmpty}};

/// The findings of the present command: those that are reported as long as it exists, and those that are added. Added
/// ones are not logged, notes and doubts only as information.
class CommandFindings {
 public:
  CommandFindings();
  ~CommandFindings();
  static void add(Finding);
  static void add(const std::vector<Finding>&);
  static std::vector<Finding> all();    ///< none outside of a command
  static std::vector<Finding> added();  ///< those of them that are listed, each once

 private:
  FindingScope scope_{true};
  std::vector<Finding> added_;
};

/// A line for each: its severity and its text.
std::string text_of(const std::vector<Finding>&);
/// Lines: code and severity, cause, cure.
std::string text_of(const FindingKind&);
/// The page of all kinds, in Markdown.
std::string findings_page();

/// 9 if one is wrong, 11 if one is a doubt and doubts count (`strict`), else 0.
Exit exit_code_of(const std::vector<Finding>&, bool strict);

}  // namespace lockstep
