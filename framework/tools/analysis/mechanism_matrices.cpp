#include <lockstep/linearization.h>

#include <cmath>

#include <lockstep/error.h>
#include <lockstep/newton.h>
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/analysis/unknowns.h"

namespace lockstep {

Unknowns::Unknowns(const System& system) {
  const auto velocities = unknown_velocities(system.plane());
  for (int k = 0; k < system.n_slots(); ++k) {
    at_.push_back({-1, -1, -1, -1, -1, -1});
    const int width = BodyMass(system.slot(k), system.plane()).width();
    for (int j = 0; j < width; ++j)
      at_.back()[static_cast<std::size_t>(velocities[static_cast<std::size_t>(j)])] = n_++;
  }
}

std::string bodies_of(const Slot& slot) {
  std::string names;
  for (const Body* body : slot.bodies) names += (names.empty() ? "" : " + ") + body->name;
  return names;
}

std::vector<UnknownVelocity> Unknowns::names(const System& system) const {
  static constexpr const char* kNames[] = {"vx", "vy", "vz", "wx", "wy", "wz"};
  std::vector<UnknownVelocity> all;
  for (int k = 0; k < system.n_slots(); ++k)
    for (int j = 0; j < 6; ++j)
      if (column(k, j) >= 0)
        all.push_back({system.body_of_slot(k).name + "." + kNames[j], j < 3 ? "m/s" : "rad/s", k, j});
  return all;
}

VecX Unknowns::of_slots(const VecX& six) const {
  VecX out(n_);
  for (std::size_t k = 0; k < at_.size(); ++k)
    for (std::size_t j = 0; j < 6; ++j)
      if (at_[k][j] >= 0) out[at_[k][j]] = six[static_cast<Eigen::Index>(6 * k + j)];
  return out;
}

VecX Unknowns::to_slots(const VecX& unknowns) const {
  VecX out = VecX::Zero(static_cast<Eigen::Index>(6 * at_.size()));
  for (std::size_t k = 0; k < at_.size(); ++k)
    for (std::size_t j = 0; j < 6; ++j)
      if (at_[k][j] >= 0) out[static_cast<Eigen::Index>(6 * k + j)] = unknowns[at_[k][j]];
  return out;
}

namespace {

using Entries3 = std::vector<Eigen::Triplet<double>>;

SparseMat sparse(Eigen::Index rows, Eigen::Index columns, const Entries3& entries) {
  SparseMat out(rows, columns);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

void add_block(const Unknowns& at, int row, int column, const Mat6& block, Entries3& to) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      if (block(i, j) != 0 && at.column(row, i) >= 0 && at.column(column, j) >= 0)
        to.emplace_back(at.column(row, i), at.column(column, j), block(i, j));
}

SparseMat mass_of(const System& system, const Unknowns& at) {
  Entries3 entries;
  for (int k = 0; k < system.n_slots(); ++k) {
    Mat6 block = Mat6::Zero();
    const Slot& slot = system.slot(k);
    block.topLeftCorner<3, 3>().diagonal().setConstant(slot.mass);
    block.bottomRightCorner<3, 3>() = slot.J;
    add_block(at, k, k, block, entries);
  }
  return sparse(at.n(), at.n(), entries);
}

SparseMat tangent_of(const TangentSum& sum, bool of_velocity, const Unknowns& at) {
  Entries3 entries;
  for (std::size_t p = 0; p < sum.pairs().size(); ++p)
    add_block(at, sum.pairs()[p].row, sum.pairs()[p].column, of_velocity ? sum.D(p) : sum.K(p), entries);
  return sparse(at.n(), at.n(), entries);
}

// J, the numbers of the rows and their names.
void write_rows(const System& system, const RowTable& table, const Unknowns& at, MechanismMatrices& out) {
  Entries3 entries;
  out.c.resize(table.n_rows), out.C.resize(table.n_rows), out.Ct.resize(table.n_rows);
  out.rows.resize(static_cast<std::size_t>(table.n_rows)), out.kinds.resize(out.rows.size());
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    const Lock& link = *system.links()[static_cast<std::size_t>(e.link)];
    for (int k = 0; k < e.m; ++k) {
      const int row = e.first_row + k;
      out.c[row] = block.Qhat(k), out.C[row] = block.C(k), out.Ct[row] = block.Ct(k);
      out.rows[static_cast<std::size_t>(row)] = link.name() + "." + link.row_name(e.own[static_cast<std::size_t>(k)]);
      out.kinds[static_cast<std::size_t>(row)] = e.kind[static_cast<std::size_t>(k)];
      for (int i = 0; i < e.slots.n; ++i) {
        const auto r = block.J(i, k);
        for (int j = 0; j < 6; ++j)
          if (at.column(e.slots[i], j) >= 0 && r[static_cast<std::size_t>(j)] != 0)
            entries.emplace_back(row, at.column(e.slots[i], j), r[static_cast<std::size_t>(j)]);
      }
    }
  }
  out.J = sparse(table.n_rows, at.n(), entries);
}

constexpr double kForceless = 1e-6;  // of the levers: loads below are what is left of their balance
constexpr double kMostLever = 10;    // of the largest load

// The loads, levers and moments of each slot. The arm on which a moment accelerates a mass centre most is the radius of
// gyration: M / (2 sqrt(J m)), here with the largest J of the slot, so that no slender axis makes much of a moment that
// its hinge carries.
void write_loads(const System& system, const Evaluation& e, const Unknowns& at, MechanismMatrices& m) {
  VecX sum = VecX::Zero(6 * system.n_slots());
  VecX one(sum.size());
  for (const auto& force : system.forces()) {
    if (!force->acts(e.inputs())) continue;
    one.setZero();
    WrenchSum wrench(e.inputs().motions, one);
    named(*force, e.inputs().t, [&] { force->apply(e.inputs(), wrench); });
    sum += one.cwiseAbs();
  }
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
  if (const double most = m.loads.maxCoeff(); most > kForceless * m.levers.maxCoeff())
    m.levers = m.levers.cwiseMin(kMostLever * most);
}

}  // namespace

MechanismMatrices matrices_at(Dynamics& dynamics, const State& given) {
  State state = given;
  dynamics.to_slots(state);
  const Solution& solution = dynamics.evaluate(state);
  const Evaluation& e = solution.evaluation;
  const System& system = dynamics.system();
  const Unknowns at(system);
  NewtonMatrix newton;
  newton.gather(e, solution.lambda);

  MechanismMatrices out;
  out.unknowns = at.names(system);
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

SparseMat stiffness_with(Dynamics& dynamics, const State& given, const VecX& lambda) {
  State state = given;
  dynamics.to_slots(state);
  const Solution& solution = dynamics.evaluate(state);
  NewtonMatrix newton;
  newton.gather(solution.evaluation, lambda);
  return tangent_of(newton.tangents(), false, Unknowns(dynamics.system()));
}

}  // namespace lockstep
