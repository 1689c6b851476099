// SPDX-License-Identifier: BSD-3-Clause
// Accounts of bodies and joints from one solution of the equations of motion.
#include <lockstep/explain.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/analysis/forces_at_rest.h"
#include "framework/tools/analysis/mechanism_matrices.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep {
namespace {

// The loads of forces and joints on a slot, part by part.
void add_loads(const System& system, const Evaluated& v, int slot, std::vector<Contribution>& out) {
  const auto add = [&](const std::string& what, const Vec6& f) {
    out.push_back({what, f.head<3>(), v.in.slot(slot).A * f.tail<3>()});
  };
  const Reactions reactions(v);
  for (const auto& force : system.forces()) {
    if (!force->acts(v.in)) continue;
    const Vec6 on = wrench_of(system, v.in, *force, &reactions).segment<6>(6 * slot);
    if (!on.isZero(0) || std::ranges::find(force->slots(), slot) != force->slots().end())
      add("force '" + force->name() + "'", on);
  }
  for (const RowEntry& entry : v.rows.entries) {
    const int i = entry.slots.position(slot);
    if (i < 0) continue;
    const Lock& link = *system.links()[entry.link];
    const int n = link.driven() ? link.driven()->n_drives() : 0;
    for (int d = -1; d < n; ++d) {  // -1: the joint
      const auto takes = [&](int k) { return link.row(entry.own[k]).drive == d; };
      add(d < 0 ? "joint '" + link.name() + "'" : "drive " + link.name() + "." + link.driven()->drive(d).name,
          -load_of(v.rows, entry, i, v.lambda, takes));
    }
  }
}

std::string left_out_in(Plane plane) {
  if (!plane) return "";
  return fmt::format(
      "motion in the plane with normal {}: forces along the normal and moments about axes in the plane are not "
      "computed",
      "xyz"[plane.n]);
}

std::vector<double> numbers(const Vec3& v) { return {v[0], v[1], v[2]}; }

LawAccount account(std::string what, const MotionLaw& law, std::string unit, double t) {
  const LawValue y = law.at(t);
  return {std::move(what), std::move(unit), {y.y}, {y.yd}, {y.ydd}};
}
LawAccount account(std::string what, const TranslationLaw& law, double t) {
  const TranslationValue y = law.at(t);
  return {std::move(what), "m", numbers(y.x), numbers(y.v), numbers(y.a)};
}
LawAccount account(std::string what, const RotationLaw& law, double t) {
  const RotationValue y = law.at(t);
  return {std::move(what), "", {y.q.w, y.q.x, y.q.y, y.q.z}, numbers(y.w), numbers(y.a)};
}

void add_laws(const Marker& marker, double t, std::vector<LawAccount>& out) {
  if (marker.translation_law)
    out.push_back(account("translation of marker '" + marker.name + "'", *marker.translation_law, t));
  if (marker.rotation_law) out.push_back(account("rotation of marker '" + marker.name + "'", *marker.rotation_law, t));
}

void add_laws(const Lock& link, double t, std::vector<LawAccount>& out) {
  if (const Jointed* joint = link.jointed()) {
    for (const Drive& d : joint->imposed().drives) {
      const std::string unit = is_rotation(d.axis) ? "rad" : "m";
      out.push_back(account((d.speed ? "speed of drive " : "drive ") + std::string(to_string(d.axis)), *d.law,
                            d.speed ? unit + "/s" : unit, t));
    }
    if (joint->imposed().move) out.push_back(account("imposed translation", *joint->imposed().move, t));
    if (joint->imposed().turn) out.push_back(account("imposed rotation", *joint->imposed().turn, t));
  }
  for (const auto& [p, s] : link.pairs())
    for (const Marker* marker : {p, s}) add_laws(*marker, t, out);
}

}  // namespace

BodyBalance balance_of(Dynamics& dynamics, const State& state, const Body& body) {
  const System& system = dynamics.system();
  if (body.slot == kGround)
    throw ModelError("body '" + body.name +
                     "' does not move, so it has no balance; name a moving body, or a joint on it");
  const Solution& v = dynamics.solution_at(state);
  const Slot& slot = system.slot(body.slot);
  const Motion& m = v.in.slot(body.slot);
  BodyBalance out;
  out.body = bodies_of(slot);
  out.mass = slot.mass, out.center = m.x, out.acceleration = v.a.segment<3>(6 * body.slot);
  if (const Vec3 weight = slot.mass * system.gravity(); !weight.isZero(0))
    out.parts.push_back({"gravity", weight, Vec3::Zero()});
  add_loads(system, v, body.slot, out.parts);
  out.sum.what = "sum", out.rate.what = "m a, rate of angular momentum";
  for (const Contribution& part : out.parts) out.sum.force += part.force, out.sum.moment += part.moment;
  out.rate.force = slot.mass * out.acceleration;
  if (slot.freedoms == Freedoms::spatial)
    out.rate.moment = m.A * (slot.J * v.a.segment<3>(6 * body.slot + 3) + cross(m.w, Vec3(slot.J * m.w)));
  Vec3 force = out.sum.force - out.rate.force, moment = out.sum.moment - out.rate.moment;
  out.incomplete = left_out_in(system.plane());
  if (const Plane plane = system.plane()) force[plane.n] = 0, moment[plane.i()] = moment[plane.j()] = 0;
  out.left_force = force.norm(), out.left_moment = moment.norm();
  return out;
}

LinkAccount account_of(Dynamics& dynamics, const State& state, const Lock& link) {
  const System& system = dynamics.system();
  LinkAccount out;
  out.name = link.name(), out.type = std::string(link.type());
  out.merged = system.merged(link);
  for (Dependency& d : mobility(dynamics, state).dependencies)
    if (d.too_many > 0 &&
        std::ranges::any_of(d.rows, [&](const std::string& row) { return row.starts_with(link.name() + "."); }))
      out.dependencies.push_back(std::move(d));
  add_laws(link, state.t, out.laws);
  for (int k = 0; k < link.row_count(); ++k)
    if ((system.left_out(link) >> k & 1U) != 0) out.left_out.push_back(link.row_name(k));
  const Solution& v = dynamics.solution_at(state);
  const auto load = [&](const VecX& lambda, int part) {
    const Reactions of(v.rows, {lambda.data(), static_cast<std::size_t>(lambda.size())});
    return link.pairs().empty() ? LinkWrench()
                                : of.on_body_of(MarkerFrame(*link.pairs().front().first), link, v.in, part);
  };
  Mat3 S = Mat3::Identity();
  if (!link.pairs().empty()) {
    const auto [p, s] = link.pairs().front();
    out.on_p = p->body->name, out.on_s = s->body->name, S = in_world(MarkerFrame(*s), v.in).A;
    out.axes = {S.col(0), S.col(1), S.col(2)};
  }
  const int entry = out.merged ? -1 : v.rows.entry_of_link[link.number()];
  out.in_force = !out.merged && (state.modes[link.number()] || state.watched[link.number()]);
  if (entry < 0) return out;
  out.incomplete = left_out_in(system.plane());
  const RowEntry& e = v.rows.entries[entry];
  VecX C, Cd;
  v.evaluation.residuals(C, Cd);
  for (int k = 0; k < e.m; ++k) {
    const LinkRow& row = link.row(e.own[k]);
    const int at = e.first_row + k;
    VecX alone = VecX::Zero(v.lambda.size());
    alone[at] = v.lambda[at];
    const LinkWrench w = load(alone, row.drive < 0 ? Reactions::kJoint : row.drive);
    out.rows.push_back({row.name, row.kind, C[at], Cd[at], v.lambda[at], row.drive >= 0, {}});
    out.rows.back().on_p = {S.transpose() * w.force, S.transpose() * w.moment};
  }
  out.joint = load(v.lambda, Reactions::kJoint), out.drives = load(v.lambda, Reactions::kDrives);
  return out;
}

LinkEquations equations_of(Dynamics& dynamics, const State& state, const Lock& link) {
  const System& system = dynamics.system();
  if (system.merged(link))
    throw ModelError("joint '" + link.name() +
                     "' is merged: its bodies move as one, so it has no constraints; give \"merge\": \"off\" "
                     "(System::set_merge)");
  const Inputs& in = dynamics.inputs(state);
  RowTable room;
  const RowBlock rows = named(link, in.t, [&] { return gather_alone(link, in, room); });
  const Eigen::Index m = link.row_count(), n = link.slots().n;
  LinkEquations out;
  out.C.resize(m), out.Ct.resize(m), out.Qc.resize(m), out.J.resize(m, 6 * n), out.Cq.resize(m, 7 * n);
  for (int i = 0; i < n; ++i) out.slots.push_back(bodies_of(system.slot(link.slots()[i])));
  for (int k = 0; k < m; ++k) {
    out.rows.push_back(link.name() + "." + link.row_name(k));
    out.C[k] = rows.C(k), out.Ct[k] = rows.Ct(k), out.Qc[k] = rows.Qhat(k);
    for (int i = 0; i < n; ++i) {
      const std::array<double, 6> J = rows.J(i, k);
      const auto at = Eigen::Map<const Eigen::Matrix<double, 1, 6>>(J.data());
      out.J.block<1, 6>(k, 6 * i) = at;
      out.Cq.block<1, 3>(k, 7 * i) = at.head<3>();
      out.Cq.block<1, 4>(k, 7 * i + 3) =
          at.tail<3>() * G_matrix(normalized(state.slot_pose(link.slots()[i]).q));  // (2.13)
    }
  }
  return out;
}

ForceEffect account_of(Dynamics& dynamics, const State& state, const Force& force) {
  const System& system = dynamics.system();
  const Solution& v = dynamics.solution_at(state);
  ForceEffect out;
  out.name = force.name(), out.type = std::string(force.type());
  for (const ForceLaw& own : force.laws()) out.laws.push_back(account(own.what, *own.law, own.unit, state.t));
  for (const Marker* marker : force.markers())
    if (marker != nullptr) add_laws(*marker, state.t, out.laws);
  out.acts = force.acts(v.in);
  if (!out.acts) return out;
  const Reactions reactions(v);
  const VecX all = wrench_of(system, v.in, force, &reactions);
  out.dissipation = channels::loss(force, v);
  named(force, v.in.t, [&] { out.potential = force.potential(v.in), out.supply = force.supply(v.in); });
  for (const int slot : force.slots())
    out.on.push_back(
        {bodies_of(system.slot(slot)), all.segment<3>(6 * slot), v.in.slot(slot).A * all.segment<3>(6 * slot + 3)});
  return out;
}

}  // namespace lockstep
