// TangentSum: how forces and constraint forces change with the pose and the velocities, summed by pairs of slots
// (theory, section 9).
//
//   K = d( inertia + Jh^T lambda - f )/d(dx, dth)      dx: translation in the world, dth: turn in slot axes,
//   D = d( inertia + Jh^T lambda - f )/d(v, w)         q <- q exp(dth/2); rows: force (world), moment (slot axes)
//
// So the force of a spring enters with a minus sign, the tangent of a constraint force Jh^T lambda with a plus (9.4),
// (9.14). Neither is symmetrised.
#pragma once

#include <span>
#include <vector>

#include "framework/mechanism/rows/rows.h"
#include "framework/mechanism/model/inputs.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

/// Where a part of a slot's six unknowns begins: its translation (world) or its turn (slot axes).
enum class Half { move = 0, turn = 3 };

/// Scratch of tangents that nobody wrote by hand: motions that may be moved, the wrench of one force, the rows of one
/// link.
struct LOCKSTEP_API Differences {
  static constexpr double kStep = 6e-6;  ///< cube root of the rounding unit: best for central differences
  /// Moved by h along unknown k: x (world), turn (slot axes), v (world), w (slot axes), three each.
  static Motion moved(const Motion&, int k, double h);
  /// What translations of these slots compare with, m: their distances, else that to the origin, else 1.
  static double distance(std::span<const int> slots, const Inputs&);

  std::vector<Motion> motions;
  VecX f;
  RowTable rows;
  bool fresh = false;  ///< motions are those of the inputs
};

class LOCKSTEP_API TangentSum {
 public:
  struct Pair {
    int row, column;  ///< slots
  };

  /// Forgets every pair.
  void lay_out(int n_slots);
  /// All numbers to zero; the pairs stay, so that nothing is allocated from the second evaluation on.
  void clear();

  // -- writing; the ground takes anything silently; a new pair brings its mirror image along
  void add_K(int row, int column, const Mat6& K) {
    if (row != kGround && column != kGround) block(row, column).K += K;
  }
  void add_D(int row, int column, const Mat6& D) {
    if (row != kGround && column != kGround) block(row, column).D += D;
  }
  /// One quarter of a block: d(force or moment of slot `row`)/d(translation or turn of slot `column`).
  void add_K(int row, Half r, int column, Half c, const Mat3& K) {
    if (row != kGround && column != kGround)
      block(row, column).K.block<3, 3>(static_cast<int>(r), static_cast<int>(c)) += K;
  }
  void add_D(int row, Half r, int column, Half c, const Mat3& D) {
    if (row != kGround && column != kGround)
      block(row, column).D.block<3, 3>(static_cast<int>(r), static_cast<int>(c)) += D;
  }

  // -- reading
  int n_slots() const { return static_cast<int>(neighbours_.size()); }
  const std::vector<Pair>& pairs() const { return pairs_; }
  const Mat6& K(std::size_t pair) const { return blocks_[pair].K; }
  const Mat6& D(std::size_t pair) const { return blocks_[pair].D; }
  /// Grows whenever a pair comes in: then whoever knows the pattern must look again.
  long revision() const { return revision_; }

  /// Motions to be moved about, equal to those of `in`; one copy an evaluation, made when first asked for.
  Differences& differences(const Inputs& in);

 private:
  struct Block {
    Mat6 K = Mat6::Zero(), D = Mat6::Zero();
  };
  struct Neighbour {
    int column;
    std::size_t block;
  };
  Block& block(int row, int column);
  void insert(int row, int column);

  std::vector<std::vector<Neighbour>> neighbours_;  // of each slot, by rising column
  std::vector<Pair> pairs_;
  std::vector<Block> blocks_;
  long revision_ = 0;
  Differences differences_;
};

}  // namespace lockstep
