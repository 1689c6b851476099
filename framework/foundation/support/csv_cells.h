// SPDX-License-Identifier: BSD-3-Clause
// The cells of a line of a CSV file (RFC 4180).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep {

/// What is wrong with the quotes of a line.
struct CsvFault {
  std::size_t byte = 0;  ///< its place, from the line's begin
  std::string problem;
};

/// Splits a line at its separators, which count as text inside of double quotes; a quote inside of quotes is doubled.
/// Blanks around cells are removed. `begins`: where cells begin, in bytes. A cell in quotes holds nothing outside them, and
/// ends on its line; else the fault is returned, and the cells are those before it.
[[nodiscard]] LOCKSTEP_API std::optional<CsvFault> split_csv(std::string_view line, char separator,
                                                             std::vector<std::string>& cells,
                                                             std::vector<std::size_t>* begins = nullptr);

/// The column, from 1, of a byte of a line of UTF-8.
LOCKSTEP_API std::size_t csv_column(std::string_view line, std::size_t byte);

/// A text as a cell of a line: line feeds as blanks, so that the line stays one; in quotes, its own doubled, where it holds
/// a comma, a quote or a carriage return, has blanks at its ends, or begins with what reads as a byte order mark.
LOCKSTEP_API std::string csv_cell(std::string_view text);

/// Removes the mark that some programs write before UTF-8. Returns false if the text is UTF-16 instead.
LOCKSTEP_API bool take_byte_order_mark(std::string& first_line);

}  // namespace lockstep
