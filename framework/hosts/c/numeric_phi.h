// SPDX-License-Identifier: BSD-3-Clause
// Joints from a function that is known by numbers, as code of another language gives it: values and derivatives.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <lockstep/author/phi_links.h>

namespace lockstep {

/// f(a) by the chain rule, if f is known by numbers at a: its value, its gradient g (one number per variable), and its
/// second derivatives H (row by row, symmetric).
///
///   f' = g_i a_i',  f'' = g_i a_i'' + H_ik a_i' a_k'
template <int N, class T, class D>
Jet<N, T, D> function_of(std::span<const Jet<N, T, D>> a, double f, const double* g, const double* H) {
  Jet<N, T, D> r(f);
  for (std::size_t i = 0; i < a.size(); ++i) {
    r.d += g[i] * a[i].d, r.h += g[i] * a[i].h, r.g += g[i] * a[i].g;
    for (std::size_t k = 0; k < a.size(); ++k) r.h += H[i * a.size() + k] * a[i].d * a[k].d;
  }
  return r;
}

/// A function of y = x, y, z (m), e0, e1, e2, e3 and t (s) that writes, of each row, its value, its gradient by these
/// eight variables, and its second derivatives, 8 x 8 row by row. All are zero before the call.
using PhiNumbers = std::function<void(const double* y, double* value, double* gradient, double* second)>;

/// phi, n rows of such a function.
template <int n>
struct NumericPhi {
  static constexpr PhiSpec spec{.rows = n, .counts_turns = false};  ///< of all seven coordinates
  static constexpr std::size_t n_variables = 8;                     ///< of y
  PhiNumbers numbers;                                               ///< the function

  /// The rows with their derivatives.
  template <class T>
  std::conditional_t<n == 1, T, std::array<T, n>> operator()(const LockCoords<T>& y) const {
    const std::array<T, n_variables> of{y.x, y.y, y.z, y.e0, y.e1, y.e2, y.e3, y.t};
    std::array<double, n_variables> at;
    for (std::size_t i = 0; i < n_variables; ++i) at[i] = of[i].v;
    std::array<double, n> f{};
    std::array<double, n * n_variables> g{};
    std::array<double, n * n_variables * n_variables> H{};
    numbers(at.data(), f.data(), g.data(), H.data());
    const auto row = [&](std::size_t k) {
      return function_of(std::span<const T>(of), f[k], &g[k * n_variables], &H[k * n_variables * n_variables]);
    };
    if constexpr (n == 1) {
      return row(0);
    } else {
      std::array<T, n> rows;
      for (std::size_t k = 0; k < n; ++k) rows[k] = row(k);
      return rows;
    }
  }
};

/// The joint of such a function between two markers, with the rows of a mask.
template <int n>
class NumericJoint final : public PhiLock<NumericPhi<n>> {
 public:
  /// `type`: name of its type, for messages. Throws as PhiLock.
  NumericJoint(std::string type, std::string name, Marker& p, Marker& s, Mask mask, PhiNumbers numbers)
      : PhiLock<NumericPhi<n>>(std::move(name), p, s, mask, {std::move(numbers)}), type_(std::move(type)) {}
  std::string_view type() const override { return type_; }

 private:
  std::string type_;
};

/// The joint of a function with 1 to 3 rows. Throws ModelError for another number.
inline std::unique_ptr<Lock> numeric_joint(const std::string& type, const Attachment& a, Mask mask, int rows,
                                           PhiNumbers numbers) {
  switch (rows) {
    case 1:
      return std::make_unique<NumericJoint<1>>(type, a.name, a.p(), a.s(), mask, std::move(numbers));
    case 2:
      return std::make_unique<NumericJoint<2>>(type, a.name, a.p(), a.s(), mask, std::move(numbers));
    case 3:
      return std::make_unique<NumericJoint<3>>(type, a.name, a.p(), a.s(), mask, std::move(numbers));
    default:
      throw ModelError("joint '" + a.name + "': its function has " + std::to_string(rows) +
                       " rows; give 1, 2 or 3, and another joint for more");
  }
}

}  // namespace lockstep
