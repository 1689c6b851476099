// SPDX-License-Identifier: BSD-3-Clause
// DART: trees in reduced coordinates, loops by ball constraints on velocities; its world steps by semi-implicit Euler
// alone. "ABA+RK4" drives its forward dynamics with a classical Runge-Kutta of ours (open chains only).
#include <dart/constraint/BallJointConstraint.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/constraint/DynamicJointConstraint.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>

#include "tests/benchmark/peers/measure.h"

using namespace lockstep::peers;
namespace dyn = dart::dynamics;
namespace con = dart::constraint;

namespace {

const Vec3 kY = Vec3::UnitY(), kZ = Vec3::UnitZ();

struct Method {
  double reduction = 0.01;  ///< part of a loop's error that a step takes away
  bool rk4 = false;
  double step = 0;
};

class Model {
 public:
  Model(const Mechanism& m, const Method& method) : mechanism_(m), method_(method) {
    con::DynamicJointConstraint::setErrorReductionParameter(method.reduction);
    con::DynamicJointConstraint::setErrorAllowance(0);
    world_->setTimeStep(method.step);
    world_->setGravity(m.gravity);
    switch (m.kind) {
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
        build_chain();
    }
  }

  void step() {
    if (mechanism_.kind == Kind::slider_crank) joint(0).setCommand(0, kCrankSpeed);  // a step forgets it
    if (method_.rk4)
      step_rk4();
    else
      world_->step();
  }

  Motions motions() const {
    Motions all;
    for (const dyn::BodyNode* b : bodies_) {
      const Vec3 c = b->getLocalCOM();
      const Eigen::Isometry3d& pose = b->getTransform();
      all.push_back({pose * c, pose.linear(), b->getLinearVelocity(c), b->getAngularVelocity()});
    }
    return all;
  }

 private:
  dyn::BodyNode::Properties properties(int body) const {
    const Mass m = mass_of(mechanism_, body);
    dyn::BodyNode::Properties p;
    p.mName = "b" + std::to_string(body);
    p.mInertia.setMass(m.mass);
    p.mInertia.setMoment(m.J[0], m.J[1], m.J[2], 0, 0, 0);
    const Vec3 along_x(half_length(mechanism_, body), 0, 0);
    p.mInertia.setLocalCOM(mechanism_.kind == Kind::heavy_top ? kY : along_x);
    return p;
  }

  dyn::BodyNode* revolute(dyn::BodyNode* parent, int body, const Vec3& at, const Vec3& axis = kZ) {
    dyn::RevoluteJoint::Properties p;
    p.mAxis = axis;
    p.mT_ParentBodyToJoint.translation() = at;
    p.mName = "j" + std::to_string(body);
    return skeleton_->createJointAndBodyNodePair<dyn::RevoluteJoint>(parent, p, properties(body)).second;
  }

  dyn::Joint& joint(int body) { return *bodies_[body]->getParentJoint(); }
  void start(int body, double q, double v) {
    joint(body).setPosition(0, q);
    joint(body).setVelocity(0, v);
  }

  void build_chain() {
    for (int k = 0; k < mechanism_.n; ++k)
      bodies_.push_back(revolute(k > 0 ? bodies_.back() : nullptr, k, Vec3(k > 0 ? 1 : 0, 0, 0),
                                 turns_about_y(mechanism_, k) ? kY : kZ));
    world_->addSkeleton(skeleton_);
  }

  void build_four_bars() {
    const int n = mechanism_.n;
    for (int k = 0; k <= n; ++k) bodies_.push_back(revolute(nullptr, k, Vec3(k, 0, 0)));
    for (int k = 0; k < n; ++k) bodies_.push_back(revolute(bodies_[k], n + 1 + k, Vec3(1, 0, 0)));
    for (int k = 0; k <= 2 * n; ++k) start(k, (k <= n ? 1 : -1) * kHalfTurn / 2, k <= n ? -1 : 1);
    world_->addSkeleton(skeleton_);
    for (int k = 0; k < n; ++k) close(n + 1 + k, k + 1, Vec3(k + 1, 1, 0));
  }

  void build_slider_crank() {
    bodies_.push_back(revolute(nullptr, 0, Vec3::Zero()));
    bodies_.push_back(revolute(bodies_[0], 1, Vec3(kCrank, 0, 0)));
    dyn::PrismaticJoint::Properties guide;
    guide.mAxis = Vec3::UnitX();
    guide.mT_ParentBodyToJoint.translation() = Vec3(kCrank + kRod, 0, 0);
    bodies_.push_back(skeleton_->createJointAndBodyNodePair<dyn::PrismaticJoint>(nullptr, guide, properties(2)).second);
    joint(0).setActuatorType(dyn::Joint::VELOCITY);
    joint(0).setCommand(0, kCrankSpeed);
    joint(0).setVelocity(0, kCrankSpeed);
    joint(1).setVelocity(0, -kCrankSpeed * kCrank / kRod - kCrankSpeed);
    world_->addSkeleton(skeleton_);
    close(1, 2, Vec3(kCrank + kRod, 0, 0));
  }

  void build_heavy_top() {
    const dyn::BallJoint::Properties tip;
    bodies_.push_back(skeleton_->createJointAndBodyNodePair<dyn::BallJoint>(nullptr, tip, properties(0)).second);
    joint(0).setVelocities(kTopSpin);
    world_->addSkeleton(skeleton_);
  }

  void close(int a, int b, const Vec3& x) {
    world_->getConstraintSolver()->addConstraint(std::make_shared<con::BallJointConstraint>(bodies_[a], bodies_[b], x));
  }

  Eigen::VectorXd acceleration(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    skeleton_->setPositions(q);
    skeleton_->setVelocities(v);
    skeleton_->computeForwardDynamics();
    return skeleton_->getAccelerations();
  }

  void step_rk4() {
    const double h = method_.step;
    const Eigen::VectorXd q = skeleton_->getPositions(), v = skeleton_->getVelocities();
    const Eigen::VectorXd a1 = acceleration(q, v), v2 = v + h / 2 * a1;
    const Eigen::VectorXd a2 = acceleration(q + h / 2 * v, v2), v3 = v + h / 2 * a2;
    const Eigen::VectorXd a3 = acceleration(q + h / 2 * v2, v3), v4 = v + h * a3;
    const Eigen::VectorXd a4 = acceleration(q + h * v3, v4);
    skeleton_->setPositions(q + h / 6 * (v + 2 * v2 + 2 * v3 + v4));
    skeleton_->setVelocities(v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4));
  }

  const Mechanism& mechanism_;
  Method method_;
  dart::simulation::WorldPtr world_ = dart::simulation::World::create();
  dyn::SkeletonPtr skeleton_ = dyn::Skeleton::create("mechanism");
  std::vector<dyn::BodyNode*> bodies_;
};

void simulate(Run& run, const Method& method) {
  Model model(run.mechanism, method);
  const long n = n_steps(run.mechanism, method.step);
  if (run.sampled) run.sample(0, model.motions());
  run.start_clock();
  for (long i = 1; i <= n; ++i) {
    model.step();
    if (run.sampled && due(i, n)) run.sample(run.mechanism.until * double(i) / double(n), model.motions());
    if (i % 64 == 0 || run.mechanism.n > 50) run.check_time();
  }
  run.stop_clock();
  run.steps = n;
}

}  // namespace

int main(int argc, char** argv) {
  Bench bench("dart", argc, argv);
  for (const Mechanism& m : all_mechanisms()) {
    if (!is_described(m) || !bench.wants(m)) continue;
    // larger steps end in an assertion of its own
    const double largest = m.kind == Kind::heavy_top ? 1e-3 : m.name == "nfourbar-40" ? 0.01 : 1e9;
    const auto sweep = [&](const std::string& name, const Method& method) {
      bench.sweep(m, name, step_ladder(m, method.rk4 ? 1e9 : largest), [=](double h) {
        return [=](Run& run) { simulate(run, {method.reduction, method.rk4, h}); };
      });
    };
    sweep(has_loops(m) ? "World(0.01)" : "World", {});
    if (has_loops(m) && m.n != 40) sweep("World(0.8)", {0.8});  // with 40 it ends in an assertion of its own
    if (!has_loops(m) && m.kind != Kind::heavy_top) sweep("ABA+RK4", {0.01, true});
  }
}
