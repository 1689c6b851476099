// SPDX-License-Identifier: BSD-3-Clause
// Digits of channels, on tables written down by hand.
#include "framework/tools/precision/certificate.h"

#include <array>
#include <cmath>

#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace lockstep {
namespace {

// sin t in metres with an error, a force of 50 N with one, a force that is round-off, and an angle that is exact.
Table table_of(double error, double noise, int n = 11) {
  Table table;
  for (const auto& [name, unit] : {std::pair{"t", "s"}, {"x", "m"}, {"F", "N"}, {"Fz", "N"}, {"turn", "rad"}})
    table.add_column(name, unit);
  for (int i = 0; i < n; ++i) {
    const double t = 0.1 * i, at = i == 5 ? error : 0;
    const double row[] = {t, 2 * std::sin(t), 50 + 1000 * at, i % 2 == 0 ? noise : -noise, 7 * t};
    table.add_row(row);
  }
  return table;
}

}  // namespace

TEST_CASE("digits are the logarithm of size over difference", "[unit][certificate]") {
  const Table run = table_of(0, 1e-15), one = table_of(1e-6, -2e-15), two = table_of(1e-8, 1e-15);
  const Certificate c = certify(run, {&one, &two});
  CHECK(c.n_rows == 11);
  CHECK_FALSE(c.cut);
  REQUIRE(c.channels.size() == 4);
  const CertifiedChannel &x = c.channels[0], &F = c.channels[1], &Fz = c.channels[2];
  CHECK(x.size == Approx(2 * std::sin(1.0)));
  CHECK(x.worst().digits == 15);
  CHECK(F.by[0].difference == Approx(1e-3).epsilon(1e-9));
  CHECK(F.by[0].digits == Approx(std::log10(50 / 1e-3)).margin(1e-9));
  CHECK(F.by[1].digits == Approx(std::log10(50 / 1e-5)).margin(1e-6));
  CHECK(F.worst().digits == Approx(F.by[0].digits));
  CHECK_FALSE(F.zero);
  CHECK(Fz.zero);
  CHECK(Fz.worst().difference == Approx(3e-15));
  const std::string text = certificate_text(c, {"dopri5 tighter", "dop853"});
  CHECK(text.find("zero to 3e-15") != std::string::npos);
  CHECK(text.find("4.7") != std::string::npos);
  CHECK(text.find("6.7") != std::string::npos);
  CHECK(text.find(">= 15.0") != std::string::npos);
}

TEST_CASE("small is not zero where its digits agree", "[unit][certificate]") {
  const Table run = table_of(0, 1e-9), other = table_of(0, 1.000000001e-9);
  const Certificate c = certify(run, {&other});
  CHECK_FALSE(c.channels[2].zero);
  CHECK(c.channels[2].worst().digits == Approx(9.0).margin(0.01));
}

// The zero of an energy is a matter of choice: here of the start, as for a pendulum that is let go.
TEST_CASE("energies agree relative to the energy exchanged", "[unit][certificate]") {
  const auto of = [](double error) {
    Table table;
    table.add_column("t", "s"), table.add_column("E", "J");
    for (int i = 0; i < 3; ++i) table.add_row(std::array{0.1 * i, error * i});
    return table;
  };
  const Table run = of(1e-7), other = of(0);
  CHECK(certify(run, {&other}).channels[0].worst().digits == 0);
  const Certificate c = certify(run, {&other}, 20);
  CHECK(c.channels[0].worst().digits == Approx(8.0));
  CHECK(c.channels[0].size == 20);
  CHECK(without_a_digit(c).empty());
}

TEST_CASE("runs that part are compared up to there", "[unit][certificate]") {
  const Table run = table_of(0, 0), shorter = table_of(0, 0, 7);
  const Certificate c = certify(run, {&shorter});
  CHECK(c.n_rows == 7);
  CHECK(c.cut);
  Table other;
  other.add_column("t", "s");
  testing::check_words(testing::message_of<ModelError>([&] { certify(run, {&other}); }),
                       {"other columns than the run", "record the same channels"});
}

TEST_CASE("values that are not finite agree in nothing", "[unit][certificate]") {
  const Table run = table_of(0, 0), broken = table_of(NAN, 0);
  CHECK(certify(run, {&broken}).channels[1].worst().digits == 0);
}

}  // namespace lockstep
