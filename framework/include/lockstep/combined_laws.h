// SPDX-License-Identifier: BSD-3-Clause
// Scalar laws made of laws.
#pragma once

#include <memory>
#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/author/params.h>

namespace lockstep {

// Laws 'sum', 'product', 'scale' and 'shift': laws made of laws. They pass on the breakpoints of the inner laws.

/// y = y_1 + y_2 + ... of several laws.
class LOCKSTEP_API SumLaw final : public MotionLaw {
 public:
  /// Throws ModelError for an empty list or a missing law.
  explicit SumLaw(std::vector<LawPtr<MotionLaw>> laws);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  std::vector<LawPtr<MotionLaw>> laws_;
};

/// y = y_1 y_2 ... of several laws.
class LOCKSTEP_API ProductLaw final : public MotionLaw {
 public:
  /// Throws ModelError for an empty list or a missing law.
  explicit ProductLaw(std::vector<LawPtr<MotionLaw>> laws);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  std::vector<LawPtr<MotionLaw>> laws_;
};

/// y = offset + factor law(t).
class LOCKSTEP_API ScaledLaw final : public MotionLaw {
 public:
  /// Throws ModelError for no law or a number that is not finite.
  ScaledLaw(LawPtr<MotionLaw> law, double factor, double offset);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  LawPtr<MotionLaw> law_;
  double factor_, offset_;
};

/// y(t) = law(t - delay): the law delayed by `delay` s (advanced when negative).
class LOCKSTEP_API ShiftedLaw final : public MotionLaw {
 public:
  /// Throws ModelError for no law or a delay that is not finite.
  ShiftedLaw(LawPtr<MotionLaw> law, double delay);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  LawPtr<MotionLaw> law_;
  double delay_;
};

/// Functions that make laws as shared pointers. They throw what the constructors throw.
namespace laws {
/// A SumLaw: y = y_1 + y_2 + ...
LOCKSTEP_API LawPtr<MotionLaw> sum(std::vector<LawPtr<MotionLaw>> laws);
/// A ProductLaw: y = y_1 y_2 ...
LOCKSTEP_API LawPtr<MotionLaw> product(std::vector<LawPtr<MotionLaw>> laws);
/// A ScaledLaw: y = offset + factor law(t).
LOCKSTEP_API LawPtr<MotionLaw> scale(LawPtr<MotionLaw> law, double factor, double offset = 0);
/// A ShiftedLaw: y = law(t - delay), delay in s.
LOCKSTEP_API LawPtr<MotionLaw> shift(LawPtr<MotionLaw> law, double delay);
}  // namespace laws

// Law 'repeat'.

/// Parameters of a Repeat law.
struct RepeatSettings {
  double t0 = 0;       ///< a start of the period, s
  bool drift = false;  ///< each period adds what the law gained over one: y(period) - y(0)
};

/// y = law(s) + n d for all t, s = t - t0 - n period in [0, period), n whole, d = law(period) - law(0) with drift, else
/// 0. Breakpoints: those of the law in (0, period), and the start of each period when y, yd or ydd jumps there.
class LOCKSTEP_API Repeat final : public MotionLaw {
 public:
  /// Repeats what `law` does from its time 0 to `period`, s. Throws ModelError for no law, a period that is not above
  /// 0, or a t0 that is not finite.
  Repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings&);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  LawPtr<MotionLaw> law_;
  double period_, t0_, gain_ = 0;
  bool jump_ = false;
};

namespace laws {
/// A Repeat of the law's time from 0 to `period`, s.
LOCKSTEP_API LawPtr<MotionLaw> repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings& k = {});
}  // namespace laws

// Law 'sequence'.

/// A piece of a sequence: a law, and how long it runs.
struct Piece {
  double duration;        ///< how long it runs, s
  LawPtr<MotionLaw> law;  ///< evaluated at the time since the piece began, s
};

/// Parameters of a Sequence.
struct SequenceSettings {
  double t0 = 0;         ///< start of the first piece, s
  bool chained = false;  ///< each piece continues from the value at which the one before ended
  bool run_on = false;   ///< outside: the first and last law run on; false: the value is held, at rest
};

/// Laws one after another: y = y_k(t - T_k) + o_k on [T_k, T_k + duration_k), T_k = t0 + the durations before. Chained:
/// o_k = y_(k-1) at its end - y_k(0), o_0 = 0; else o_k = 0. Breakpoints: those of the pieces, and where pieces meet
/// with a jump of y, yd or ydd.
class LOCKSTEP_API Sequence final : public MotionLaw {
 public:
  /// Throws ModelError for no piece, a duration that is not above 0, no law, or a t0 that is not finite. Evaluates the
  /// pieces: what a law throws is passed on.
  Sequence(std::vector<Piece> pieces, const SequenceSettings&);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  bool jumps_at(std::size_t k) const;
  std::vector<Piece> pieces_;
  SequenceSettings k_;
  std::vector<double> start_;   // T_0 .. T_n, the last one the end
  std::vector<double> offset_;  // o_0 .. o_(n-1)
  std::vector<bool> jump_;      // at T_0 .. T_n
};

namespace laws {
/// A Sequence of pieces.
LOCKSTEP_API LawPtr<MotionLaw> sequence(std::vector<Piece> pieces, const SequenceSettings& k = {});
}  // namespace laws

}  // namespace lockstep
