// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/run_words.h"
#include "framework/description/scene/system_of.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <lockstep/recorder.h>
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/lines.h"
#include "framework/tools/program/method_specs.h"

namespace lockstep {

std::vector<MissedEvent> missed_events(Mechanism& m, const StepLoop& sim) {
  std::vector<MissedEvent> missed;
  const std::vector<EventCourse> courses = sim.event_courses();
  for (std::size_t i = 0; i < m.events.size(); ++i)
    if (const EventRequest& e = m.events[i]; courses[i].last < 0)
      missed.push_back({e, courses[i], e.channel.empty() ? "s" : make_channel(system_of(m), e.channel).unit});
  return missed;
}

namespace {

// The texts of those findings that pass a test.
template <class Test>
std::vector<std::string> texts_of_those(std::vector<Finding> findings, const Test& test) {
  std::erase_if(findings, std::not_fn(test));
  return texts_of(findings);
}

std::string words_of(const MissedEvent& e) {
  const std::string unit = e.unit.empty() ? "" : " " + e.unit;
  if (e.asked.channel.empty())
    return fmt::format("event '{}': its time, {:g} s, was not reached", e.course.name, e.asked.event.at);
  const Event::Crossing way = e.asked.event.crossing;
  std::string words = fmt::format("event '{}': {} did not {} {:g}{}", e.course.name, e.asked.channel,
                                  way == Event::Crossing::rising    ? "rise through"
                                  : way == Event::Crossing::falling ? "fall through"
                                                                    : "cross",
                                  e.asked.crosses, unit);
  if (way != Event::Crossing::any && e.course.nearest == 0)
    words += fmt::format("; it crossed in the other direction at t = {:.6g} s", e.course.at);
  else if (std::isfinite(e.course.nearest))
    words +=
        fmt::format("; nearest value {:.6g}{} at t = {:.6g} s", e.asked.crosses + e.course.nearest, unit, e.course.at);
  return words;
}

bool is_adaptive(const EndedRun& r) { return r.sim.integrator().info().adaptive; }

const Fields<EndedRun> kMethodFields{
    {"integrator", "", "", [](const EndedRun& r) { return to_word(r.settings.integrator); }},
    {"tolerance", "", "", [](const EndedRun& r) { return is_adaptive(r) ? r.settings.tolerance.relative : NAN; },
     kUnlessEmpty},
    {"step", "s", "", [](const EndedRun& r) { return is_adaptive(r) ? NAN : r.settings.step; }, kUnlessEmpty},
    {"formulation", "", "", [](const EndedRun& r) { return to_string(r.settings.formulation); }},
    {"formulation_used", "", "", &EndedRun::formulation},
    {"solver", "", "", [](const EndedRun& r) { return to_word(r.settings.solver); }}};

const Fields<Audit::Instant> kInstantFields{{"cause", "", "cause", &Audit::Instant::cause},
                                            {"count", "", "times", &Audit::Instant::count},
                                            {"first", "s", "from", &Audit::Instant::first},
                                            {"last", "s", "to", &Audit::Instant::last},
                                            {"energy", "J", "unaccounted energy", &Audit::Instant::energy}};
const Fields<Audit> kAuditFields{
    {"verdict", "", "", &Audit::verdict},
    {"imbalance", "J", "largest error during the run", &Audit::imbalance},
    {"exchanged", "J", "exchanged", &Audit::scale},
    {"limit", "", "", [](const Audit& a) { return a.limits.energy; }},
    {"change", "J", "change of total energy", [](const Audit& a) { return a.end - a.start; }},
    {"drives", "J", "work of drives", &Audit::drives},
    {"supplied", "J", "work of motors and forces", &Audit::supplied},
    {"dissipated", "J", "dissipated", &Audit::dissipated},
    {"instants", "at single times", &Audit::instants, kInstantFields},
    {"unbooked_forces", "", "", &Audit::unbooked_forces}};
std::vector<std::string> suspect_texts(const EndedRun& run) {
  return texts_of_those(run.findings, [](const Finding& f) { return f.code() == finding::energy_suspect.code; });
}
const Fields<EndedRun> kEnergyFields =
    Fields<EndedRun>{}.with(&EndedRun::audit, kAuditFields).with({{"suspects", "", "", suspect_texts}});

double of_channel(const MissedEvent& e, double x) { return e.asked.channel.empty() ? NAN : x; }

const Fields<MissedEvent> kMissedFields{
    {"event", "", "", [](const auto& e) { return e.course.name; }},
    {"at", "s", "", [](const auto& e) { return e.asked.channel.empty() ? e.asked.event.at : NAN; }, kUnlessEmpty},
    {"channel", "", "", [](const auto& e) { return e.asked.channel; }, kUnlessEmpty},
    {"unit", "", "", [](const auto& e) { return e.asked.channel.empty() ? "" : e.unit; }, kUnlessEmpty},
    {"crosses", "", "", [](const auto& e) { return of_channel(e, e.asked.crosses); }, kUnlessEmpty},
    {"nearest", "", "", [](const auto& e) { return of_channel(e, e.asked.crosses + e.course.nearest); }, kUnlessEmpty},
    {"t", "s", "", [](const auto& e) { return of_channel(e, e.course.at); }, kUnlessEmpty}};

std::string of_its_unit(const Json& x) { return number_text(x); }  // units differ by column

const Fields<ColumnEnds> kColumnFields{
    {"name", "", "column", &ColumnEnds::name},
    {"unit", "", "unit", &ColumnEnds::unit},
    {"final", "", "", &ColumnEnds::last},
    {"min", "", "least", &ColumnEnds::least, of_its_unit},
    {"t_min", "s", "at t", &ColumnEnds::t_least},
    {"max", "", "greatest", &ColumnEnds::most, of_its_unit},
    {"t_max", "s", "at t", &ColumnEnds::t_most},
    {"resolved", "", "resolved between steps", &ColumnEnds::resolved, only_if_false}};

std::vector<ColumnEnds> columns_of(const EndedRun& run) {
  std::vector<ColumnEnds> all;
  for (const ColumnRange& range : run.recorder.ranges()) {
    const Column& column = run.recorder.table().columns()[all.size() + 1];
    all.push_back({range, column.name, column.unit});
    if (std::isnan(range.least)) all.back().at_least = fmt::format(" at t = {:.4g} s", range.t_least);
  }
  return all;
}

// The first three of many.
std::string first_places(const Json& places) {
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(places.size(), 3); ++k)
    text += (k > 0 ? "; " : "") + places[k].get<std::string>();
  if (places.empty()) return "";
  return text + " (no place given)" +
         (places.size() > 3 ? fmt::format("; and {} more (lockstep check)", places.size() - 3) : "");
}

std::vector<std::string> in_contact(const EndedRun& run) {
  std::vector<std::string> names;
  for (const auto& link : run.sim.system().links())
    if (link->unilateral() && run.sim.state().modes[link->number()]) names.push_back(link->name());
  return names;
}

std::string line_of(std::string_view label, const std::string& text) {
  return fmt::format("  {:<9}  {}\n", label, text);
}

std::string simulated(const EndedRun& run) {
  const RunSettings& set = run.settings;
  const SimulationReport& report = run.sim.report();
  const double t = run.sim.state().t;
  const double mean = report.steps > 0 ? t / static_cast<double>(report.steps) : set.step;
  const bool cut = fmt::format("{:.2g}", mean) != fmt::format("{:.2g}", set.step);  // at outputs and events
  const std::string method = run.sim.integrator().info().adaptive
                                 ? fmt::format("tolerance {:g}", set.tolerance.relative)
                             : cut ? fmt::format("mean step {:.2g} s", mean)
                                   : fmt::format("step {:g} s", set.step);
  std::string text = fmt::format("{:.6g} s{} in {} step{}, computed in {} ({}, {})", t,
                                 t < set.until ? fmt::format(" of {:.6g} s", set.until) : "", report.steps,
                                 report.steps == 1 ? "" : "s", time_text(run.seconds), to_word(set.integrator), method);
  if (report.impacts > 0) text += fmt::format(", {} impact{}", report.impacts, report.impacts == 1 ? "" : "s");
  if (!run.interrupted && !report.stopped_by.empty()) text += ", stopped by " + report.stopped_by;
  return text;
}

std::string checks(const EndedRun& run) {
  const Audit& audit = run.audit;
  const bool ok = audit.energy == Audit::Energy::conserved;
  return fmt::format("energy {} ({})   constraints {} (at most {:.2g} m)", ok ? "ok" : audit.verdict(),
                     ok && audit.scale == 0
                         ? "nothing exchanged"
                         : fmt::format("error {:.2g} J of {:.3g} J exchanged", audit.imbalance, audit.scale),
                     audit.drifted ? "VIOLATED" : "ok", audit.violation);
}

// Energy that a law, an event or an impact changed at a single time, beyond rounding.
std::string energy_jumps(const EndedRun& run) {
  std::string text;
  for (const Audit::Instant& i : run.audit.instants)
    if (run.audit.scale > 0 && std::abs(i.energy) > run.settings.tolerance.relative * run.audit.scale)
      text += line_of(
          text.empty() ? "energy" : "",
          fmt::format("{:.3g} J at {}, {}", i.energy, i.cause,
                      i.count == 1 ? fmt::format("t = {:.6g} s", i.first)
                                   : fmt::format("{} times from t = {:.6g} s to {:.6g} s", i.count, i.first, i.last)));
  return text;
}

std::vector<ColumnEnds> rounded_columns(const EndedRun& run) {
  std::vector<ColumnEnds> columns = columns_of(run);
  drop_rounding(columns, run.settings.tolerance.relative);
  return columns;
}

// A line for each column, with the times of its extremes.
std::string summary_of(const EndedRun& run) {
  using Columns = std::vector<ColumnEnds>;
  static const Fields<Columns> kTable{{"columns", "extremes of the motion", std::identity(), kColumnFields, kWhole}};
  Columns columns = rounded_columns(run);
  for (ColumnEnds& c : columns)
    if (c.most - c.least <= run.settings.tolerance.relative * std::abs(c.most)) c.t_least = c.t_most = NAN;
  return text_of(kTable.schema(), kTable(columns));
}

std::string status_of(const EndedRun& r) {
  const bool wrong = std::ranges::any_of(r.findings, [](const Finding& f) { return f.severity() == Severity::wrong; });
  return r.interrupted ? "interrupted" : wrong ? "wrong" : "ok";
}
std::string method_text(const Json& m) {
  return m["integrator"].get<std::string>() + ", formulation " + m["formulation_used"].get<std::string>();
}
const Fields<PassedPosition> kPassedFields{{"t", "s", "", &PassedPosition::t},
                                           {"indicator", "", "", &PassedPosition::indicator},
                                           {"links", "", "", &PassedPosition::links}};
const Fields<EndedRun> kDriftFields{{"violation", "m", "", [](const EndedRun& r) { return r.audit.violation; }},
                                    {"limit", "m", "", [](const EndedRun& r) { return r.audit.limits.violation; }},
                                    {"drifted", "", "", [](const EndedRun& r) { return r.audit.drifted; }}};

}  // namespace

void drop_rounding(std::vector<ColumnEnds>& columns, double tolerance) {
  tolerance = std::min(tolerance, kSlight);  // of a loose one, what is inaccurate is printed as it is
  std::map<std::string, double> largest;
  for (const ColumnEnds& c : columns)
    if (c.resolved) largest[c.unit] = std::max({largest[c.unit], std::abs(c.least), std::abs(c.most)});
  for (ColumnEnds& c : columns)
    for (double* x : {&c.least, &c.most})
      if (std::abs(*x) <= tolerance * largest[c.unit]) *x = 0;
}

std::string range_text(const ColumnEnds& c) {
  if (!(c.least <= c.most)) return "no number" + c.at_least;
  const std::string least = fmt::format("{:.4g}", c.least), most = fmt::format("{:.4g}", c.most);
  const std::string words = least == most ? least : least + c.at_least + " ... " + most + c.at_most;
  return c.resolved || least == most ? words : words + " at least";
}

std::string results_text(const std::vector<ColumnEnds>& columns, const std::string& all) {
  std::vector<std::string> cells;
  std::size_t width = 1;
  for (const ColumnEnds& c : columns) {
    cells.push_back(c.name + "  " + range_text(c) + (c.unit.empty() ? "" : " " + c.unit));
    width = std::max(width, cells.back().size() + 3);
  }
  const std::size_t per_line = std::max<std::size_t>(1, kResultsWidth / width),
                    n = std::min(cells.size(), 3 * per_line);
  std::string text;
  for (std::size_t k = 0; k < n; k += per_line) {
    std::string line;
    for (std::size_t i = k; i < std::min(n, k + per_line); ++i) line += fmt::format("{:<{}}", cells[i], width);
    line.erase(line.find_last_not_of(' ') + 1);
    if (k + per_line >= n && n < cells.size()) line += fmt::format("   (all {}: {})", cells.size(), all);
    text += line_of(k == 0 ? "results" : "", line);
  }
  return text;
}

Finding finding_of(const MissedEvent& e) {
  Finding f{&finding::event_missed, "event '" + e.course.name + "'", words_of(e)};
  f.unit = e.unit, f.t = e.course.at;
  if (!e.asked.channel.empty()) f.value = e.asked.crosses + e.course.nearest, f.limit = e.asked.crosses;
  return f;
}

const Fields<EndedRun> kRunFields{
    {"status", "", "", status_of},
    {"assembled", "", "", &EndedRun::assembled},
    {"resumed_at", "s", "", &EndedRun::resumed_at},
    {"t", "s", "", [](const EndedRun& r) { return r.sim.state().t; }},
    {"until", "s", "", [](const EndedRun& r) { return r.settings.until; }},
    {"seconds", "s", "", &EndedRun::seconds},
    {"method", "method", std::identity(), kMethodFields, method_text},
    {"steps", "", "", [](const EndedRun& r) { return r.sim.report().steps; }},
    {"rejected", "", "rejected steps", [](const EndedRun& r) { return r.sim.report().rejected; }, unless_zero},
    {"manifold_steps", "", "steps with projected stages",
     [](const EndedRun& r) { return r.sim.report().manifold_steps; }, unless_zero},
    {"evaluations", "", "", [](const EndedRun& r) { return r.sim.dynamics().work().evaluations; }},
    {"factors", "", "", [](const EndedRun& r) { return r.sim.dynamics().work().factors; }},
    {"impacts", "", "", [](const EndedRun& r) { return r.sim.report().impacts; }},
    {"in_contact", "", "in contact", in_contact},
    {"stopped_by", "", "", [](const EndedRun& r) { return r.interrupted ? "" : r.sim.report().stopped_by; }},
    {"missed_events", "", &EndedRun::missed, kMissedFields},
    {"energy", "energy", std::identity(), kEnergyFields},
    {"drift", "", std::identity(), kDriftFields},
    {"warnings", "", "", [](const EndedRun& r) { return texts_of(r.sim.report().findings); }},
    {"doubts", "", "",
     [](const EndedRun& r) {
       return texts_of_those(r.findings, [](const Finding& f) { return f.severity() == Severity::doubt; });
     }},
    {"singular_positions", "", [](const EndedRun& r) { return r.passed; }, kPassedFields},
    {"rows", "", "rows", [](const EndedRun& r) { return r.rows.n_rows(); }},
    {"columns", "", columns_of, kColumnFields},
    {"frames_taken", "", "places assumed", &EndedRun::frames_taken, first_places},
    {"notes", "", "", &EndedRun::notes},
    {"certificate", "", "", &EndedRun::certificate, kUnlessEmpty},
    {"not_unique", "", "", &EndedRun::not_unique},
    {"nearly_redundant", "", &EndedRun::near, kNearFields}};

std::string run_text(const EndedRun& run, ColumnText columns, bool verbose) {
  std::string text;
  if (run.moved || (verbose && !run.assembled.empty())) text += line_of("start", run.assembled);
  if (std::isfinite(run.resumed_at)) text += line_of("resumed", fmt::format("at t = {:.6g} s", run.resumed_at));
  text += line_of("simulated", simulated(run)) + line_of("checks", checks(run)) + energy_jumps(run);
  if (columns == ColumnText::all) text += summary_of(run);
  if (columns == ColumnText::some) text += results_text(rounded_columns(run), "--summary");
  for (const std::string& note : run.notes) text += line_of("note", note);
  for (const std::string& line : lines_of(run.certificate)) text += line_of("", line);
  return verbose ? text + text_of(kRunFields.schema(), kRunFields(run)) : text;
}

}  // namespace lockstep
