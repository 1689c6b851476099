// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/recorder.h>

#include <unistd.h>

#include <clocale>
#include <cmath>
#include <filesystem>
#include <limits>
#include <locale>
#include <sstream>

#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace table_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

Table three_rows() {
  Table table;
  table.add_column("t", "s");
  table.add_column("Bx", "N");
  table.add_column("count");
  for (double t : {0.0, 0.1, 0.2}) {
    const double row[] = {t, std::sqrt(2.0) * std::exp(80 * t), 1.0 + std::round(10 * t)};
    table.add_row(row);
  }
  return table;
}

std::string failure(const std::string& text) {
  std::istringstream in(text);
  return message_of<FileError>([&] { read_csv(in, "x.csv"); });
}

}  // namespace

TEST_CASE("a table finds columns by name and detects their change", "[unit][record]") {
  const Table table = three_rows();
  CHECK(table.n_rows() == 3);
  CHECK(table["t"] == std::vector<double>{0.0, 0.1, 0.2});
  CHECK(table.change("count") == 2);
  CHECK(table.first("count") == 1);
  CHECK(table.last("t") == 0.2);
  CHECK(column_title(table.column("Bx")) == "Bx [N]");
  CHECK(column_title(table.column("count")) == "count");
  check_words(message_of<ModelError>([&] { table.column("bx "); }), {"did you mean \"Bx\"?"});
}

TEST_CASE("a table rejects ambiguous columns", "[unit][record]") {
  Table table = three_rows();
  check_words(message_of<ModelError>([&] { table.add_column("late"); }), {"too late"});
  Table fresh;
  fresh.add_column("a");
  check_words(message_of<ModelError>([&] { fresh.add_column("a"); }), {"two columns named \"a\""});
  check_words(message_of<ModelError>([&] { fresh.add_column(""); }), {"column 2 of the table has no name"});
  check_words(message_of<ModelError>([&] { fresh.change("a"); }), {"no rows"});
}

TEST_CASE("CSV brings back the same numbers, names and units", "[unit][record]") {
  Table table;
  table.add_column("t", "s");
  table.add_column("a, \"b\" [c]", "m/s^2");
  table.add_column("plain");
  const double values[][3] = {{0.1, -1e-310, std::numeric_limits<double>::max()},
                              {1.0 / 3.0, std::nextafter(1.0, 2.0), -std::numeric_limits<double>::infinity()},
                              {-0.0, std::numeric_limits<double>::denorm_min(), 12345678.0}};
  for (const auto& row : values) table.add_row(row);
  std::stringstream text;
  write_csv(text, table);
  const Table back = read_csv(text, "x.csv");
  REQUIRE(back.n_columns() == 3);
  REQUIRE(back.n_rows() == 3);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(back.columns()[k].name == table.columns()[k].name);
    CHECK(back.columns()[k].unit == table.columns()[k].unit);
    for (std::size_t i = 0; i < 3; ++i) CHECK(back.columns()[k].values[i] == values[i][k]);
  }
  CHECK(std::signbit(back["t"][2]));
}

TEST_CASE("CSV is what a person would write", "[unit][record]") {
  Table table;
  table.add_column("t", "s");
  table.add_column("Bx", "N");
  const double row[] = {0.1, -2};
  table.add_row(row);
  std::ostringstream text;
  write_csv(text, table);
  CHECK(text.str() == "t [s],Bx [N]\n0.1,-2\n");
}

TEST_CASE("CSV does not ask the locale", "[unit][record]") {
  const char* const comma = std::setlocale(LC_ALL, "de_DE.UTF-8");
  Table table;
  table.add_column("t", "s");
  const double row[] = {1234.5};
  table.add_row(row);
  struct Commas : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::stringstream text;
  text.imbue(std::locale(std::locale::classic(), new Commas));
  write_csv(text, table);
  CHECK(text.str() == "t [s]\n1234.5\n");
  CHECK(read_csv(text, "x.csv")["t"][0] == 1234.5);
  if (comma) std::setlocale(LC_ALL, "C");
}

TEST_CASE("CSV reads foreign files: no units, blanks, carriage returns, a byte order mark", "[unit][record]") {
  std::istringstream in("\xEF\xBB\xBFt, phi_d ,Fx [kN]\r\n0, +1.5,2\r\n\r\n1,nan,4e-3\r\n");
  const Table table = read_csv(in, "x.csv");
  CHECK(table.names() == std::vector<std::string>{"t", "phi_d", "Fx"});
  CHECK(table.column("Fx").unit == "kN");
  CHECK(table["phi_d"][0] == 1.5);
  CHECK(std::isnan(table["phi_d"][1]));
  CHECK(table.n_rows() == 2);
}

TEST_CASE("a unit of nothing in a CSV header is none, and what is written of it reads back alike", "[unit][record]") {
  std::istringstream in("t [],n [m] [],k\n0,1,2\n");
  std::stringstream text;
  write_csv(text, read_csv(in, "x.csv"));
  CHECK(text.str() == "t,n [m],k\n0,1,2\n");
  const Table back = read_csv(text, "x.csv");
  CHECK(back.names() == std::vector<std::string>{"t", "n", "k"});
  CHECK(back.column("t").unit.empty());
  CHECK(back.column("n").unit == "m");
}

TEST_CASE("CSV faults are reported with file and line", "[unit][record]") {
  check_words(failure("t,a\n0,1\n1,two\n"), {"x.csv:3", "\"a\"", "\"two\""});
  check_words(failure("t,a\n0,1\n1\n"), {"x.csv:3", "1 cells", "2 columns"});
  check_words(failure("t,a\n0,1e999\n"), {"x.csv:2", "1e999"});
  check_words(failure("t,a\n0,\n"), {"x.csv:2", "not a number"});
  check_words(failure("t,t\n"), {"x.csv:1", "two columns"});
  check_words(failure(""), {"x.csv:1", "empty"});
}

TEST_CASE("CSV files that cannot be opened are named", "[unit][record]") {
  const std::string missing = "no/such/folder/out.csv";
  check_words(message_of<FileError>([&] { write_csv(missing, three_rows()); }), {missing});
  check_words(message_of<FileError>([&] { read_csv(missing); }), {missing});
}

TEST_CASE("CSV files are written whole", "[unit][record]") {
  const auto file =
      std::filesystem::temp_directory_path() / ("lockstep_table_test_" + std::to_string(getpid()) + ".csv");
  write_csv(file.string(), three_rows());
  const Table back = read_csv(file.string());
  CHECK(back["Bx"] == three_rows()["Bx"]);
  std::filesystem::remove(file);
}

}  // namespace table_test
