// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/run_words.h"
#include "framework/description/scene/system_of.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include <lockstep/recorder.h>
#include <lockstep/sweep.h>
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/method_specs.h"

namespace lockstep {
namespace {

using Json = nlohmann::ordered_json;

std::string counted(long n, const char* one, const char* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }

Json energy_of(const EndedRun& ended) {
  const Audit& audit = ended.audit;
  Json instants = Json::array();
  for (const Audit::Instant& i : audit.instants)
    instants.push_back(
        {{"cause", i.cause}, {"count", i.count}, {"first", i.first}, {"last", i.last}, {"energy", i.energy}});
  return {{"verdict", audit.verdict()},
          {"imbalance", json_number(audit.imbalance)},
          {"exchanged", json_number(audit.scale)},
          {"limit", audit.limits.energy},
          {"change", json_number(audit.end - audit.start)},
          {"drives", json_number(audit.drives)},
          {"supplied", json_number(audit.supplied)},
          {"dissipated", json_number(audit.dissipated)},
          {"instants", std::move(instants)},
          {"unbooked_forces", audit.unbooked_forces},
          {"suspects", texts_of(of_kind(ended.findings, finding::energy_suspect))}};
}

Json columns_of(const RowEnvelope& rows) {
  Json all = Json::array();
  const SweepRun ranges = rows.ranges();
  const Table table = rows.table();
  for (std::size_t k = 0; k < ranges.columns.size(); ++k) {
    const Column& column = table.columns()[k + 1];
    const ColumnRange& r = ranges.columns[k];
    all.push_back({{"name", column.name},
                   {"unit", column.unit},
                   {"final", json_number(r.last)},
                   {"min", json_number(r.least)},
                   {"max", json_number(r.most)}});
  }
  return all;
}

}  // namespace

std::vector<Finding> of_severity(const std::vector<Finding>& findings, Severity severity) {
  std::vector<Finding> some;
  std::ranges::copy_if(findings, std::back_inserter(some), [&](const Finding& f) { return f.severity() == severity; });
  return some;
}
std::vector<Finding> of_kind(const std::vector<Finding>& findings, const FindingKind& kind) {
  std::vector<Finding> some;
  std::ranges::copy_if(findings, std::back_inserter(some), [&](const Finding& f) { return f.code() == kind.code; });
  return some;
}

std::vector<MissedEvent> missed_events(Mechanism& m, const StepLoop& sim) {
  std::vector<MissedEvent> missed;
  const std::vector<EventCourse> courses = sim.event_courses();
  for (std::size_t i = 0; i < m.events.size(); ++i)
    if (const EventRequest& e = m.events[i]; courses[i].last < 0)
      missed.push_back({e, courses[i], e.channel.empty() ? "s" : make_channel(system_of(m), e.channel).unit});
  return missed;
}

namespace {

std::string words_of(const MissedEvent& e) {
  const std::string unit = e.unit.empty() ? "" : " " + e.unit;
  if (e.asked.channel.empty())
    return fmt::format("event '{}': its instant, {:g} s, did not come", e.course.name, e.asked.event.at);
  const Event::Crossing way = e.asked.event.crossing;
  std::string words = fmt::format("event '{}': {} did not {} {:g}{}", e.course.name, e.asked.channel,
                                  way == Event::Crossing::rising    ? "rise through"
                                  : way == Event::Crossing::falling ? "fall through"
                                                                    : "cross",
                                  e.asked.crosses, unit);
  if (way != Event::Crossing::any && e.course.nearest == 0)
    words += fmt::format("; it passed there the other way at t = {:.6g} s", e.course.at);
  else if (std::isfinite(e.course.nearest))
    words += fmt::format("; nearest {:.6g}{} at t = {:.6g} s", e.asked.crosses + e.course.nearest, unit, e.course.at);
  return words;
}

Json json_of(const MissedEvent& e) {
  Json j = {{"event", e.course.name}};
  if (e.asked.channel.empty()) return j["at"] = e.asked.event.at, j;
  j.update({{"channel", e.asked.channel},
            {"unit", e.unit},
            {"crosses", e.asked.crosses},
            {"nearest", json_number(e.asked.crosses + e.course.nearest)},
            {"t", json_number(e.course.at)}});
  return j;
}

}  // namespace

Finding finding_of(const MissedEvent& e) {
  Finding f{&finding::event_missed, "event '" + e.course.name + "'", words_of(e)};
  f.unit = e.unit, f.t = e.course.at;
  if (!e.asked.channel.empty()) f.value = e.asked.crosses + e.course.nearest, f.limit = e.asked.crosses;
  return f;
}

std::string rows_of(long n) { return counted(n, "row", "rows"); }

std::string end_words(const EndedRun& ended, const Summary& summary) {
  StepLoop& sim = ended.sim;
  const Audit& audit = ended.audit;
  std::string words;
  const auto say = [&]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
    words += fmt::format(format, std::forward<Args>(args)...);
  };
  const SimulationReport& r = sim.report();
  const std::string rejected =
      sim.integrator().info().adaptive ? fmt::format(" ({} rejected)", counted(r.rejected, "try", "tries")) : "";
  say("  run        t = {:.6g} s in {} of {}{}, formulation {}, {:.3g} s of computing\n", sim.state().t,
      counted(r.steps, "step", "steps"), ended.settings.integrator.type, rejected, ended.formulation, ended.seconds);
  if (r.manifold_steps > 0)
    say("  stages     on the constraints in {} of {}, as singular positions or rows that are redundant only there ask "
        "for\n",
        r.manifold_steps, counted(r.steps, "step", "steps"));
  for (const Finding& f : of_severity(ended.findings, Severity::doubt)) say("  DOUBTFUL   {}\n", f.text());
  for (const Finding& f : of_kind(ended.findings, finding::stiff)) say("  stiff      {}\n", f.text());
  const auto& links = sim.system().links();
  const auto resting = std::count_if(links.begin(), links.end(), [&](const auto& link) {
    return link->unilateral() && sim.state().modes[link->number()];
  });
  if (r.impacts > 0 || resting > 0)
    say("  impacts    {} of one-sided links; {} of them {} in contact at the end\n", r.impacts, resting,
        resting == 1 ? "is" : "are");
  if (r.stopped && !r.stopped_by.empty() && !ended.interrupted) say("  stopped    by '{}'\n", r.stopped_by);
  for (const Finding& f : of_kind(ended.findings, finding::event_missed)) say("  never      {}\n", f.text());
  say("{}", summary.text());
  say("{}", words_of(audit, summary.nothing_moved()));
  for (const Finding& f : of_kind(ended.findings, finding::energy_not_conserved))
    say("  NOT CONSERVED  {}\n", f.text());
  for (const Finding& f : of_kind(ended.findings, finding::energy_not_judged)) say("  NOT JUDGED  {}\n", f.text());
  const char* word = "suspect";
  for (const Finding& f : of_kind(ended.findings, finding::energy_suspect))
    say("  {:<10} {}\n", std::exchange(word, ""), f.text());
  for (const Finding& f : of_kind(ended.findings, finding::constraints_drifted)) say("  DRIFTED    {}\n", f.text());
  if (!sim.system().links().empty() && !audit.drifted)
    say("  drift      constraints violated by at most {:.2g} m after a step\n", r.largest_violation);
  return words;
}

Json json_of(const EndedRun& ended, const RowEnvelope& rows) {
  StepLoop& sim = ended.sim;
  const RunSettings& run = ended.settings;
  const Audit& audit = ended.audit;
  const SimulationReport& r = sim.report();
  const WorkCount& work = sim.dynamics().work();
  const char* status = ended.interrupted ? "interrupted" : audit.is_wrong() ? "wrong" : "ok";
  Json method = {{"integrator", to_word(run.integrator)}};
  if (sim.integrator().info().adaptive)
    method["tolerance"] = run.tolerance.relative;
  else
    method["step"] = run.step;
  method["formulation"] = to_string(run.formulation), method["formulation_used"] = ended.formulation;
  method["solver"] = to_word(run.solver);
  Json singular = Json::array();
  for (const PassedPosition& p : ended.passed)
    singular.push_back({{"t", p.t}, {"indicator", json_number(p.indicator)}, {"links", p.links}});
  Json missed = Json::array();
  for (const MissedEvent& each : ended.missed) missed.push_back(json_of(each));
  Json j = {
      {"status", status},
      {"t", sim.state().t},
      {"until", run.until},
      {"seconds", ended.seconds},
      {"method", std::move(method)},
      {"steps", r.steps},
      {"rejected", r.rejected},
      {"evaluations", work.evaluations},
      {"factors", work.factors},
      {"impacts", r.impacts},
      {"stopped_by", r.stopped_by},
      {"missed_events", std::move(missed)},
      {"energy", energy_of(ended)},
      {"drift",
       {{"violation", json_number(audit.violation)}, {"limit", audit.limits.violation}, {"drifted", audit.drifted}}},
      {"warnings", texts_of(r.findings)},
      {"doubts", texts_of(of_severity(ended.findings, Severity::doubt))},
      {"singular_positions", std::move(singular)},
      {"rows", rows.n_rows()},
      {"columns", columns_of(rows)}};
  return j;
}

}  // namespace lockstep
