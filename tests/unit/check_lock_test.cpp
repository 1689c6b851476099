// SPDX-License-Identifier: BSD-3-Clause
// check_lock: right links pass, wrong ones are named in words.
#include <lockstep/author/check.h>

#include <lockstep/author/registry.h>
#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include "tests/support/catch.h"
#include "tests/support/check_words.h"
#include "tests/support/messages.h"
#include "tests/support/samples_of_types.h"

namespace check_lock_test {

using namespace lockstep;
using lockstep::test::says;

namespace {

enum class Fault {
  none,
  rate_sign,
  half_square,
  half_turning,
  mixed,
  world_axes,
  body_axes,
  column_missing,
  ct_missing,
  ct_sometimes,
  breakpoint,
  keeps,
  slots,
  names,
  this_for_all,
  padding,
  tangent,
  nan,
  velocity,
  kind
};

/// f(t) = 0.5 + 0.1 sin(2 t), whose rate grows by 0.3 from 1.25 s on.
class Length final : public MotionLaw {
 public:
  LawValue at(double t) const override {
    LawValue r{0.5 + 0.1 * std::sin(2 * t), 0.2 * std::cos(2 * t), -0.4 * std::sin(2 * t)};
    if (t > 1.25) r.y += 0.3 * (t - 1.25), r.yd += 0.3;
    return r;
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (t0 < 1.25 && 1.25 < t1) out.push_back(1.25);
  }
};

/// C = (d.d - f^2)/2, d = x_P - x_S, written by hand on the bare Lock; each fault is one that one makes.
class Rod : public Lock, public Driven, public TangentFormula {
 public:
  Rod(std::string name, Marker& p, Marker& s, Fault fault) : Lock(std::move(name)), p_(p), s_(s), fault_(fault) {}
  std::string_view type() const override { return "rod"; }
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return {{&p_, &s_}}; }
  const Driven* driven() const override { return this; }
  std::string diagnose(double) const override { return {}; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (fault_ != Fault::breakpoint) law_.breakpoints(t0, t1, out);
  }
  RowPlan plan_rows() override {
    P_ = MarkerFrame(p_), S_ = MarkerFrame(s_);
    RowPlan plan;
    for (int k = 0; k < (fault_ == Fault::names ? 2 : 1); ++k)
      plan.add({fault_ == Fault::kind ? RowKind::rotation : RowKind::function, "length"});
    plan.slots.add(P_.slot);
    if (fault_ != Fault::slots) plan.slots.add(S_.slot);
    return plan;
  }
  void gather(Group links, const Inputs& in, RowSpan out) const override {
    for (std::size_t i = 0; i < links.size(); ++i)
      (fault_ == Fault::this_for_all ? *this : static_cast<const Rod&>(*links[i])).fill(in, out.lane(i));
  }
  const TangentFormula* tangent_formula() const override { return fault_ == Fault::tangent ? this : nullptr; }
  void tangent(const Inputs&, std::span<const double> lambda, TangentSum& out) const override {
    out.add_K(P_.slot, Half::move, P_.slot, Half::move, 2 * lambda[0] * Mat3::Identity());
  }

 private:
  void fill(const Inputs& in, const RowBlock& b) const {
    const Motion &O1 = in.slot(P_.slot), &O2 = in.slot(S_.slot);
    const Vec3 &u1 = P_.u0, &u2 = S_.u0;
    const Vec3 d = O1.x + O1.A * u1 - O2.x - O2.A * u2;
    const Vec3 dd = O1.v + O1.A * cross(O1.w, u1) - O2.v - O2.A * cross(O2.w, u2);
    const Vec3 ddd = O1.A * cross(O1.w, cross(O1.w, u1)) - O2.A * cross(O2.w, cross(O2.w, u2));
    const LawValue f = law_.at(in.t);
    b.C(0) = 0.5 * (d.dot(d) - f.y * f.y);
    if (fault_ == Fault::keeps) b.C(0) += 1e-3 * ++n_calls_;
    if (fault_ == Fault::nan) b.C(0) += std::sqrt(f.y - 5);
    if (fault_ != Fault::ct_missing && !(fault_ == Fault::ct_sometimes && in.t > 0.2))
      b.Ct(0) = (fault_ == Fault::rate_sign ? 1 : -1) * f.y * f.yd;
    if (fault_ == Fault::velocity) b.Ct(0) += d.dot(O1.v);
    const double square = (fault_ == Fault::half_square ? 0.5 : 1) * dd.dot(dd);
    const double turning = (fault_ == Fault::half_turning ? 0.5 : 1) * d.dot(ddd);
    const double mixed = fault_ == Fault::mixed ? 2 * f.yd * d.dot(O1.v) : 0;  // of a law that turns, which it has not
    b.Qhat(0) = mixed - square - turning + f.yd * f.yd + f.y * f.ydd;
    Vec3 v1 = d, w1 = cross(u1, Vec3(O1.A.transpose() * d));
    if (fault_ == Fault::world_axes) w1 = O1.A * w1;
    if (fault_ == Fault::body_axes) v1 = O1.A.transpose() * v1;
    b.set(slots().position(P_.slot), 0, v1, w1);
    const Vec3 w2 = -cross(u2, Vec3(O2.A.transpose() * d));
    if (slots().position(S_.slot) >= 0)
      b.set(slots().position(S_.slot), 0, Vec3(-d), fault_ == Fault::column_missing ? Vec3(Vec3::Zero()) : w2);
    if (fault_ == Fault::padding) b.C(1) = 1;
    if (fault_ == Fault::names) b.C(1) = b.Ct(1) = b.Qhat(1) = 0;
    if (fault_ == Fault::names)
      for (int i = 0; i < 2; ++i) b.set(i, 1, Vec3::Zero(), Vec3::Zero());
  }

  Marker &p_, &s_;
  Fault fault_;
  Length law_;
  MarkerFrame P_, S_;
  mutable int n_calls_ = 0;
};

Pose place(double x, double y, double z, double angle) { return {{x, y, z}, axis_angle(Vec3(1, 2, -2), angle)}; }

/// Two bodies with a marker each.
struct Bench {
  System system;
  Body &arm, &cam;
  Marker &p, &s;
  Bench()
      : arm(system.add_body("arm", {2.0, Vec3(0.1, 0, 0.05), Vec3(0.5, 0.6, 0.7).asDiagonal()},
                            place(0.2, 0.1, 0, 0.4))),
        cam(system.add_body("cam", {1.0, Vec3::Zero(), Vec3(0.3, 0.4, 0.5).asDiagonal()}, place(-0.2, 0.3, 0.2, -0.7))),
        p(system.add_marker("p", arm, place(0.1, -0.2, 0.1, 0.3))),
        s(system.add_marker("s", cam, place(0.0, 0.1, -0.2, 1.1))) {}

  CheckReport rod(Fault fault) {
    return check_lock(system, system.add(std::make_unique<Rod>("rod", p, s, fault)), {.seed = 7});
  }
};

CheckReport rod(Fault fault) {
  Bench bench;
  return bench.rod(fault);
}

}  // namespace

TEST_CASE("check_lock passes a right joint and reports the extent of its checks", "[unit][check]") {
  const CheckReport r = rod(Fault::none);
  INFO(r.text());
  CHECK(r.ok());
  CHECK(says(r, "joint 'rod' (rod): no findings in"));
  CHECK(says(r, "(seed 7; finite differences accurate to"));
  CHECK(r.accuracy() < 1e-5);
}

TEST_CASE("check_lock names wrong derivatives", "[unit][check]") {
  CheckReport r = rod(Fault::rate_sign);
  CAPTURE(r.text());
  CHECK(says(r, "joint 'rod' (rod): 1 finding (seed 7)\n  Ct of constraint length is "));
  CHECK(says(r, "so it has the wrong sign (seed 7, state "));

  r = rod(Fault::half_square);
  CAPTURE(r.text());
  CHECK(says(r, "Qhat of constraint length is "));
  CHECK(says(r, "its part that is quadratic in the velocity of body 'arm' is "));
  CHECK(says(r, "so it is half the value: a factor of 2 is missing"));
  CHECK(r.findings().size() == 1);

  r = rod(Fault::half_turning);
  CAPTURE(r.text());
  CHECK(says(r, "its part that is quadratic in the angular velocity of body 'arm'"));

  r = rod(Fault::mixed);
  CAPTURE(r.text());
  const std::string product = "its part that is the product of the velocity of body 'arm' and the rate of a law is ";
  REQUIRE(says(r, product));
  const std::string said = r.text().substr(r.text().find(product) + product.size());
  const std::string should_be = "and should be ";
  CHECK(std::abs(std::stod(said)) > 1e-3);
  CHECK(std::abs(std::stod(said.substr(said.find(should_be) + should_be.size()))) < 1e-6);

  r = rod(Fault::world_axes);
  CAPTURE(r.text());
  CHECK(says(r, "Jacobian of constraint length with respect to the angular velocity of body 'arm' about its "));
  CHECK(says(r, "its three numbers are in world axes, but the angular velocity is in body axes"));

  r = rod(Fault::body_axes);
  CAPTURE(r.text());
  CHECK(says(r, "with respect to the velocity of body 'arm' along the world's "));
  CHECK(says(r, "are in body axes"));

  r = rod(Fault::column_missing);
  CAPTURE(r.text());
  CHECK(says(r, "with respect to the angular velocity of body 'cam'"));
  CHECK(says(r, "so it is missing"));

  r = rod(Fault::tangent);
  CAPTURE(r.text());
  CHECK(says(r, "tangent(): the change of the force on body 'arm'"));
  CHECK(says(r, "a factor of 2 is superfluous"));

  CHECK(says(rod(Fault::velocity), "Ct of constraint length changes with the velocities"));
}

TEST_CASE("check_lock names missing and misplaced values", "[unit][check]") {
  CHECK(says(rod(Fault::ct_missing), "leaves Ct of constraint length unwritten"));  // found when it is set up
  CHECK(says(rod(Fault::ct_sometimes), "Ct of constraint length is not written: it keeps the number from before"));
  CheckReport r = rod(Fault::breakpoint);
  CAPTURE(r.text());
  CHECK(says(r, "Ct of constraint length jumps by "));
  CHECK(says(r, "at t = 1.25 s, which breakpoints() does not report"));
  CHECK(says(rod(Fault::keeps), "has other constraints in a second call"));
  CHECK(says(rod(Fault::slots), "slots() lacks body 'cam', which has its marker 's'"));
  CHECK(says(rod(Fault::slots), "constraint length depends on body 'cam', which slots() lacks"));
  CHECK(says(rod(Fault::names), "two constraints are called 'length'"));
  CHECK(says(rod(Fault::padding), "writes outside of its rows, beyond row 0"));
  CHECK(says(rod(Fault::nan), "C of constraint length is not finite at t = "));
  CHECK(says(rod(Fault::kind), "constraint length is of the kind rotation, but translations of body 'arm' change it"));
}

TEST_CASE("check_lock of a type finds a group that writes one joint twice", "[unit][check]") {
  Registry registry = builtin_registry();
  const auto with = [&](const char* name, Fault fault) {
    registry.links.add({name, "a rod", {}}, [fault](const Attachment& attachment, const Params&) {
      return std::make_unique<Rod>(attachment.name, attachment.p(), attachment.s(), fault);
    });
  };
  with("rod", Fault::none), with("rod_this", Fault::this_for_all);
  const CheckReport right = check_lock(registry, "rod"), wrong = check_lock(registry, "rod_this");
  CAPTURE(right.text(), wrong.text());
  CHECK(right.ok());
  CHECK(says(wrong, "two joints gathered as one group differ from each one alone"));
  CHECK(says(wrong, "links[i] (not this)"));
  CHECK(says(wrong, "the findings are from the test system with both bodies moving"));
}

TEST_CASE("every joint of the library passes its check", "[unit][check]") {
  const Registry registry = builtin_registry();
  for (const std::string& name : registry.links.names()) {
    const CheckOptions options{.seed = 2, .states = 4, .pairs = sample_pairs(name)};
    const CheckReport report = check_lock(registry, name, sample_params("link", name), options);
    INFO(report.text());
    CHECK(report.ok());
    CHECK(report.comparisons() > 100);
  }
  const CheckReport report = check_lock(registry, "rack_and_pinion", sample_params("link", "rack_and_pinion"),
                                        {.seed = 3, .states = 4, .pairs = 2});
  INFO(report.text());
  CHECK(report.ok());
}

TEST_CASE("drives by angle and by speed pass the check of links", "[unit][check]") {
  const Registry registry = builtin_registry();
  for (const bool speed : {false, true}) {
    Bench bench;
    auto& hinge = bench.system.add<Revolute>("hinge", bench.p, bench.s);
    const auto law = registry.laws.make("cycloid", sample_params("law", "cycloid"), &registry, "law");
    speed ? hinge.drive_speed(Axis::rz, law) : hinge.drive(Axis::rz, law);
    const CheckReport report = check_lock(bench.system, hinge, {.seed = 11});
    INFO(report.text());
    CHECK(report.ok());
  }
}

TEST_CASE("check_lock asks for a joint of the system", "[unit][check]") {
  Bench here, there;
  Lock& link = there.system.add(std::make_unique<Rod>("rod", there.p, there.s, Fault::none));
  testing::check_words(testing::message_of<ModelError>([&] { check_lock(here.system, link); }),
                       {"joint 'rod' is not in the system", "System::add"});
}

}  // namespace check_lock_test
