// SPDX-License-Identifier: BSD-3-Clause
// Simbody: reduced coordinates (Pin, Ball and Slider mobilizers), loops closed by constraints. Its headers are C++17 at
// most.
#include <Simbody.h>

#include <memory>
#include <stdexcept>

#include "tests/benchmark/peers/assemblies.h"
#include "tests/benchmark/peers/measure.h"

using namespace lockstep::peers;
using SimTK::MobilizedBody;
using SimTK::Transform;

namespace {

constexpr double kQuarter = kHalfTurn / 2;

/// How a planar loop is closed.
enum class Closure {
  planes,  ///< two point-in-plane constraints: none too many
  full     ///< a ball and two constant angles, as a revolute in space: three rows too many a loop
};

SimTK::Vec3 along_x(double x) { return SimTK::Vec3(x, 0, 0); }
SimTK::Vec3 vec(const lockstep::peers::Vec3& v) { return SimTK::Vec3(v[0], v[1], v[2]); }

class Model {
 public:
  Model(const Mechanism& m, Closure closure) : mechanism_(m), closure_(closure) {
    SimTK::Force::UniformGravity(forces_, matter, vec(m.gravity));
    switch (m.kind) {
      case Kind::chain:
      case Kind::spatial_chain:
        build_chain();
        break;
      case Kind::four_bars:
        build_four_bars();
        break;
      case Kind::slider_crank:
        build_slider_crank();
        break;
      case Kind::heavy_top:
        build_heavy_top();
        break;
      default:
        build(assembly_of(m));
    }
  }

  Motions motions(const SimTK::State& s) const {
    Motions bodies(bodies_.size());
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const Transform& pose = bodies_[k].getBodyTransform(s);
      const SimTK::SpatialVec& twist = bodies_[k].getBodyVelocity(s);
      for (int i = 0; i < 3; ++i) {
        bodies[k].x[i] = pose.p()[i];
        bodies[k].w[i] = twist[0][i];
        bodies[k].v[i] = twist[1][i];
        for (int j = 0; j < 3; ++j) bodies[k].R(i, j) = pose.R()[i][j];
      }
    }
    return bodies;
  }

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::State start;

 private:
  SimTK::Body::Rigid rigid(int body) const {
    const Mass m = mass_of(mechanism_, body);
    const SimTK::Inertia J(m.J[0], m.J[1], m.J[2]);
    return SimTK::Body::Rigid(SimTK::MassProperties(m.mass, SimTK::Vec3(0), J));
  }

  void build_chain() {
    MobilizedBody parent = matter.Ground();
    for (int k = 0; k < mechanism_.n; ++k) {
      SimTK::Rotation axes;
      if (turns_about_y(mechanism_, k)) axes = SimTK::Rotation(-kQuarter, SimTK::XAxis);
      parent = MobilizedBody::Pin(parent, Transform(axes, along_x(k > 0 ? 0.5 : 0)), rigid(k),
                                  Transform(axes, along_x(-0.5)));
      bodies_.push_back(parent);
    }
    start = system.realizeTopology();
  }

  void build_four_bars() {
    const int n = mechanism_.n;
    bodies_.resize(2 * n + 1);
    const auto body = [&](int k) -> MobilizedBody& { return bodies_[k]; };
    for (int k = 0; k <= n; ++k)
      body(k) = MobilizedBody::Pin(matter.Ground(), Transform(along_x(k)), rigid(k), Transform(along_x(-0.5)));
    for (int k = 0; k < n; ++k)
      body(n + 1 + k) =
          MobilizedBody::Pin(body(k), Transform(along_x(0.5)), rigid(n + 1 + k), Transform(along_x(-0.5)));
    for (int k = 0; k < n; ++k) close(body(k + 1), along_x(0.5), body(n + 1 + k), along_x(0.5));
    start = system.realizeTopology();
    for (int k = 0; k <= 2 * n; ++k) {
      const double side = k <= n ? 1 : -1;
      body(k).setOneQ(start, 0, side * kQuarter);
      body(k).setOneU(start, 0, -side);
    }
  }

  void build_slider_crank() {
    MobilizedBody::Pin crank(matter.Ground(), Transform(), rigid(0), Transform(along_x(-kCrank / 2)));
    SimTK::Motion::Steady(crank, kCrankSpeed);
    MobilizedBody::Pin rod(crank, Transform(along_x(kCrank / 2)), rigid(1), Transform(along_x(-kRod / 2)));
    MobilizedBody::Slider slider(matter.Ground(), Transform(), rigid(2), Transform());
    close(slider, along_x(0), rod, along_x(kRod / 2));
    start = system.realizeTopology();
    slider.setOneQ(start, 0, kCrank + kRod);
    crank.setOneU(start, 0, kCrankSpeed);
    rod.setOneU(start, 0, -kCrankSpeed * kCrank / kRod - kCrankSpeed);
    bodies_ = {crank, rod, slider};
  }

  void build_heavy_top() {
    MobilizedBody::Ball top(matter.Ground(), Transform(), rigid(0), Transform(SimTK::Vec3(0, -1, 0)));
    start = system.realizeTopology();
    top.setU(start, vec(kTopSpin));
    bodies_ = {top};
  }

  // Every joint's coordinate is zero at the start: its frames are where it stands then.
  void build(const Assembly& assembly) {
    bodies_.resize(assembly.bodies.size());
    const auto body = [&](int k) -> MobilizedBody& { return k == kGroundBody ? matter.updGround() : bodies_[k]; };
    const auto place = [&](int k) { return k == kGroundBody ? Transform() : pose(assembly.bodies[std::size_t(k)]); };
    for (const TreeJoint& j : assembly.tree) {
      const SimTK::CoordinateAxis along(j.slides ? 0 : 2);
      const Transform world(SimTK::Rotation(SimTK::UnitVec3(vec(j.axis)), along), vec(j.at));
      const Mass& m = assembly.bodies[std::size_t(j.child)].mass;
      const SimTK::Body::Rigid solid(
          SimTK::MassProperties(m.mass, SimTK::Vec3(0), SimTK::Inertia(m.J[0], m.J[1], m.J[2])));
      const Transform on_parent = ~place(j.parent) * world, on_child = ~place(j.child) * world;
      if (j.slides)
        body(j.child) = MobilizedBody::Slider(body(j.parent), on_parent, solid, on_child);
      else
        body(j.child) = MobilizedBody::Pin(body(j.parent), on_parent, solid, on_child);
    }
    for (const ClosingJoint& j : assembly.loops) close(j, body(j.a), body(j.b), ~place(j.a), ~place(j.b));
    for (const Spring& s : assembly.springs) {
      const SimTK::Vec3 at_a = ~place(s.a) * vec(s.at_a), at_b = ~place(s.b) * vec(s.at_b);
      SimTK::Force::TwoPointLinearSpring(forces_, body(s.a), at_a, body(s.b), at_b, s.stiffness, s.free_length);
      if (s.damping > 0) SimTK::Force::TwoPointLinearDamper(forces_, body(s.a), at_a, body(s.b), at_b, s.damping);
    }
    if (assembly.torque != 0) SimTK::Force::ConstantTorque(forces_, body(0), SimTK::Vec3(0, 0, assembly.torque));
    start = system.realizeTopology();
    for (const TreeJoint& j : assembly.tree) body(j.child).setOneU(start, 0, j.speed);
  }

  static Transform pose(const AssemblyBody& b) {
    SimTK::Mat33 R;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) R(i, j) = b.R(i, j);
    return Transform(SimTK::Rotation(R), vec(b.x));
  }

  // In the plane two rows; in space a ball, and the axis upright on one other direction (on both: one row too many).
  void close(const ClosingJoint& j, MobilizedBody& a, MobilizedBody& b, const Transform& to_a, const Transform& to_b) {
    using namespace SimTK;
    const SimTK::Vec3 at_a = to_a * vec(j.at), at_b = to_b * vec(j.at);
    if (j.planar) {
      // the planes stand still in body b, and the rows need not be the world's x and y
      Constraint::PointInPlane(b, UnitVec3(XAxis), at_b[0], a, at_a);
      Constraint::PointInPlane(b, UnitVec3(YAxis), at_b[1], a, at_a);
      return;
    }
    Constraint::Ball(a, at_a, b, at_b);
    const UnitVec3 axis(vec(j.axis)), first = axis.perp();
    const UnitVec3 second(SimTK::cross(axis, first));
    const UnitVec3 on_a(to_a.R() * axis);
    Constraint::ConstantAngle(a, on_a, b, UnitVec3(to_b.R() * first), kQuarter);
    if (closure_ == Closure::full) Constraint::ConstantAngle(a, on_a, b, UnitVec3(to_b.R() * second), kQuarter);
  }

  void close(MobilizedBody& a, const SimTK::Vec3& at_a, MobilizedBody& b, const SimTK::Vec3& at_b) {
    using namespace SimTK;
    if (closure_ == Closure::planes) {
      Constraint::PointInPlane(a, UnitVec3(XAxis), at_a[0], b, at_b);
      Constraint::PointInPlane(a, UnitVec3(YAxis), at_a[1], b, at_b);
    } else {
      Constraint::Ball(a, at_a, b, at_b);
      Constraint::ConstantAngle(a, UnitVec3(ZAxis), b, UnitVec3(XAxis), kQuarter);
      Constraint::ConstantAngle(a, UnitVec3(ZAxis), b, UnitVec3(YAxis), kQuarter);
    }
  }

  const Mechanism& mechanism_;
  Closure closure_;
  SimTK::GeneralForceSubsystem forces_{system};
  std::vector<MobilizedBody> bodies_;  // in the order of mechanisms.h
};

std::unique_ptr<SimTK::Integrator> make_integrator(const std::string& name, const SimTK::System& system) {
  using namespace SimTK;
  if (name == "RKMerson") return std::make_unique<RungeKuttaMersonIntegrator>(system);
  if (name == "RKFeldberg") return std::make_unique<RungeKuttaFeldbergIntegrator>(system);
  if (name == "RK3") return std::make_unique<RungeKutta3Integrator>(system);
  if (name == "CPodesBDF") return std::make_unique<CPodesIntegrator>(system, CPodes::BDF, CPodes::Newton);
  if (name == "CPodesAdams") return std::make_unique<CPodesIntegrator>(system, CPodes::Adams, CPodes::Functional);
  if (name == "Verlet") return std::make_unique<VerletIntegrator>(system);
  if (name == "SemiExplicitEuler2") return std::make_unique<SemiExplicitEuler2Integrator>(system);
  throw std::runtime_error("no integrator " + name);
}

struct Method {
  std::string integrator;
  Closure closure = Closure::planes;
  double accuracy = 1e-10;
  double step = 0;     ///< fixed, s; 0: chosen by the error
  bool dense = false;  ///< stops at the report times; else runs through and its steps' ends are sampled
};

void simulate(Run& run, const Method& method) {
  Model model(run.mechanism, method.closure);
  const std::unique_ptr<SimTK::Integrator> integrator = make_integrator(method.integrator, model.system);
  const double end = run.mechanism.until;
  integrator->setAccuracy(method.accuracy);
  integrator->setFinalTime(end);
  if (method.step > 0) {
    integrator->setFixedStepSize(method.step);
    integrator->setProjectEveryStep(true);
  }
  const bool reactions = run.mechanism.kind == Kind::slider_crank;
  integrator->setReturnEveryInternalStep(!method.dense && (run.sampled || reactions));
  SimTK::Vector_<SimTK::SpatialVec> reaction;
  run.start_clock();
  integrator->initialize(model.start);
  if (run.sampled) run.sample(0, model.motions(integrator->getState()));
  for (int next = 1; integrator->getTime() < end;) {
    integrator->stepTo(method.dense ? end * next / kReports : end);  // the first call only returns the start
    const SimTK::State& state = integrator->getState();
    if (reactions) {
      model.system.realize(state, SimTK::Stage::Acceleration);
      model.matter.calcMobilizerReactionForces(state, reaction);
    }
    if (state.getTime() >= end * next / kReports) ++next;
    if (run.sampled && state.getTime() > run.t_last) {
      model.system.realize(state, SimTK::Stage::Velocity);
      run.sample(state.getTime(), model.motions(state));
    }
    run.check_time();
  }
  run.stop_clock();
  run.steps = integrator->getNumStepsTaken();
  run.note = "realizations=" + std::to_string(integrator->getNumRealizations()) +
             " projections=" + std::to_string(integrator->getNumProjections());
  if (reactions) {
    SimTK::Vector torque;
    model.matter.findMotionForces(integrator->getState(), torque);  // the constraint's side of it
    run.note += " torque_error=" + std::to_string(-torque[0] - slider_crank_torque());
  }
}

void sweep(Bench& bench, const Mechanism& m, const std::string& integrator, Closure closure, const std::string& tag) {
  const double growth = integrator == "SemiExplicitEuler2" ? 1
                        : integrator == "Verlet"           ? 0.5
                        : integrator == "RK3"              ? 1.0 / 3
                                                           : 0.25;
  const auto make = [=](const Method& method) { return [method](Run& run) { simulate(run, method); }; };
  const auto by_error = [=](bool dense) {
    return [=](double accuracy) { return make({integrator, closure, accuracy, 0, dense}); };
  };
  bench.sweep(m, integrator + tag, tolerance_ladder(), by_error(false), growth);
  if (integrator == "CPodesAdams")
    bench.sweep(m, integrator + tag + "-dense", tolerance_ladder(), by_error(true), growth);
  if (integrator == "RKMerson" || integrator == "RKFeldberg")
    bench.sweep(m, integrator + tag + "-fixed", step_ladder(m), [=](double h) {
      return make({integrator, closure, 1e-10, h});
    });
}

std::vector<std::string> integrators_for(const Mechanism& m) {
  std::vector<std::string> names = {"RKMerson", "RKFeldberg", "CPodesAdams", "RK3", "Verlet"};
  if (n_bodies(m) <= 10 && m.kind != Kind::slider_crank) names.insert(names.end(), {"CPodesBDF", "SemiExplicitEuler2"});
  return names;
}

}  // namespace

int main(int argc, char** argv) {
  Bench bench("simbody", argc, argv);
  for (const Mechanism& m : all_mechanisms()) {
    if (!bench.wants(m)) continue;
    const std::string tag = m.kind == Kind::four_bars || m.kind == Kind::andrews ? "+planes"
                            : m.kind == Kind::bricard                            ? "+ball+angle"
                            : m.kind == Kind::slider_crank                       ? "+steady"
                                                                                 : "";
    for (const std::string& integrator : integrators_for(m)) sweep(bench, m, integrator, Closure::planes, tag);
    if (m.name == "nfourbar-2" || m.kind == Kind::bricard) sweep(bench, m, "RKMerson", Closure::full, "+redundant");
  }
}
