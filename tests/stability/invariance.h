// SPDX-License-Identifier: BSD-3-Clause
// A mechanism seen from another frame, in another order and unit, and computed in another way: its motion is the same.
#pragma once

#include <string>
#include <vector>

#include <lockstep/math.h>

namespace lockstep::invariance {

/// How a mechanism is written.
struct View {
  Pose frame{};            ///< of the scene's world in that of the run
  double length = 1;       ///< units of length of the run per metre
  unsigned order = 0;      ///< 0: as written; else a seed of the order of bodies and joints
  bool exchanged = false;  ///< whether p and s of hinges and guides are exchanged
  bool company = false;    ///< a pendulum hangs at rest beside it, 400 times as long
};

/// How it is computed.
struct Way {
  std::string formulation = "auto", solver = "schur", integrator = "dop853", stages = "auto";
  double tolerance = 1e-10;
  bool in_space = true;  ///< also where it moves in a plane
  std::string words() const;
};

/// Poses and twists of all bodies at one time, in the scene's own world and unit.
struct Instant {
  double t = 0;
  std::vector<Pose> poses;
  std::vector<Twist> twists;
};

/// A history, or the words of an error; what makes it doubtful.
struct Trace {
  std::vector<Instant> history;
  std::string refusal, doubts;
  long steps = 0;
  bool ok() const { return refusal.empty(); }
};

/// A scene file, and how long it runs here, s.
struct Case {
  std::string name, path;
  double until;
  bool has_forces = false;         ///< forces of its own, whose numbers have units of length
  std::vector<std::string> set{};  ///< "NAME=VALUE" of its parameters
};

/// `faster`: all velocities of the start grow by this share.
Trace follow(const Case&, const View&, const Way&, double faster = 0);

/// The largest speed, m/s, or angular velocity, rad/s.
double fastest(const std::vector<Instant>&);

/// Largest difference of two histories: distance, m, angle, rad, and a tenth of those of the rates, or their ratio to the
/// fastest rate of the first where that is above 10; infinite where they are not of the same times and bodies, or not
/// finite.
double difference(const std::vector<Instant>&, const std::vector<Instant>&);

}  // namespace lockstep::invariance
