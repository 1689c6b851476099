// Planar mechanisms: which rows lie in the plane, and what leaves it. Found by evaluating links and forces in planar
// poses and motions around the start, so that no table of types is needed; what these do not show - laws, functions -
// links and forces answer for themselves.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <new>
#include <optional>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <Eigen/SparseQR>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include <lockstep/system.h>
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr double kTolerance = 1e-10;  // relative to the largest number of its kind
constexpr int kPoses = 4;

// A planar pose and motion near the start, different for every k; k = 0 is the start itself, moving.
State planar_state(const System& system, const State& start, int k) {
  const Plane plane = system.plane();
  State s = start;
  s.t = start.t + 0.37 * k;
  for (int i = 0; i < system.n_slots(); ++i) {
    const auto wave = [&](double phase) { return std::sin(1.0 + 2.3 * i + 1.7 * k + phase); };
    const double turn = k == 0 ? 0.0 : 0.4 * wave(0.0), move = k == 0 ? 0.0 : 0.2 * system.length();
    Pose pose = s.slot_pose(i);
    pose.x[plane.i()] += move * wave(1.0);
    pose.x[plane.j()] += move * wave(2.0);
    pose.q = pose.q * axis_angle(Vec3(Vec3::Unit(plane.n)), turn);
    s.set_slot_pose(i, pose);
    Twist twist;
    twist.v[plane.i()] = wave(3.0) * system.length();
    twist.v[plane.j()] = wave(4.0) * system.length();
    twist.w[plane.n] = wave(5.0);
    s.set_slot_twist(i, twist);
  }
  return s;
}

const char* axis_name(Plane plane) { return plane.n == 0 ? "x" : plane.n == 1 ? "y" : "z"; }

std::string in_plane_words(Plane plane) { return fmt::format("the scene is planar with normal {}", axis_name(plane)); }

/// Largest numbers of a row or force: in the plane, along its normal, moments about axes in the plane; of C, Ct, Qhat.
struct Shares {
  double in = 0, out = 0, arm = 0, free = 0;
  void add(int velocity, double x, Plane plane, double length) {
    const bool inside = velocity == plane.i() || velocity == plane.j() || velocity == 3 + plane.n;
    const double size = std::abs(x) / (velocity < 3 ? 1.0 : length);
    double& share = inside ? in : velocity < 3 ? out : arm;
    share = std::max(share, size);
  }
  bool lies_in() const { return in > kTolerance * std::max(out, arm); }
  bool leaves() const { return out > kTolerance * in; }
  bool has_arm() const { return arm > kTolerance * in; }
};

using Refusal = std::optional<ModelError>;  // empty: all lies in the plane

Refusal refusal_of(Thing thing, const std::string& problem) {
  return ModelError({.thing = std::move(thing), .problem = problem});
}

// `length`: of the mechanism; a velocity of less than a rounding of it a second is none.
Refusal check_body(const Body& b, const Slot& s, Plane plane, double length) {
  const Thing body{.kind = "body", .name = b.name};
  const std::string what = in_plane_words(plane) + ", and ";
  const Mat3 A = rotation(b.home.q);
  const Vec3 v = b.start.v + A * cross(b.start.w, b.mass.center), w = A * b.start.w;
  if (std::abs(v[plane.n]) > kTolerance * v.norm() + kRoundOff * length)
    return refusal_of(body, what + "it starts with " + text::brief(v[plane.n]) +
                                " m/s along the normal; set \"planar\" to \"off\", or start in the plane");
  if (std::max(std::abs(w[plane.i()]), std::abs(w[plane.j()])) > kTolerance * w.norm() + kRoundOff)
    return refusal_of(
        body,
        what + "it starts turning about an axis in the plane; set \"planar\" to \"off\", or turn about the normal");
  if (s.freedoms == Freedoms::particle || s.bodies.size() > 1) return {};
  const double J = s.J.trace();
  if (std::abs(s.J(plane.n, plane.i())) > kTolerance * J || std::abs(s.J(plane.n, plane.j())) > kTolerance * J)
    return refusal_of(
        body,
        what + "the normal is not a principal axis of its inertia (products " + text::brief(s.J(plane.n, plane.i())) +
            " and " + text::brief(s.J(plane.n, plane.j())) +
            " kg m^2), so it would not stay in the plane without moments from its links; set \"planar\" to \"off\"");
  return {};
}

// What a row has at the start on one slot of the motions out of the plane: along the normal, about i, about j.
struct OutOfPlane {
  int slot;
  std::array<double, 3> J;
};

// Whether the mass centres of a slot's bodies lie beside the plane of their common one.
bool has_products(const Slot& s, Plane plane) {
  return std::abs(s.J(plane.n, plane.i())) + std::abs(s.J(plane.n, plane.j())) > kTolerance * s.J.trace();
}

// The shares found in the sampled poses, by link and row and by force.
struct Look {
  std::vector<std::vector<Shares>> rows;
  std::vector<std::vector<std::vector<OutOfPlane>>> out;  // by link and row
  std::vector<Shares> forces;
};

void look_at_link(const System& system, const Lock& link, const Inputs& in, std::vector<Shares>& rows,
                  std::vector<std::vector<OutOfPlane>>* out) {
  const Plane plane = system.plane();
  RowTable table;
  const Lock* const one = &link;
  const RowShape shape = link.shape();
  link.gather(Group(&one, 1), in, table.spatial_span(shape));
  const RowBlock block = table.spatial(shape);
  rows.resize(static_cast<std::size_t>(shape.m));
  if (out) out->resize(rows.size());
  for (int row = 0; row < shape.m; ++row) {
    Shares& s = rows[static_cast<std::size_t>(row)];
    s.free = std::max({s.free, std::abs(block.C(row)), std::abs(block.Ct(row)), std::abs(block.Qhat(row))});
    for (int i = 0; i < shape.n; ++i) {
      const auto J = block.J(i, row);
      for (std::size_t c = 0; c < 6; ++c) s.add(static_cast<int>(c), J[c], plane, system.length());
      if (!out) continue;
      const auto at = [&](int c) { return J[static_cast<std::size_t>(c)]; };
      (*out)[static_cast<std::size_t>(row)].push_back(
          {link.slots().slot[i], {at(plane.n), at(3 + plane.i()), at(3 + plane.j())}});
    }
  }
}

// `later`: at different times, which laws may not cover.
Look look_in_plane(const System& system, bool later) {
  Look look;
  look.rows.resize(system.links().size());
  look.out.resize(look.rows.size());
  look.forces.resize(system.forces().size());
  const State start = system.start();
  std::vector<Motion> motions;
  VecX f = VecX::Zero(6 * system.n_slots());
  for (int k = 0; k < kPoses; ++k) {
    State state = planar_state(system, start, k);
    if (!later) state.t = start.t;
    system.motions(state, motions);
    Inputs in;
    in.t = state.t, in.motions = motions;
    in.s = {state.s.data(), static_cast<std::size_t>(state.s.size())};
    in.z = {state.z.data(), static_cast<std::size_t>(state.z.size())};
    for (std::size_t l = 0; l < look.rows.size(); ++l)
      if (!system.merged(*system.links()[l]))
        named(*system.links()[l], in.t, [&] {
          look_at_link(system, *system.links()[l], in, look.rows[l], k == 0 ? &look.out[l] : nullptr);
        });
    for (std::size_t l = 0; l < look.forces.size(); ++l) {
      const Force& force = *system.forces()[l];
      for (const int slot : force.slots()) f.segment<6>(6 * slot).setZero();
      WrenchSum sum(in.motions, f);
      named(force, in.t, [&] { force.apply(in, sum); });
      for (const int slot : force.slots())
        for (int i = 0; i < 6; ++i) look.forces[l].add(i, f[6 * slot + i], system.plane(), system.length());
    }
  }
  return look;
}

Refusal check_force(const Force& force, const Shares& s, Plane plane) {
  if (!s.leaves()) return {};
  return refusal_of({.kind = "force", .name = force.name()},
                    in_plane_words(plane) + ", and it pushes out of the plane (" + text::brief(s.out) +
                        " N); turn it into the plane, or set \"planar\" to \"off\"");
}

// A row must lie in the plane or be normal to it, and must not ask for a motion out of it.
Refusal check_row(const Lock& link, int row, const Shares& s, Plane plane, double length) {
  const auto refuse = [&](const std::string& problem) {
    return ModelError("link '" + link.name() + "', row " + link.row_name(row) + ": " + in_plane_words(plane) +
                          ", and the row " + problem,
                      {.thing = {.kind = "link", .name = link.name()}, .problem = problem});
  };
  if (s.lies_in() && s.leaves())
    return refuse(
        "holds a direction that is neither in the plane nor normal to it; turn the link's axes into the plane, or set "
        "\"planar\" to \"off\"");
  if (s.in == 0 && s.out == 0 && s.arm == 0)
    return refuse("has no direction in any planar pose; turn the link's markers, or set \"planar\" to \"off\"");
  if (!s.lies_in() && s.free > kTolerance * std::max(1.0, length))
    return refuse("asks for a motion out of the plane (a law, or markers that do not meet: " + text::brief(s.free) +
                  "); set \"planar\" to \"off\", or keep its law in the plane");
  return {};
}

// A slot on which something with a lever arm along the normal acts, and what that is.
struct Tipped {
  int slot;
  Thing thing;
};

std::vector<Tipped> tipped_slots(const System& system, const Look& look) {
  std::vector<Tipped> out;
  for (std::size_t f = 0; f < look.forces.size(); ++f)
    if (look.forces[f].has_arm())
      for (const int slot : system.forces()[f]->slots())
        out.push_back({slot, {.kind = "force", .name = system.forces()[f]->name()}});
  for (std::size_t l = 0; l < look.rows.size(); ++l) {
    const Lock& link = *system.links()[l];
    if (std::ranges::none_of(look.rows[l], [](const Shares& row) { return row.lies_in() && row.has_arm(); })) continue;
    for (int k = 0; k < link.slots().n; ++k)
      out.push_back({link.slots().slot[static_cast<std::size_t>(k)], {.kind = "link", .name = link.name()}});
  }
  for (int k = 0; k < system.n_slots(); ++k)
    if (has_products(system.slot(k), system.plane()))
      out.push_back({k, {.kind = "body", .name = system.body_of_slot(k).name}});
  std::erase_if(out, [&](const Tipped& t) { return system.slot(t.slot).freedoms == Freedoms::particle; });
  return out;
}

// The rows out of the plane of links that hold at all times, transposed: three unknowns a slot.
Eigen::SparseMatrix<double> rows_out_of_plane(const System& system, const Look& look) {
  std::vector<Eigen::Triplet<double>> numbers;
  int m = 0;
  for (std::size_t l = 0; l < look.rows.size(); ++l) {
    const Lock& link = *system.links()[l];
    if (!link.active_at_start() || link.unilateral()) continue;
    for (std::size_t row = 0; row < look.out[l].size(); ++row) {
      if (look.rows[l][row].lies_in()) continue;
      for (const OutOfPlane& of : look.out[l][row])
        for (int c = 0; c < 3; ++c)
          numbers.emplace_back(3 * of.slot + c, m, of.J[static_cast<std::size_t>(c)] / (c == 0 ? 1 : system.length()));
      ++m;
    }
  }
  Eigen::SparseMatrix<double> Jt(3 * system.n_slots(), m);
  Jt.setFromTriplets(numbers.begin(), numbers.end());
  Jt.makeCompressed();
  return Jt;
}

// A lever arm along the normal gives moments about axes in the plane: links must take both, or the body tips over.
Refusal check_tipping(const System& system, const Look& look) {
  const Eigen::SparseMatrix<double> Jt = rows_out_of_plane(system, look);
  Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> qr;
  if (Jt.cols() > 0) qr.compute(Jt);
  for (const Tipped& tipped : tipped_slots(system, look))
    for (int c = 1; c < 3; ++c) {
      VecX moment = VecX::Zero(Jt.rows());
      moment[3 * tipped.slot + c] = 1;
      if (Jt.cols() > 0) {
        const VecX taken = qr.solve(moment);
        if ((Jt * taken - moment).norm() < 1e-9) continue;
      }
      return refusal_of(tipped.thing,
                        in_plane_words(system.plane()) +
                            ", and it has a lever arm along the normal, which tips body '" +
                            system.body_of_slot(tipped.slot).name +
                            "' over, as its links do not take the moment; set \"planar\" to \"off\", or put all into "
                            "one plane");
    }
  return {};
}

// The reactions that a force reads must be complete.
Refusal check_reads(const Force& force, const System& system, const std::vector<PlanarRows>& rows, bool offsets) {
  if (force.reacting() == nullptr) return {};
  for (const Lock* link : force.reacting()->reads()) {
    const Thing thing{.kind = "force", .name = force.name()};
    const std::string what = in_plane_words(system.plane()) + ", and it reads ";
    if (offsets)
      return refusal_of(thing, what +
                                   "reactions, which lack the moments of lever arms along the normal in a planar "
                                   "scene; set \"planar\" to \"off\", or put links and forces into one plane");
    if (rows[static_cast<std::size_t>(link->number())].m == 0)
      return refusal_of(thing,
                        what + "link '" + link->name() + "', which lies out of the plane; set \"planar\" to \"off\"");
  }
  return {};
}

// What does not say of itself that it stays in the plane.
Refusal check_declared(const System& system) {
  const auto refuse = [&](const char* kind, const std::string& name, std::string_view type) {
    return refusal_of({.kind = kind, .name = name},
                      fmt::format("'{}' does not say that it stays in the plane with normal {}; let its "
                                  "stays_in_plane(), or kStaysInPlane of a function, say so",
                                  type, axis_name(system.plane())));
  };
  for (const auto& link : system.links())
    if (!system.merged(*link) && !link->stays_in_plane(system.plane()))
      return refuse("link", link->name(), link->type());
  for (const auto& force : system.forces())
    if (!force->stays_in_plane(system.plane())) return refuse("force", force->name(), force->type());
  return {};
}

}  // namespace

std::optional<ModelError> System::setup_plane() {
  offsets_ = false;
  for (const Slot& s : slots_) {
    for (const Body* b : s.bodies)
      if (Refusal refusal = check_body(*b, s, plane_, length_)) return refusal;
    offsets_ = offsets_ || has_products(s, plane_);  // welded bodies at different heights
  }
  if (const double g = options_.gravity[plane_.n]; std::abs(g) > kTolerance * options_.gravity.norm())
    return ModelError(in_plane_words(plane_) + ", and gravity has " + text::brief(g) +
                      " m/s^2 along it; set \"planar\" to \"off\"");
  if (plane_is_known_)
    if (Refusal refusal = check_declared(*this)) return refusal;
  Look look;
  try {
    struct Borrowed {  // all but the plane is set up, so start() may be called
      bool& ready;
      ~Borrowed() { ready = false; }
    } borrowed{ready_ = true};
    try {
      look = look_in_plane(*this, true);
    } catch (const Error&) {  // laws of plugins and of the host end, too
      look = look_in_plane(*this, false);
    }
  } catch (const ModelError& error) {  // a link or force that cannot be evaluated in planar poses
    return error;
  } catch (const Error& error) {  // the same of a plugin or the host: where nobody asked for a plane, there is none
    if (!plane_is_known_) throw;
    return ModelError(error.what());
  }
  for (std::size_t l = 0; l < forces_.size(); ++l) {
    if (Refusal refusal = check_force(*forces_[l], look.forces[l], plane_)) return refusal;
    offsets_ = offsets_ || look.forces[l].has_arm();
  }
  planar_rows_.assign(links_.size(), {});
  for (std::size_t l = 0; l < links_.size(); ++l) {
    if (merged_[l]) continue;
    PlanarRows& rows = planar_rows_[l];
    for (int row = 0; row < links_[l]->row_count(); ++row) {
      const Shares& s = look.rows[l][static_cast<std::size_t>(row)];
      if (Refusal refusal = check_row(*links_[l], row, s, plane_, length_)) return refusal;
      if (!s.lies_in()) continue;
      rows.own[static_cast<std::size_t>(rows.m++)] = row;
      offsets_ = offsets_ || s.has_arm();
    }
    Planar* own = links_[l]->planar();
    rows.by_link = own != nullptr && own->setup_plane(plane_);
  }
  if (offsets_ && plane_is_known_)
    return ModelError(in_plane_words(plane_) +
                      ", and there are lever arms along it, whose reactions would be left out");
  if (offsets_)
    if (Refusal refusal = check_tipping(*this, look)) return refusal;
  for (const auto& force : forces_)
    if (Refusal refusal = check_reads(*force, *this, planar_rows_, offsets_)) return refusal;
  return {};
}

Plane find_plane(System& system, const std::function<bool(Plane)>& starts_in) {
  struct Restore {
    System& system;
    Plane plane = system.plane();
    bool known = system.plane_is_known();
    ~Restore() { system.set_planar(plane, known); }
  } const restore{system};
  for (int n = 2; n >= 0; --n) {
    system.set_planar(Plane{n}, true);
    try {
      if (!system.try_setup() && (!starts_in || starts_in(Plane{n}))) return Plane{n};
    } catch (const std::bad_alloc&) {
      throw;
    } catch (...) {  // code of a user that throws where it is only looked at will say so in the run
    }
  }
  return {};
}

}  // namespace lockstep
