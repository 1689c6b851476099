// SPDX-License-Identifier: BSD-3-Clause
// Operations: what an evaluation costs, counted from its plan.
#pragma once

namespace lockstep {

/// Multiply-adds, of numbers or of packs that one instruction takes; and visits: divisions, and what a plan is read for one by
/// one, such as nodes, sides and rows.
struct Operations {
  double multiply_adds = 0, visits = 0;

  void add(double more, double times) { multiply_adds += more, visits += times; }
  /// In multiply-adds. What a visit takes of them, benchmark `formulations` measures.
  double total() const { return multiply_adds + kVisit * visits; }
  static constexpr int kVisit = 25;
};

}  // namespace lockstep
