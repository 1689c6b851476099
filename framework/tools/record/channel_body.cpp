// SPDX-License-Identifier: BSD-3-Clause
// Channels of bodies and markers: motion in the world, and seen from another frame.
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <memory>

#include <lockstep/author/params.h>
#include <lockstep/author/relative.h>
#include "framework/tools/record/channel_entry.h"

namespace lockstep::channels {
namespace {

/// Angle of a frame's own next axis about axis k of another frame, or of the world, for planar motion: angle_z is that of its
/// x axis. It is undefined if that axis is along k.
class DirectionAngle final : public CountedAngle {
 public:
  DirectionAngle(const Frame& m, const Frame& n, int k)
      : CountedAngle(fmt::format("angle_{} of '{}'{}", kAxisName[k], name_of(m),
                                 n.body ? fmt::format(" seen from '{}'", name_of(n)) : "")),
        m_(m),
        n_(n),
        k_(k) {}
  void setup() override { M_ = m_.folded(), N_ = n_.folded(); }
  std::optional<Turn> turn() const override {
    if (M_.rotation_law || N_.rotation_law) return {};
    return Turn{M_.slot, N_.slot, rotation(N_.at(0).q).col(k_)};
  }

 protected:
  double angle(const Inputs& in) const override {
    const Vec3 axis = marker_on(N_, in).A().transpose() * marker_on(M_, in).axis(i());
    return std::atan2(axis[j()], axis[i()]);
  }
  double rate_of_pose(const Inputs& in) const override {
    const MarkerOn<double> m = marker_on(M_, in), n = marker_on(N_, in);
    const Mat3 to_n = n.A().transpose();
    const Vec3 axis = to_n * m.axis(i()), rate = cross(Vec3(to_n * Vec3(m.w() - n.w())), axis);  // (1.10)
    const double clear = axis[i()] * axis[i()] + axis[j()] * axis[j()];
    return clear > 1e-12 ? (axis[i()] * rate[j()] - axis[j()] * rate[i()]) / clear : 0.0;
  }

 private:
  int i() const { return (k_ + 1) % 3; }
  int j() const { return (k_ + 2) % 3; }
  static const std::string& name_of(const Frame& f) { return f.marker ? f.marker->name : f.body->name; }

  Frame m_, n_;  // n without a body: the world
  int k_;
  MarkerFrame M_, N_;
};

/// The rotation of m relative to n as a quaternion, as three sequences of angles, and by an angle about each axis.
void add_rotation(Entries& out, const Frame& m, const Frame& n, const std::string& quaternion_help,
                  const std::string& angle_help) {
  const auto q = [m, n](const Sample& s) { return conjugate(n.at(s).q()) * m.at(s).q(); };
  const char* const names[] = {"qw", "qx", "qy", "qz"};
  for (int k = 0; k < 4; ++k)
    add(out, names[k], "", quaternion_help + ", scalar first",
        [q, k](const Sample& s) { return q(s).coefficients()[k]; });
  for (int k = 0; k < 3; ++k)
    add_angle(out, std::string("angle_") + kAxisName[k],
              fmt::format(fmt::runtime(angle_help), kAxisName[k], kAxisName[(k + 1) % 3]),
              [m, n, k](System& system) -> const CountedAngle& {
                return system.count(std::make_unique<DirectionAngle>(m, n, k));
              });
  for (const std::string name : {"cardan", "euler", "hpb"}) {
    const std::string sequence = angle_sequence(name);
    for (int k = 0; k < 3; ++k)
      add(out, fmt::format("{}_{}", name, k + 1), "rad",
          fmt::format("rotation {} of three about its axes {}", k + 1, sequence),
          [q, sequence, k](const Sample& s) { return to_angles(sequence, q(s)).value[k]; });
    add(out, name + "_gimbal", "", "1 in gimbal lock of that sequence (the third rotation is set to 0), else 0",
        [q, sequence](const Sample& s) { return to_angles(sequence, q(s)).gimbal ? 1.0 : 0.0; });
  }
}

}  // namespace

void of_frame(const Frame& f, Entries& out) {
  for (const NamedCoordinate& c : coordinates_of(CoordinateOwner::frame)) add_coordinate(out, c, f, {});
  add_rotation(out, f, {}, "quaternion to world axes",
               "angle about the world's {}, of the own {} axis, with its revolutions");
}

void of_body(const Body& body, Entries& out) {
  of_frame({{&body, nullptr}}, out);
  if (body.fixed) return;
  const Body* const b = &body;  // the centre of mass is the slot's origin
  add_vector(out, "center_", "m", "position of the centre of mass, world",
             [b](const Sample& s) { return Vec3(s.inputs().slot(b->slot).x); });
  add_vector(out, "center_v", "m/s", "velocity of the centre of mass, world",
             [b](const Sample& s) { return Vec3(s.inputs().slot(b->slot).v); });
  add_vector(out, "center_a", "m/s^2", "acceleration of the centre of mass, world",
             [b](const Sample& s) { return Vec3(s.accelerations().segment<3>(6 * b->slot)); });
}

void of_pair(const Frame& m, const Frame& n, Entries& out) {
  for (const NamedCoordinate& c : coordinates_of(CoordinateOwner::pair)) add_coordinate(out, c, m, n);
  add_rotation(out, m, n, "quaternion to the axes of the other frame",
               "angle about the {} axis of the other frame, with its revolutions");
}

}  // namespace lockstep::channels
