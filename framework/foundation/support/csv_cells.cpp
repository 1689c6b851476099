// SPDX-License-Identifier: BSD-3-Clause
#include "framework/foundation/support/csv_cells.h"

#include <algorithm>

#include <lockstep/text.h>

namespace lockstep {

namespace {

// The last cell of a line that is being split.
enum class InCell { plain, inside_quotes, behind_quotes };

bool only_blanks(std::string_view text) { return text::trimmed(text).empty(); }

}  // namespace

std::optional<CsvFault> split_csv(std::string_view line, char separator, std::vector<std::string>& cells,
                                  std::vector<std::size_t>* begins) {
  cells.assign(1, {});
  if (begins != nullptr) begins->assign(1, 0);
  std::optional<CsvFault> fault;
  InCell at = InCell::plain;
  std::size_t opened = 0;
  for (std::size_t i = 0; i < line.size() && !fault; ++i) {
    const char c = line[i];
    if (at == InCell::inside_quotes) {
      if (c != '"')
        cells.back() += c;
      else if (i + 1 < line.size() && line[i + 1] == '"')
        cells.back() += line[++i];
      else
        at = InCell::behind_quotes;
    } else if (c == separator) {
      cells.emplace_back(), at = InCell::plain;
      if (begins != nullptr) begins->push_back(i + 1);
    } else if (c == '"' && at == InCell::plain && only_blanks(cells.back())) {
      cells.back().clear(), at = InCell::inside_quotes, opened = i;
    } else if (c == '"') {
      fault = {i, "a quote inside an unquoted cell; put the cell in quotes and double the quotes inside it"};
    } else if (at == InCell::plain) {
      cells.back() += c;
    } else if (!only_blanks(line.substr(i, 1))) {
      fault = {i, "text after the closing quote of a cell; put a separator there"};
    }
  }
  if (at == InCell::inside_quotes) fault = {opened, "a quote is not closed on its line; close or remove it"};
  for (std::string& cell : cells) cell = std::string(text::trimmed(cell));
  return fault;
}

std::size_t csv_column(std::string_view line, std::size_t byte) {
  const auto goes_on = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; };
  const std::string_view before = line.substr(0, byte);
  return 1 + before.size() - static_cast<std::size_t>(std::ranges::count_if(before, goes_on));
}

std::string csv_cell(std::string_view text) {
  std::string plain, doubled;
  for (const char c : text) {
    plain += c == '\n' ? ' ' : c;
    if (c == '"') doubled += '"';
    doubled += plain.back();
  }
  const bool whole = plain == text::trimmed(plain) && plain.find_first_of(",\"\r") == std::string::npos &&
                     !plain.starts_with("\xEF\xBB\xBF");
  return whole ? plain : '"' + doubled + '"';
}

bool take_byte_order_mark(std::string& first_line) {
  if (first_line.starts_with("\xEF\xBB\xBF")) first_line.erase(0, 3);
  return !first_line.starts_with("\xFF\xFE") && !first_line.starts_with("\xFE\xFF");
}

}  // namespace lockstep
