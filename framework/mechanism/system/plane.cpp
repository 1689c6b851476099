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

Refusal check_body(const Body& b, const Slot& s, Plane plane) {
  const Thing body{.kind = "body", .name = b.name};
  const std::string what = in_plane_words(plane) + ", and ";
  const Mat3 A = rotation(b.home.q);
  const Vec3 v = b.start.v + A * cross(b.start.w, b.mass.center), w = A * b.start.w;
  if (v[plane.n] != 0 && std::abs(v[plane.n]) > kTolerance * v.norm())
    return refusal_of(body, what + "it starts with " + text::brief(v[plane.n]) +
                                " m/s along the normal; remove \"planar\", or start in the plane");
  if (std::abs(w[plane.i()]) > kTolerance * w.norm() || std::abs(w[plane.j()]) > kTolerance * w.norm())
    return refusal_of(
        body, what + "it starts turning about an axis in the plane; remove \"planar\", or turn about the normal");
  if (s.freedoms == Freedoms::particle || s.bodies.size() > 1) return {};
  const double J = s.J.trace();
  if (std::abs(s.J(plane.n, plane.i())) > kTolerance * J || std::abs(s.J(plane.n, plane.j())) > kTolerance * J)
    return refusal_of(
        body, what + "the normal is not a principal axis of its inertia (products " +
                  text::brief(s.J(plane.n, plane.i())) + " and " + text::brief(s.J(plane.n, plane.j())) +
                  " kg m^2), so it would not stay in the plane without moments from its links; remove \"planar\"");
  return {};
}

// What a row has at the start on one slot of the motions out of the plane: along the normal, about i, about j.
struct OutOfPlane {
  int slot;
  std::array<double, 3> J;
};

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
      for (std::size_t c = 0; c < 6; ++c) s.add(static_cast<int>(c), J[c], plane, 1.0 / system.length());
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
  VecX f(6 * system.n_slots());
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
        look_at_link(system, *system.links()[l], in, look.rows[l], k == 0 ? &look.out[l] : nullptr);
    for (std::size_t l = 0; l < look.forces.size(); ++l) {
      f.setZero();
      WrenchSum sum(in.motions, f);
      system.forces()[l]->apply(in, sum);
      for (int i = 0; i < f.size(); ++i) look.forces[l].add(i % 6, f[i], system.plane(), system.length());
    }
  }
  return look;
}

Refusal check_force(const Force& force, const Shares& s, Plane plane) {
  if (!s.leaves()) return {};
  return refusal_of({.kind = "force", .name = force.name()},
                    in_plane_words(plane) + ", and it pushes out of the plane (" + text::brief(s.out) +
                        " N); turn it into the plane, or remove \"planar\"");
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
        "holds a direction that is neither in the plane nor normal to it; turn the link's axes into the plane, or take "
        "\"planar\" out");
  if (s.in == 0 && s.out == 0 && s.arm == 0)
    return refuse("has no direction in any planar pose; turn the link's markers, or remove \"planar\"");
  if (!s.lies_in() && s.free > kTolerance * std::max(1.0, length))
    return refuse("asks for a motion out of the plane (a law, or markers that do not meet: " + text::brief(s.free) +
                  "); remove \"planar\", or keep its law in the plane");
  return {};
}

// Lever arms along the normal tip a body over unless links hold it in the plane: then their rows that lie out of it have
// full rank. Names what has the arm.
Refusal check_tipping(const System& system, const Look& look) {
  std::vector<Eigen::Triplet<double>> numbers;
  int m = 0, n = 0;
  for (std::size_t l = 0; l < look.rows.size(); ++l)
    for (std::size_t row = 0; row < look.out[l].size(); ++row) {
      if (look.rows[l][row].lies_in()) continue;
      for (const OutOfPlane& of : look.out[l][row])
        for (int c = 0; c < 3; ++c)
          numbers.emplace_back(m, 3 * of.slot + c, of.J[static_cast<std::size_t>(c)] / (c == 0 ? 1 : system.length()));
      ++m;
    }
  for (int k = 0; k < system.n_slots(); ++k)  // a particle does not turn
    if (system.slot(k).freedoms == Freedoms::particle)
      for (int c = 1; c < 3; ++c) numbers.emplace_back(m++, 3 * k + c, 1.0);
  n = 3 * system.n_slots();
  if (m >= n) {
    Eigen::SparseMatrix<double> J(m, n);
    J.setFromTriplets(numbers.begin(), numbers.end());
    J.makeCompressed();
    if (Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>>(J).rank() == n) return {};
  }
  const std::string problem = in_plane_words(system.plane()) +
                              ", and it has a lever arm along the normal, which tips bodies that the links do not hold "
                              "in the plane; remove \"planar\", or put all into one plane";
  for (std::size_t f = 0; f < look.forces.size(); ++f)
    if (look.forces[f].has_arm()) return refusal_of({.kind = "force", .name = system.forces()[f]->name()}, problem);
  for (std::size_t l = 0; l < look.rows.size(); ++l)
    for (const Shares& row : look.rows[l])
      if (row.lies_in() && row.has_arm())
        return refusal_of({.kind = "link", .name = system.links()[l]->name()}, problem);
  return ModelError(in_plane_words(system.plane()) +
                    ", and welded bodies have their mass centres beside it, which tips them as no link holds them in "
                    "the plane; remove \"planar\"");
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
                                   "scene; remove \"planar\", or put links and forces into one plane");
    if (rows[static_cast<std::size_t>(link->number())].m == 0)
      return refusal_of(thing, what + "link '" + link->name() + "', which lies out of the plane; remove \"planar\"");
  }
  return {};
}

// Whether everything says of itself that it stays in the plane.
bool declared(const System& system) {
  return std::ranges::all_of(
             system.links(),
             [&](const auto& link) { return system.merged(*link) || link->stays_in_plane(system.plane()); }) &&
         std::ranges::all_of(system.forces(), [&](const auto& force) { return force->stays_in_plane(system.plane()); });
}

}  // namespace

std::optional<ModelError> System::setup_plane() {
  offsets_ = false;
  for (const Slot& s : slots_) {
    for (const Body* b : s.bodies)
      if (Refusal refusal = check_body(*b, s, plane_)) return refusal;
    const double products = std::abs(s.J(plane_.n, plane_.i())) + std::abs(s.J(plane_.n, plane_.j()));
    if (products > kTolerance * s.J.trace()) offsets_ = true;  // welded bodies at different heights
  }
  if (const double g = options_.gravity[plane_.n]; std::abs(g) > kTolerance * options_.gravity.norm())
    return ModelError(in_plane_words(plane_) + ", and gravity has " + text::brief(g) +
                      " m/s^2 along it; remove \"planar\"");
  Look look;
  try {
    struct Borrowed {  // all but the plane is set up, so start() may be called
      bool& ready;
      ~Borrowed() { ready = false; }
    } borrowed{ready_ = true};
    try {
      look = look_in_plane(*this, true);
    } catch (const ModelError&) {
      look = look_in_plane(*this, false);
    }
  } catch (const ModelError& error) {  // a link or force that cannot be evaluated in planar poses
    return error;
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
  if (offsets_)
    if (Refusal refusal = check_tipping(*this, look)) return refusal;
  for (const auto& force : forces_)
    if (Refusal refusal = check_reads(*force, *this, planar_rows_, offsets_)) return refusal;
  return {};
}

namespace {

// Code of a user that throws where it is only looked at will say so in the run.
bool stays_in(System& system, const std::function<bool(Plane)>& starts_in) {
  try {
    if (system.try_setup() || system.has_offsets() || !declared(system)) return false;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
    return false;
  }
  return !starts_in || starts_in(system.plane());
}

}  // namespace

Plane find_plane(System& system, const std::function<bool(Plane)>& starts_in) {
  const Plane before = system.plane();
  Plane found;
  for (int n = 2; n >= 0 && !found; --n) {
    system.set_planar(Plane{n});
    if (stays_in(system, starts_in)) found = Plane{n};
  }
  system.set_planar(before);
  return found;
}

}  // namespace lockstep
