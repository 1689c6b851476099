// SPDX-License-Identifier: BSD-3-Clause
// Planar mechanisms: the rows in the plane, and the parts that leave it. The declarations of types decide
// (stays_in_plane, turns_about, PhiSpec); positions are read at the start.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <Eigen/SparseQR>

#include <lockstep/author/force.h>
#include <lockstep/author/passes.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/mechanism/system/rows_at_start.h"

namespace lockstep {

RowsAtStart::RowsAtStart(const System& system, Plane plane, State start)
    : system_(system), plane_(plane), start_(std::move(start)) {
  start_.v.setZero();
  passes::motions(system, start_, motions_);
  in_.t = start_.t, in_.motions = motions_;
  in_.s = {start_.s.data(), static_cast<std::size_t>(start_.s.size())};
  in_.z = {start_.z.data(), static_cast<std::size_t>(start_.z.size())};
}

std::span<const RowAtStart> RowsAtStart::of(const Lock& link) {
  const RowBlock block = named(link, in_.t, [&] { return gather_alone(link, in_, table_); });
  rows_.assign(block.rows(), {});
  for (int row = 0; row < block.rows(); ++row) {
    RowAtStart& r = rows_[row];
    r.demand = std::max({std::abs(block.C(row)), std::abs(block.Ct(row)), std::abs(block.Qhat(row))});
    for (int i = 0; i < block.slots(); ++i) {
      const std::array<double, 6> J = block.J(i, row);
      const Vec3 f(J[0], J[1], J[2]), m = in_.slot(link.slots()[i]).A * Vec3(J[3], J[4], J[5]) / system_.length();
      r.normal[i] = {f[plane_.n], m[plane_.i()], m[plane_.j()]};
      r.add(f, m, plane_);
    }
  }
  return rows_;
}

namespace {

using Refusal = std::optional<ModelError>;  // empty: all lies in the plane

char axis_name(Plane plane) { return "xyz"[plane.n]; }

// `advice`: besides leaving the plane.
Refusal leaves(Plane plane, Thing thing, const std::string& what, const std::string& advice = {}) {
  return ModelError({.thing = std::move(thing),
                     .problem = fmt::format("the scene is planar with normal {}, but {}", axis_name(plane), what),
                     .advice = "set \"planar\" to \"off\"" + advice});
}

// Whether the normal is no principal axis of a slot's inertia: the centres of mass of its bodies may be outside the plane of
// their common one.
bool has_products(const Slot& s, Plane plane) {
  return std::hypot(s.J(plane.n, plane.i()), s.J(plane.n, plane.j())) > kNegligible * s.J.trace();
}

// `length`: of the mechanism; a velocity of less than a rounding of it a second is none.
Refusal check_body(const Body& b, const Slot& s, Plane plane, double length) {
  const Thing body{.kind = "body", .name = b.name};
  const Mat3 A = rotation(b.home.q);
  const Vec3 v = b.start.v + A * cross(b.start.w, b.mass.center), w = A * b.start.w;
  if (std::abs(v[plane.n]) > kNegligible * v.norm() + kRoundOff * length)
    return leaves(plane, body, "it starts with " + text::brief(v[plane.n]) + " m/s along the normal",
                  ", or start in the plane");
  if (std::hypot(w[plane.i()], w[plane.j()]) > kNegligible * w.norm() + kRoundOff)
    return leaves(plane, body, "it starts rotating about an axis in the plane", ", or rotate it about the normal");
  if (s.freedoms == Freedoms::particle || s.bodies.size() > 1 || !has_products(s, plane)) return {};
  return leaves(plane, body,
                "the normal is not a principal axis of its inertia (products " + text::brief(s.J(plane.n, plane.i())) +
                    " and " + text::brief(s.J(plane.n, plane.j())) +
                    " kg m^2), so it would not stay in the plane without moments from its joints");
}

// The message about a type that does not declare that it stays in the plane, with the line to add unless it is built in.
std::string silence(const std::string& type, const std::string& origin, Plane plane, const std::string& line) {
  if (origin == "built in") return fmt::format("{} may leave the plane with normal {}", type, axis_name(plane));
  return fmt::format("{} does not declare that it stays in the plane with normal {}; add to its {}", type,
                     axis_name(plane), line);
}

// The same for the first of two laws that does not declare it; "" for none. `normal`: in the axes in which they are imposed.
std::string silence_of(const LawPtr<TranslationLaw>& move, const LawPtr<RotationLaw>& turn, Plane plane,
                       const Vec3& normal) {
  const bool moves = move && !move->stays_in_plane(normal);
  if (!moves && (!turn || turn->turns_about(normal))) return "";
  const LawLabel* label = moves ? label_of(move) : label_of(turn);
  return silence(label != nullptr ? "its law '" + label->type + "'" : "its law", label != nullptr ? label->origin : "",
                 plane,
                 moves ? "class: \"bool stays_in_plane(const lockstep::Vec3& normal) const override\""
                       : "class: \"bool turns_about(const lockstep::Vec3& axis) const override\"");
}

// The same of a joint or force and its laws. `markers`: of a joint, P before S.
template <class T>
Refusal silence_of(const char* kind, const T& thing, const std::vector<const Marker*>& markers, const Jointed* joint,
                   Plane plane) {
  const auto normal = [&](const Marker* m) { return Vec3(MarkerFrame(*m).A0.row(plane.n)); };
  std::string words;
  if (joint != nullptr) words = silence_of(joint->imposed().move, joint->imposed().turn, plane, normal(markers[1]));
  for (const Marker* m : markers)
    if (words.empty()) words = silence_of(m->translation_law, m->rotation_law, plane, normal(m));
  if (words.empty())
    words = silence(fmt::format("'{}'", thing.type()), thing.origin(), plane,
                    "class: \"bool stays_in_plane(lockstep::Plane) const override { return true; }\", or to "
                    "the spec of its function: \".stays_in_plane = true\"");
  return ModelError({.thing = {.kind = kind, .name = thing.name()}, .problem = words});
}

Refusal check_declared(const System& system) {
  const Plane plane = system.plane();
  for (const auto& link : system.links()) {
    if (system.merged(*link) || link->stays_in_plane(plane)) continue;
    std::vector<const Marker*> markers;
    for (const auto& [p, s] : link->pairs()) markers.insert(markers.end(), {p, s});
    return silence_of("joint", *link, markers, link->jointed(), plane);
  }
  for (const auto& force : system.forces())
    if (!force->stays_in_plane(plane)) return silence_of("force", *force, force->markers(), nullptr, plane);
  return {};
}

// A row must be in the plane or normal to it, and must not prescribe a motion out of it. Those of a mask keep their
// directions against the markers. `is_watched`: the row is evaluated during the run, with others of its joint.
Refusal check_row(const Lock& link, int row, const RowAtStart& r, bool is_watched, const System& system) {
  const bool of_mask = link.jointed() != nullptr && row < count_rows(link.jointed()->rows());
  std::string problem;
  if (r.in == 0 && r.along == 0 && r.about == 0)
    problem = "has no direction at the start; rotate the joint's markers, or";
  else if (r.lies_in() ? r.is_tilted() : !is_watched && !of_mask)
    problem = "acts in a direction neither in the plane nor normal to it; rotate the joint's axes into it, or";
  else if (!r.lies_in() && r.demand > kNegligible * std::max(1.0, system.length()))
    problem = "prescribes a motion out of the plane (a law, or markers that do not meet: " + text::brief(r.demand) +
              "); keep its law in the plane, or";
  if (problem.empty()) return {};
  return ModelError(fmt::format("joint '{}', constraint {}: the scene is planar with normal {}, but the constraint {} "
                                "set \"planar\" to \"off\"",
                                link.name(), link.row_name(row), axis_name(system.plane()), problem),
                    {.thing = {.kind = "joint", .name = link.name()}, .problem = problem});
}

// A slot on which something with a lever arm along the normal acts, and what that is.
struct Tipped {
  int slot;
  Thing thing;
};

// A lever arm along the normal gives moments about axes in the plane: joints that hold at all times must take both, or
// the body tips over. Three unknowns a slot: along the normal, about both axes.
Refusal check_tipping(const System& system, RowsAtStart& at_start, std::vector<Tipped> tipped) {
  std::vector<Eigen::Triplet<double>> numbers;
  int m = 0;
  for (const auto& link : system.links()) {
    if (system.merged(*link)) continue;
    const SlotList& slots = link->slots();
    bool has_arm = false;
    for (const RowAtStart& row : at_start.of(*link)) {
      has_arm = has_arm || (row.lies_in() && row.has_arm());
      if (row.lies_in() || !link->active_at_start() || link->unilateral()) continue;
      for (int k = 0; k < slots.n; ++k)
        for (int c = 0; c < 3; ++c) numbers.emplace_back(3 * slots[k] + c, m, row.normal[k][c]);
      ++m;
    }
    for (int k = 0; has_arm && k < slots.n; ++k) tipped.push_back({slots[k], {.kind = "joint", .name = link->name()}});
  }
  for (int k = 0; k < system.n_slots(); ++k)
    if (has_products(system.slot(k), system.plane()))
      tipped.push_back({k, {.kind = "body", .name = system.body_of_slot(k).name}});
  Eigen::SparseMatrix<double> Jt(3 * system.n_slots(), m);
  Jt.setFromTriplets(numbers.begin(), numbers.end());
  Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> qr;
  if (m > 0) qr.compute(Jt);
  for (const Tipped& t : tipped)
    for (int c = 1; c < 3 && system.slot(t.slot).freedoms != Freedoms::particle; ++c) {
      VecX moment = VecX::Zero(Jt.rows());
      moment[3 * t.slot + c] = 1;
      if (m > 0 && (Jt * VecX(qr.solve(moment)) - moment).norm() < kNegligible) continue;
      return leaves(system.plane(), t.thing,
                    "it has a lever arm along the normal, or a moment about another axis: the joints of body '" +
                        system.body_of_slot(t.slot).name + "' do not take it, so the body tips out of the plane",
                    ", or put all into one plane");
    }
  return {};
}

// The reactions that a force reads must be complete. `arms`: there may be lever arms along the normal.
Refusal check_reads(const Force& force, Plane plane, const System::Found& found, bool arms) {
  const Thing thing{.kind = "force", .name = force.name()};
  if (force.reacting() == nullptr) return {};
  for (const Lock* link : force.reacting()->reads()) {
    if (arms)
      return leaves(plane, thing,
                    "it reads reactions, which lack the moments of lever arms along the normal in a planar scene",
                    ", or put joints and forces into one plane");
    if (found.planar_rows[link->number()].held == 0)
      return leaves(plane, thing, "it reads joint '" + link->name() + "', which is out of the plane");
  }
  return {};
}

// Whether all joints that can move do so only out of the plane, such as hinges with their axes in it.
bool moves_only_out(const System& system) {
  bool some = false;
  for (const auto& link : system.links()) {
    if (system.merged(*link) || link->row_count() == 6) continue;
    if (std::popcount(unsigned{system.found().planar_rows[link->number()].held}) < 3) return false;
    some = true;
  }
  return some;
}

}  // namespace

std::optional<ModelError> setup_plane(const System& system, System::Found& found) {
  const Plane plane = system.plane();
  const double length = system.length();
  for (const Slot& s : found.slots) {
    for (const Body* b : s.bodies)
      if (Refusal refusal = check_body(*b, s, plane, length)) return refusal;
    found.has_offsets = found.has_offsets || has_products(s, plane);  // welded bodies at different heights
  }
  if (const double g = system.gravity()[plane.n]; std::abs(g) > kNegligible * system.gravity().norm())
    return leaves(plane, {}, "gravity has " + text::brief(g) + " m/s^2 along it");
  if (system.plane_is_known())
    if (Refusal refusal = check_declared(system)) return refusal;
  RowsAtStart at_start(system, plane, system.start());
  const Inputs& in = at_start.inputs();
  std::vector<Tipped> tipped;
  VecX f(6 * system.n_slots());
  for (const auto& force : system.forces()) {
    if (force->stays_in_plane(plane)) continue;
    const Thing thing{.kind = "force", .name = force->name()};
    for (const int slot : force->slots()) f.segment<6>(6 * slot).setZero();
    WrenchSum sum(in.motions, f);
    named(*force, in.t, [&] { force->apply(in, sum); });
    PartsInPlane parts;
    for (const int k : force->slots()) parts.add(f.segment<3>(6 * k), f.segment<3>(6 * k + 3) / length, plane);
    if (parts.leaves())
      return leaves(plane, thing, "it acts out of the plane (" + text::brief(parts.along) + " N)",
                    ", or rotate it into the plane");
    found.has_offsets = found.has_offsets || parts.has_arm();
    if (parts.has_arm() || dynamic_cast<const MarkerForce*>(force.get()) != nullptr)  // it may have one later
      for (const int slot : force->slots()) tipped.push_back({slot, thing});
  }
  found.planar_rows.assign(system.links().size(), {});
  for (std::size_t l = 0; l < system.links().size(); ++l) {
    if (found.merged[l]) continue;
    System::Found::PlanarRows& rows = found.planar_rows[l];
    const std::span<const RowAtStart> at = at_start.of(*system.links()[l]);
    const bool is_watched = !system.plane_is_known() && std::ranges::any_of(at, &RowAtStart::lies_in);
    int row = 0;
    for (const RowAtStart& r : at) {
      if (Refusal refusal = check_row(*system.links()[l], row, r, is_watched, system)) return refusal;
      if (r.lies_in()) rows.held |= 1U << row, found.has_offsets = found.has_offsets || r.has_arm();
      ++row;
    }
    Planar* own = system.links()[l]->planar();
    rows.by_link = own != nullptr && own->setup_plane(plane);
  }
  if (found.has_offsets && system.plane_is_known())
    return leaves(plane, {}, "there are lever arms along it, whose reactions would be left out");
  const bool arms = found.has_offsets || !tipped.empty();
  if (Refusal refusal = arms ? check_tipping(system, at_start, std::move(tipped)) : Refusal()) return refusal;
  for (const auto& force : system.forces())
    if (Refusal refusal = check_reads(*force, plane, found, arms)) return refusal;
  return {};
}

Plane settle_in_plane(System& system, const std::function<bool(Plane)>& starts_in) {
  for (int n = 2; n >= 0; --n) {
    system.set_planar(Plane{n}, true);
    bool fits = false;  // also where user code throws, which will report it in the run
    succeeds([&] { fits = !system.try_setup() && !moves_only_out(system) && (!starts_in || starts_in(Plane{n})); });
    if (fits) return Plane{n};
  }
  system.set_planar({});
  return {};
}

}  // namespace lockstep
