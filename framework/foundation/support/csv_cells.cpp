#include "framework/foundation/support/csv_cells.h"

#include <lockstep/text.h>

namespace lockstep {

void split_csv(std::string_view line, char separator, std::vector<std::string>& cells) {
  cells.assign(1, {});
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && inside && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[++i];
    else if (c == '"')
      inside = !inside;
    else if (c == separator && !inside)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  for (std::string& cell : cells) cell = std::string(text::trimmed(cell));
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
