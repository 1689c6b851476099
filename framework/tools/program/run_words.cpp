#include "framework/description/scene/system_of.h"
#include "framework/tools/program/run_words.h"

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
          {"suspects", ended.suspects}};
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

std::vector<std::string> doubts_of(const EndedRun& ended) {
  StepLoop& sim = ended.sim;
  std::vector<std::string> all = ended.doubts.words(sim.report().steps, sim.state().t);
  if (!ended.passed.empty())
    all.insert(all.begin(), passed_words(ended.passed, ended.n_passed, sim.integrator().info(),
                                         sim.dynamics().options().stabilization.kind == Stabilization::Kind::project));
  return all;
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
  for (const std::string& doubt : doubts_of(ended)) say("  DOUBTFUL   {}\n", doubt);
  if (std::isfinite(r.stiff_since))
    say("  stiff      from t = {:.4g} s on damped fast modes limited the steps, not accuracy: an implicit method is "
        "cheaper (--integrator radau5 or generalized_alpha)\n",
        r.stiff_since);
  const auto& links = sim.system().links();
  const auto resting = std::count_if(links.begin(), links.end(), [&](const auto& link) {
    return link->unilateral() && sim.state().modes[link->number()];
  });
  if (r.impacts > 0 || resting > 0)
    say("  impacts    {} of one-sided links; {} of them {} in contact at the end\n", r.impacts, resting,
        resting == 1 ? "is" : "are");
  if (r.stopped && !r.stopped_by.empty() && !ended.interrupted) say("  stopped    by '{}'\n", r.stopped_by);
  for (const MissedEvent& missed : ended.missed) say("  never      {}\n", words_of(missed));
  say("{}", summary.text());
  say("{}", words_of(audit, summary.nothing_moved(), sim.integrator().info().adaptive));
  const char* word = "suspect";
  for (const std::string& clause : ended.suspects) say("  {:<10} {}\n", std::exchange(word, ""), clause);
  if (!sim.system().links().empty())
    say("  {}    constraints violated by at most {:.2g} m after a step{}\n", audit.drifted ? "DRIFTED" : "drift  ",
        r.largest_violation,
        audit.drifted ? fmt::format(" (limit {:.2g} m): project them (stabilization project)", audit.limits.violation)
                      : "");
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
      {"warnings", r.warnings},
      {"doubts", doubts_of(ended)},
      {"singular_positions", std::move(singular)},
      {"rows", rows.n_rows()},
      {"columns", columns_of(rows)}};
  return j;
}

}  // namespace lockstep
