// The rows of a mechanism loop by loop, scaled to lengths: what rank, dependencies and unique reactions are found from.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/SparseCore>

#include <lockstep/system.h>

namespace lockstep {

/// Entries of the table in groups whose ranks add up: those that lie on common loops of slots.
std::vector<std::vector<int>> loops_of(const System&, const RowTable&);

/// Rows of some entries, in lengths: angular columns divided by System::length(), and every row of length 1.
class LoopRows {
 public:
  LoopRows(const System&, const RowTable&, const std::vector<int>& entries);
  int n() const { return static_cast<int>(numbers_.size()); }
  int n_columns() const { return 6 * static_cast<int>(first_.size()); }
  int number(int row) const { return numbers_[static_cast<std::size_t>(row)]; }    ///< in the table
  double length(int row) const { return length_[static_cast<std::size_t>(row)]; }  ///< before it was scaled
  const std::vector<Eigen::Triplet<double>>& Jt() const { return Jt_; }            ///< transposed: a row is a column
  MatX matrix() const;                                                             ///< the same

 private:
  void add(const System&, const RowTable&, const RowEntry&);

  std::map<int, int> first_;  // of the slots that are touched
  std::vector<int> numbers_;
  std::vector<double> length_;
  std::vector<Eigen::Triplet<double>> Jt_;
};

const RowEntry& entry_of_row(const RowTable&, int row);
/// "A.z"
std::string name_of_row(const System&, const RowTable&, int row);

}  // namespace lockstep
