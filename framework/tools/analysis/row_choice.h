// Which rows on common loops are independent, and which may go: Gram and Schmidt.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/analysis/loop_rows.h"

namespace lockstep {

/// A row of the table, by its link and its number there.
struct OwnRow {
  const Lock* link = nullptr;
  int own = 0;
  double length = 1;  ///< of the row in lengths
  VecX J;             ///< 6 per slot
};

/// Rows on common loops: those that stay are independent, and others go.
struct Choice {
  std::vector<OwnRow> gone;
  std::vector<std::string> links;  ///< on loops with such rows
  double smallest = 1;             ///< pivot of those that stay
  std::string kept;                ///< what keeps a row of `gone` from being left out; "" for nothing
};

/// The rows of a loop above a limit: the next that stays is the first, in the order of the links, of which others leave at
/// least half of the most; rows with laws, and others that are kept, go first as long as they are a tenth of the most. Ends
/// where no row is left above `limit`.
Choice choose_rows(const System&, const RowTable&, const LoopRows&, double limit);

/// What keeps a row of a link from being left out: "a law is among them"; "" for nothing.
std::string keeper_of(const Lock&, int own);

/// Adds a name that is not there.
void add_name(const std::string& name, std::vector<std::string>& names);

}  // namespace lockstep
