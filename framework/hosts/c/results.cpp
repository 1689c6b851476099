// SPDX-License-Identifier: BSD-3-Clause
// The functions of runs that judge: verdict, report, findings, linearisation.
#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/tree.h"
#include "framework/hosts/c/run.h"

namespace lockstep::c {
namespace {

Value report_of(Simulation& s) {
  const SimulationReport& report = s.loop().report();
  const RunVerdict verdict = s.verdict();
  return Value::object({{"t", s.state().t},
                        {"steps", static_cast<double>(report.steps)},
                        {"rejected", static_cast<double>(report.rejected)},
                        {"largest_violation", number_or_null(report.largest_violation)},
                        {"impacts", static_cast<double>(report.impacts)},
                        {"stopped", report.stopped},
                        {"stopped_by", report.stopped_by},
                        {"right", verdict.right},
                        {"energy", verdict.audit.verdict()},
                        {"imbalance", number_or_null(verdict.audit.imbalance_share())}});
}

// Fields that do not apply are absent, as in the program's results.
Value value_of(const Finding& f) {
  Value v = Value::object({{"severity", to_string(f.severity())}, {"code", std::string(f.code())}});
  const auto text = [&](const char* key, const std::string& words) {
    if (!words.empty()) put(v, key, words);
  };
  const auto number = [&](const char* key, double x) {
    if (!std::isnan(x)) put(v, key, number_or_null(x));
  };
  text("thing", f.thing), text("message", f.message), text("advice", f.advice);
  number("value", f.value), number("limit", f.limit), text("unit", f.unit), number("t", f.t), text("place", f.place);
  return v;
}

Value list_of(const std::vector<Signal>& signals) {
  Value::List all;
  for (const Signal& s : signals) all.push_back(Value::object({{"name", s.name}, {"unit", s.unit}}));
  return all;
}

// About the present state, by dynamics of its own: six velocities a body, without stabilisation.
StateSpace linearized(Run& run, Simulation& s, const char* names, const LinearMotionOptions& options) {
  std::vector<Request> wanted;
  for (const std::string& name : lines_of(names, "outputs")) {
    const std::size_t index = static_cast<std::size_t>(&s.table().column(name) - s.table().columns().data());
    if (index == 0) refuse(LOCKSTEP_USAGE, "outputs: \"" + name + "\" is the time, which is no output");
    wanted.push_back(run.columns[index - 1]);
  }
  std::vector<Channel> outputs;
  for (const Request& column : names != nullptr ? wanted : run.columns)
    outputs.push_back(make_channel(s.system(), column.channel)), outputs.back().name = column.name;
  std::vector<LinearInput> inputs;
  for (const ControlInput& input : s.system().control_inputs())
    inputs.push_back({input.name(), input.unit(), run.laws->at(input.name())});
  Dynamics dynamics(s.system(), make_solver(MethodSpec{"schur"}, builtin_registry(), "linearisation"),
                    {.formulation = Formulation::omega, .stabilization = {.kind = Stabilization::Kind::none}});
  return linearize(dynamics, s.dynamics().in_slots(s.state()), inputs, outputs, options);
}

const StateSpace& space_of(const Run& run) {
  if (!run.space) refuse(LOCKSTEP_USAGE, "nothing was linearised; call lockstep_linearize first");
  return *run.space;
}

}  // namespace
}  // namespace lockstep::c

using namespace lockstep;
using namespace lockstep::c;

extern "C" {

int lockstep_verdict(lockstep_run* run, int* right) {
  return call_begun(run, [&](Run&, Simulation& s) { needed(right, "right") = s.verdict().right ? 1 : 0; });
}

int lockstep_report(lockstep_run* run, const char** json) {
  return call_begun(run, [&](Run& r, Simulation& s) { needed(json, "json") = r.keep(write_json_line(report_of(s))); });
}

int lockstep_findings(lockstep_run* run, int* count) {
  return call_run(run, [&](Run& r, Simulation&) { needed(count, "count") = int(r.all_findings().size()); });
}

int lockstep_finding(lockstep_run* run, int index, const char** text, const char** json) {
  return call_run(run, [&](Run& r, Simulation&) {
    std::vector<Finding> all = r.all_findings();
    if (index != -1) all = {all[Run::checked(index, all.size(), "a finding")]};
    Value::List values;
    std::string lines;
    for (const Finding& f : all) values.push_back(value_of(f)), lines += (lines.empty() ? "" : "\n") + f.text();
    r.more_text = write_json_line(index == -1 ? Value(std::move(values)) : values.front());
    put(text, r.keep(lines)), put(json, r.more_text.c_str());
  });
}

int lockstep_linearize(lockstep_run* run, const char* outputs, int frozen, const double* spin) {
  return call_begun(run, [&](Run& r, Simulation& s) {
    r.space.reset();
    LinearMotionOptions options{.frozen = flag(frozen, "frozen")};
    if (spin != nullptr) check_given(spin, 3, "spin"), options.spin = Vec3(spin[0], spin[1], spin[2]);
    r.space = linearized(r, s, outputs, options);
    Run::add_new(r.space->notes, r.found);
  });
}

int lockstep_matrix(lockstep_run* run, int which, const double** values, int* rows, int* columns) {
  return call_run(run, [&](Run& r, Simulation&) {
    const StateSpace& space = space_of(r);
    const MatX* const all[] = {&space.A, &space.B, &space.C, &space.D};
    if (which < 'A' || which > 'D')
      refuse(LOCKSTEP_USAGE, "which is " + std::to_string(which) + "; must be 'A', 'B', 'C' or 'D'");
    r.matrix = all[which - 'A']->transpose();
    needed(values, "values") = r.matrix.data();
    put(rows, r.matrix.cols()), put(columns, r.matrix.rows());
  });
}

int lockstep_signals(lockstep_run* run, const char** json) {
  return call_run(run, [&](Run& r, Simulation&) {
    const StateSpace& space = space_of(r);
    needed(json, "json") = r.keep(write_json_line(Value::object({{"states", list_of(space.states)},
                                                                 {"inputs", list_of(space.inputs)},
                                                                 {"outputs", list_of(space.outputs)},
                                                                 {"accuracy", number_or_null(space.accuracy)}})));
  });
}
}
