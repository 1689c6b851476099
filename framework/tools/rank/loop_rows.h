// SPDX-License-Identifier: BSD-3-Clause
// The rows of a mechanism loop by loop, for rank, dependencies and unique reactions.
#pragma once

#include <string>
#include <vector>

#include "framework/dynamics/evaluate/loop_rows.h"
#include "framework/tools/rank/unknowns.h"

namespace lockstep {

/// The rows of an evaluation with those that were left out; `room` holds them if there are some.
const RowTable& all_rows(const Evaluation&, const State&, RowTable& room);

/// Rows of some entries, in the unknowns of the slots that they touch.
struct LoopRows {
  LoopRows(const System&, const RowTable&, const std::vector<int>& entries);

  Unknowns at;
  SparseMat Jt;              ///< rows_of_loop()
  std::vector<int> numbers;  ///< of its columns in the table

  int n() const { return static_cast<int>(numbers.size()); }
};

/// A row of a table by its link: the link's own number of it, its name, "A.z", and that of its drive, "A.rz", or "".
struct LOCKSTEP_API NamedRow {
  NamedRow(const System&, const RowTable&, int row);
  const Lock* link;
  int own;
  std::string name() const;
  std::string drive() const;
  bool moves() const;  ///< it is of a drive whose law is not constant
};

/// Adds a name that is not there.
LOCKSTEP_API void add_name(const std::string& name, std::vector<std::string>& names);

}  // namespace lockstep
