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

/// The motion of a body in a mode: amplitudes at its centre of mass; the motion is the real part of shape exp(l t).
struct BodyShape {
  std::string body;                                  ///< its name; of bodies that move as one, all of them: "arm + bob"
  Eigen::Vector3cd move = Eigen::Vector3cd::Zero(),  ///< translation, world, m
      turn = Eigen::Vector3cd::Zero();               ///< rotation, world axes, rad
};

/// One mode: a real eigenvalue, a pair, or a direction without a restoring force.
struct Mode {
  /// The kind of its motion.
  enum class Kind {
    rigid,        ///< eigenvalue zero within round-off: no restoring force
    oscillation,  ///< a pair: oscillates, growing or decaying
    decay,        ///< a negative real eigenvalue
    growth        ///< a positive real eigenvalue
  };
  Kind kind = Kind::rigid;         ///< the kind of its motion
  std::complex<double> value{};    ///< eigenvalue l, 1/s; of a pair that with the positive imaginary part
  double bound = 0;                ///< error of l by round-off and residual accelerations of the state, 1/s
  std::vector<BodyShape> shape{};  ///< of all moving bodies; the largest rotation, or translation over length, is 1

  double omega() const { return value.imag(); }               ///< circular frequency, rad/s, of the damped motion
  double frequency() const { return value.imag() / kTwoPi; }  ///< the same, Hz
  /// -Re l/|l|: 0 undamped, 1 and more no oscillation, negative growing.
  double damping() const { return value == 0.0 ? 0.0 : (0.0 - value.real()) / std::abs(value); }
  /// Whether growth or decay is within round-off.
  bool is_marginal() const { return std::abs(value.real()) <= bound; }
};

/// Options of the modes.
struct ModesOptions {
  LinearMotionOptions motion{};  ///< axes, and states that are no equilibrium
  /// Number of lowest modes, by |l|. 0: all for up to dense_limit unknown velocities, otherwise 20.
  int count = 0;
  /// Up to this number of unknown velocities, dense matrices give all modes; beyond, shift and invert gives the lowest.
  int dense_limit = 1200;
};

/// The modes of a mechanism.
struct Modes {
  std::vector<Mode> modes;  ///< rigid ones first, then by rising |l|
  int freedoms = 0;         ///< degrees of freedom: unknown velocities less the rank of the constraints
  int zeros = 0;            ///< number of zero eigenvalues: one per rigid mode, two if it can also drift
  /// |l| below which a mode counts as rigid, 1/s: the error by round-off and residual accelerations of the state.
  double zero_bound = 0;
  bool complete = true;          ///< whether these are all modes
  double length = 1;             ///< length by which translations of shapes are compared with rotations, m
  Vec3 spin = Vec3::Zero();      ///< as LinearMotion
  Unrest unrest;                 ///< as LinearMotion
  std::vector<Finding> notes{};  ///< as LinearMotion

  /// All eigenvalues of these modes: zeros, and pairs as two.
  LOCKSTEP_API std::vector<std::complex<double>> eigenvalues() const;
};

/// Finds the modes about a state, in space as linear_motion(). Throws as linear_motion(). Throws ModelError for a
/// singular configuration, in which a mechanism has no unique linearisation (detected for up to dense_limit unknown
/// velocities), and SolveError if the lowest modes do not converge.
LOCKSTEP_API Modes find_modes(Dynamics&, const State&, const ModesOptions& = {});

}  // namespace lockstep
