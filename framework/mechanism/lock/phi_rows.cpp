// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/detail/phi_rows.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <lockstep/error.h>
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/lock/pair_setup.h"
#include "framework/mechanism/lock/stiffness.h"

namespace lockstep {

PhiHooks::~PhiHooks() = default;

PhiRows::PhiRows(const PhiSpec& spec) : spec_(spec) {}
PhiRows::~PhiRows() = default;

void PhiRows::setup(const std::string& link) {
  moving_ = false;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const auto [p, s] = pairs_[k];
    if (spec_.reads_of(static_cast<int>(k), Reads::rotation)) refuse_particles(link, "phi", *p, *s);
    FramePair& frames = frames_[k];
    frames.P = MarkerFrame(*p), frames.S = MarkerFrame(*s);
    moving_ = moving_ || frames.P.translation_law || frames.P.rotation_law || frames.S.translation_law ||
              frames.S.rotation_law;
  }
  const Coords y = at_start();
  refuse_opposed(link, y);
  hooks_->initialise(link, given(y));
  refuse_unread(link, y);
}

void PhiRows::count_angles(AngleCounter& counter, bool coupled) {
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    if (spec_.counts(static_cast<int>(k))) angles_[k] = &counter.count(*pairs_[k].first, *pairs_[k].second, 2, coupled);
}

void PhiRows::add_slots(SlotList& slots) const {
  for (std::size_t k = 0; k < pairs_.size(); ++k) slots.add(frames_[k].P.slot), slots.add(frames_[k].S.slot);
}

LinkRow PhiRows::row(int k) const {
  if (spec_.names[k] != nullptr) return {spec_.kind, spec_.names[k]};
  return {spec_.kind, spec_.rows == 1 ? "phi" : "phi" + std::to_string(k + 1)};
}

std::array<RelativeKinematics, 3> PhiRows::look_at(const Inputs& in) const {
  std::array<RelativeKinematics, 3> y;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const FramePair& frames = frames_[k];
    y[k] = relative_kinematics(in.slot(frames.P.slot), in.slot(frames.S.slot), frames.P.at(in.t), frames.S.at(in.t),
                               moving_ ? 1u : 0u, spec_.reads.of[k]);
  }
  return y;
}

PhiRows::Coords PhiRows::along_motion(const Inputs& in, const double* memory) const {
  const auto points = look_at(in);
  Coords y;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const RelativeKinematics& L = points[k];
    const auto v = [&](int i) { return Time(L.y[i], L.yd[i], 0); };
    y[k] = {v(0), v(1), v(2), v(3), v(4), v(5), v(6), Time(in.t, 1, 0)};
    y[k].memory = memory;
    if (angles_[k] != nullptr) expect_angle(y[k], k, in);
  }
  return y;
}

PhiRows::Coords PhiRows::at_start() const {
  Coords y;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Pose rel = pose_at_start(*pairs_[k].first, *pairs_[k].second, frames_[k].P, frames_[k].S);
    y[k] = {rel.x[0], rel.x[1], rel.x[2], rel.q.w, rel.q.x, rel.q.y, rel.q.z, Time(0, 1, 0)};
  }
  return y;
}

void PhiRows::start_memory(std::span<double> z) const { hooks_->reset(z, given(at_start())); }

void PhiRows::accept_step(const Inputs& in, std::span<double> z) const {
  hooks_->accept_step(z, given(along_motion(in, z.data())));
}

// Derivatives of the sum of lambda phi, time fixed: the first and second ones along each variable, the mixed ones from
// the second along the sum of two variables. All are exact.
void PhiRows::tangent(const Inputs& in, const double* memory, const double* lambda, TangentSum& out) const {
  const auto points = look_at(in);
  const int n = spec_.variables(), n_pairs = spec_.pairs;
  Coords y;
  for (int k = 0; k < n_pairs; ++k) {
    y[k].t = Time(in.t, 0, 0), y[k].memory = memory;
    if (angles_[k] != nullptr) expect_angle(y[k], k, in);
  }
  std::array<Time, kMaxRows> rows;
  const auto along = [&](int a, int b) {
    for (int k = 0, v = 0; k < n_pairs; ++k) {
      LockCoords<Time>& c = y[k];
      const std::array<Time*, 7> all{&c.x, &c.y, &c.z, &c.e0, &c.e1, &c.e2, &c.e3};
      for (int i = spec_.first(k); i < spec_.end(k); ++i, ++v)
        *all[i] = Time(points[k].y[i], v == a || v == b ? 1.0 : 0.0, 0.0);
    }
    values(given(y), rows);
    double second = 0;
    for (int r = 0; r < spec_.rows; ++r) second += lambda[r] * rows[r].h;
    return second;
  };
  Eigen::Matrix<double, 21, 21> H = Eigen::Matrix<double, 21, 21>::Zero();  // on all seven coordinates of each pair
  std::array<Vec7T<double>, 3> phi_y{Vec7T<double>::Zero(), Vec7T<double>::Zero(), Vec7T<double>::Zero()};
  std::array<int, 21> place{};  // of each variable
  for (int k = 0, v = 0; k < n_pairs; ++k)
    for (int i = spec_.first(k); i < spec_.end(k); ++i) place[v++] = 7 * k + i;
  for (int a = 0; a < n; ++a) {
    const int i = place[a];
    H(i, i) = along(a, a);
    for (int r = 0; r < spec_.rows; ++r) phi_y[i / 7][i % 7] += lambda[r] * rows[r].d;
    for (int b = 0; b < a; ++b) {
      const int j = place[b];
      H(i, j) = H(j, i) = 0.5 * (along(a, b) - H(i, i) - H(j, j));
    }
  }
  std::array<Eigen::Matrix<double, 7, 6>, 6> J;
  std::array<int, 6> slots{};
  for (int k = 0; k < n_pairs; ++k) {
    const RelativeKinematics& L = points[k];
    J[2 * k] << L.Jv1, L.Jw1;
    J[2 * k + 1] << -L.Jv1, L.Jw2;
    const FramePair& frames = frames_[k];
    slots[2 * k] = frames.P.slot, slots[2 * k + 1] = frames.S.slot;
    const MarkerMotion P = frames.P.at(in.t), S = frames.S.at(in.t);
    if (spec_.reads_of(k, Reads::translation))
      add_translation_stiffness(in, frames.P.slot, frames.S.slot, P, S, phi_y[k].head<3>(), out);
    if (spec_.reads_of(k, Reads::rotation))
      add_rotation_stiffness(in, frames.P.slot, frames.S.slot, P, S, Quat{}, Quat::from(phi_y[k].tail<4>()), out);
  }
  for (int a = 0; a < 2 * n_pairs; ++a)
    for (int b = 0; b < 2 * n_pairs; ++b) {
      const Eigen::Matrix<double, 7, 7> full = H.block<7, 7>(7 * (a / 2), 7 * (b / 2));
      out.add_K(slots[a], slots[b], J[a].transpose() * full * J[b]);
    }
}

void PhiRows::refuse_opposed(const std::string& link, const Coords& y) const {
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    if (spec_.counts(static_cast<int>(k)) && !(y[k].e0.v * y[k].e0.v + y[k].e3.v * y[k].e3.v > 1e-12))
      throw ModelError("joint '" + link + "': the z axes of '" + pairs_[k].first->name + "' and '" +
                       pairs_[k].second->name +
                       "' are opposed at the start, so the angle about them is undefined; rotate one "
                       "marker by 180 deg about its x axis");
}

// What the spec leaves out is NaN, one after another: a function that is finite without it and not with it reads it.
void PhiRows::refuse_unread(const std::string& link, Coords y) const {
  std::vector<double> memory(static_cast<std::size_t>(spec_.memory) + 1);
  const auto finite = [&] {
    std::array<Time, kMaxRows> rows;
    return succeeds([&] { values(given(y), rows); }) &&
           std::all_of(rows.begin(), rows.begin() + spec_.rows, [](const Time& row) { return std::isfinite(row.v); });
  };
  const auto refuse = [&](bool reads, const std::string& what) {
    if (reads) throw ModelError("joint '" + link + "': its function " + what);
  };
  const bool starts = succeeds([&] { hooks_->reset({memory.data(), memory.size() - 1}, given(y)); });
  for (LockCoords<Time>& each : y) each.memory = memory.data();
  if (!starts || !finite()) return;  // not a matter of what is read
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (spec_.memory == 0) {
    memory[0] = none;
    refuse(!finite(), "reads y.memory, but its spec has none; set .memory there");
  }
  if (!spec_.counts_turns) {
    for (LockCoords<Time>& each : y) each.turns = none;
    refuse(!finite(),
           "calls angle_z(); set .counts_turns = true in its spec, or false if the angle stays within half "
           "a revolution of zero");
  }
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const int pair = static_cast<int>(k);
    if (!spec_.reads_of(pair, Reads::translation)) y[k].x = y[k].y = y[k].z = Time(none);
    if (!spec_.reads_of(pair, Reads::rotation)) y[k].e0 = y[k].e1 = y[k].e2 = y[k].e3 = Time(none);
    refuse(!finite(), "reads coordinates of pair " + std::to_string(k + 1) +
                          " that its spec leaves out; list in .reads what it reads of each pair");
  }
}

}  // namespace lockstep
