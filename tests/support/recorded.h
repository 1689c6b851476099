// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// A number that writes down what is done with it, as a list of operations without branches: what was computed at one
/// state can be computed again at others. Equal operations are written once, constants are folded, and 0 x = 0, 0 + x = x,
/// 1 x = x, so that what remains gives the same bits as doubles do, but for the sign of a zero. A comparison would be a
/// branch, and is an error.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "framework/dynamics/tree/spaces.h"

namespace lockstep::oracle {

enum class Op : std::uint8_t { constant, input, add, subtract, multiply, divide, negate, sqrt, sin, cos };

/// a, b: numbers of operations before; of an input a is its number, of a constant `bits` its value.
struct Operation {
  Op op;
  int a = -1, b = -1;
  std::uint64_t bits = 0;
  auto operator<=>(const Operation&) const = default;
};

class Recording {
 public:
  int put(Operation step) {
    if ((step.op == Op::add || step.op == Op::multiply) && step.b < step.a) std::swap(step.a, step.b);
    const auto [known, is_new] = known_.try_emplace(step, static_cast<int>(steps_.size()));
    if (is_new) steps_.push_back(step);
    return known->second;
  }
  const Operation& operator[](int i) const { return steps_[i]; }
  std::span<const Operation> steps() const { return steps_; }

  /// The one that numbers of this thread are written to: the last that began.
  static inline thread_local Recording* now = nullptr;
  Recording() { now = this; }
  Recording(const Recording&) = delete;
  ~Recording() { now = nullptr; }

 private:
  std::vector<Operation> steps_;
  std::map<Operation, int> known_;
};

class Recorded {
 public:
  Recorded() = default;
  Recorded(double value) : value_(value) {}  // NOLINT: a constant is a number
  static Recorded input(int i) { return Recorded(Op::input, i); }
  /// Its operation.
  int step() const {
    const double positive = value_ == 0 ? 0.0 : value_;
    return step_ >= 0 ? step_ : Recording::now->put({Op::constant, -1, -1, std::bit_cast<std::uint64_t>(positive)});
  }

  [[gnu::noinline]] friend Recorded operator+(const Recorded& a, const Recorded& b) {
    if (a.is_constant() && b.is_constant()) return a.value_ + b.value_;
    if (a.is(0)) return b;
    if (b.is(0)) return a;
    if (b.is_negated()) return a - b.negated();
    if (a.is_negated()) return b - a.negated();
    return {Op::add, a.step(), b.step()};
  }
  [[gnu::noinline]] friend Recorded operator-(const Recorded& a, const Recorded& b) {
    if (a.is_constant() && b.is_constant()) return a.value_ - b.value_;
    if (a.is(0)) return -b;
    if (b.is(0)) return a;
    if (b.is_negated()) return a + b.negated();
    return {Op::subtract, a.step(), b.step()};
  }
  [[gnu::noinline]] friend Recorded operator*(const Recorded& a, const Recorded& b) {
    if (a.is_constant() && b.is_constant()) return a.value_ * b.value_;
    if (a.is(0) || b.is(0)) return 0.0;
    if (a.is(1)) return b;
    if (b.is(1)) return a;
    if (a.is(-1)) return -b;
    if (b.is(-1)) return -a;
    if (a.is_negated()) return -(a.negated() * b);
    if (b.is_negated()) return -(a * b.negated());
    return {Op::multiply, a.step(), b.step()};
  }
  [[gnu::noinline]] friend Recorded operator/(const Recorded& a, const Recorded& b) {
    if (a.is_constant() && b.is_constant()) return a.value_ / b.value_;
    if (a.is(0) || b.is(1)) return a;
    return {Op::divide, a.step(), b.step()};
  }
  [[gnu::noinline]] friend Recorded operator-(const Recorded& a) {
    if (a.is_constant()) return -a.value_;
    return a.is_negated() ? a.negated() : Recorded(Op::negate, a.step_);
  }
  Recorded& operator+=(const Recorded& b) { return *this = *this + b; }
  Recorded& operator-=(const Recorded& b) { return *this = *this - b; }
  Recorded& operator*=(const Recorded& b) { return *this = *this * b; }
  Recorded& operator/=(const Recorded& b) { return *this = *this / b; }
  friend Recorded sqrt(const Recorded& a) {
    return a.is_constant() ? std::sqrt(a.value_) : Recorded(Op::sqrt, a.step_);
  }
  friend Recorded sin(const Recorded& a) { return a.is_constant() ? std::sin(a.value_) : Recorded(Op::sin, a.step_); }
  friend Recorded cos(const Recorded& a) { return a.is_constant() ? std::cos(a.value_) : Recorded(Op::cos, a.step_); }
  friend bool operator<(const Recorded&, const Recorded&) { return refuse(); }
  friend bool operator>(const Recorded&, const Recorded&) { return refuse(); }
  friend bool operator<=(const Recorded&, const Recorded&) { return refuse(); }
  friend bool operator>=(const Recorded&, const Recorded&) { return refuse(); }
  friend bool operator==(const Recorded&, const Recorded&) { return refuse(); }

 private:
  Recorded(Op op, int a, int b = -1) : step_(Recording::now->put({op, a, b})) {}
  [[noreturn]] static bool refuse() {
    throw std::logic_error("a recorded number was compared: what follows would hold at the recorded state alone");
  }
  bool is_constant() const { return step_ < 0; }
  bool is(double x) const { return is_constant() && value_ == x; }
  bool is_negated() const { return !is_constant() && (*Recording::now)[step_].op == Op::negate; }
  Recorded negated() const {
    Recorded of;
    of.step_ = (*Recording::now)[step_].a;
    return of;
  }

  double value_ = 0;
  int step_ = -1;  // -1: a constant
};

/// The operations that some results need, in their order.
class Program {
 public:
  Program(const Recording& recording, std::span<const Recorded> results) {
    std::vector<int> place(recording.steps().size(), -1);
    for (const Recorded& y : results) results_.push_back(y.step());
    place.resize(recording.steps().size(), -1);
    std::vector<char> needed(place.size(), 0);
    for (const int i : results_) needed[i] = 1;
    for (std::size_t i = needed.size(); i-- > 0;) {
      const Operation& s = recording.steps()[i];
      if (!needed[i] || s.op == Op::constant || s.op == Op::input) continue;
      needed[s.a] = 1;
      if (s.b >= 0) needed[s.b] = 1;
    }
    for (std::size_t i = 0; i < needed.size(); ++i) {
      if (!needed[i]) continue;
      Operation s = recording.steps()[i];
      if (s.op != Op::constant && s.op != Op::input) {
        s.a = place[s.a];
        if (s.b >= 0) s.b = place[s.b];
      }
      place[i] = static_cast<int>(steps_.size());
      steps_.push_back(s);
    }
    for (int& i : results_) i = place[i];
  }

  std::vector<double> replay(std::span<const double> inputs) const {
    std::vector<double> x(steps_.size()), out;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const Operation& s = steps_[i];
      const auto a = [&] { return x[s.a]; };
      const auto b = [&] { return x[s.b]; };
      switch (s.op) {
        case Op::constant:
          x[i] = std::bit_cast<double>(s.bits);
          break;
        case Op::input:
          x[i] = inputs[s.a];
          break;
        case Op::add:
          x[i] = a() + b();
          break;
        case Op::subtract:
          x[i] = a() - b();
          break;
        case Op::multiply:
          x[i] = a() * b();
          break;
        case Op::divide:
          x[i] = a() / b();
          break;
        case Op::negate:
          x[i] = -a();
          break;
        case Op::sqrt:
          x[i] = std::sqrt(a());
          break;
        case Op::sin:
          x[i] = std::sin(a());
          break;
        case Op::cos:
          x[i] = std::cos(a());
          break;
      }
    }
    for (const int i : results_) out.push_back(x[i]);
    return out;
  }

  std::size_t size() const { return steps_.size(); }
  long count(std::initializer_list<Op> of) const {
    return std::count_if(steps_.begin(), steps_.end(),
                         [&](const Operation& s) { return std::ranges::count(of, s.op); });
  }

 private:
  std::vector<Operation> steps_;
  std::vector<int> results_;
};

}  // namespace lockstep::oracle

template <>
inline constexpr bool lockstep::bodies::kUncompared<lockstep::oracle::Recorded> = true;

template <>
struct Eigen::NumTraits<lockstep::oracle::Recorded> : Eigen::GenericNumTraits<double> {
  using Real = lockstep::oracle::Recorded;
  using NonInteger = lockstep::oracle::Recorded;
  using Nested = lockstep::oracle::Recorded;
  using Literal = double;
};
