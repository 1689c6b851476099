// The cells of a line of a CSV file (RFC 4180).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <lockstep/export.h>

namespace lockstep {

/// Splits a line at its separators, which count as text inside of double quotes; a quote inside of quotes is doubled.
/// Blanks around cells are removed.
LOCKSTEP_API void split_csv(std::string_view line, char separator, std::vector<std::string>& cells);

/// A text as a cell of a line: line feeds as blanks, so that the line stays one; in quotes, its own doubled, where it holds
/// a comma, a quote or a carriage return, has blanks at its ends, or begins with what reads as a byte order mark.
LOCKSTEP_API std::string csv_cell(std::string_view text);

/// Removes the mark that some programs write before UTF-8. Returns false if the text is UTF-16 instead.
LOCKSTEP_API bool take_byte_order_mark(std::string& first_line);

}  // namespace lockstep
