// SPDX-License-Identifier: BSD-3-Clause
// Scalar laws made of laws.
#pragma once

#include <vector>

#include <lockstep/author/law.h>

namespace lockstep {

/// Parameters of repeat().
struct RepeatSettings {
  double t0 = 0;       ///< a start of the period, s
  bool drift = false;  ///< each period adds what the law gained over one: y(period) - y(0)
};

/// A piece of a sequence: a law, and how long it runs.
struct Piece {
  double duration;        ///< how long it runs, s
  LawPtr<MotionLaw> law;  ///< evaluated at the time since the piece began, s
};

/// Parameters of sequence().
struct SequenceSettings {
  double t0 = 0;         ///< start of the first piece, s
  bool chained = false;  ///< each piece continues from the end value of the one before
  bool run_on = false;   ///< outside: the first and last law run on; false: the value is held, at rest
};

namespace laws {
// Laws 'sum', 'product', 'scale' and 'shift': laws made of laws. They pass on the breakpoints of the inner laws.

/// y = y_1 + y_2 + ... of several laws. Throws ModelError for an empty list or a missing law.
LOCKSTEP_API LawPtr<MotionLaw> sum(std::vector<LawPtr<MotionLaw>> laws);
/// y = y_1 y_2 ... of several laws. Throws ModelError for an empty list or a missing law.
LOCKSTEP_API LawPtr<MotionLaw> product(std::vector<LawPtr<MotionLaw>> laws);
/// y = offset + factor law(t). Throws ModelError for no law or a number that is not finite.
LOCKSTEP_API LawPtr<MotionLaw> scale(LawPtr<MotionLaw> law, double factor, double offset = 0);
/// y(t) = law(t - delay): the law delayed by `delay` s (advanced if negative). Throws ModelError for no law or a delay that
/// is not finite.
LOCKSTEP_API LawPtr<MotionLaw> shift(LawPtr<MotionLaw> law, double delay);

// Law 'repeat'.

/// Repeats what `law` does from its time 0 to `period`, s: y = law(s) + n d for all t, s = t - t0 - n period in
/// [0, period), n whole, d = law(period) - law(0) with drift, else 0. Breakpoints: those of the law in (0, period), and the
/// start of each period if y, yd or ydd jumps there. Throws ModelError for no law, a period that is not above 0, or a t0
/// that is not finite.
LOCKSTEP_API LawPtr<MotionLaw> repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings& k = {});

// Law 'sequence'.

/// Laws one after another: y = y_k(t - T_k) + o_k on [T_k, T_k + duration_k), T_k = t0 + the durations before. Chained:
/// o_k = y_(k-1) at its end - y_k(0), o_0 = 0; else o_k = 0. Breakpoints: those of the pieces, and where pieces meet
/// with a jump of y, yd or ydd. Throws ModelError for no piece, a duration that is not above 0, no law, or a t0 that is
/// not finite. Evaluates the pieces: exceptions of laws are passed on.
LOCKSTEP_API LawPtr<MotionLaw> sequence(std::vector<Piece> pieces, const SequenceSettings& k = {});
}  // namespace laws

}  // namespace lockstep
