// SPDX-License-Identifier: BSD-3-Clause
// One computation of a scene, and how far two of them are from each other.
#pragma once

#include <string>
#include <vector>

#include <lockstep/math.h>

namespace lockstep::differential {

/// How a scene is computed.
struct Way {
  std::string integrator = "dop853", solver = "dense", formulation = "omega";
  double tolerance = 1e-11;
  double step = 0;         ///< s, of integrators with fixed steps
  double unit = 1;         ///< of length, in the scene's: absolute tolerances are lengths
  bool baumgarte = false;  ///< else projected
  bool and_back = false;   ///< at the end all velocities are reversed, and as much time is run again
  std::string words() const;
};

/// Poses and twists of the bodies b0, b1, ... at the output times.
struct Snapshot {
  double t = 0;
  std::vector<Pose> poses;
  std::vector<Twist> twists;
};

/// What came of a computation: a history, or the words of an error.
struct Trial {
  std::vector<Snapshot> history;
  std::string refusal;  ///< "" where it went through
  std::string kind;     ///< of the refusal; "foreign" for what is no Error
  bool ok() const { return refusal.empty(); }
};

Trial compute(const std::string& scene, const Way&);

/// The histories in the design's own world, from one that was computed in a frame and a unit of length.
std::vector<Snapshot> seen_back(std::vector<Snapshot>, const Pose& frame, double length);

/// Largest difference of two histories: distance, m, and angle, rad, and a tenth of those of the rates. Infinite where
/// they are not of the same instants and bodies, or not finite.
double difference(const std::vector<Snapshot>&, const std::vector<Snapshot>&);

}  // namespace lockstep::differential
