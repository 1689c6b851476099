// SPDX-License-Identifier: BSD-3-Clause
// Cells of CSV files: what is written reads back.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/recorder.h>
#include <lockstep/splines.h>
#include "framework/foundation/support/csv_cells.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace csv_cells_test {

using namespace lockstep;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

TEST_CASE("csv cells: texts read back as they were, on one line", "[unit][csv]") {
  const std::vector<std::string> texts = {"plain", "", "a,b", "say \"no\"", "\"", " blanks ", "x; y [m/s]"};
  std::string line;
  for (const std::string& text : texts) line += (line.empty() ? "" : ",") + csv_cell(text);
  std::vector<std::string> cells;
  REQUIRE_FALSE(split_csv(line, ',', cells));
  REQUIRE(cells.size() == texts.size());
  for (std::size_t k = 0; k < texts.size(); ++k) CHECK(cells[k] == (texts[k] == " blanks " ? "blanks" : texts[k]));
  CHECK(csv_cell("plain") == "plain");
  CHECK(csv_cell("say \"no\"") == "\"say \"\"no\"\"\"");
  CHECK(csv_cell("two\nlines\t") == "\"two lines\t\"");
  CHECK(csv_cell("\x19one\rtwo") == "\"\x19one\rtwo\"");
  CHECK(csv_cell("\xEF\xBB\xBFx") == "\"\xEF\xBB\xBFx\"");  // no byte order mark
}

TEST_CASE("csv cells: quotes that are not closed, or inside a cell, are found at their places", "[unit][csv]") {
  struct Line {
    const char* text;
    std::size_t column;
    const char* problem;
  };
  const Line lines[] = {{"0,\"0", 3, "is not closed"},
                        {"\"0,1", 1, "is not closed"},
                        {"a,\"b\"\"", 3, "is not closed"},
                        {"0,\"", 3, "is not closed"},
                        {"0,1\"", 4, "inside an unquoted cell"},
                        {"5\" pipe,2", 2, "inside an unquoted cell"},
                        {"1,2\"3\"", 4, "inside an unquoted cell"},
                        {"1,\"2\"3", 6, "after the closing quote"},
                        {"1,\"2\" \"3\"", 7, "inside an unquoted cell"},
                        {"\xC3\xA4,\xC3\xB6,\"x", 5, "is not closed"}};  // columns count characters
  std::vector<std::string> cells;
  for (const Line& line : lines) {
    CAPTURE(line.text);
    const auto fault = split_csv(line.text, ',', cells);
    REQUIRE(fault);
    CHECK(csv_column(line.text, fault->byte) == line.column);
    CHECK(fault->problem.find(line.problem) != std::string::npos);
  }
  std::vector<std::size_t> begins;
  CHECK_FALSE(split_csv("1, \"a \"\"b\"\", c\" ,,x\r", ',', cells, &begins));
  CHECK(cells == std::vector<std::string>{"1", "a \"b\", c", "", "x"});
  CHECK(begins == std::vector<std::size_t>{0, 2, 17, 18});
}

TEST_CASE("csv: a law's table is rejected at a wrong quote or number of cells", "[unit][csv]") {
  const std::string file =
      (std::filesystem::temp_directory_path() / ("lockstep_cells_test_" + std::to_string(getpid()) + ".csv")).string();
  const auto refused = [&](const std::string& text) {
    std::ofstream(file) << text;
    return message_of<FileError>([&] { read_columns(file, "t", {"y"}); });
  };
  check_words(refused("t,y\n0,\"0\n0.5,1\n1,2\n"), {file + ":2:3: ", "a quote is not closed"});
  check_words(refused("t,y\n0,0\n0.5,1\"\n1,2\n"), {file + ":3:6: ", "a quote inside an unquoted cell"});
  check_words(refused("t,\"y\n0,0\n"), {file + ":1:3: ", "a quote is not closed"});
  check_words(refused("t;y\n0;0\n0,2;\"1\"1\n"), {file + ":3:8: ", "text after the closing quote"});
  check_words(refused("t,y\n0,0\n0.2,0,02\n"),
              {file + ":3:7: has 3 cells, the first line has 2"});  // the first surplus
  check_words(refused("t,y\n0,0\n 0.25 \r\n"), {file + ":3:6: has 1 cell, the first line has 2"});  // the end
  CHECK(refused("\"t\",\"y\"\n\"0\",\"0\"\n\"1\", \"2\" \n") == "no error");
  CHECK(read_columns(file, "t", {"y"}).y(1, 0) == 2);
  CHECK(refused("t,y\n# a \" in a remark\n0,0\n1,1\n") == "no error");
  std::istringstream table("t [s],x [m]\n0,\"1\n");
  check_words(message_of<FileError>([&] { read_csv(table, "run.csv"); }), {"run.csv:2:3: ", "a quote is not"});
  std::filesystem::remove(file);
}

}  // namespace csv_cells_test
