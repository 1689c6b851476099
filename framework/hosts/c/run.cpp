// SPDX-License-Identifier: BSD-3-Clause
// The functions of runs: opening, columns, inputs, steps, the table.
#include "framework/hosts/c/run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/reading.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep::c {

void Run::add_new(const std::vector<Finding>& more, std::vector<Finding>& all) {
  for (const Finding& f : more)
    if (std::ranges::find(all, f.text(), &Finding::text) == all.end()) all.push_back(f);
}

std::vector<Finding> Run::all_findings() {
  std::vector<Finding> all = found;
  if (begun) add_new(simulation->verdict().findings, all);
  return all;
}

void Run::begin() {
  if (const State& now = simulation->state(); !std::exchange(begun, true)) started = now;
}

std::size_t Run::checked(int index, std::size_t count, const char* of) {
  if (count == 0) refuse(LOCKSTEP_USAGE, fmt::format("index of {} is {}; there is none", of, index));
  return static_cast<std::size_t>(within(index, 0, static_cast<int>(count) - 1, std::string("index of ") + of));
}

const Column& Run::column(int index) const {
  const std::vector<Column>& all = simulation->table().columns();
  return all[checked(index, all.size(), "a column")];
}

ControlInput& Run::input(int index) {
  std::deque<ControlInput>& all = simulation->system().control_inputs();
  return all[checked(index, all.size(), "an input")];
}

std::vector<std::string> lines_of(const char* text, const char* name) {
  std::vector<std::string> lines = words_at('\n', text_or(text, name));
  std::erase(lines, "");
  return lines;
}

namespace {

// The law "input" is made around an InputLaw, by which a linearisation moves it; laws of one name share it.
void keep_inputs(Registry& registry, const Run& run) {
  using Entry = decltype(registry.laws)::Entry;
  auto& entry = const_cast<Entry&>(*registry.laws.find("input"));  // NOLINT: of this registry
  entry.make = [laws = run.laws, make = entry.make](const Params& p) -> LawPtr<MotionLaw> {
    std::shared_ptr<InputLaw>& law = (*laws)[p.text("name")];
    const LawPtr<MotionLaw> reads = make(p);
    if (law == nullptr) law = std::make_shared<InputLaw>(reads);
    return law;
  };
}

// By a copy of the host's registry, with the inputs of the run and the plugins that the scene requires.
void open(Run& run, const lockstep_registry* given, const char* set, Scene scene) {
  Registry registry = given == nullptr ? builtin_registry() : Registry();
  if (given != nullptr)
    with_argument<RegistryObject>(given, "registry", [&](RegistryObject& r) { registry = r.registry; });
  scene = with_values(std::move(scene), registry, lines_of(set, "set"));
  keep_inputs(registry, run);
  Mechanism mechanism = build_observed(scene, registry);
  record_places(mechanism);
  for (const ChannelRequest& c : mechanism.run.record) run.columns.emplace_back(c.column(), c.channel);
  run.step = mechanism.run.step;
  run.simulation.emplace(std::move(mechanism));
  run.simulation->recorder().find_extremes();
}

template <class Open>
int make_run(lockstep_run** made, Open&& open_it) noexcept {
  return make<Run>(made, [&](Run& run) { run.collecting([&] { open_it(run); }); });
}

}  // namespace
}  // namespace lockstep::c

using namespace lockstep;
using namespace lockstep::c;

extern "C" {

int lockstep_open(lockstep_registry* registry, const char* file, const char* set, lockstep_run** made) {
  return make_run(made, [&](Run& run) { open(run, registry, set, read_scene(needed_text(file, "file"))); });
}

int lockstep_open_text(lockstep_registry* registry, const char* scene, const char* name, const char* set,
                       lockstep_run** made) {
  return make_run(made, [&](Run& run) {
    open(run, registry, set, scene_from_text(needed_text(scene, "scene"), text_or(name, "name", "scene")));
  });
}

int lockstep_channels(lockstep_run* run, const char** json) {
  return call_run(run, [&](Run& r, Simulation& s) {
    Value::List all;
    for (const ChannelHelp& c : channel_help(s.system()))
      all.push_back(Value::object({{"name", c.name}, {"unit", c.unit}, {"help", c.help}}));
    needed(json, "json") = r.keep(write_json(std::move(all)));
  });
}

int lockstep_record(lockstep_run* run, const char* channel, const char* name) {
  return call_run(run, [&](Run& r, Simulation& s) {
    const std::string of = needed_text(channel, "channel");
    const Request request(text_or(name, "name", channel), of);
    s.record({request});
    r.columns.push_back(request);
  });
}

int lockstep_inputs(lockstep_run* run, int* count) {
  return call_run(run, [&](Run&, Simulation& s) { needed(count, "count") = int(s.system().control_inputs().size()); });
}

int lockstep_input(lockstep_run* run, int index, const char** name, const char** unit, double* value) {
  return call_run(run, [&](Run& r, Simulation&) {
    const ControlInput& input = r.input(index);
    put(name, input.name().c_str()), put(unit, input.unit().c_str()), put(value, input.value());
  });
}

int lockstep_input_index(lockstep_run* run, const char* name, int* index) {
  return call_run(run, [&](Run&, Simulation& s) {
    const std::string& known = s.input(needed_text(name, "name")).name();
    const std::deque<ControlInput>& all = s.system().control_inputs();
    needed(index, "index") = static_cast<int>(std::ranges::find(all, known, &ControlInput::name) - all.begin());
  });
}

int lockstep_set_input(lockstep_run* run, int index, double value) {
  return call_run(run, [&](Run& r, Simulation&) { r.input(index).set(value); });
}

int lockstep_run_to_end(lockstep_run* run) {
  return call_begun(run, [](Run&, Simulation& s) { s.run(); });
}
int lockstep_run_until(lockstep_run* run, double t) {
  return call_begun(run, [&](Run&, Simulation& s) { s.run_until(t); });
}
int lockstep_advance(lockstep_run* run, double h) {
  return call_begun(run, [&](Run&, Simulation& s) { s.advance(h); });
}
int lockstep_step(lockstep_run* run, double h, double* made) {
  return call_begun(run, [&](Run& r, Simulation& s) {
    try {
      put(made, s.loop().step(h).h);
    } catch (const Error& error) {
      rethrow_of_run(s.system(), s.loop(), r.started, r.step, error);
    }
  });
}
int lockstep_time(lockstep_run* run, double* t) {
  return call_begun(run, [&](Run&, Simulation& s) { needed(t, "t") = s.state().t; });
}
int lockstep_switch(lockstep_run* run, const char* name, int active) {
  return call_begun(run, [&](Run&, Simulation& s) {
    const std::string thing = needed_text(name, "name");
    flag(active, "active") ? s.activate(thing) : s.deactivate(thing);
  });
}
int lockstep_save(lockstep_run* run, const char* file) {
  return call_begun(run, [&](Run&, Simulation& s) { s.save(needed_text(file, "file")); });
}
int lockstep_load(lockstep_run* run, const char* file) {
  return call_begun(run, [&](Run& r, Simulation& s) { s.load(needed_text(file, "file")), r.started = s.state(); });
}

int lockstep_table(lockstep_run* run, int* columns, int64_t* rows) {
  return call_run(run,
                  [&](Run&, Simulation& s) { put(columns, s.table().n_columns()), put(rows, s.table().n_rows()); });
}
int lockstep_column(lockstep_run* run, int index, const char** name, const char** unit) {
  return call_run(run, [&](Run& r, Simulation&) {
    const Column& column = r.column(index);
    put(name, column.name.c_str()), put(unit, column.unit.c_str());
  });
}
int lockstep_column_index(lockstep_run* run, const char* name, int* index) {
  return call_run(run, [&](Run&, Simulation& s) {
    const Column& column = s.table().column(needed_text(name, "name"));
    needed(index, "index") = static_cast<int>(&column - s.table().columns().data());
  });
}
int lockstep_values(lockstep_run* run, int index, const double** values, int64_t* rows) {
  return call_run(run, [&](Run& r, Simulation&) {
    const std::vector<double>& of = r.column(index).values;
    needed(values, "values") = of.data();
    put(rows, of.size());
  });
}
int lockstep_last(lockstep_run* run, int index, double* value) {
  return call_run(run, [&](Run& r, Simulation&) {
    const std::vector<double>& of = r.column(index).values;
    if (of.empty()) refuse(LOCKSTEP_USAGE, "the table has no row; run first");
    needed(value, "value") = of.back();
  });
}
int lockstep_extremes(lockstep_run* run, int index, double out[4]) {
  return call_run(run, [&](Run& r, Simulation& s) {
    r.column(index);
    const std::span<const ColumnRange> ranges = s.recorder().ranges();
    if (index == 0) refuse(LOCKSTEP_USAGE, "column 0 is the time, which has no extremes");
    if (ranges.empty()) refuse(LOCKSTEP_USAGE, "no step was made; run first");
    const ColumnRange& range = ranges[static_cast<std::size_t>(index - 1)];
    double* const to = &needed(out, "out");
    to[0] = range.least, to[1] = range.t_least, to[2] = range.most, to[3] = range.t_most;
  });
}
}
