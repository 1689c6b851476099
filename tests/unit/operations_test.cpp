// SPDX-License-Identifier: BSD-3-Clause
// What the kernel costs, counted on the numbers themselves: no more than the theory's table (5.2), nothing for the half
// that a joint does not use, less for every row that is masked. The instance is chosen as MarkerLock chooses it.
#include <cmath>

#include <lockstep/author/passes.h>
#include <lockstep/author/registry.h>
#include <lockstep/author/relative.h>
#include <lockstep/scene.h>
#include "framework/description/scene/system_of.h"
#include "framework/dynamics/tree/joint_cost.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "framework/mechanism/lock/dispatch.h"
#include "tests/support/catch.h"
#include "tests/support/counted.h"
#include "tests/support/counted_blocks.h"
#include "tests/support/lock_inputs.h"
#include "tests/support/paths.h"

namespace operations_test {

using namespace lockstep;
using oracle::Counted;
using oracle::Operations;

namespace {

template <class A>
auto counted(const A& a) {
  return a.template cast<Counted>().eval();
}
QuatT<Counted> counted(const Quat& q) { return {q.w, q.x, q.y, q.z}; }

struct Counting {
  MotionT<Counted> O1, O2;
  MarkerMotionT<Counted> P, S;
  ImposedTranslationT<Counted> p;
  ImposedRotationT<Counted> D;
};

MotionT<Counted> body(const Motion& O) {
  return {counted(O.x), counted(O.A), counted(O.e), counted(O.v), counted(O.w)};
}
MarkerMotionT<Counted> marker(const MarkerMotion& m) {
  return {counted(m.u), counted(m.ud), counted(m.udd), counted(m.A), counted(m.q), counted(m.w), counted(m.a)};
}
Counting inputs_of(unsigned laws, bool aligned) {
  const inputs::KernelInputs in(oracle::random_configuration(11, {laws, aligned}));
  return {body(in.O1),
          body(in.O2),
          marker(in.P),
          marker(in.S),
          {counted(in.p.p), counted(in.p.pd), counted(in.p.pdd)},
          {counted(in.D.q), counted(in.D.A), counted(in.D.w), counted(in.D.a)}};
}

struct Cost {
  Operations translation, rotation;
  long total() const { return translation.total() + rotation.total(); }
};

/// C, Ct, rows and right side of the mask's rows. The matrix of every rotation law is made from its quaternion here,
/// because the table counts that too.
Cost cost(Mask rows, unsigned laws, bool parallel = false) {
  Counting in = inputs_of(laws, parallel);
  const unsigned bits = laws | (parallel ? unsigned(with::parallel) : 0u);
  Cost c;
  c.translation = oracle::operations_of([&] {
    TranslationRowsT<Counted> r;
    choose_translation(rows, bits, [&](auto with) { translation<with>(in.O1, in.O2, in.P, in.S, in.p, rows, r); });
  });
  c.rotation = oracle::operations_of([&] {
    RotationRowsT<Counted> r;
    choose_rotation(rows, bits, [&](auto with) {
      if (laws & with::qP) in.P.A = rotation(in.P.q);
      if (laws & with::qS) in.S.A = rotation(in.S.q);
      if (laws & with::qD) in.D.A = rotation(in.D.q);
      rotation<with>(in.O1, in.O2, in.P, in.S, in.D, rows, r);
    });
  });
  return c;
}

constexpr double kAllowed = 1.05;

}  // namespace

TEST_CASE("a counted number counts", "[unit][lock]") {
  const Operations one = oracle::operations_of([] {
    const Counted a(2), b(3);
    const Counted c = -(a * b + a - b) / a;
    CHECK(c.value() == -2.5);
  });
  CHECK(one.mul == 1);
  CHECK(one.add == 2);
  CHECK(one.div == 1);
  const Operations product = oracle::operations_of([] {
    const Mat3T<Counted> A = Mat3T<Counted>::Identity();
    const Vec3T<Counted> b = Vec3T<Counted>::Ones(), c = A * b;
    CHECK(c[2].value() == 1);
  });
  CHECK(product.mul == 9);
  CHECK(product.add == 6);
}

TEST_CASE("the six constraints cost no more than the theory's table", "[unit][lock]") {
  const Cost all = cost(Mask::all, 63), none = cost(Mask::all, 0), aligned = cost(Mask::all, 0, true);
  CAPTURE(all.translation.total(), all.rotation.total(), none.translation.total(), none.rotation.total(),
          aligned.translation.total(), aligned.rotation.total());
  CHECK(double(all.total()) <= kAllowed * 1219);
  CHECK(double(none.total()) <= kAllowed * 600);
  CHECK(double(aligned.total()) <= kAllowed * 322);
  CHECK(double(cost(Mask::all, with::p).total()) <= kAllowed * 606);
  CHECK(double(cost(Mask::all, with::qD).total()) <= kAllowed * 832);
  CHECK(double(cost(Mask::all, with::p | with::qD).total()) <= kAllowed * 838);
  // each half by itself
  CHECK(double(none.translation.total()) <= kAllowed * 336);
  CHECK(double(none.rotation.total()) <= kAllowed * 264);
  CHECK(double(aligned.translation.total()) <= kAllowed * 234);
  CHECK(double(aligned.rotation.total()) <= kAllowed * 88);
  CHECK(double(all.translation.total()) <= kAllowed * 549);
  CHECK(double(all.rotation.total()) <= kAllowed * 763);
  // nothing is divided, and every law costs something
  CHECK(all.translation.div + all.rotation.div == 0);
  CHECK(none.total() < all.total());
  CHECK(aligned.total() < none.total());
}

TEST_CASE("a joint without rotations never evaluates the rotational half, and the other way round", "[unit][lock]") {
  for (unsigned m = 1; m < 64; ++m) {
    const Mask mask = Mask(std::uint8_t(m));
    for (unsigned laws : {0u, 16u, 32u, 48u, 63u}) {
      CAPTURE(m, laws);
      const Cost c = cost(mask, laws);
      CHECK((c.translation.total() > 0) == overlaps(mask, Mask::xyz));
      CHECK((c.rotation.total() > 0) == overlaps(mask, Mask::e123));
    }
  }
  CHECK(cost(Mask::none, 63).total() == 0);
}

TEST_CASE("each masked constraint saves its Jacobian", "[unit][lock]") {
  for (unsigned laws : {0u, 48u, 63u}) {
    for (unsigned m = 1; m < 64; ++m) {
      const Mask mask = Mask(std::uint8_t(m));
      const Cost c = cost(mask, laws);
      for (int k = 0; k < 6; ++k) {
        if (!includes(mask, row_bit(k))) continue;
        CAPTURE(laws, m, k);
        const Cost less = cost(Mask(std::uint8_t(m & ~(1u << k))), laws);
        CHECK(c.total() - less.total() >= (k < 3 ? 48 : 30));
      }
    }
  }
}

TEST_CASE("a drive costs its law and no more", "[unit][lock]") {
  // p alone: three subtractions in C, and pd, pdd; never the markers' transport terms
  CHECK(cost(Mask::xyz, with::p).total() - cost(Mask::xyz, 0).total() <= 9);
  CHECK(cost(Mask::xyz, with::qD | with::qP).total() == cost(Mask::xyz, 0).total());
  CHECK(cost(Mask::e123, with::p | with::uP | with::uS).total() == cost(Mask::e123, 0).total());
}

TEST_CASE("relative_kinematics leaves out the half that is not needed", "[unit][lock]") {
  const Counting in = inputs_of(0, false);
  const auto price = [&](Reads reads) {
    return oracle::operations_of([&] { relative_kinematics(in.O1, in.O2, in.P, in.S, 0u, reads); }).total();
  };
  CHECK(price(Reads::translation) > 0);
  CHECK(price(Reads::translation) + price(Reads::rotation) == price(Reads::both));
}

namespace {

std::string scene_of(const std::string& name) {
  return std::string(paths::kSource) + "/samples/scenes/" + name + ".json";
}
Mechanism built(const std::string& name, Formulation formulation) {
  Scene scene = read_scene(scene_of(name));
  scene.run.formulation = formulation;
  return build_mechanism(scene, builtin_registry());
}

/// A multiply-add is two of what is counted.
double multiply_adds(const Operations& done) { return 0.5 * static_cast<double>(done.mul + done.add); }
constexpr double kNear = 0.2;

}  // namespace

TEST_CASE("a plan of the block elimination reports its number of operations", "[unit][solver]") {
  for (const char* name :
       {"nfourbar_2", "andrews_ivp", "slider_crank", "spatial_slider_crank", "stewart", "hooke_double",
        "spatial_chain_10_tilted", "overconstrained/bennett", "overconstrained/delta"}) {
    Mechanism m = built(name, Formulation::omega);
    System& system = system_of(m);
    RowTable all;
    passes::lay_out(system, system.start().modes, all);
    const bool planar(system.plane());
    const schur::Plan plan = schur::make_plan(all, system.n_slots(), planar);
    const double counted = oracle::elimination(plan), predicted = schur::count_operations(plan).multiply_adds;
    CAPTURE(name, counted, predicted);
    CHECK(std::abs(predicted - counted) < kNear * counted);
  }
}

// What the joints themselves take is no part of the difference.
TEST_CASE("the fronts of closures report the operations of their constraints along a tree", "[unit][joint]") {
  for (const char* name : {"spatial_slider_crank", "stewart", "hooke_double", "overconstrained/bennett",
                           "overconstrained/sarrus_three", "overconstrained/spherical_five_bar"}) {
    Mechanism m = built(name, Formulation::joint);
    const System& system = system_of(m);
    const TreeLayout layout = lay_out_tree(system, system.start().modes, Taken::all);
    REQUIRE(layout.tree);
    ClosureFronts none;  // no rows
    none.n_nodes = layout.fronts.n_nodes, none.all.resize(none.n_nodes), none.parents = layout.fronts.parents;
    const auto counted_with = [&](const ClosureFronts& fronts) {
      return multiply_adds(oracle::recursion(*layout.tree, fronts));
    };
    const auto predicted_with = [&](const ClosureFronts& fronts) {
      return count_operations(*layout.tree, fronts, {}).multiply_adds;
    };
    const double counted = counted_with(layout.fronts) - counted_with(none),
                 predicted = predicted_with(layout.fronts) - predicted_with(none);
    CAPTURE(name, counted, predicted);
    CHECK(std::abs(predicted - counted) < kNear * counted);
  }
}

TEST_CASE("the cheaper formulation follows from the operations of both", "[unit][joint]") {
  const auto taken = [](const std::string& name) {
    Mechanism m = built(name, Formulation::automatic);
    const System& system = system_of(m);
    return lay_out_tree(system, system.start().modes, Taken::where_cheaper).tree ? "joint" : "omega";
  };
  for (const char* name :
       {"four_bar", "nfourbar_2", "nfourbar_40", "slider_crank", "peaucellier", "andrews_ivp", "oldham", "belt",
        "gear_train", "homokinetic", "hooke_single", "spatial_slider_crank", "overconstrained/bennett",
        "overconstrained/bricard", "overconstrained/sarrus", "overconstrained/scissor_lift_20",
        "overconstrained/jansen", "overconstrained/spherical_four_bar"}) {
    CAPTURE(name);
    CHECK(taken(name) == std::string("joint"));
  }
  for (const char* name : {"stewart", "hooke_double", "screw", "rack", "overconstrained/three_balls",
                           "overconstrained/door_two_balls", "overconstrained/hooke_two_bearings"}) {
    CAPTURE(name);
    CHECK(taken(name) == std::string("omega"));
  }
}

}  // namespace operations_test
