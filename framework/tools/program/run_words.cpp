// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/run_words.h"
#include "framework/description/scene/system_of.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/recorder.h>
#include <lockstep/sweep.h>
#include "framework/tools/program/method_specs.h"

namespace lockstep {
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

}  // namespace

Finding finding_of(const MissedEvent& e) {
  Finding f{&finding::event_missed, "event '" + e.course.name + "'", words_of(e)};
  f.unit = e.unit, f.t = e.course.at;
  if (!e.asked.channel.empty()) f.value = e.asked.crosses + e.course.nearest, f.limit = e.asked.crosses;
  return f;
}

namespace {

const Fields<EndedRun>& method_fields() {
  using Run = EndedRun;
  constexpr auto adaptive = [](const Run& r) { return r.sim.integrator().info().adaptive; };
  static const Fields<Run> kFields{
      {"integrator", "", "", [](const Run& r) { return to_word(r.settings.integrator); }},
      Field<Run>("tolerance", "", "", [=](const Run& r) { return adaptive(r) ? r.settings.tolerance.relative : NAN; })
          .optional(),
      Field<Run>("step", "s", "", [=](const Run& r) { return adaptive(r) ? NAN : r.settings.step; }).optional(),
      {"formulation", "", "", [](const Run& r) { return to_string(r.settings.formulation); }},
      {"formulation_used", "", "", &Run::formulation},
      {"solver", "", "", [](const Run& r) { return to_word(r.settings.solver); }}};
  return kFields;
}

const Fields<EndedRun>& energy_fields() {
  using Run = EndedRun;
  using Instant = Audit::Instant;
  static const Fields<Instant> kInstant{{"cause", "", "cause", &Instant::cause},
                                        {"count", "", "times", &Instant::count},
                                        {"first", "s", "from", &Instant::first},
                                        {"last", "s", "to", &Instant::last},
                                        {"energy", "J", "energy", &Instant::energy}};
  static const Fields<Run> kFields{
      {"verdict", "", "verdict", [](const Run& r) { return r.audit.verdict(); }},
      {"imbalance", "J", "imbalance", [](const Run& r) { return r.audit.imbalance; }},
      {"exchanged", "J", "exchanged", [](const Run& r) { return r.audit.scale; }},
      {"limit", "", "", [](const Run& r) { return r.audit.limits.energy; }},
      {"change", "J", "change", [](const Run& r) { return r.audit.end - r.audit.start; }},
      {"drives", "J", "work of drives", [](const Run& r) { return r.audit.drives; }},
      {"supplied", "J", "of motors and forces", [](const Run& r) { return r.audit.supplied; }},
      {"dissipated", "J", "dissipated", [](const Run& r) { return r.audit.dissipated; }},
      {"instants", "at instants", [](const Run& r) { return r.audit.instants; }, kInstant},
      {"unbooked_forces", "", "", [](const Run& r) { return r.audit.unbooked_forces; }},
      {"suspects", "", "", [](const Run& r) { return texts_of(of_kind(r.findings, finding::energy_suspect)); }}};
  return kFields;
}

const Fields<MissedEvent>& missed_fields() {
  using Missed = MissedEvent;
  constexpr auto of_channel = [](const Missed& e, double x) { return e.asked.channel.empty() ? NAN : x; };
  static const Fields<Missed> kFields{
      {"event", "", "", [](const Missed& e) { return e.course.name; }},
      Field<Missed>("at", "s", "", [](const Missed& e) { return e.asked.channel.empty() ? e.asked.event.at : NAN; })
          .optional(),
      Field<Missed>("channel", "", "", [](const Missed& e) { return e.asked.channel; }).optional(),
      Field<Missed>("unit", "", "", [](const Missed& e) { return e.asked.channel.empty() ? "" : e.unit; }).optional(),
      Field<Missed>("crosses", "", "", [=](const Missed& e) { return of_channel(e, e.asked.crosses); }).optional(),
      Field<Missed>("nearest", "", "",
                    [=](const Missed& e) { return of_channel(e, e.asked.crosses + e.course.nearest); })
          .optional(),
      Field<Missed>("t", "s", "", [=](const Missed& e) { return of_channel(e, e.course.at); }).optional()};
  return kFields;
}

struct ColumnEnds {
  std::string name, unit;
  ColumnRange range;
};
const Fields<ColumnEnds>& column_fields() {
  static const Fields<ColumnEnds> kFields{{"name", "", "", &ColumnEnds::name},
                                          {"unit", "", "", &ColumnEnds::unit},
                                          {"final", "", "", [](const ColumnEnds& c) { return c.range.last; }},
                                          {"min", "", "", [](const ColumnEnds& c) { return c.range.least; }},
                                          {"max", "", "", [](const ColumnEnds& c) { return c.range.most; }}};
  return kFields;
}
std::vector<ColumnEnds> columns_of(const EndedRun& run) {
  std::vector<ColumnEnds> all;
  const SweepRun ranges = run.rows->ranges();
  const Table table = run.rows->table();
  for (std::size_t k = 0; k < ranges.columns.size(); ++k)
    all.push_back({table.columns()[k + 1].name, table.columns()[k + 1].unit, ranges.columns[k]});
  return all;
}

// The first three of many.
std::string first_places(const Json& places) {
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(places.size(), 3); ++k)
    text += (k > 0 ? "; " : "") + places[k].get<std::string>();
  if (places.empty()) return "";
  return text + ", as no place is given" +
         (places.size() > 3 ? fmt::format("; and {} more (lockstep check)", places.size() - 3) : "");
}

std::vector<std::string> in_contact(const EndedRun& run) {
  std::vector<std::string> names;
  for (const auto& link : run.sim.system().links())
    if (link->unilateral() && run.sim.state().modes[link->number()]) names.push_back(link->name());
  return names;
}

}  // namespace

const Fields<EndedRun>& run_fields() {
  using Run = EndedRun;
  static const Fields<PassedPosition> kPassed{{"t", "s", "", &PassedPosition::t},
                                              {"indicator", "", "", &PassedPosition::indicator},
                                              {"links", "", "", &PassedPosition::links}};
  static const Fields<Run> kDrift{{"violation", "m", "", [](const Run& r) { return r.audit.violation; }},
                                  {"limit", "m", "", [](const Run& r) { return r.audit.limits.violation; }},
                                  {"drifted", "", "", [](const Run& r) { return r.audit.drifted; }}};
  constexpr auto status = [](const Run& r) {
    return r.interrupted ? "interrupted" : r.audit.is_wrong() ? "wrong" : "ok";
  };
  constexpr auto method = +[](const Json& m) {
    return m["integrator"].get<std::string>() + ", formulation " + m["formulation_used"].get<std::string>();
  };
  constexpr auto drift = +[](const Json& d) {
    return d["violation"] == 0
               ? std::string()
               : fmt::format("constraints violated by at most {} m after a step", number_text(d["violation"]));
  };
  static const Fields<Run> kFields{
      {"status", "", "", status},
      {"assembled", "", "assembled", &Run::assembled},
      {"resumed_at", "s", "resumed at t", &Run::resumed_at},
      {"t", "s", "t", [](const Run& r) { return r.sim.state().t; }},
      {"until", "s", "", [](const Run& r) { return r.settings.until; }},
      {"seconds", "s", "computed in", &Run::seconds},
      {"method", "method", std::identity(), method_fields(), method},
      {"steps", "", "steps", [](const Run& r) { return r.sim.report().steps; }},
      {"rejected", "", "rejected", [](const Run& r) { return r.sim.report().rejected; }, unless_zero},
      {"manifold_steps", "", "on the constraints", [](const Run& r) { return r.sim.report().manifold_steps; },
       unless_zero},
      {"evaluations", "", "", [](const Run& r) { return r.sim.dynamics().work().evaluations; }},
      {"factors", "", "", [](const Run& r) { return r.sim.dynamics().work().factors; }},
      {"impacts", "", "impacts", [](const Run& r) { return r.sim.report().impacts; }, unless_zero},
      {"in_contact", "", "in contact", in_contact},
      {"stopped_by", "", "stopped by", [](const Run& r) { return r.interrupted ? "" : r.sim.report().stopped_by; }},
      {"missed_events", "", &Run::missed, missed_fields()},
      {"moved", "moved", &Run::moved, way_fields()},
      {"energy", "energy", std::identity(), energy_fields()},
      {"drift", "drift", std::identity(), kDrift, drift},
      {"warnings", "", "", [](const Run& r) { return texts_of(r.sim.report().findings); }},
      {"doubts", "", "", [](const Run& r) { return texts_of(of_severity(r.findings, Severity::doubt)); }},
      {"singular_positions", "", [](const Run& r) { return r.passed; }, kPassed},
      {"rows", "", "rows", [](const Run& r) { return r.rows->n_rows(); }},
      {"columns", "", columns_of, column_fields()},
      {"frames_taken", "", "taken", &Run::frames_taken, first_places},
      {"notes", "", "pictures", &Run::notes},
      Field<Run>("certificate", "", "certificate", &Run::certificate).optional(),
      {"not_unique", "", "", &Run::not_unique},
      {"nearly_redundant", "", &Run::near, near_fields()}};
  return kFields;
}

}  // namespace lockstep
