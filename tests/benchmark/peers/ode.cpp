// SPDX-License-Identifier: BSD-3-Clause
// ODE: rigid bodies in maximal coordinates, hinges; its direct step (LCP) and its iterated one ("quick").
#include <ode/ode.h>

#include "tests/benchmark/peers/measure.h"

using namespace lockstep::peers;

namespace {

struct Method {
  int iterations = 0;      ///< of the quick step; 0: the direct one
  double reduction = 0.2;  ///< part of a joint's error that a step takes away
  double step = 0;
};

class Model {
 public:
  Model(const Mechanism& m, const Method& method) : mechanism_(m), world_(dWorldCreate()) {
    dWorldSetGravity(world_, m.gravity[0], m.gravity[1], m.gravity[2]);
    dWorldSetERP(world_, method.reduction);
    dWorldSetCFM(world_, 1e-10);
    dWorldSetAutoDisableFlag(world_, 0);
    dWorldSetDamping(world_, 0, 0);
    if (method.iterations > 0) dWorldSetQuickStepNumIterations(world_, method.iterations);
    add_bodies();
    switch (m.kind) {
      case Kind::four_bars:
        join_four_bars();
        break;
      case Kind::slider_crank:
        join_slider_crank();
        break;
      case Kind::heavy_top:
        join_heavy_top();
        break;
      default:
        for (int k = 0; k < m.n; ++k) hinge(k, k - 1, {double(k), 0, 0}, turns_about_y(m, k));
    }
  }
  ~Model() { dWorldDestroy(world_); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  void step(const Method& method) {
    if (method.iterations > 0)
      dWorldQuickStep(world_, method.step);
    else
      dWorldStep(world_, method.step);
  }

  Motions motions() const {
    Motions all;
    for (const dBodyID b : bodies_) {
      const dReal *x = dBodyGetPosition(b), *R = dBodyGetRotation(b), *v = dBodyGetLinearVel(b),
                  *w = dBodyGetAngularVel(b);
      BodyMotion m;
      for (int i = 0; i < 3; ++i) {
        m.x[i] = x[i], m.v[i] = v[i], m.w[i] = w[i];
        for (int j = 0; j < 3; ++j) m.R(i, j) = R[4 * i + j];
      }
      all.push_back(m);
    }
    return all;
  }

  /// Of the slider-crank's motor; the feedback is about the body's centre, so it is moved to the hinge.
  double drive_torque() const {
    dVector3 anchor;
    dJointGetHingeAnchor(motor_, anchor);
    const dReal* x = dBodyGetPosition(bodies_[0]);
    return feedback_.t1[2] - ((anchor[0] - x[0]) * feedback_.f1[1] - (anchor[1] - x[1]) * feedback_.f1[0]);
  }

 private:
  void add_bodies() {
    for (const BodyMotion& m : start_of(mechanism_)) {
      const Mass mass = mass_of(mechanism_, static_cast<int>(bodies_.size()));
      const dBodyID b = dBodyCreate(world_);
      dMass parameters;
      dMassSetParameters(&parameters, mass.mass, 0, 0, 0, mass.J[0], mass.J[1], mass.J[2], 0, 0, 0);
      dBodySetMass(b, &parameters);
      dMatrix3 R = {};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) R[4 * i + j] = m.R(i, j);
      dBodySetPosition(b, m.x[0], m.x[1], m.x[2]);
      dBodySetRotation(b, R);
      dBodySetLinearVel(b, m.v[0], m.v[1], m.v[2]);
      dBodySetAngularVel(b, m.w[0], m.w[1], m.w[2]);
      dBodySetFiniteRotationMode(b, 1);
      dBodySetGyroscopicMode(b, 1);
      bodies_.push_back(b);
    }
  }

  dBodyID body(int k) const { return k < 0 ? nullptr : bodies_[k]; }

  /// Of body a on body b (-1: the ground).
  dJointID hinge(int a, int b, const Vec3& x, bool about_y = false) {
    const dJointID joint = dJointCreateHinge(world_, nullptr);
    dJointAttach(joint, body(a), body(b));
    dJointSetHingeAnchor(joint, x[0], x[1], x[2]);
    dJointSetHingeAxis(joint, 0, about_y ? 1 : 0, about_y ? 0 : 1);
    return joint;
  }

  void join_four_bars() {
    const int n = mechanism_.n;
    for (int k = 0; k <= n; ++k) hinge(k, -1, {double(k), 0, 0});
    for (int k = 0; k < n; ++k) {
      hinge(n + 1 + k, k, {double(k), 1, 0});
      hinge(n + 1 + k, k + 1, {double(k + 1), 1, 0});
    }
  }

  void join_slider_crank() {
    motor_ = hinge(0, -1, {0, 0, 0});
    hinge(1, 0, {kCrank, 0, 0});
    hinge(2, 1, {kCrank + kRod, 0, 0});
    const dJointID guide = dJointCreateSlider(world_, nullptr);
    dJointAttach(guide, body(2), nullptr);
    dJointSetSliderAxis(guide, 1, 0, 0);
    dJointSetHingeParam(motor_, dParamVel, dJointGetHingeAngleRate(motor_) > 0 ? kCrankSpeed : -kCrankSpeed);
    dJointSetHingeParam(motor_, dParamFMax, 1e9);
    dJointSetFeedback(motor_, &feedback_);
  }

  void join_heavy_top() {
    const dJointID tip = dJointCreateBall(world_, nullptr);
    dJointAttach(tip, body(0), nullptr);
    dJointSetBallAnchor(tip, 0, 0, 0);
  }

  const Mechanism& mechanism_;
  dWorldID world_;
  std::vector<dBodyID> bodies_;
  dJointID motor_ = nullptr;
  dJointFeedback feedback_{};
};

void simulate(Run& run, const Method& method) {
  Model model(run.mechanism, method);
  const long n = n_steps(run.mechanism, method.step);
  if (run.sampled) run.sample(0, model.motions());
  run.start_clock();
  for (long i = 1; i <= n; ++i) {
    model.step(method);
    if (run.sampled && due(i, n)) run.sample(run.mechanism.until * double(i) / double(n), model.motions());
    if (i % 64 == 0 || run.mechanism.n > 50) run.check_time();
  }
  run.stop_clock();
  run.steps = n;
  if (run.mechanism.kind == Kind::slider_crank)
    run.note = "torque_error=" + std::to_string(model.drive_torque() - slider_crank_torque());
}

}  // namespace

int main(int argc, char** argv) {
  Bench bench("ode", argc, argv);
  dInitODE2(0);
  for (const Mechanism& m : all_mechanisms()) {
    if (!is_described(m) || !bench.wants(m)) continue;
    const auto sweep = [&](const std::string& name, const Method& method) {
      bench.sweep(m, name, step_ladder(m), [=](double h) {
        return [=](Run& run) { simulate(run, {method.iterations, method.reduction, h}); };
      });
    };
    if (m.n < 1000) sweep("direct(0.2)", {});  // its cost grows with the cube of the rows
    if (m.n <= 10) sweep("direct(0.8)", {0, 0.8});
    sweep("quick(20)", {20});
    if (m.n <= 100) sweep("quick(200)", {200});
  }
}
