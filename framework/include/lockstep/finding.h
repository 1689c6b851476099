// SPDX-License-Identifier: BSD-3-Clause
// Findings: remarks about a scene, a start, a run or an analysis that are not errors, as data.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep {

/// How serious a finding is.
enum class Severity {
  note,     ///< a fact worth reading
  warning,  ///< probably not what was meant
  doubt,    ///< the result may be wrong: an error with --strict
  wrong     ///< the result is wrong
};

/// "note", "warning", "doubt", "wrong".
LOCKSTEP_API const char* to_string(Severity);

/// What a finding is about, once for all findings of the kind. The entries are in finding_kinds.h of the sources, and in
/// the page findings.md.
struct FindingKind {
  std::string_view code;  ///< "energy-not-conserved"; never changes
  Severity severity;      ///< of all findings of the kind
  const char* cause;      ///< why it happens, a sentence or two
  const char* cure;       ///< what to do about it
};

/// All kinds, the most serious first.
LOCKSTEP_API std::span<const FindingKind* const> finding_kinds();
/// The kind with this code. Throws ModelError for an unknown one.
LOCKSTEP_API const FindingKind& finding_kind(std::string_view code);

/// One finding.
struct Finding {
  const FindingKind* kind;  ///< never null; compare codes, as each library has separate constants
  std::string thing{};      ///< what it is about, "joint 'A'"; "" for the mechanism or the run
  std::string message{};    ///< what was found
  std::string advice{};     ///< what to do about it here; "" if nothing
  double value = std::numeric_limits<double>::quiet_NaN(),  ///< what was measured; NaN: nothing
      limit = std::numeric_limits<double>::quiet_NaN();     ///< what it was compared with; NaN: nothing
  std::string unit{};                                       ///< of value and limit
  double t = std::numeric_limits<double>::quiet_NaN();      ///< simulated time, s; NaN: none
  std::string place{};                                      ///< "four_bar.json:4:64"; "" if in no file

  Severity severity() const { return kind->severity; }  ///< of its kind
  std::string_view code() const { return kind->code; }  ///< of its kind
  LOCKSTEP_API std::string text() const;                ///< "place: message; advice"
};

/// The texts of findings, in their order.
LOCKSTEP_API std::vector<std::string> texts_of(const std::vector<Finding>&);

/// Hands a finding to the innermost FindingScope of this thread. Without one it goes to the logger (log.h): notes as
/// information, all others as warnings.
LOCKSTEP_API void report_finding(const Finding&);

/// Receives the findings of this thread as long as it exists, in place of an outer scope or the logger, or before them.
/// Scopes nest; destroy the inner one first.
class LOCKSTEP_API FindingScope {
 public:
  /// `hands_on`: the outer scope, or the logger, receives them too; the logger receives doubts as information then.
  explicit FindingScope(bool hands_on = false);
  ~FindingScope();
  FindingScope(const FindingScope&) = delete;
  FindingScope& operator=(const FindingScope&) = delete;

  std::vector<Finding> found{};  ///< in the order in which they came

 private:
  friend LOCKSTEP_API void report_finding(const Finding&);
  const bool hands_on_;
  FindingScope* const outer_;
};

}  // namespace lockstep
