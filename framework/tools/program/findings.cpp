// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/findings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lockstep {

namespace {

std::vector<Finding>* of_command = nullptr;

}  // namespace

CommandFindings::CommandFindings() { of_command = &scope_.found; }
CommandFindings::~CommandFindings() { of_command = nullptr; }
void CommandFindings::add(Finding f) {
  if (of_command != nullptr) of_command->push_back(std::move(f));
}
void CommandFindings::add(const std::vector<Finding>& findings) {
  for (const Finding& f : findings) add(f);
}
const std::vector<Finding>& CommandFindings::all() {
  static const std::vector<Finding> kNone;
  return of_command != nullptr ? *of_command : kNone;
}

nlohmann::ordered_json findings_json(const std::vector<Finding>& findings) {
  auto all = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    nlohmann::ordered_json j = {{"severity", to_string(f.severity())}, {"code", f.code()}};
    const auto put = [&](const char* key, const std::string& text) {
      if (!text.empty()) j[key] = text;
    };
    const auto put_number = [&](const char* key, double x) {
      if (std::isfinite(x)) j[key] = x;
    };
    put("thing", f.thing), put("message", f.message), put("advice", f.advice);
    put_number("value", f.value), put_number("limit", f.limit), put("unit", f.unit);
    put_number("t", f.t), put("place", f.place);
    all.push_back(std::move(j));
  }
  return all;
}

const FindingKind* find_kind(std::string_view code) {
  const auto all = finding_kinds();
  const auto found = std::ranges::find(all, code, [](const FindingKind* kind) { return kind->code; });
  return found == all.end() ? nullptr : *found;
}

std::string text_of(const FindingKind& kind) {
  return fmt::format("{} ({})\n  {}\n  {}\n", kind.code, to_string(kind.severity), kind.cause, kind.cure);
}

std::string findings_page() {
  constexpr std::pair<Severity, const char*> kParts[] = {
      {Severity::wrong, "The result is wrong: the program ends with exit code 9."},
      {Severity::doubt,
       "The result may be wrong: with `--strict` the program ends with exit code 11. `not-certified` and `start-far`, "
       "which are asked for, end with 11 without it."},
      {Severity::warning,
       "Probably not what was meant. The exit code does not change, but that of `assemble`: 11 for a start that is not "
       "the one given."},
      {Severity::note, "Information."}};
  std::string page =
      "# Findings\n\nWhat lockstep notices of a scene, a start, a run or an analysis and is not an error. Every "
      "finding has "
      "a code, which\nnever changes. `lockstep describe CODE` prints what stands here, `--json` lists the findings of "
      "a run "
      "under\n`findings`, and hosts read `SimulationReport::findings`, `RunVerdict::findings` and `FindingScope`\n"
      "(`<lockstep/finding.h>`). This page is written by `lockstep reference findings`.\n";
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
