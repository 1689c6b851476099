// SPDX-License-Identifier: BSD-3-Clause
// The verb linearize: A, B, C, D with named inputs and outputs.
#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include <lockstep/error.h>
#include <lockstep/linearization.h>
#include <lockstep/text.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/commands/linear_inputs.h"
#include "framework/tools/commands/linear_words.h"
#include "framework/tools/commands/matrix_files.h"
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"

namespace lockstep {
namespace {

std::string with_unit(const Signal& s) { return s.unit.empty() ? s.name : s.name + " [" + s.unit + "]"; }

nlohmann::ordered_json signals_json(const std::vector<Signal>& signals) {
  auto all = nlohmann::ordered_json::array();
  for (const Signal& s : signals) all.push_back({{"name", s.name}, {"unit", s.unit}});
  return all;
}

nlohmann::ordered_json matrix_json(const MatX& A) {
  auto rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    auto row = nlohmann::ordered_json::array();
    for (Eigen::Index j = 0; j < A.cols(); ++j) row.push_back(A(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

// One table: rows are x' and y, columns x and u.
void write_table(const std::string& file, const StateSpace& s) {
  std::vector<std::vector<std::string>> lines(1, {"of"});
  for (const Signal& x : s.states) lines[0].push_back(with_unit(x));
  for (const Signal& u : s.inputs) lines[0].push_back(with_unit(u));
  const auto add = [&](const std::string& name, const MatX& left, const MatX& right, Eigen::Index row) {
    std::vector<std::string>& line = lines.emplace_back(1, name);
    for (const double x : left.row(row)) line.push_back(text::number(x));
    for (const double x : right.row(row)) line.push_back(text::number(x));
  };
  for (std::size_t k = 0; k < s.states.size(); ++k)
    add("d/dt " + with_unit(s.states[k]), s.A, s.B, static_cast<Eigen::Index>(k));
  for (std::size_t k = 0; k < s.outputs.size(); ++k)
    add(with_unit(s.outputs[k]), s.C, s.D, static_cast<Eigen::Index>(k));
  write_lines(file, lines);
}

void print_matrix(const char* name, const MatX& A) {
  constexpr Eigen::Index kMost = 12;
  fmt::print("  {}  {} x {}\n", name, A.rows(), A.cols());
  if (A.rows() > kMost || A.cols() > kMost) return;
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    std::string line = "    ";
    for (Eigen::Index j = 0; j < A.cols(); ++j) line += fmt::format(" {:>13.6g}", A(i, j));
    fmt::print("{}\n", line);
  }
}

std::string names_of_signals(const std::vector<Signal>& signals) {
  std::vector<std::string> names;
  for (const Signal& s : signals) names.push_back(with_unit(s));
  return names.empty() ? "none" : text::join(names, ", ");
}

}  // namespace

int linearize_command(const Arguments& args) {
  if (args.has("--json") && !args["--csv"].empty())
    throw UsageError("--json and --csv: the numbers are printed or written, not both; give one of the two");
  const Loaded loaded = load(args);
  if (!args["--csv"].empty()) check_overwrites(args["--csv"], loaded.scene);
  MechanismWithInputs built = build_with_inputs(loaded.scene, loaded.registry, args.all("--inputs"));
  std::vector<Channel> outputs;
  for (const std::string& name : args.all("--outputs"))
    outputs.push_back(make_channel(system_of(*built.mechanism), name));
  const MechanismAt at = state_at(std::move(built.mechanism), loaded.registry, instant_of(args));
  const StateSpace s = with_words_of_program(
      [&] { return linearize(*at.dynamics, at.state, built.inputs, outputs, motion_options(args)); });
  if (!args["--csv"].empty()) write_table(args["--csv"], s);
  if (args.has("--json")) {
    nlohmann::ordered_json j = {{"scene", loaded.scene.file},
                                {"t", at.state.t},
                                {"states", signals_json(s.states)},
                                {"inputs", signals_json(s.inputs)},
                                {"outputs", signals_json(s.outputs)},
                                {"A", matrix_json(s.A)},
                                {"B", matrix_json(s.B)},
                                {"C", matrix_json(s.C)},
                                {"D", matrix_json(s.D)},
                                {"accuracy", s.accuracy},
                                {"state", state_json(s.spin, s.unrest, s.notes)}};
    print_result(j);
    return kExitOk;
  }
  fmt::print("{}\n{}", loaded.title(), state_words(at.state.t, s.spin, s.unrest, s.notes));
  fmt::print("  x          {}\n  u          {}\n  y          {}\n", names_of_signals(s.states),
             names_of_signals(s.inputs), names_of_signals(s.outputs));
  fmt::print("  accuracy   {:.1g} of B, C and D (two steps of a central difference of sixth order)\n", s.accuracy);
  print_matrix("A", s.A), print_matrix("B", s.B), print_matrix("C", s.C), print_matrix("D", s.D);
  if (!args["--csv"].empty()) fmt::print("  written    {}\n", args["--csv"]);
  return kExitOk;
}

}  // namespace lockstep
