// SPDX-License-Identifier: BSD-3-Clause
// The terms of a formula while it is read.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "framework/mechanism/expression/evaluate.h"

namespace lockstep::expression {

/// Terms by number, each after those that it is made of. A term of constants is the constant that it gives.
class TermList {
 public:
  const Term& operator[](int i) const { return all_[static_cast<std::size_t>(i)]; }
  bool is_constant(int i) const { return (*this)[i].operation == Operation::number; }

  // Each appends a term and returns its number.
  int constant(double x) { return put({.value = x}); }
  int variable(int k) { return put({.operation = Operation::name, .variable = k}); }
  int put(Operation o, const std::vector<int>& parts, Function f = {}) {
    Term t{.operation = o, .function = f};
    std::copy(parts.begin(), parts.end(), t.parts.begin());
    t.n_parts = static_cast<int>(parts.size());
    t.decides = is_condition(o) || o == Operation::choose || (o == Operation::call && f.signature().decides);
    return put(t);
  }
  int put(const Term& t) {
    all_.push_back(t);
    const std::span<const int> parts(t.parts.data(), static_cast<std::size_t>(t.n_parts));
    if (!parts.empty() && std::ranges::all_of(parts, [&](int i) { return is_constant(i); }))
      all_.back() = {.value = value_of_term<double>(all_, all_.size() - 1, {})};
    return static_cast<int>(all_.size()) - 1;
  }

  /// Term i, as the last, and those that it is made of.
  std::vector<Term> needed_by(int i) const {
    std::vector<bool> needed(all_.size());
    needed[static_cast<std::size_t>(i)] = true;
    for (std::size_t k = all_.size(); k-- > 0;)
      for (int j = 0; needed[k] && j < all_[k].n_parts; ++j) needed[static_cast<std::size_t>(all_[k].parts[j])] = true;
    std::vector<Term> kept;
    std::vector<int> place(all_.size());
    for (std::size_t k = 0; k < all_.size(); ++k) {
      if (!needed[k]) continue;
      place[k] = static_cast<int>(kept.size());
      Term& t = kept.emplace_back(all_[k]);
      for (int j = 0; j < t.n_parts; ++j) t.parts[j] = place[static_cast<std::size_t>(t.parts[j])];
    }
    return kept;
  }

 private:
  std::vector<Term> all_;
};

}  // namespace lockstep::expression
