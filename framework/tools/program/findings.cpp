// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/findings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "framework/foundation/support/finding_kinds.h"

namespace lockstep {

namespace {

CommandFindings* under_way = nullptr;

}  // namespace

CommandFindings::CommandFindings() { under_way = this; }
CommandFindings::~CommandFindings() { under_way = nullptr; }
void CommandFindings::add(Finding f) {
  if (under_way == nullptr) return;
  under_way->added_.push_back(f);
  under_way->scope_.found.push_back(std::move(f));
}
void CommandFindings::add(const std::vector<Finding>& findings) {
  for (const Finding& f : findings) add(f);
}
std::vector<Finding> CommandFindings::all() {
  return under_way != nullptr ? under_way->scope_.found : std::vector<Finding>();
}
std::vector<Finding> CommandFindings::added() {
  if (under_way == nullptr) return {};
  std::vector<Finding> unlogged = under_way->added_;
  for (const Finding& f : under_way->scope_.found)
    if (f.severity() != Severity::warning && std::ranges::find(unlogged, f.text(), &Finding::text) == unlogged.end())
      unlogged.push_back(f);
  return unlogged;
}

std::string text_of(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) {
    std::string word = to_string(f.severity());
    if (f.severity() >= Severity::doubt) std::ranges::transform(word, word.begin(), toupper);
    const bool is_named = f.code() != finding::analysis_note.code;  // which says no more than "note"
    text += fmt::format("  {:<8}  {}{}{}\n", word, is_named ? f.code() : "", is_named ? ": " : "", f.text());
  }
  return text;
}

std::string text_of(const FindingKind& kind) {
  return fmt::format("{} ({})\n  {}\n  {}\n", kind.code, to_string(kind.severity), kind.cause, kind.cure);
}

std::string findings_page() {
  constexpr std::pair<Severity, const char*> kParts[] = {
      {Severity::wrong, "The result is wrong: the program ends with exit code 9."},
      {Severity::doubt,
       "The result may be wrong: with `--strict` the program ends with exit code 11. `not-certified` and `start-far` "
       "give that code without `--strict`."},
      {Severity::warning,
       "Probably not intended. The exit code does not change, except that of `assemble` without `--within` and "
       "`--branches`: 11 for a warning about the "
       "start."},
      {Severity::note, "Information."}};
  std::string page =
      "# Findings\n\nThis page lists the findings: everything that lockstep reports about a model, a run or an "
      "analysis, except errors.\nErrors have no code; see [Find and fix modelling errors](find_errors.md). The page is "
      "for users who look up a code,\nand for authors of host programs.\n\nA code never changes. "
      "`lockstep describe CODE` prints its entry, `--json` lists the findings of a run under `findings`,\nand hosts "
      "read `SimulationReport::findings`, `RunVerdict::findings` and `FindingScope` (`<lockstep/finding.h>`).\n"
      "`lockstep reference findings` prints this page. `lockstep check` reports findings about the model and its "
      "start, "
      "the other commands those of their results too.\n";
  for (const auto& [severity, words] : kParts) {
    page += fmt::format("\n## {}\n\n{}\n\n| code | cause | cure |\n|---|---|---|\n", to_string(severity), words);
    for (const FindingKind* kind : finding_kinds())
      if (kind->severity == severity) page += fmt::format("| `{}` | {} | {} |\n", kind->code, kind->cause, kind->cure);
  }
  return page;
}

Exit exit_code_of(const std::vector<Finding>& findings, bool strict) {
  const auto any = [&](Severity s) {
    return std::ranges::any_of(findings, [&](const Finding& f) { return f.severity() == s; });
  };
  if (any(Severity::wrong)) return kExitNotConserved;
  return strict && any(Severity::doubt) ? kExitDoubtful : kExitOk;
}

}  // namespace lockstep
