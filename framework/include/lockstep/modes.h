// SPDX-License-Identifier: BSD-3-Clause
// Modes: frequencies, damping ratios and shapes of a mechanism about an equilibrium, a steady rotation or a state.
//
//   ( l^2 N^T M N + l N^T D N + N^T K N ) y = 0,   N a basis of the null space of J        theory, (9.21)
#pragma once

#include <complex>
#include <string>
#include <vector>

#include <lockstep/linearization.h>

namespace lockstep {

/// How a body moves in a mode: amplitudes of its mass centre; the motion is the real part of shape exp(l t).
struct BodyShape {
  std::string body;                                  ///< its name; of bodies that move as one, all of them: "arm + bob"
  Eigen::Vector3cd move = Eigen::Vector3cd::Zero(),  ///< translation, world, m
      turn = Eigen::Vector3cd::Zero();               ///< rotation, world axes, rad
};

/// One mode: a real eigenvalue, a pair, or a direction in which nothing pulls back.
struct Mode {
  /// What it does.
  enum class Kind {
    rigid,        ///< eigenvalue zero within round-off: the mechanism stays where it is put, or drifts
    oscillation,  ///< a pair: swings, growing or decaying
    decay,        ///< a negative real eigenvalue
    growth        ///< a positive real eigenvalue
  };
  Kind kind = Kind::rigid;         ///< what it does
  std::complex<double> value{};    ///< eigenvalue l, 1/s; of a pair that with the positive imaginary part
  double bound = 0;                ///< what round-off and unrest may have changed of l, 1/s
  std::vector<BodyShape> shape{};  ///< of all that moves; the largest rotation or translation over the length is 1

  double omega() const { return value.imag(); }               ///< circular frequency, rad/s, of the damped motion
  double frequency() const { return value.imag() / kTwoPi; }  ///< the same, Hz
  /// -Re l/|l|: 0 undamped, 1 and more no oscillation, negative growing.
  double damping() const { return value == 0.0 ? 0.0 : -value.real() / std::abs(value); }
  /// Whether growth and decay cannot be told apart from round-off.
  bool is_marginal() const { return std::abs(value.real()) <= bound; }
};

/// Which modes.
struct ModesOptions {
  LinearMotionOptions motion{};  ///< axes, and states that are no equilibrium
  /// The lowest so many, by |l|. 0: all of up to dense_limit unknown velocities, 20 of more.
  int count = 0;
  /// Up to so many unknown velocities all modes are found by dense matrices; beyond, the lowest by shift and invert.
  int dense_limit = 1200;
};

/// The modes of a mechanism.
struct Modes {
  std::vector<Mode> modes;  ///< rigid ones first, then by rising |l|
  int freedoms = 0;         ///< unknown velocities less the rank of the rows
  int zeros = 0;            ///< eigenvalues that are zero: one a rigid mode, two where it can also drift
  /// |l| below which a mode counts as rigid, 1/s: what round-off leaves of a zero, and the unrest of the state.
  double zero_bound = 0;
  bool complete = true;              ///< whether these are all of them
  double length = 1;                 ///< by which translations of shapes are compared with rotations, m
  Vec3 spin = Vec3::Zero();          ///< as LinearMotion
  Unrest unrest;                     ///< as LinearMotion
  std::vector<Finding> notes{};      ///< as LinearMotion

  /// All eigenvalues that were found: zeros, and pairs as two.
  LOCKSTEP_API std::vector<std::complex<double>> eigenvalues() const;
};

/// Finds the modes about a state, in space as linear_motion(). Throws as linear_motion(); ModelError for a pose in which rows become dependent that
/// are not so elsewhere, where a mechanism has no single linearisation (looked for up to dense_limit unknown velocities);
/// SolveError where the lowest modes did not settle.
LOCKSTEP_API Modes find_modes(Dynamics&, const State&, const ModesOptions& = {});

}  // namespace lockstep
