// SPDX-License-Identifier: BSD-3-Clause
// Copies in joint coordinates, one per lane, against the recursion of each mechanism alone.
#include "framework/tools/batch/batch.h"

#include <cmath>

#include <lockstep/author/stepping.h>
#include <lockstep/forces.h>
#include <lockstep/laws.h>
#include "tests/support/catch.h"
#include "tests/support/copies_of.h"
#include "tests/support/messages.h"
#include "tests/support/random_bodies.h"
#include "tests/support/worst.h"

namespace tree_lanes_test {

using namespace lockstep;
using namespace lockstep::test;
using lockstep::testing::check_words;
using lockstep::testing::largest;

namespace {

// Largest difference of the rates in lanes from those of the recursion at the same coordinates, which are away from the
// start by `away`, relative to the largest rate of their kind. The motions of the slots too.
double difference(Family& family, double away, Instructions set = Instructions::best) {
  CopiesOptions options;
  options.instructions = set, options.formulation = Formulation::joint;
  const std::vector<System*> systems = family.pointers();
  for (System* system : systems) system->setup();
  const auto batch = std::make_unique<lanes::Batch>(systems, 0, options);
  Aligned<double> y(batch->n_numbers()), rate(batch->n_numbers());
  std::vector<State> states;
  lanes::Numbers8 t{};
  for (std::size_t k = 0; k < systems.size(); ++k) {
    State s = systems[k]->start();
    s.t = t[k] = 0.1 * static_cast<double>(k);
    batch->to_batch(static_cast<int>(k), s);
    s.q += away * VecX::Random(s.q.size()), s.v.setRandom();
    batch->put(static_cast<int>(k), s, y.data());
    states.push_back(s);
  }
  for (const bool failed : batch->evaluate(y.data(), t, rate.data())) CHECK_FALSE(failed);
  double worst = 0;
  for (std::size_t k = 0; k < systems.size(); ++k) {
    Dynamics dynamics(*systems[k], std::make_unique<SchurSolver>(), {Formulation::joint, {}});
    State own = systems[k]->start();
    dynamics.to_formulation(own);
    own.t = t[k], own.q = states[k].q, own.v = states[k].v;
    StateRate truth, found = sized_like(own);
    dynamics.rates(own, truth);
    State as_state = own;
    batch->get(static_cast<int>(k), rate.data(), as_state);
    found.q = as_state.q, found.v = as_state.v, found.s = as_state.s;
    for (const auto part : {&StateRate::q, &StateRate::v, &StateRate::s})
      keep_worst(worst, largest(found.*part - truth.*part) / std::max(1.0, largest(truth.*part)));
    keep_worst(worst, std::abs(batch->largest_a(k) - truth.largest_a) / std::max(1.0, truth.largest_a));
    keep_worst(worst, std::abs(batch->largest_alpha(k) - truth.largest_alpha) / std::max(1.0, truth.largest_alpha));
  }
  return worst;
}

}  // namespace

TEST_CASE("a vectorised tree accelerates as alone: every mask, in both directions", "[unit][copies]") {
  int taken = 0;
  for (int mask = 1; mask < 64; ++mask)
    for (const bool reversed : {false, true}) {
      Family family = random_family(2, [&](inputs::RandomMechanism& m) {
        reversed ? m.link(-1, 0, Mask(mask)) : m.link(0, -1, Mask(mask));
        reversed ? m.link(0, 1, Mask(mask)) : m.link(1, 0, Mask(mask));
      });
      std::string why = Copies::unsuited(*family.systems[0], Formulation::joint);
      if (mask == 63) {
        check_words(why, {"no coordinate is free"});
        continue;
      }
      INFO("mask " << mask << ", reversed " << reversed << ": " << why);
      REQUIRE(why.empty());
      ++taken;
      CHECK(difference(family, 0.4) < 1e-12);
    }
  CHECK(taken == 2 * 62);
}

TEST_CASE("vectorised markers that move on their bodies carry as alone: every mask, in both directions",
          "[unit][copies]") {
  constexpr unsigned kMarkers = oracle::kUP | oracle::kQP | oracle::kUS | oracle::kQS;
  int taken = 0;
  for (int mask = 1; mask < 63; ++mask) {
    const auto rows = static_cast<Mask>(mask);
    if (count_rows(rows & Mask::e123) == 1) continue;
    for (const unsigned markers : {kMarkers, unsigned(oracle::kUP | oracle::kQS), unsigned(oracle::kQP)})
      for (const bool reversed : {false, true}) {
        const unsigned held =
            (overlaps(rows, Mask::xyz) ? oracle::kP : 0U) | (overlaps(rows, Mask::e123) ? oracle::kQD : 0U);
        Family family = random_family(2, [&](inputs::RandomMechanism& m) {
          reversed ? m.link(-1, 0, rows, markers | held) : m.link(0, -1, rows, markers | held);
          reversed ? m.link(0, 1, rows, markers) : m.link(1, 0, rows, markers);
        });
        ++taken;
        INFO("mask " << mask << ", laws " << markers << ", reversed " << reversed);
        CHECK(difference(family, 0.4) < 1e-12);
      }
  }
  CHECK(taken == 38 * 3 * 2);
}

TEST_CASE("vectorised markers that move on their bodies carry as alone: branches, drives, forces", "[unit][copies]") {
  Family family = random_family(6, [](inputs::RandomMechanism& m) {
    m.link(0, -1, Mask::xyz, oracle::kQS);
    m.link(0, 1, Mask::xyz | Mask::e1 | Mask::e2, oracle::kUP | oracle::kUS);
    m.link(2, 0, Mask::all, oracle::kQP | oracle::kUS | oracle::kQD);  // carries, and leaves nothing free
    m.link(3, 2, Mask::x | Mask::y | Mask::e123);
    m.driven(4, 0, Mask::xyz | Mask::e1 | Mask::e2, Axis::rz, oracle::kUP | oracle::kQP);
    m.link(4, 5, Mask::y, oracle::kQP | oracle::kP);
    Marker &a = m.system.add_marker("a", *m.bodies[3], {Vec3(0.5, 0.1, 0.2), {}}),
           &b = m.system.add_marker("b", *m.bodies[5], {Vec3(0, 1, 0.2), {}});
    m.system.add<SpringDamper>("spring", a, b, {.stiffness = 40.0, .damping = 1.0, .free_length = 0.5});
  });
  CHECK(difference(family, 0.4) < 1e-12);
}

TEST_CASE("a vectorised tree accelerates as alone: branches, free bodies, particles", "[unit][copies]") {
  Family family = random_family(
      6,
      [](inputs::RandomMechanism& m) {
        m.link(0, -1, Mask::xyz);
        m.link(0, 1, Mask::xyz | Mask::e1 | Mask::e2);
        m.link(2, 0, Mask::x | Mask::y | Mask::e123);
        m.link(3, 2, Mask::xyz | Mask::e2 | Mask::e3);
        m.link(4, 0, Mask::x);
        m.link(6, -1, Mask::x | Mask::z);
      },
      1);
  CHECK(difference(family, 0.4) < 1e-12);
  for (const double twist : {0.0, 0.7}) {
    Family chains(5, [&](int k) { return chain(12, k, twist); });
    CHECK(difference(chains, 0.4) < 1e-12);
  }
}

TEST_CASE("a vectorised tree accelerates as alone: in a planar mechanism", "[unit][copies]") {
  Family family(4, [](int k) {
    auto sys = chain(4, k);
    sys->set_gravity(Vec3(0.1 * k, 0, -9.81));
    Body& loose = sys->add_body("loose", {1.0 + k, Vec3::Zero(), Vec3(1, 2, 3).asDiagonal()}, {Vec3(0, 0, 2), Quat{}});
    sys->add<Spherical>(
        "ball", sys->add_body("end", {2.0, Vec3::Zero(), Vec3(1, 2, 3).asDiagonal()}, {Vec3(0.5, 0, 2), Quat{}}), loose,
        pose_at(Vec3(0.2, 0, 2)));
    sys->set_planar(Plane{1});
    return sys;
  });
  CHECK(difference(family, 0.4) < 1e-12);
}

TEST_CASE("a vectorised tree accelerates as alone: one instance in a plane, the others askew", "[unit][copies]") {
  Family askew(8, [](int k) { return chain(3, k, 0.2 * k); });
  CHECK(difference(askew, 0.4) < 1e-12);
  Family one_turned(8, [](int k) { return chain(3, k, k == 1 ? 0.3 : 0.0); });
  CHECK(difference(one_turned, 0.4) < 1e-12);
}

TEST_CASE("a vectorised tree accelerates as alone: laws, drives, forces", "[unit][copies]") {
  SECTION("imposed laws and drives, either way round") {
    Family family = random_family(5, [](inputs::RandomMechanism& m) {
      m.link(0, -1, Mask::all, oracle::kP | oracle::kQD);
      m.link(1, 0, Mask::x | Mask::z | Mask::e123, oracle::kP | oracle::kQD);
      m.link(1, 2, Mask::xyz | Mask::e1 | Mask::e2, oracle::kP | oracle::kQD);
      m.link(3, 2, Mask::x | Mask::y, oracle::kP);
      m.driven(4, 1, Mask::xyz | Mask::e1 | Mask::e2, Axis::rz);
    });
    CHECK(difference(family, 0.4) < 1e-12);
  }
  SECTION("driven speeds, a spring with a moment on either side") {
    Family family(5, [&](int k) {
      auto sys = chain(3, k, 0.4);
      static_cast<MarkerLock&>(*sys->links()[1]).drive_speed(Axis::rz, laws::law([k](auto t) {
                                                               return 0.1 * k + sin(t);
                                                             }));
      Marker& p = sys->add_marker("p", sys->body("rod 2"), {Vec3(0.5, 0.1, 0.2), {}});
      Marker& s = sys->add_marker("s", sys->body("rod 0"), {Vec3(0, 1, 2), {}});
      sys->add<SpringDamper>("spring", p, s, {.stiffness = 40.0 + k, .damping = 1.0, .free_length = 0.5});
      return sys;
    });
    CHECK(difference(family, 0.3) < 1e-12);
  }
}

TEST_CASE("errors of vectorised steps are those of ErrorNorm", "[unit][copies]") {
  Family family = random_family(8, [](inputs::RandomMechanism& m) {
    m.link(0, -1, Mask::xyz);
    m.link(1, 0, Mask::xyz | Mask::e1 | Mask::e2);
    m.link(1, 2, Mask::x | Mask::y | Mask::e123);
    m.link(3, 1, Mask::x | Mask::z | Mask::e2 | Mask::e3, oracle::kP | oracle::kQD);
    m.link(3, 4, Mask::xyz | Mask::e1 | Mask::e2, oracle::kP | oracle::kQD);
    m.link(0, 5, Mask::y, oracle::kP);
    m.link(6, 5, Mask::x | Mask::e2 | Mask::e3, oracle::kAllLaws);
    m.link(6, 7, Mask::z, oracle::kUP | oracle::kQP | oracle::kUS | oracle::kQS);
  });
  const std::vector<System*> systems = family.pointers();
  for (System* system : systems) system->setup();
  CopiesOptions options;
  options.formulation = Formulation::joint;
  const auto batch = std::make_unique<lanes::Batch>(systems, 0, options);
  Aligned<double> y0(batch->n_numbers()), y1 = y0, error = y0;
  lanes::Numbers8 t{}, t1{}, h{};
  std::vector<State> from, to;
  std::vector<StateRate> errors;
  for (std::size_t k = 0; k < systems.size(); ++k) {
    State s = systems[k]->start();
    batch->to_batch(static_cast<int>(k), s);
    s.t = t[k] = 0.1 * static_cast<double>(k), h[k] = 0.05 + 0.01 * static_cast<double>(k);
    s.v.setRandom();
    from.push_back(s);
    s.t = t1[k] = t[k] + h[k];
    s.q += 0.1 * VecX::Random(s.q.size()), s.v += 0.1 * VecX::Random(s.v.size());
    to.push_back(s);
    StateRate e = sized_like(s);
    e.q.setRandom(), e.v.setRandom(), e.q *= 1e-3, e.v *= 1e-3;
    errors.push_back(e);
    batch->put(static_cast<int>(k), from[k], y0.data()), batch->put(static_cast<int>(k), to[k], y1.data());
    State packed = s;
    packed.q = e.q, packed.v = e.v;
    batch->put(static_cast<int>(k), packed, error.data());
  }
  std::array<Change, lanes::kLanes> change, by;
  batch->start_from(y0.data(), t);
  batch->change_to(y1.data(), t1, h, change);
  batch->weigh(error.data(), by);
  for (std::size_t k = 0; k < systems.size(); ++k) {
    const Tolerance tolerance{1e-4 * static_cast<double>(k), 1e-6};
    StateRate still = sized_like(from[k]);
    still.v.setZero(), still.q.setZero();
    ErrorNorm norm;
    norm.set(tolerance);
    norm.scale(from[k], still, h[k], to[k]);
    const double truth = norm.of(errors[k], to[k]);
    CHECK(in_tolerances(by[k], weights_of(tolerance, change[k])) == Approx(truth).epsilon(1e-10));
  }
}

TEST_CASE("trees by plain x86-64, FMA and AVX-512 agree", "[unit][copies]") {
  Family family = random_family(4, [](inputs::RandomMechanism& m) {
    m.link(0, -1, Mask::xyz | Mask::e1 | Mask::e2);
    m.link(1, 0, Mask::x | Mask::y | Mask::e123, oracle::kP);
    m.link(2, 1, Mask::xyz);
    m.link(2, 3, Mask::x | Mask::e1 | Mask::e2, oracle::kAllLaws);
  });
  int compared = 0;
  for (const Instructions set : {Instructions::plain, Instructions::fma, Instructions::avx512}) try {
      const double off = difference(family, 0.4, set);  // by itself: a check would report what it throws
      CHECK(off < 1e-12);
      ++compared;
    } catch (const ModelError& absent) {
      check_words(absent.what(), {"this processor has no"});
    }
  CHECK(compared >= 1);
}

TEST_CASE("vectorised batches have joint coordinates alone, except for bodies that lose digits there",
          "[unit][copies]") {
  const Family family(1, [](int k) { return chain(2, k); });
  for (const Formulation other : {Formulation::omega, Formulation::quaternion})
    check_words(Copies::unsuited(*family.systems[0], other), {"a batch needs joint coordinates"});
  System slender;
  Body& bar = slender.add_body("bar", MassProperties{1, Vec3::Zero(), Vec3(1e-9, 1, 1).asDiagonal()});
  slender.add<Spherical>("ball", slender.add_marker("p", bar, {Vec3(1, 0, 0), {}}),
                         slender.add_marker("s", slender.ground(), {Vec3(1, 0, 0), {}}));
  check_words(Copies::unsuited(slender), {"bar"});
  CHECK(Copies::unsuited(slender, Formulation::joint).empty());
}

}  // namespace tree_lanes_test
