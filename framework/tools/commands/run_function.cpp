// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/run_function.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/place.h"
#include "framework/description/scene/reading.h"
#include "framework/description/scene/system_of.h"
#include "framework/mechanism/expression/expression.h"
#include "framework/mechanism/params/units.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/report/histories.h"
#include "framework/tools/sweep/watched_run.h"

namespace lockstep {

Sides sides_of(const std::string& option, const std::string& comparison) {
  using expression::Operation;
  return as_usage(option, [&] {
    std::string text(text::trimmed(comparison));
    if (text.starts_with('=')) text.erase(0, 1);
    for (std::size_t i = 1; i + 1 < text.size(); ++i)
      if (text[i] == '=' && text[i + 1] != '=' && std::string_view("<>!=").find(text[i - 1]) == std::string::npos)
        text.insert(i++, 1, '=');
    static const std::vector<std::string> kTime{"t"};
    const expression::Expression read(text, kTime, expression::Naming::channels);
    const expression::Node& root = read.node(read.root());
    if (root.operation < Operation::less || root.operation > Operation::equal)
      throw ModelError("\"" + comparison + "\" compares nothing; write \"max(T) = 3 N m\" or \"max(T) < 3 N m\"");
    const std::size_t n = text[root.at + 1] == '=' ? 2 : 1;
    const auto part = [&](std::size_t from, std::size_t to) {
      return std::string(text::trimmed(text.substr(from, to)));
    };
    return Sides{part(0, root.at), part(root.at, n), part(root.at + n, text.size())};
  });
}

RunFunction::RunFunction(VariedScene varied, const Interrupt& interrupt)
    : varied_(std::move(varied)), interrupt_(interrupt) {
  override_settings(varied_.loaded.scene.run, varied_.arguments, varied_.loaded.registry);
  built_ = build_mechanism(varied_.loaded.scene, varied_.loaded.registry);
  like_.add_column("t", "s");
}

void RunFunction::add(const std::string& option, const std::string& text, const std::string& formula) {
  as_usage(option, [&] {
    if (built_.run.until < 0) throw ModelError("the scene has no end time; give --until");
    const std::string of_channels =
        without_columns((formula.starts_with('=') ? "" : "=") + formula, varied_.loaded.scene);
    like_.add_column(option + " " + text, make_channel(system_of(built_), of_channels).unit);
    formulas_.push_back({of_channels, option + " " + text, {}});
    return 0;
  });
}

std::optional<double> RunFunction::given(std::size_t k) const try {
  Value root = varied_.loaded.scene.root;
  const std::string in_set = "set.", &place = varied_.variables[k].place;
  const Value& value =
      *find_place(root, place.starts_with(in_set) ? place.substr(in_set.size()) : place, varied_.loaded.registry).value;
  if (const double* x = value.number()) return *x;
  const Measured read = read_quantity(value.text() != nullptr ? *value.text() : "", Unit::any);
  return read.problem.empty() ? std::optional(read.value) : std::nullopt;
} catch (const ModelError&) {
  return {};
}

Scene RunFunction::scene(const Point& x) const {
  std::vector<Variable> variables = varied_.variables;
  for (std::size_t k = 0; k < x.size(); ++k) variables[k].values = {Value(x[k])};
  Scene s = vary_scene(varied_.loaded.scene, variables, std::vector<std::size_t>(x.size()), varied_.loaded.registry);
  override_settings(s.run, varied_.arguments, varied_.loaded.registry);
  return s;
}

SweepRun RunFunction::at(const Point& x, StepSequence* steps) const {
  const FindingScope unheard;  // the scene as it is written was read before
  SweepRun run;
  try {
    Scene s = scene(x);
    s.run.record = formulas_;
    run = watched_run(s, varied_.loaded.registry, like_, goes_on(), nullptr, {.steps = steps});
  } catch (const std::exception& error) {
    run.failed = true, run.status = error.what();
  }
  if (run.broken_off) run.failed = true, run.status = "interrupted";
  const auto is_finite = [](const ColumnRange& c) { return std::isfinite(c.last); };
  if (!run.failed && (run.columns.empty() || !std::ranges::all_of(run.columns, is_finite)))
    run.status = run.wrong ? run.outcome() : "a formula has no finite value at the end of the run", run.failed = true;
  return run;
}

SweepRun RunFunction::succeeded(const Point& x, StepSequence* steps) const {
  SweepRun run = at(x, steps);
  if (interrupt_.asked()) throw InterruptedError("interrupted");
  if (run.failed) throw Error(fmt::format("the run with {} failed: {}", text(x), run.status));
  return run;
}

std::vector<Variable> RunFunction::shown(const Point& x) const {
  std::vector<Variable> all = varied_.shown;
  for (std::size_t k = 0; k < x.size(); ++k)
    all[k].values = {Value(all[k].unit.empty() ? x[k] : x[k] / in_si(1, all[k].unit).value)};
  return all;
}

std::string RunFunction::text(const Point& x) const {
  std::string all;
  for (const Variable& v : shown(x))
    all += (all.empty() ? "" : ", ") + v.path + " = " + with_unit(*v.values[0].number(), v.unit);
  return all;
}

Outcome RunFunction::outcome(const std::string& name, const Point& x, const SweepRun& run) const {
  const double value = run.columns[0].last;
  Outcome o{fmt::format("{}{} with {}", name.empty() ? "" : name + " = ", with_unit(value, unit(0)), text(x)),
            Json::object(), value, unit(0)};
  for (std::size_t k = 0; k < x.size(); ++k) o.values[varied_.variables[k].path] = x[k];
  if (run.outcome() != "ok") o.status = run.outcome();
  return o;
}

void RunFunction::check_files() const {
  const std::string &file = varied_.arguments["--write"], &report = varied_.arguments["--report"];
  if (!report.empty()) report_path(report, file, varied_.loaded.scene);
  if (file.empty()) return;
  check_overwrites(file, varied_.loaded.scene);
  check_writable(file);
}

void RunFunction::conclude(Result& result, const std::vector<Point>& points, const std::vector<SweepRun>& runs,
                           std::size_t best) const {
  const Scene found = scene(points[best]);
  const std::string &file = varied_.arguments["--write"], &page = varied_.arguments["--report"];
  if (!file.empty()) result.write(file, write_json(found.written.is_null() ? found.root : found.written));
  CommandFindings::add(runs[best].findings);
  result.code = runs[best].wrong ? kExitNotConserved : kExitOk;
  if (page.empty()) return;
  const FindingScope unheard;  // they were reported above
  report::Histories kept(2);
  std::string rows = sweep_header(varied_.shown, like_);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const long number = static_cast<long>(i + 1);
    rows += sweep_row(number, shown(points[i]), std::vector<std::size_t>(n()), like_, runs[i]);
    if (runs[i].failed || (i != 0 && i != best)) continue;
    const Scene s = scene(points[i]);
    const std::unique_ptr<report::Frames> seen = kept.watcher();
    Table history;
    watched_run(s, varied_.loaded.registry, recorded_columns(s, varied_.loaded.registry), goes_on(), &history,
                {seen.get(), [&](const Mechanism& m, const Table& table) { kept.add(number, table, *seen, m); }});
  }
  write_runs_report(page, text_of(varied_.arguments, varied_.loaded), rows, "run",
                    column_title({like_.columns()[1].name + " final", unit(0), {}}), false, &kept, best + 1);
  result.files.push_back(page);
}

std::string with_unit(double value, const std::string& unit) {
  return fmt::format("{:.6g}{}", value, unit.empty() ? "" : " " + unit);
}

}  // namespace lockstep
