// SPDX-License-Identifier: BSD-3-Clause
// Bullet: btMultiBody (reduced coordinates, articulated bodies) and btRigidBody with hinges (maximal coordinates).
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyMLCPConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>

#include <memory>

#include "tests/benchmark/peers/measure.h"

using namespace lockstep::peers;

namespace {

constexpr double kMuch = 1e30;  // no limit to impulses
const btVector3 kY(0, 1, 0), kZ(0, 0, 1), kOrigin(0, 0, 0);

enum class Solver { sequential, dantzig };

struct Method {
  bool reduced = true, rk4 = false;
  Solver solver = Solver::sequential;
  double step = 0;
};

btVector3 vec(const Vec3& v) { return btVector3(v[0], v[1], v[2]); }
btVector3 along_x(double x) { return btVector3(x, 0, 0); }
Vec3 vec(const btVector3& v) { return Vec3(v[0], v[1], v[2]); }
BodyMotion motion(const btTransform& pose, const btVector3& v, const btVector3& w) {
  BodyMotion m{vec(pose.getOrigin()), {}, vec(v), vec(w)};
  for (int i = 0; i < 3; ++i) m.R.row(i) = vec(pose.getBasis()[i]);
  return m;
}

/// What both kinds of worlds share.
class World {
 public:
  explicit World(const Mechanism& m) : mechanism_(m) {}
  virtual ~World() = default;
  virtual Motions motions() = 0;
  void step(double h) { world_->stepSimulation(h, 1, h); }

 protected:
  void set_up() {
    world_->setGravity(vec(mechanism_.gravity));
    world_->getSolverInfo().m_numIterations = 50;
    world_->getSolverInfo().m_leastSquaresResidualThreshold = 0;
  }

  const Mechanism& mechanism_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSphereShape shape_{0.01};
  std::unique_ptr<btMLCPSolverInterface> lcp_;
  std::unique_ptr<btConstraintSolver> solver_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
};

class ReducedWorld final : public World {
 public:
  ReducedWorld(const Mechanism& m, const Method& method) : World(m) {
    if (method.solver == Solver::dantzig) {
      lcp_ = std::make_unique<btDantzigSolver>();
      solver_ = std::make_unique<btMultiBodyMLCPConstraintSolver>(lcp_.get());
    } else {
      solver_ = std::make_unique<btMultiBodyConstraintSolver>();
    }
    auto own = std::make_unique<btMultiBodyDynamicsWorld>(
        &dispatcher_, &broadphase_, static_cast<btMultiBodyConstraintSolver*>(solver_.get()), &configuration_);
    multi_ = own.get();
    world_ = std::move(own);
    set_up();
    body_ = make_body(method.rk4);
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
    place();
  }
  ~ReducedWorld() override {
    for (const auto& c : constraints_) multi_->removeMultiBodyConstraint(c.get());
    for (const auto& c : colliders_) world_->removeCollisionObject(c.get());
    multi_->removeMultiBody(body_.get());
    constraints_.clear();
    body_.reset();
    world_.reset();
  }
  ReducedWorld(const ReducedWorld&) = delete;
  ReducedWorld& operator=(const ReducedWorld&) = delete;

  Motions motions() override {
    place();
    const auto n = static_cast<std::size_t>(body_->getNumLinks());
    std::vector<btVector3> w(n + 1), v(n + 1);  // the base first, each in its own axes
    body_->compTreeLinkVelocities(w.data(), v.data());
    Motions bodies;
    for (int k = 0; k < int(n); ++k) {
      const auto i = static_cast<std::size_t>(k + 1);
      bodies.push_back(motion(body_->getLink(k).m_cachedWorldTransform, body_->localDirToWorld(k, v[i]),
                              body_->localDirToWorld(k, w[i])));
    }
    return bodies;
  }

 private:
  std::unique_ptr<btMultiBody> make_body(bool rk4) const {
    auto body = std::make_unique<btMultiBody>(n_bodies(mechanism_), 0, kOrigin, true, false);
    body->setBasePos(kOrigin);
    body->setWorldToBaseRot(btQuaternion::getIdentity());
    body->setLinearDamping(0);
    body->setAngularDamping(0);
    body->setUseGyroTerm(true);
    body->setMaxCoordinateVelocity(1e12);
    body->setMaxAppliedImpulse(kMuch);
    body->useRK4Integration(rk4);
    body->setHasSelfCollision(false);
    return body;
  }

  void revolute(int link, int parent, const btVector3& axis, const btVector3& from_parent, const btVector3& to_centre) {
    const Mass m = mass_of(mechanism_, link);
    body_->setupRevolute(link, m.mass, vec(m.J), parent, btQuaternion::getIdentity(), axis, from_parent, to_centre,
                         true);
  }

  void build_chain() {
    for (int k = 0; k < mechanism_.n; ++k)
      revolute(k, k - 1, turns_about_y(mechanism_, k) ? kY : kZ, along_x(k > 0 ? 0.5 : 0), along_x(0.5));
    enter();
  }

  void build_four_bars() {
    const int n = mechanism_.n;
    for (int k = 0; k <= n; ++k) revolute(k, -1, kZ, along_x(k), along_x(0.5));
    for (int k = 0; k < n; ++k) revolute(n + 1 + k, k, kZ, along_x(0.5), along_x(0.5));
    enter();
    add_colliders();
    for (int k = 0; k <= 2 * n; ++k) {
      const double side = k <= n ? 1 : -1;
      body_->setJointPos(k, side * kHalfTurn / 2);
      body_->setJointVel(k, -side);
    }
    for (int k = 0; k < n; ++k) pin(n + 1 + k, along_x(0.5), k + 1, along_x(0.5));
  }

  void build_slider_crank() {
    revolute(0, -1, kZ, kOrigin, along_x(kCrank / 2));
    revolute(1, 0, kZ, along_x(kCrank / 2), along_x(kRod / 2));
    const Mass m = mass_of(mechanism_, 2);
    body_->setupPrismatic(2, m.mass, vec(m.J), -1, btQuaternion::getIdentity(), along_x(1), along_x(kCrank + kRod),
                          kOrigin, true);
    enter();
    add_colliders();
    body_->setJointVel(0, kCrankSpeed);
    body_->setJointVel(1, -kCrankSpeed * kCrank / kRod - kCrankSpeed);
    pin(1, along_x(kRod / 2), 2, kOrigin);
    constrain(std::make_unique<btMultiBodyJointMotor>(body_.get(), 0, kCrankSpeed, 1e12));
  }

  void build_heavy_top() {
    const Mass m = mass_of(mechanism_, 0);
    body_->setupSpherical(0, m.mass, vec(m.J), -1, btQuaternion::getIdentity(), kOrigin, kY, true);
    enter();
    const btScalar w[3] = {kTopSpin[0], kTopSpin[1], kTopSpin[2]};
    body_->setJointVelMultiDof(0, w);
  }

  void enter() {
    body_->finalizeMultiDof();
    multi_->addMultiBody(body_.get());
  }

  // Constraints on links without a collider are never solved (they are in no island), without a word.
  void add_colliders() {
    for (int link = 0; link < body_->getNumLinks(); ++link) {
      auto collider = std::make_unique<btMultiBodyLinkCollider>(body_.get(), link);
      collider->setCollisionShape(&shape_);
      body_->getLink(link).m_collider = collider.get();
      world_->addCollisionObject(collider.get(), 0, 0);
      colliders_.push_back(std::move(collider));
    }
    world_->setForceUpdateAllAabbs(false);
    body_->setCanSleep(false);
  }

  void pin(int a, const btVector3& at_a, int b, const btVector3& at_b) {
    constrain(std::make_unique<btMultiBodyPoint2Point>(body_.get(), a, body_.get(), b, at_a, at_b));
    constraints_.back()->setMaxAppliedImpulse(kMuch);
  }

  void constrain(std::unique_ptr<btMultiBodyConstraint> constraint) {
    multi_->addMultiBodyConstraint(constraint.get());
    constraints_.push_back(std::move(constraint));
  }

  void place() {
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> places;
    body_->forwardKinematics(turns, places);
    body_->updateCollisionObjectWorldTransforms(turns, places);
  }

  btMultiBodyDynamicsWorld* multi_ = nullptr;
  std::unique_ptr<btMultiBody> body_;  // its links are the bodies
  std::vector<std::unique_ptr<btMultiBodyConstraint>> constraints_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
};

class MaximalWorld final : public World {
 public:
  MaximalWorld(const Mechanism& m, const Method& method) : World(m) {
    if (method.solver == Solver::dantzig) {
      lcp_ = std::make_unique<btDantzigSolver>();
      solver_ = std::make_unique<btMLCPSolver>(lcp_.get());
    } else {
      solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
    }
    world_ = std::make_unique<btDiscreteDynamicsWorld>(&dispatcher_, &broadphase_, solver_.get(), &configuration_);
    set_up();
    add_bodies();
    switch (m.kind) {
      case Kind::four_bars:
        join_four_bars();
        break;
      case Kind::slider_crank:
        join_slider_crank();
        break;
      case Kind::heavy_top:
        constrain(std::make_unique<btPoint2PointConstraint>(*bodies_[0], -kY));
        break;
      default:
        for (int k = 0; k < m.n; ++k) hinge(k, k - 1, along_x(k), turns_about_y(m, k) ? kY : kZ);
    }
  }
  ~MaximalWorld() override {
    for (const auto& c : constraints_) world_->removeConstraint(c.get());
    for (const auto& b : bodies_) world_->removeRigidBody(b.get());
    world_.reset();
  }
  MaximalWorld(const MaximalWorld&) = delete;
  MaximalWorld& operator=(const MaximalWorld&) = delete;

  Motions motions() override {
    Motions m;
    for (const auto& b : bodies_)
      m.push_back(motion(b->getCenterOfMassTransform(), b->getLinearVelocity(), b->getAngularVelocity()));
    return m;
  }

 private:
  void add_bodies() {
    int k = 0;
    for (const BodyMotion& m : start_of(mechanism_)) {
      const Mass mass = mass_of(mechanism_, k++);
      auto body = std::make_unique<btRigidBody>(
          btRigidBody::btRigidBodyConstructionInfo(mass.mass, nullptr, &shape_, vec(mass.J)));
      const Mat3& R = m.R;
      const btMatrix3x3 basis(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2));
      body->setCenterOfMassTransform(btTransform(basis, vec(m.x)));
      body->setLinearVelocity(vec(m.v));
      body->setAngularVelocity(vec(m.w));
      body->setDamping(0, 0);
      body->setSleepingThresholds(0, 0);
      body->setActivationState(DISABLE_DEACTIVATION);
      world_->addRigidBody(body.get(), 0, 0);
      bodies_.push_back(std::move(body));
    }
  }

  /// Of body a on body b (-1: the ground) at a point and along an axis of the world.
  btHingeConstraint& hinge(int a, int b, const btVector3& x, const btVector3& axis) {
    btRigidBody& A = *bodies_[a];
    const btTransform to_a = A.getCenterOfMassTransform().inverse();
    btVector3 axis_a = to_a.getBasis() * axis;
    std::unique_ptr<btHingeConstraint> joint;
    if (b < 0) {
      joint = std::make_unique<btHingeConstraint>(A, to_a * x, axis_a, false);
    } else {
      btRigidBody& B = *bodies_[b];
      const btTransform to_b = B.getCenterOfMassTransform().inverse();
      btVector3 axis_b = to_b.getBasis() * axis;
      joint = std::make_unique<btHingeConstraint>(A, B, to_a * x, to_b * x, axis_a, axis_b, false);
    }
    btHingeConstraint& made = *joint;
    constrain(std::move(joint));
    return made;
  }

  void join_four_bars() {
    const int n = mechanism_.n;
    for (int k = 0; k <= n; ++k) hinge(k, -1, along_x(k), kZ);
    for (int k = 0; k < n; ++k) {
      hinge(n + 1 + k, k, btVector3(k, 1, 0), kZ);
      hinge(n + 1 + k, k + 1, btVector3(k + 1, 1, 0), kZ);
    }
  }

  void join_slider_crank() {
    hinge(0, -1, kOrigin, kZ).enableAngularMotor(true, kCrankSpeed, 1e12);
    hinge(1, 0, along_x(kCrank), kZ);
    hinge(2, 1, along_x(kCrank + kRod), kZ);
    auto guide = std::make_unique<btSliderConstraint>(*bodies_[2], btTransform::getIdentity(), true);
    guide->setLowerLinLimit(1);  // above the upper one: no limit
    guide->setUpperLinLimit(-1);
    constrain(std::move(guide));
  }

  void constrain(std::unique_ptr<btTypedConstraint> constraint) {
    world_->addConstraint(constraint.get(), true);
    constraints_.push_back(std::move(constraint));
  }

  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> constraints_;
};

std::unique_ptr<World> make_world(const Mechanism& m, const Method& method) {
  if (method.reduced) return std::make_unique<ReducedWorld>(m, method);
  return std::make_unique<MaximalWorld>(m, method);
}

void simulate(Run& run, const Method& method) {
  const std::unique_ptr<World> world = make_world(run.mechanism, method);
  const long n = n_steps(run.mechanism, method.step);
  if (run.sampled) run.sample(0, world->motions());
  run.start_clock();
  for (long i = 1; i <= n; ++i) {
    world->step(method.step);
    if (run.sampled && due(i, n)) run.sample(run.mechanism.until * double(i) / double(n), world->motions());
    if (i % 64 == 0 || run.mechanism.n > 50) run.check_time();
  }
  run.stop_clock();
  run.steps = n;
}

}  // namespace

int main(int argc, char** argv) {
  Bench bench("bullet", argc, argv);
  for (const Mechanism& m : all_mechanisms()) {
    if (!is_described(m) || !bench.wants(m)) continue;
    const auto sweep = [&](const std::string& name, const Method& method) {
      bench.sweep(m, name, step_ladder(m), [=](double h) {
        return [=](Run& run) {
          Method with_step = method;
          with_step.step = h;
          simulate(run, with_step);
        };
      });
    };
    sweep("MultiBody-Euler", {});
    sweep("MultiBody-RK4", {true, true});
    if (has_loops(m) && m.n <= 2) sweep("MultiBody-Euler-Dantzig", {true, false, Solver::dantzig});
    sweep("RigidBody-SI50", {false});
    // with the slider's constraint this solver frees what is not its own
    if (m.n <= 10 && m.kind != Kind::slider_crank) sweep("RigidBody-Dantzig", {false, false, Solver::dantzig});
  }
}
