// SPDX-License-Identifier: BSD-3-Clause
// Matrices as files: Matrix Market, and the names of rows and columns as CSV.
#pragma once

#include <string>
#include <vector>

#include <lockstep/linearization.h>

namespace lockstep {

/// Writes a sparse matrix as Matrix Market, coordinate real general; every number reads back as the same double.
/// `comment`: one line. Throws FileError.
void write_matrix_market(const std::string& file, const SparseMat&, const std::string& comment);

/// Writes lines of cells as CSV; a cell with a comma or a quote is put in quotes. Throws FileError.
void write_lines(const std::string& file, const std::vector<std::vector<std::string>>& lines);

}  // namespace lockstep
