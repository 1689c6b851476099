// SPDX-License-Identifier: BSD-3-Clause
// The command linearize: A, B, C, D with named inputs and outputs.
#include <spdlog/fmt/fmt.h>

#include <lockstep/linearization.h>
#include <lockstep/text.h>
#include "framework/tools/commands/linear_words.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/run_words.h"

namespace lockstep {
namespace {

std::string title_of(const Signal& s) { return column_title({s.name, s.unit, {}}); }

// One table: rows are x' and y, columns x and u.
std::string csv_text(const StateSpace& s) {
  std::vector<std::vector<std::string>> lines(1, {"of"});
  for (const Signal& x : s.states) lines[0].push_back(title_of(x));
  for (const Signal& u : s.inputs) lines[0].push_back(title_of(u));
  const auto add = [&](const std::string& name, const MatX& left, const MatX& right, Eigen::Index row) {
    std::vector<std::string>& line = lines.emplace_back(1, name);
    for (const double x : left.row(row)) line.push_back(text::number(x));
    for (const double x : right.row(row)) line.push_back(text::number(x));
  };
  for (std::size_t k = 0; k < s.states.size(); ++k)
    add("d/dt " + title_of(s.states[k]), s.A, s.B, static_cast<Eigen::Index>(k));
  for (std::size_t k = 0; k < s.outputs.size(); ++k)
    add(title_of(s.outputs[k]), s.C, s.D, static_cast<Eigen::Index>(k));
  return csv_of(lines);
}

struct Linearized {
  StateFound state;
  StateSpace space;
};

std::string small_matrix(const Json& A) {
  const std::size_t most = kResultsWidth / 7;
  const std::size_t columns = A.empty() ? 0 : A[0].size();
  if (columns == 0) return "";
  std::string text = fmt::format("{} x {}", A.size(), columns);
  if (A.size() > most || columns > most) return text + " (numbers: --csv FILE.csv or --json)";
  for (const Json& row : A) {
    text += "\n ";
    for (const Json& x : row)
      text += x.is_null() ? fmt::format(" {:>13}", "-") : fmt::format(" {:>13.6g}", x.get<double>());
  }
  return text;
}

const Fields<Signal> kSignalFields{{"name", "", "name", &Signal::name}, {"unit", "", "unit", &Signal::unit}};
const Fields<StateSpace> kSpaceFields{{"states", "x", &StateSpace::states, kSignalFields},
                                      {"inputs", "u", &StateSpace::inputs, kSignalFields},
                                      {"outputs", "y", &StateSpace::outputs, kSignalFields},
                                      {"A", "", "A", &StateSpace::A, small_matrix},
                                      {"B", "", "B", &StateSpace::B, small_matrix},
                                      {"C", "", "C", &StateSpace::C, small_matrix},
                                      {"D", "", "D", &StateSpace::D, small_matrix},
                                      // two steps of a central difference of sixth order
                                      {"accuracy", "", "accuracy of B, C, D", &StateSpace::accuracy}};
const Fields<Linearized> kLinearizeFields =
    Fields<Linearized>{}.with(&Linearized::state, kStateFields).with(&Linearized::space, kSpaceFields);

MechanismWithInputs inputs_of(const Loaded& loaded, const Arguments& args) {
  try {
    return build_with_inputs(loaded.scene, loaded.registry, args.all("--inputs"));
  } catch (const UnknownInput& error) {
    throw UsageError(std::string("--inputs: ") + error.what());
  }
}

Result linearize_scene(const Arguments& args) {
  const Loaded loaded = load(args);
  if (args.has("--json") && !args["--csv"].empty())
    throw UsageError("--json and --csv exclude each other; give one of the two");
  if (!args["--csv"].empty()) check_overwrites(args["--csv"], loaded.scene);
  MechanismWithInputs built = inputs_of(loaded, args);
  const std::vector<Channel> outputs = channels_of(*built.mechanism, args.all("--outputs"));
  const MechanismAt at = motion_state(std::move(built.mechanism), loaded.registry, args);
  const StateSpace s = with_advice(
      kAdvice, [&] { return linearize(*at.dynamics, at.state, built.inputs, outputs, motion_options(args)); });
  CommandFindings::add(s.notes);
  Result result(loaded, kLinearizeFields, Linearized{{at.state.t, s.spin, s.unrest}, s});
  if (!args["--csv"].empty()) result.write(args["--csv"], csv_text(s));
  return result;
}

}  // namespace

Command linearize_command() {
  return {"linearize",
          join({motion_command_options(),
                {Option{"--inputs", "A,B",
                        "driven joints (A, or A.rz of several drives: value and its first two rates), forces (motor, "
                        "pad.x), laws (rope.length, table.translation.x)"},
                 Option{"--outputs", "A,B",
                        "recorded columns, or channels as `lockstep check SCENE --channels` lists them"},
                 {"--csv", "FILE.csv", "one table: rows x' and y, columns x and u"}}}),
          linearize_scene,
          R"(x' = A x + B u, y = C x + D u. The states are one displacement per degree of freedom, then their rates.

Example:
  lockstep linearize samples/scenes/mass_spring_damper_fast.json --set bodies.mass_c.velocity.0=0 --set bodies.mass_c.position.0=0 --inputs push_c --outputs mass_c.x,mass_c.ax)",
          {&kLinearizeFields.schema()}};
}

}  // namespace lockstep
