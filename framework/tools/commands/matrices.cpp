// SPDX-License-Identifier: BSD-3-Clause
// The command matrices: M, D, K, J and the right-hand sides at one time, with names.
#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include <lockstep/linearization.h>
#include <lockstep/text.h>
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/files.h"

namespace lockstep {
namespace {

using Lines = std::vector<std::vector<std::string>>;

Lines unknown_lines(const MechanismMatrices& m) {
  Lines lines = {{"number", "name", "unit", "v", "f", "a"}};
  for (std::size_t i = 0; i < m.unknowns.size(); ++i)
    lines.push_back({std::to_string(i + 1), m.unknowns[i].name, m.unknowns[i].unit, text::number(m.v[i]),
                     text::number(m.f[i]), text::number(m.a[i])});
  return lines;
}

Lines row_lines(const MechanismMatrices& m) {
  Lines lines = {{"number", "name", "kind", "C", "Ct", "c", "lambda"}};
  for (std::size_t i = 0; i < m.rows.size(); ++i)
    lines.push_back({std::to_string(i + 1), m.rows[i], word_of(m.kinds[i]), text::number(m.C[i]), text::number(m.Ct[i]),
                     text::number(m.c[i]), text::number(m.lambda[i])});
  return lines;
}

struct FoundMatrices {
  double t;
  MechanismMatrices m;
};
using NamedRow = std::pair<std::string, std::string>;  // its kind

const Fields<UnknownVelocity> kUnknownFields{{"name", "", "name", &UnknownVelocity::name},
                                             {"unit", "", "unit", &UnknownVelocity::unit}};
const Fields<NamedRow> kNamedRowFields{{"name", "", "name", &NamedRow::first}, {"kind", "", "kind", &NamedRow::second}};
const Fields<SparseMat> kSparseFields{{"rows", "", "rows", [](const SparseMat& A) { return A.rows(); }},
                                      {"columns", "", "columns", [](const SparseMat& A) { return A.cols(); }},
                                      {"entries", "", "entries", [](const SparseMat& A) {
                                         std::vector<std::vector<double>> all;  // from 1, as in Matrix Market
                                         for (Eigen::Index c = 0; c < A.cols(); ++c)
                                           for (SparseMat::InnerIterator it(A, c); it; ++it)
                                             all.push_back({it.row() + 1.0, c + 1.0, it.value()});
                                         return all;
                                       }}};
std::vector<NamedRow> named_rows(const MechanismMatrices& m) {
  std::vector<NamedRow> all;
  for (std::size_t k = 0; k < m.rows.size(); ++k) all.push_back({m.rows[k], word_of(m.kinds[k])});
  return all;
}
std::string size_text(const Json& A) {
  return fmt::format("{} x {}, {} numbers", A["rows"].dump(), A["columns"].dump(), A["entries"].size());
}
const Fields<MechanismMatrices> kMatricesFields{{"unknowns", "unknowns", &MechanismMatrices::unknowns, kUnknownFields},
                                                {"rows", "constraints", named_rows, kNamedRowFields},
                                                {"M", "M", &MechanismMatrices::M, kSparseFields, size_text},
                                                {"D", "D", &MechanismMatrices::D, kSparseFields, size_text},
                                                {"K", "K", &MechanismMatrices::K, kSparseFields, size_text},
                                                {"J", "J", &MechanismMatrices::J, kSparseFields, size_text},
                                                {"v", "", "", &MechanismMatrices::v},
                                                {"f", "", "", &MechanismMatrices::f},
                                                {"a", "", "", &MechanismMatrices::a},
                                                {"C", "", "", &MechanismMatrices::C},
                                                {"Ct", "", "", &MechanismMatrices::Ct},
                                                {"c", "", "", &MechanismMatrices::c},
                                                {"lambda", "", "", &MechanismMatrices::lambda}};
const Fields<FoundMatrices> kMatrixFields =
    Fields<FoundMatrices>{{"t", "s", "t", &FoundMatrices::t}}.with(&FoundMatrices::m, kMatricesFields);

// Every number reads back as the same double.
std::string matrix_market(const SparseMat& A, const std::string& comment) {
  std::string text = "%%MatrixMarket matrix coordinate real general\n% " + comment + "\n" + std::to_string(A.rows()) +
                     " " + std::to_string(A.cols()) + " " + std::to_string(A.nonZeros()) + "\n";
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (SparseMat::InnerIterator it(A, j); it; ++it)
      text += std::to_string(it.row() + 1) + " " + std::to_string(j + 1) + " " + text::number(it.value()) + "\n";
  return text;
}

// Files of --out.
void write_all(const std::string& folder, double t, const MechanismMatrices& m, const Scene& scene, Result& result) {
  make_folder(folder);
  const auto market = [&](const SparseMat& A, const char* what) {
    return matrix_market(A, fmt::format("{} of {} at t = {} s", what, scene.file, text::number(t)));
  };
  const std::pair<const char*, std::string> files[] = {
      {"M.mtx", market(m.M, "mass: rows and columns are unknowns.csv")},
      {"D.mtx", market(m.D, "d(inertia - forces)/dv: rows and columns are unknowns.csv")},
      {"K.mtx", market(m.K, "d(inertia + J^T lambda - forces)/dx: rows and columns are unknowns.csv")},
      {"J.mtx", market(m.J, "Jacobian: rows are rows.csv, columns are unknowns.csv")},
      {"unknowns.csv", csv_of(unknown_lines(m))},
      {"rows.csv", csv_of(row_lines(m))}};
  const auto path = [&](const char* name) { return (std::filesystem::path(folder) / name).string(); };
  for (const auto& [name, text] : files) check_overwrites(path(name), scene);
  for (const auto& [name, text] : files) result.write(path(name), text);
}

Result find_matrices(const Arguments& args) {
  const Loaded loaded = load(args);
  const MechanismAt at = state_at(std::make_unique<Mechanism>(build_mechanism(loaded.scene, loaded.registry)),
                                  loaded.registry, instant_of(args));
  const System::InSpace look = at.dynamics->look_in_space();
  const FoundMatrices found{at.state.t, matrices_at(*at.dynamics, at.state)};
  Result result(loaded, kMatrixFields, found);
  if (!args["--out"].empty()) write_all(args["--out"], found.t, found.m, loaded.scene, result);
  return result;
}

}  // namespace

Command matrices_command() {
  return {
      "matrices",
      join(
          {scene_options(),
           {kAt, kJson, {"--out", "DIR", "folder for M, D, K and J as Matrix Market, and rows.csv and unknowns.csv"}}}),
      find_matrices,
      "M a + J^T lambda = f, J a = c. The unknowns are velocities in space, also for a planar motion. The numbers are\n"
      "printed by --json and written by --out.\n\nExample:\n  lockstep "
      "matrices samples/scenes/four_bar.json --at 0.1 --out four_bar",
      {&kMatrixFields.schema()}};
}

}  // namespace lockstep
