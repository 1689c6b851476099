// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/mechanism_matrices.h"

#include <cmath>

#include <lockstep/detail/newton.h>
#include <lockstep/linearization.h>
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/rank/loop_rows.h"

namespace lockstep {

std::string bodies_of(const Slot& slot) {
  std::string names;
  for (const Body* body : slot.bodies) names += (names.empty() ? "" : " + ") + body->name;
  return names;
}

SparseMat mass_of(const System& system, const Unknowns& at) {
  Triplets entries;
  for (int k = 0; k < system.n_slots(); ++k)
    at.add(k, system.slot(k).mass * Mat3::Identity(), system.slot(k).J, entries);
  return at.square(entries);
}

SparseMat carried_by(const Vec3& spin, const System& system, const State& state) {
  const Unknowns at(system);
  Triplets entries;
  for (int k = 0; k < system.n_slots(); ++k)
    at.add(k, skew(spin), skew(Vec3(slot_motion(state, k).A.transpose() * spin)), entries);
  return at.square(entries);
}

namespace {

std::vector<UnknownVelocity> names_of_unknowns(const System& system, const Unknowns& at) {
  static constexpr const char* kNames[] = {"vx", "vy", "vz", "wx", "wy", "wz"};
  std::vector<UnknownVelocity> all;
  for (const int place : at.places()) {
    const int slot = place / 6, j = place % 6;
    all.push_back({system.body_of_slot(slot).name + "." + kNames[j], j < 3 ? "m/s" : "rad/s", slot, j});
  }
  return all;
}

// J, the numbers of the rows and their names.
void write_rows(const System& system, const RowTable& table, const Unknowns& at, MechanismMatrices& out) {
  out.c.resize(table.n_rows), out.C.resize(table.n_rows), out.Ct.resize(table.n_rows);
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    for (int k = 0; k < e.m; ++k) {
      const int row = e.first_row + k;
      out.c[row] = block.Qhat(k), out.C[row] = block.C(k), out.Ct[row] = block.Ct(k);
      out.rows.push_back(NamedRow(system, table, row).name());
      out.kinds.push_back(e.kind[k]);
    }
  }
  out.J = at.rows(table, up_to(table.entries.size())).transpose();
}

constexpr double kMostLever = 10;  // of the largest load

// The loads, levers and moments of each slot. The arm on which a moment accelerates a centre of mass most is the radius
// of gyration: M / (2 sqrt(J m)), here with the largest J of the slot, so that no slender axis makes much of a moment
// that its hinge carries.
void write_loads(const System& system, const Evaluation& e, const Unknowns& at, MechanismMatrices& m) {
  VecX sum = VecX::Zero(6 * system.n_slots());
  for (const auto& force : system.forces()) sum += wrench_of(system, e.inputs(), *force).cwiseAbs();
  const VecX reactions = at.to_slots(VecX(m.J.cwiseAbs().transpose() * m.lambda.cwiseAbs()));
  m.loads.setZero(system.n_slots()), m.levers.setZero(system.n_slots()), m.moments.setZero(3 * system.n_slots());
  for (int k = 0; k < system.n_slots(); ++k) {
    const BodyMass mass(system.slot(k), system.plane());
    const Vec3 w = e.inputs().slot(k).w;
    Vec3 turning = sum.segment<3>(6 * k + 3) + Vec3(cross(w, Vec3(mass.J() * w))).cwiseAbs();
    for (int i = 0; i < 3; ++i)
      if (at.column(k, 3 + i) < 0) turning[i] = 0;
    m.loads[k] = system.gravity().norm() + (sum + reactions).segment<3>(6 * k).norm() / mass.m();
    m.moments.segment<3>(3 * k) = turning + reactions.segment<3>(6 * k + 3);
    if (const double J = 0.5 * mass.J().trace(); J > 0) m.levers[k] = turning.norm() / (2 * std::sqrt(J * mass.m()));
  }
  if (m.loads.size() == 0) return;
  if (const double most = m.loads.maxCoeff(); most > kSlight * m.levers.maxCoeff())
    m.levers = m.levers.cwiseMin(kMostLever * most);
}

}  // namespace

MechanismMatrices matrices_at(Dynamics& dynamics, const State& given) {
  const State state = dynamics.in_slots(given);
  const Solution& solution = dynamics.evaluate(state);
  const Evaluation& e = solution.evaluation;
  const System& system = dynamics.system();
  const Unknowns at(system);
  NewtonMatrix newton;
  newton.gather(e, solution.lambda);

  MechanismMatrices out;
  out.unknowns = names_of_unknowns(system, at);
  out.M = mass_of(system, at);
  out.D = tangent_of(newton.tangents(), true, at);
  out.K = tangent_of(newton.tangents(), false, at);
  write_rows(system, e.rows(), at, out);
  VecX f = e.force();
  e.react(solution.lambda, f);
  out.f = at.of_slots(f), out.a = at.of_slots(solution.a), out.v = at.of_slots(state.v);
  out.lambda = solution.lambda;
  out.length = system.length();
  write_loads(system, e, at, out);
  return out;
}

}  // namespace lockstep
