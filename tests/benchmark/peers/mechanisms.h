// SPDX-License-Identifier: BSD-3-Clause
// The mechanisms that lockstep and its peers are measured on: how many bodies, how heavy, where they start, their
// energy and the gaps of their joints. SI, world axes unless said; a body's place is that of its mass centre. This and
// measure.h stay within C++17: not every peer's headers can do more.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace lockstep::peers {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
inline constexpr double kHalfTurn = 3.14159265358979323846;

enum class Kind { chain, spatial_chain, four_bars, slider_crank, heavy_top, andrews, bricard, flyball };

struct Mechanism {
  std::string name;  ///< as in the tables: "chain-10"
  Kind kind;
  int n;         ///< rods of a chain, four-bars in a row; 1 for the others
  double until;  ///< length of the run, s
  Vec3 gravity;
};

/// Motion of a body: x, v of its mass centre, R body's axes -> world, w in world axes.
struct BodyMotion {
  Vec3 x = Vec3::Zero();
  Mat3 R = Mat3::Identity();
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();
};
using Motions = std::vector<BodyMotion>;
using Positions = std::vector<Vec3>;  ///< of the mass centres

struct Mass {
  double mass;
  Vec3 J;  ///< principal, body's axes, about the mass centre
};

inline constexpr double kGravity = 9.81;
inline constexpr double kCrank = 0.15, kRod = 0.35, kCrankSpeed = 2 * kHalfTurn;  ///< of the slider-crank, m and rad/s
inline const Vec3 kTopSpin{0, 150, -4.61538};  ///< of the heavy top, body's axes, rad/s

Mechanism pendulum();
Mechanism chain(int n);
Mechanism spatial_chain(int n);
Mechanism four_bars(int n);
Mechanism slider_crank();
Mechanism heavy_top();
/// All that are measured, in the order of the tables.
const std::vector<Mechanism>& all_mechanisms();
/// Whether its start, masses and joints are here; the others are in assemblies.h and have a scene of their own.
bool is_described(const Mechanism&);
/// Whether it has loops.
bool has_loops(const Mechanism&);

int n_bodies(const Mechanism&);
/// Whether joint k of a chain turns about y; else it does about z.
bool turns_about_y(const Mechanism&, int k);
Mass mass_of(const Mechanism&, int body);
/// From the mass centre to either end of a rod, along its x axis.
double half_length(const Mechanism&, int body);
/// The start. Only for described mechanisms, as are the next three.
Motions start_of(const Mechanism&);
double kinetic_energy(const Mechanism&, const Motions&);
double potential_energy(const Mechanism&, const Motions&);
/// The largest distance between the two points that a joint should hold together, m.
double largest_gap(const Mechanism&, const Motions&);

}  // namespace lockstep::peers
