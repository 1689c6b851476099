// SPDX-License-Identifier: BSD-3-Clause
// The verb matrices: M, D, K, J and the right sides at an instant, with names.
#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include <lockstep/error.h>
#include <lockstep/linearization.h>
#include <lockstep/text.h>
#include "framework/tools/commands/matrix_files.h"
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"

namespace lockstep {
namespace {

using Lines = std::vector<std::vector<std::string>>;

const char* word(RowKind kind) {
  return kind == RowKind::translation ? "translation" : kind == RowKind::rotation ? "rotation" : "function";
}

Lines unknown_lines(const MechanismMatrices& m) {
  Lines lines = {{"number", "name", "unit", "v", "f", "a"}};
  for (std::size_t i = 0; i < m.unknowns.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    lines.push_back({std::to_string(i + 1), m.unknowns[i].name, m.unknowns[i].unit, text::number(m.v[k]),
                     text::number(m.f[k]), text::number(m.a[k])});
  }
  return lines;
}

Lines row_lines(const MechanismMatrices& m) {
  Lines lines = {{"number", "name", "kind", "C", "Ct", "c", "lambda"}};
  for (std::size_t i = 0; i < m.rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    lines.push_back({std::to_string(i + 1), m.rows[i], word(m.kinds[i]), text::number(m.C[k]), text::number(m.Ct[k]),
                     text::number(m.c[k]), text::number(m.lambda[k])});
  }
  return lines;
}

struct Named {
  const char *name, *what;
  const SparseMat& matrix;
};

std::vector<Named> all_of(const MechanismMatrices& m) {
  return {{"M", "mass: rows and columns are unknowns.csv", m.M},
          {"D", "d(inertia - forces)/dv: rows and columns are unknowns.csv", m.D},
          {"K", "d(inertia + J^T lambda - forces)/dx: rows and columns are unknowns.csv", m.K},
          {"J", "jacobian: rows are rows.csv, columns are unknowns.csv", m.J}};
}

}  // namespace

int matrices_command(const Arguments& args) {
  namespace fs = std::filesystem;
  const Loaded loaded = load(args);
  const MechanismAt at = state_at(loaded, instant_of(args));
  const System::InSpace look = at.dynamics->look_in_space();
  const MechanismMatrices m = matrices_at(*at.dynamics, at.state);
  std::vector<std::string> files;
  if (!args["--out"].empty()) {
    std::error_code error;
    fs::create_directories(args["--out"], error);
    if (error) throw FileError("folder '" + args["--out"] + "' cannot be made: " + error.message() + "; name another");
    const auto file = [&](const std::string& name) {
      return files.emplace_back((fs::path(args["--out"]) / name).string());
    };
    const std::string where = fmt::format("{} at t = {} s", loaded.scene.file, text::number(at.state.t));
    for (const char* name : {"unknowns.csv", "rows.csv", "M.mtx", "D.mtx", "K.mtx", "J.mtx"})
      check_overwrites((fs::path(args["--out"]) / name).string(), loaded.scene);
    for (const Named& each : all_of(m))
      write_matrix_market(file(std::string(each.name) + ".mtx"), each.matrix,
                          fmt::format("{} of {}", each.what, where));
    write_lines(file("unknowns.csv"), unknown_lines(m));
    write_lines(file("rows.csv"), row_lines(m));
  }
  if (args.has("--json")) {
    nlohmann::ordered_json j = {{"scene", loaded.scene.file}, {"t", at.state.t}};
    const auto numbers = [](const VecX& v) { return std::vector<double>(v.begin(), v.end()); };
    j["unknowns"] = nlohmann::ordered_json::array();
    for (const UnknownVelocity& u : m.unknowns) j["unknowns"].push_back({{"name", u.name}, {"unit", u.unit}});
    j["rows"] = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < m.rows.size(); ++k)
      j["rows"].push_back({{"name", m.rows[k]}, {"kind", word(m.kinds[k])}});
    for (const Named& each : all_of(m)) {
      auto entries = nlohmann::ordered_json::array();  // [row, column, value], from 1 as in Matrix Market
      for (Eigen::Index c = 0; c < each.matrix.cols(); ++c)
        for (SparseMat::InnerIterator it(each.matrix, c); it; ++it)
          entries.push_back({it.row() + 1, c + 1, it.value()});
      j[each.name] = {{"rows", each.matrix.rows()}, {"columns", each.matrix.cols()}, {"entries", entries}};
    }
    j["v"] = numbers(m.v), j["f"] = numbers(m.f), j["a"] = numbers(m.a);
    j["C"] = numbers(m.C), j["Ct"] = numbers(m.Ct), j["c"] = numbers(m.c), j["lambda"] = numbers(m.lambda);
    j["files"] = files;
    print_result(j);
    return kExitOk;
  }
  fmt::print("{}\n  t = {:.6g} s: {} unknown velocities, {} rows;  M a + J^T lambda = f,  J a = c\n", loaded.title(),
             at.state.t, m.unknowns.size(), m.rows.size());
  for (const Named& each : all_of(m))
    fmt::print("  {}  {} x {}, {} numbers\n", each.name, each.matrix.rows(), each.matrix.cols(),
               each.matrix.nonZeros());
  for (const std::string& name : files) fmt::print("  written    {}\n", name);
  if (files.empty())
    fmt::print("  --out DIR writes them as Matrix Market, with the names as CSV; --json prints them\n");
  return kExitOk;
}

}  // namespace lockstep
