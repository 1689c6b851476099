// SPDX-License-Identifier: BSD-3-Clause
// Where the mass centres truly are at 101 equal times: closed forms, the trusted csv files of tests/verification/data,
// or few coordinates in extended precision.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/benchmark/peers/mechanisms.h"

namespace lockstep::peers {

using History = std::vector<Positions>;  ///< at i until/kReports, start and end included
inline constexpr int kReports = 100;

/// Largest over the bodies, and over the times too, m; NaN when anything is no number.
double largest_distance(const Positions&, const Positions&);
double largest_distance(const History&, const History&);

/// At every `stride`-th report time; coarser `steps` (of the integration between two reports) tell the truth's own
/// error. Throws std::runtime_error when a csv cannot be read.
History compute_truth(const Mechanism&, int steps, int stride);
/// Steps between two reports that suffice for 1e-12 m.
int truth_steps(const Mechanism&);

/// Truths, computed once and kept as files in a folder.
class Truths {
 public:
  explicit Truths(std::string folder) : folder_(std::move(folder)) {}
  const History& of(const Mechanism&);

 private:
  std::string folder_;
  std::map<std::string, History> known_;
};

/// Columns of a csv by name, without the unit in brackets.
std::map<std::string, std::vector<double>> read_columns(const std::string& path);
/// File of tests/verification/data.
std::string data_file(const std::string& name);

/// Torque that drives the slider-crank at the end of its run, N m.
double slider_crank_torque();

}  // namespace lockstep::peers
