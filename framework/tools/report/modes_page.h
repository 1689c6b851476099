// SPDX-License-Identifier: BSD-3-Clause
// The report of modes: the mechanism at rest, and its motion in each of its modes.
#pragma once

#include <array>
#include <complex>
#include <string>
#include <vector>

#include <lockstep/report.h>
#include <lockstep/scene.h>
#include <lockstep/step_loop.h>

namespace lockstep::report {

/// The motion of one rigid group in a mode: amplitudes of the translation of its origin, m, and of the rotation, rad, in
/// world axes.
using SlotShape = std::array<std::complex<double>, 6>;

/// One mode.
struct ShownMode {
  std::string name,                ///< "1: 3.56 Hz"
      words;                       ///< further facts, in a sentence
  double frequency = 0;            ///< Hz; 0 of one that does not swing
  double damping = 0;              ///< damping ratio
  std::vector<SlotShape> shape{};  ///< by rigid group
};

/// The page as text: `rest` is the state about which the modes are. Translations of shapes are compared with rotations by
/// `length`, m.
LOCKSTEP_API std::string modes_page(const ReportText&, const Sample& rest, const Mechanism&,
                                    const std::vector<ShownMode>&, double length);

}  // namespace lockstep::report
