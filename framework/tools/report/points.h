// SPDX-License-Identifier: BSD-3-Clause
// The report of many runs: each is a point of a plot; the axes are columns of their table.
#pragma once

#include <string>

#include <lockstep/report.h>
#include "framework/tools/report/histories.h"

namespace lockstep::report {

/// Many runs, and how they are shown at first; the reader may choose otherwise.
struct Points {
  ReportText text{};
  std::string csv,     ///< their table, one row per run; "failure" and "status" give the reason of a failure
      x, y,            ///< titles of the columns on the axes; what is no column of numbers: the first ones
      color{};         ///< title of the column that gives the colour; "": the texts that distinguish the runs
  bool log = false,    ///< logarithmic axes
      joined = false;  ///< lines between the points of a group
  const Histories* histories = nullptr;  ///< of the runs, by the column "run"; null: none are shown
};

/// The page as text.
LOCKSTEP_API std::string points_page(const Points&);

}  // namespace lockstep::report
