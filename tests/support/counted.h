// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// A number that counts what is done with it: multiplications, additions (and subtractions), divisions. Changes of sign
/// are free, as in the theory's section 5.

#include <cmath>

#include <Eigen/Core>

#include "framework/dynamics/tree/spaces.h"

namespace lockstep::oracle {

struct Operations {
  long mul = 0, add = 0, div = 0;
  long total() const { return mul + add + div; }
};

class Counted {
 public:
  Counted() = default;
  Counted(double value) : value_(value) {}  // NOLINT: a constant is a number
  double value() const { return value_; }

  static Operations& done() {
    static Operations operations;
    return operations;
  }

  Counted& operator+=(const Counted& b) { return ++done().add, value_ += b.value_, *this; }
  Counted& operator-=(const Counted& b) { return ++done().add, value_ -= b.value_, *this; }
  Counted& operator*=(const Counted& b) { return ++done().mul, value_ *= b.value_, *this; }
  Counted& operator/=(const Counted& b) { return ++done().div, value_ /= b.value_, *this; }
  friend Counted operator+(Counted a, const Counted& b) { return a += b; }
  friend Counted operator-(Counted a, const Counted& b) { return a -= b; }
  friend Counted operator*(Counted a, const Counted& b) { return a *= b; }
  friend Counted operator/(Counted a, const Counted& b) { return a /= b; }
  friend Counted operator-(const Counted& a) { return {-a.value_}; }
  /// One operation, as a division.
  friend Counted sqrt(const Counted& a) { return ++done().div, Counted(std::sqrt(a.value_)); }
  friend Counted sin(const Counted& a) { return std::sin(a.value_); }  // not counted
  friend Counted cos(const Counted& a) { return std::cos(a.value_); }
  friend bool operator==(const Counted& a, const Counted& b) { return a.value_ == b.value_; }
  friend bool operator<(const Counted& a, const Counted& b) { return a.value_ < b.value_; }
  friend bool operator>(const Counted& a, const Counted& b) { return a.value_ > b.value_; }
  explicit operator int() const { return static_cast<int>(value_); }

 private:
  double value_ = 0;
};

/// What `act` does with counted numbers.
template <class F>
Operations operations_of(F&& act) {
  Counted::done() = {};
  act();
  return Counted::done();
}

}  // namespace lockstep::oracle

template <>
struct Eigen::NumTraits<lockstep::oracle::Counted> : Eigen::GenericNumTraits<double> {
  using Real = lockstep::oracle::Counted;
  using NonInteger = lockstep::oracle::Counted;
  using Nested = lockstep::oracle::Counted;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

// Pivots are taken as they are: what they are compared with is no operation.
template <>
inline constexpr bool lockstep::bodies::kUncompared<lockstep::oracle::Counted> = true;
