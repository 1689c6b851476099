// SPDX-License-Identifier: BSD-3-Clause
// check_force: right forces pass, wrong ones are named in words.
#include <lockstep/author/check.h>

#include <lockstep/author/force.h>
#include <lockstep/author/formula.h>
#include <lockstep/author/registry.h>
#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/check_words.h"
#include "tests/support/samples_of_types.h"

namespace check_force_test {

using namespace lockstep;
using lockstep::test::says;

namespace {

enum class Fault {
  none,
  potential,
  dissipation,
  negative,
  supply,  // a power too much
  motor,   // pushes along, and says nothing of it
  stiffness,
  damping,
  markers,
  breakpoint,
  keeps,
  nan,
  turns
};

/// A spring of length zero and a damper between P and S: F = -k d - c dd + law(t) e_x on P, and -F on S at S.
class Rubber final : public Force {
 public:
  Rubber(std::string name, Marker& p, Marker& s, Fault fault) : Force(std::move(name)), p_(p), s_(s), fault_(fault) {}
  std::string_view type() const override { return "rubber"; }
  std::vector<const Marker*> markers() const override {
    if (fault_ == Fault::markers) return {&p_};
    return {&p_, &s_};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (fault_ != Fault::breakpoint && t0 < 0.8 && 0.8 < t1) out.push_back(0.8);
  }
  void setup() override { P_ = MarkerFrame(p_), S_ = MarkerFrame(s_); }
  void apply(const Inputs& in, WrenchSum& out) const override {
    const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
    Vec3 F = -kK * (P.x - S.x) - (fault_ == Fault::motor ? -kC : kC) * (P.v - S.v) + law(in.t);
    if (fault_ == Fault::keeps) F *= 1 + 1e-3 * ++n_calls_;
    if (fault_ == Fault::nan) F /= 0.0 * in.t;
    out.force(P_.slot, F, P.x);
    out.force(S_.slot, -F, S.x);
    if (fault_ == Fault::turns) {  // an angle about z that is not counted
      const Quat rel = conjugate(in.slot(S_.slot).e * S_.q0) * (in.slot(P_.slot).e * P_.q0);
      const double a = 2 * std::atan2(rel.z, rel.w);
      out.torque(P_.slot, -0.3 * (a - kTwoPi * std::round(a / kTwoPi)) * S.A.col(2));
    }
  }
  void tangent(const Inputs& in, TangentSum& out) const override {
    if (fault_ == Fault::stiffness) out.add_K(P_.slot, Half::move, P_.slot, Half::move, kK * Mat3::Identity());
    if (fault_ == Fault::damping) out.add_D(P_.slot, Half::move, P_.slot, Half::move, kC * Mat3::Identity());
    Force::tangent(in, out);
  }
  double potential(const Inputs& in) const override {
    const double d2 = (in_world(P_, in).x - in_world(S_, in).x).squaredNorm();
    return (fault_ == Fault::potential ? 1 : 0.5) * kK * d2;
  }
  double dissipation(const Inputs& in) const override {
    const double d2 = (in_world(P_, in).v - in_world(S_, in).v).squaredNorm();
    if (fault_ == Fault::motor) return 0;
    return (fault_ == Fault::dissipation ? 0.5 : fault_ == Fault::negative ? -1 : 1) * kC * d2;
  }
  double supply(const Inputs& in) const override {
    const Vec3 v = in_world(P_, in).v - in_world(S_, in).v;
    return law(in.t).dot(v) + (fault_ == Fault::supply ? v.squaredNorm() : 0);
  }

 private:
  static constexpr double kK = 40, kC = 3;
  static Vec3 law(double t) { return {t > 0.8 ? 2.0 : 0.5, 0, 0}; }
  Marker &p_, &s_;
  Fault fault_;
  MarkerFrame P_, S_;
  mutable int n_calls_ = 0;
};

/// The same from one formula, without the law; what it says of its energies is wrong by these factors.
class FormulaRubber final : public FormulaForce<FormulaRubber> {
 public:
  FormulaRubber(std::string name, Marker& p, Marker& s, double stored, double lost)
      : FormulaForce(std::move(name), p, &s), stored_(stored), lost_(lost) {}
  std::string_view type() const override { return "formula_rubber"; }
  template <class T, class Load>
  void act(const Ends<T>& at, Load& load) const {
    const Vec3T<T> d = at.P.x() - at.S.x(), dd = at.P.v() - at.S.v();
    load.force(-40.0 * d - 3.0 * dd, at.P.x(), at.S.x());
    load.stores(stored_ * 20.0 * d.dot(d));
    load.dissipates(lost_ * 3.0 * dd.dot(dd));
  }

 private:
  double stored_, lost_;
};

template <class F, class... Args>
CheckReport checked(Args... args) {
  System system;
  const MassProperties mass{2.0, Vec3(0.1, 0, 0.05), Vec3(0.5, 0.6, 0.7).asDiagonal()};
  Body& arm = system.add_body("arm", mass, {{0.2, 0.1, 0}, axis_angle(Vec3(1, 2, -2), 0.4)});
  Body& cam = system.add_body("cam", mass, {{-0.2, 0.3, 0.2}, axis_angle(Vec3(1, 0, -2), -0.7)});
  Marker& p = system.add_marker("p", arm, {{0.1, -0.2, 0.1}, axis_angle(Vec3(1, 1, 1), 0.3)});
  Marker& s = system.add_marker("s", cam, {{0.0, 0.1, -0.2}, axis_angle(Vec3(0, 1, 1), 0.3)});
  return check_force(system, system.add(std::make_unique<F>("rubber", p, s, args...)), {.seed = 7});
}
CheckReport rubber(Fault fault) { return checked<Rubber>(fault); }

}  // namespace

TEST_CASE("check_force passes a right force", "[unit][check]") {
  const CheckReport r = rubber(Fault::none);
  INFO(r.text());
  CHECK(r.ok());
  CHECK(says(r, "force 'rubber' (rubber): no findings in"));
}

TEST_CASE("check_force names wrong energies", "[unit][check]") {
  CheckReport r = rubber(Fault::potential);
  CAPTURE(r.text());
  CHECK(says(r, "W to the bodies, but -dV/dt - dissipation() + supply() is"));
  CHECK(says(r, "its force on body 'arm' along the world's "));
  CHECK(says(r, "at rest, but potential() and supply() give"));
  CHECK(says(r, "look at potential(), whose gradient is minus the force"));

  r = rubber(Fault::dissipation);
  CAPTURE(r.text());
  CHECK(says(r, "its force at rest fits potential() and supply(), so its part that depends on velocities is wrong"));
  CHECK(says(r, "look at dissipation()"));
  CHECK(says(rubber(Fault::negative), "below zero"));

  // A supply that is wrong is not blamed on the damper alone; a power put in is no loss.
  for (const Fault fault : {Fault::supply, Fault::motor}) {
    r = rubber(fault);
    CAPTURE(r.text());
    CHECK(says(r, "or at supply(): the power that laws and motors put in"));
  }
}

TEST_CASE("check_force finds wrong energies of a formula, whose supply follows from it", "[unit][check]") {
  const CheckReport right = checked<FormulaRubber>(1.0, 1.0);
  INFO(right.text());
  CHECK(right.ok());
  CHECK(says(checked<FormulaRubber>(2.0, 1.0), "at rest, but potential() and supply() give"));
  CHECK(says(checked<FormulaRubber>(1.0, 0.5), "so its part that depends on velocities is wrong"));
}

TEST_CASE("check_force names wrong tangents", "[unit][check]") {
  CheckReport r = rubber(Fault::stiffness);
  CAPTURE(r.text());
  CHECK(says(r, "tangent(): K of the force on body 'arm' along its "));
  CHECK(says(r, "so it is twice the value: a factor of 2 is superfluous"));
  CHECK(r.findings().size() == 1);
  r = rubber(Fault::damping);
  CAPTURE(r.text());
  CHECK(says(r, "tangent(): D of the force on body 'arm' along its "));
  CHECK(says(r, "with the velocity of body 'arm'"));
}

TEST_CASE("check_force names what is forgotten", "[unit][check]") {
  CHECK(says(rubber(Fault::markers), "acts on body 'cam', which has none of its markers()"));
  CHECK(says(rubber(Fault::breakpoint), "at t = 0.8 s, which breakpoints() does not report"));
  CHECK(says(rubber(Fault::keeps), "exerts another force in a second call with the same inputs"));
  CHECK(says(rubber(Fault::nan), "its force on body 'arm' is not finite at t = "));
  CheckReport r = rubber(Fault::turns);
  CAPTURE(r.text());
  CHECK(says(r, " deg of body 'arm' about z of '"));
}

TEST_CASE("every force of the library passes its check", "[unit][check]") {
  const Registry registry = builtin_registry();
  for (const std::string& name : registry.forces.names()) {
    const CheckReport report = check_force(registry, name, sample_params("force", name), {.seed = 2});
    INFO(report.text());
    CHECK(report.ok());
    CHECK(report.comparisons() > 100);
  }
}

}  // namespace check_force_test
