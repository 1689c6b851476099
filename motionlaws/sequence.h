// Law 'sequence'.
#pragma once

#include <utility>
#include <vector>

#include "framework/mechanism/params/params.h"

namespace lockstep {

/// A piece of a sequence: its law runs for `duration` s on its own time, which starts at 0.
struct Piece {
  double duration;
  LawPtr<MotionLaw> law;
};

struct SequenceSettings {
  double t0 = 0;         ///< start of the first piece, s
  bool chained = false;  ///< each piece goes on from the value at which the one before ended
  bool run_on = false;   ///< outside: first and last law run on; false: y is held there, at rest
};

/// y = y_k(t - T_k) + o_k on [T_k, T_k + duration_k), T_k = t0 + the durations before; chained: o_k = y_(k-1) at its
/// end - y_k(0), o_0 = 0. Breakpoints: those of the pieces, and where pieces meet with a jump of y, yd or ydd.
class LOCKSTEP_API Sequence final : public MotionLaw {
 public:
  /// Throws ModelError: no piece, a duration not above 0, no law, or what a law says that refuses an instant of its
  /// piece.
  Sequence(std::vector<Piece> pieces, const SequenceSettings&);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  bool jumps_at(std::size_t k) const;
  std::vector<Piece> pieces_;
  SequenceSettings k_;
  std::vector<double> start_;   // T_0 .. T_n, the last one the end
  std::vector<double> offset_;  // o_0 .. o_(n-1)
  std::vector<bool> jump_;      // at T_0 .. T_n
};

namespace laws {
inline LawPtr<MotionLaw> sequence(std::vector<Piece> pieces, const SequenceSettings& k = {}) {
  return std::make_shared<const Sequence>(std::move(pieces), k);
}
}  // namespace laws

}  // namespace lockstep
