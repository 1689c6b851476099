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
  void setup() override {
    M_ = m_.folded();
    if (n_.body) N_ = n_.folded();
  }
  std::optional<Turn> turn() const override {
    if (M_.rotation_law || N_.rotation_law) return {};
    return Turn{M_.slot, N_.slot, rotation(N_.at(0).q).col(k_)};
  }

 protected:
  double angle(const Inputs& in) const override {
    const Vec3 axis = N(in).A().transpose() * M(in).axis(i());
    return std::atan2(axis[j()], axis[i()]);
  }
  double rate_of_pose(const Inputs& in) const override {
    const auto m = M(in), n = N(in);
    const Mat3 to_n = n.A().transpose();
    const Vec3 axis = to_n * m.axis(i()), rate = cross(Vec3(to_n * Vec3(m.w() - n.w())), axis);  // (1.10)
    const double clear = axis[i()] * axis[i()] + axis[j()] * axis[j()];
    return clear > 1e-12 ? (axis[i()] * rate[j()] - axis[j()] * rate[i()]) / clear : 0.0;
  }

 private:
  int i() const { return (k_ + 1) % 3; }
  int j() const { return (k_ + 2) % 3; }
  MarkerOn<double> M(const Inputs& in) const { return {in.slot(M_.slot), M_.at(in.t)}; }
  MarkerOn<double> N(const Inputs& in) const { return {in.slot(N_.slot), N_.at(in.t)}; }
  static const std::string& name_of(const Frame& f) { return f.marker ? f.marker->name : f.body->name; }

  Frame m_, n_;  // n without a body: the world
  int k_;
  MarkerFrame M_, N_;
};

void add_directions(Entries& out, const Frame& m, const Frame& n, const std::string& help) {
  for (int k = 0; k < 3; ++k)
    add_angle(out, std::string("angle_") + kAxisName[k],
              fmt::format(fmt::runtime(help), kAxisName[k], kAxisName[(k + 1) % 3]),
              [m, n, k](System& system) -> const CountedAngle& {
                return system.count(std::make_unique<DirectionAngle>(m, n, k));
              });
}

void add_quaternion(Entries& out, const std::string& help, const std::function<Quat(const Sample&)>& q) {
  const char* const names[] = {"qw", "qx", "qy", "qz"};
  for (int k = 0; k < 4; ++k)
    add(out, names[k], "", help + ", scalar first", [q, k](const Sample& s) { return q(s).coefficients()[k]; });
}

void add_sequences(Entries& out, const std::function<Quat(const Sample&)>& q) {
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

void add_origin(Entries& out, const Frame& m, const Frame& n, const std::array<const char*, 3>& help) {
  add_vector(out, "", "m", help[0], [m, n](const Sample& s) { return relative(m, n, s).x; });
  add_vector(out, "v", "m/s", help[1], [m, n](const Sample& s) { return relative(m, n, s).v; });
  add_vector(out, "a", "m/s^2", help[2], [m, n](const Sample& s) { return relative_with_second(m, n, s).a; });
}

void of_frame(const Frame& f, Entries& out) {
  const auto y = [f](const Sample& s) { return relative(f, {}, s); };
  const auto y2 = [f](const Sample& s) { return relative_with_second(f, {}, s); };
  add_origin(out, f, {},
             {"position of the origin, world", "velocity of the origin, world", "acceleration of the origin, world"});
  const auto q = [y](const Sample& s) { return y(s).e; };
  add_quaternion(out, "quaternion to world axes", q);
  add_vector(out, "omega_world_", "rad/s", "angular velocity, world axes", [y](const Sample& s) { return y(s).w(); });
  add_vector(out, "omega_body_", "rad/s", "angular velocity, its axes", [y](const Sample& s) { return y(s).w_in_m(); });
  add_vector(out, "alpha_world_", "rad/s^2", "angular acceleration, world axes",
             [y2](const Sample& s) { return y2(s).alpha(); });
  add_vector(out, "alpha_body_", "rad/s^2", "angular acceleration, its axes",
             [y2](const Sample& s) { return y2(s).alpha_in_m(); });
  add_directions(out, f, {}, "angle about the world's {}, of the own {} axis, with its revolutions");
  add_sequences(out, q);
}

void of_body(const Body& body, Entries& out) {
  of_frame({&body, nullptr}, out);
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
  const auto y = [m, n](const Sample& s) { return relative(m, n, s); };
  add_origin(
      out, m, n,
      {"position of the origin seen from the other frame", "rate of the position", "second rate of the position"});
  const auto q = [y](const Sample& s) { return y(s).e; };
  add_quaternion(out, "quaternion to the axes of the other frame", q);
  add_vector(out, "omega_", "rad/s", "angular velocity relative to the other frame, its axes",
             [y](const Sample& s) { return y(s).w(); });
  add_directions(out, m, n, "angle about the {} axis of the other frame, with its revolutions");
  add_sequences(out, q);
  add(out, "distance", "m", "distance between the two origins", [y](const Sample& s) { return y(s).x.norm(); });
  add(out, "distance_d", "m/s", "rate of the distance; 0 if the origins meet", [y](const Sample& s) {
    const Relative r = y(s);
    const double d = r.x.norm();
    return d > 0 ? r.x.dot(r.v) / d : 0.0;
  });
}

}  // namespace lockstep::channels
