// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a scene: its table and its audit, or the words of the error that ended it.
#pragma once

#include <string>

#include <lockstep/recorder.h>

namespace lockstep::stability {

struct Outcome {
  std::string error;  ///< "": it reached its end
  Table table;        ///< with what was recorded until then
  Audit audit;
  SimulationReport report;

  bool ended() const { return error.empty(); }
  /// Whether somebody who reads the summary learns that it is wrong: an error, a warning, energy or drift out of bounds.
  bool told() const {
    return !ended() || !report.findings.empty() || audit.drifted || audit.energy != Audit::Energy::conserved;
  }
};

/// Builds the scene of this text, assembles its start and runs it to its end, as the program does.
Outcome outcome_of(const std::string& text);

/// The text with every `word` replaced.
std::string filled(std::string text, const std::string& word, const std::string& value);
std::string filled(std::string text, const std::string& word, double value);

}  // namespace lockstep::stability
