// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/force.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"
#include "tests/support/messages.h"

namespace force_function_force_test {

using namespace lockstep;
using oracle::ForceBench;

TEST_CASE("function_force: does what the function does", "[unit][force]") {
  ForceBench bench(4);
  const auto spring = function_force(
      "pull", {&bench.p},
      [&](const Inputs& in, WrenchSum& out) {
        const Vec3 x = in_world(MarkerFrame(bench.p), in).x;
        out.force(bench.p.body->slot, -3.0 * x, x);
      },
      [&](const Inputs& in) { return 1.5 * in_world(MarkerFrame(bench.p), in).x.squaredNorm(); });
  spring->setup();
  const double Vd = bench.rate_of([&] { return spring->potential(bench.in()); });
  CHECK(bench.power(*spring) == Approx(-Vd).epsilon(1e-10));
  CHECK(bench.moment_about_origin(*spring, 0).norm() < 1e-14);
  CHECK(spring->dissipation(bench.in()) == 0);
  CHECK(spring->markers().size() == 1);
  CHECK(spring->type() == "function_force");
}

TEST_CASE("function_force: a missing function is rejected", "[unit][force]") {
  CHECK_THROWS_WITH(function_force("pull", {}, nullptr), "force 'pull' (function_force) has no function; give one");
  testing::check_words(
      testing::message_of<ModelError>([&] { function_force("pull", {nullptr}, [](const Inputs&, WrenchSum&) {}); }),
      {"force 'pull'", "a marker is null"});
}

}  // namespace force_function_force_test
