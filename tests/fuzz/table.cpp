// SPDX-License-Identifier: BSD-3-Clause
#include <bit>
#include <sstream>

#include <lockstep/recorder.h>
#include <lockstep/splines.h>
#include "tests/fuzz/answered.h"
#include "tests/fuzz/scratch_file.h"
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

namespace {

void check_same(const Table& a, const Table& b) {
  if (a.names() != b.names() || a.n_rows() != b.n_rows()) throw Broken{"a table that was written is read as another"};
  for (std::size_t k = 0; k < a.n_columns(); ++k)
    for (std::size_t i = 0; i < a.n_rows(); ++i) {
      const double x = a.columns()[k].values[i], y = b.columns()[k].values[i];
      if (std::bit_cast<std::uint64_t>(x) != std::bit_cast<std::uint64_t>(y) && !(std::isnan(x) && std::isnan(y)))
        throw Broken{"a number that was written is read as another"};
    }
}

}  // namespace

void table(Bytes bytes) {
  answered([&] {
    std::istringstream in(text_of(bytes));
    const Table first = read_csv(in, "fuzz.csv");
    std::stringstream written;
    write_csv(written, first);
    check_same(first, read_csv(written, "again.csv"));
  });
  const std::string file = scratch_file(bytes, ".csv");
  for (const char* const column : {"y", "2"})
    answered([&] {
      const Columns columns = read_columns(file, column[0] == 'y' ? "t" : "1", {column});
      for (std::size_t i = 0; i < columns.t.size(); ++i) {
        must_be_finite(columns.t[i], "a time of a law");
        must_be_finite(columns.y(static_cast<Eigen::Index>(i), 0), "a value of a law");
        if (i > 0 && !(columns.t[i] > columns.t[i - 1])) throw Broken{"times of a law that do not increase"};
      }
    });
}

}  // namespace lockstep::fuzz
