// Cells of CSV files: what is written reads back.
#include <string>
#include <vector>

#include "framework/foundation/support/csv_cells.h"
#include "tests/support/catch.h"

namespace csv_cells_test {

using namespace lockstep;

TEST_CASE("csv cells: texts read back as they were, on one line", "[unit][csv]") {
  const std::vector<std::string> texts = {"plain", "", "a,b", "say \"no\"", "\"", " blanks ", "x; y [m/s]"};
  std::string line;
  for (const std::string& text : texts) line += (line.empty() ? "" : ",") + csv_cell(text);
  std::vector<std::string> cells;
  split_csv(line, ',', cells);
  REQUIRE(cells.size() == texts.size());
  for (std::size_t k = 0; k < texts.size(); ++k) CHECK(cells[k] == (texts[k] == " blanks " ? "blanks" : texts[k]));
  CHECK(csv_cell("plain") == "plain");
  CHECK(csv_cell("say \"no\"") == "\"say \"\"no\"\"\"");
  CHECK(csv_cell("two\nlines\t") == "\"two lines\t\"");
  CHECK(csv_cell("\x19one\rtwo") == "\"\x19one\rtwo\"");
  CHECK(csv_cell("\xEF\xBB\xBFx") == "\"\xEF\xBB\xBFx\"");  // no byte order mark
}

}  // namespace csv_cells_test
