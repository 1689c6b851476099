// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/modes.h>

#include <cmath>

#include <lockstep/analysis.h>
#include "framework/foundation/support/finding_kinds.h"
#include "framework/tools/analysis/mechanism_matrices.h"
#include "framework/tools/analysis/minimal_coordinates.h"
#include "framework/tools/analysis/spectrum.h"
#include "framework/tools/rank/motion_words.h"

namespace lockstep {
namespace {

using Complex = std::complex<double>;

// The bodies' motions of a displacement of the unknowns, scaled so that the largest rotation, or translation over the
// length, is 1 and real.
std::vector<BodyShape> shape_of(const System& system, const State& state, const LinearMotion& motion,
                                const Eigen::VectorXcd& dx) {
  std::vector<BodyShape> shape(system.n_slots());
  for (std::size_t i = 0; i < motion.unknowns.size(); ++i) {
    const UnknownVelocity& u = motion.unknowns[i];
    BodyShape& of = shape[u.slot];
    (u.velocity < 3 ? of.move[u.velocity] : of.turn[u.velocity - 3]) = dx[static_cast<Eigen::Index>(i)];
  }
  Complex largest = 0;
  for (int k = 0; k < system.n_slots(); ++k) {
    BodyShape& of = shape[k];
    of.body = bodies_of(system.slot(k));
    of.turn = (rotation(normalized(state.slot_pose(k).q)).cast<Complex>() * of.turn).eval();
    for (int c = 0; c < 3; ++c)
      for (const Complex z : {Complex(of.move[c] / motion.length), Complex(of.turn[c])})
        if (std::abs(z) > kLarger * std::abs(largest)) largest = z;
  }
  if (largest == 0.0) return shape;
  for (BodyShape& of : shape) of.move /= largest, of.turn /= largest;
  return shape;
}

Mode::Kind kind_of(Complex l) {
  if (l.imag() != 0) return Mode::Kind::oscillation;
  if (l == 0.0) return Mode::Kind::rigid;
  return l.real() < 0 ? Mode::Kind::decay : Mode::Kind::growth;
}

// Motions in which the modes are looked for: all that the rows leave free, or those in which the lowest modes lie.
MatX basis_of(Dynamics& dynamics, const State& state, const LinearMotion& motion, int count, Modes& out) {
  if (!out.complete) {
    const MobilityReport mobile = mobility(dynamics, state);
    out.freedoms = mobile.freedoms;
    return lowest_motions(motion, count, mobile.redundant > 0);
  }
  MinimalCoordinates c = minimal_coordinates(dynamics, state, motion);
  if (c.nearly > 0)
    out.notes.push_back(
        {&finding::analysis_note, "",
         "a singular configuration is near: " + std::to_string(c.nearly) + " constraints nearly depend on others"});
  out.freedoms = static_cast<int>(c.N.cols());
  return c.N;
}

}  // namespace

std::vector<std::complex<double>> Modes::eigenvalues() const {
  std::vector<Complex> all(zeros, 0.0);
  for (const Mode& mode : modes) {
    if (mode.kind == Mode::Kind::rigid) continue;
    all.push_back(mode.value);
    if (mode.value.imag() != 0) all.push_back(std::conj(mode.value));
  }
  return all;
}

Modes find_modes(Dynamics& dynamics, const State& given, const ModesOptions& options) {
  const State state = dynamics.in_slots(given);
  const System::InSpace look = dynamics.look_in_space();
  const LinearMotion motion = linear_motion(dynamics, state, options.motion);
  const System& system = dynamics.system();
  Modes out;
  out.length = motion.length, out.spin = motion.spin, out.unrest = motion.unrest, out.notes = motion.notes;
  out.complete = static_cast<int>(motion.unknowns.size()) <= options.dense_limit;
  const int count = options.count > 0 || out.complete ? options.count : 20;
  const Spectrum found = spectrum_of(motion, basis_of(dynamics, state, motion, count, out));
  if (out.freedoms == 0)
    out.notes.push_back({&finding::analysis_note, "", "no modes: joints and drives leave no degree of freedom",
                         "take out a drive, or open a joint"});
  out.zeros = found.zeros, out.zero_bound = found.zero_bound;
  for (const Eigenvalue& e : found.all)
    out.modes.push_back({kind_of(e.l), e.l, e.bound, shape_of(system, state, motion, e.x)});
  if (count > 0 && static_cast<std::size_t>(count) < out.modes.size()) {
    out.modes.resize(count);
    out.complete = false;
  }
  return out;
}

}  // namespace lockstep
