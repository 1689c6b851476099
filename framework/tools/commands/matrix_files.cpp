// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/matrix_files.h"

#include <lockstep/text.h>
#include "framework/foundation/support/csv_cells.h"
#include "framework/tools/program/growing_file.h"

namespace lockstep {
namespace {

void write_whole(const std::string& file, const std::string& text) {
  GrowingFile out(file);
  out.clear();
  out.append(text);
  out.write(), out.commit();
}

}  // namespace

void write_matrix_market(const std::string& file, const SparseMat& A, const std::string& comment) {
  std::string text = "%%MatrixMarket matrix coordinate real general\n% " + comment + "\n" + std::to_string(A.rows()) +
                     " " + std::to_string(A.cols()) + " " + std::to_string(A.nonZeros()) + "\n";
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (SparseMat::InnerIterator it(A, j); it; ++it)
      text += std::to_string(it.row() + 1) + " " + std::to_string(j + 1) + " " + text::number(it.value()) + "\n";
  write_whole(file, text);
}

void write_lines(const std::string& file, const std::vector<std::vector<std::string>>& lines) {
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t k = 0; k < line.size(); ++k) text += (k == 0 ? "" : ",") + csv_cell(line[k]);
    text += "\n";
  }
  write_whole(file, text);
}

}  // namespace lockstep
