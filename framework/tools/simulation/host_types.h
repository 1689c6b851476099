// SPDX-License-Identifier: BSD-3-Clause
// Joints and integrators whose code is that of a host in another language.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <lockstep/author/phi_links.h>
#include <lockstep/author/stepping.h>

namespace lockstep {

/// A joint, a PhiLock or a PhiCoupling, of a type that has its name from the host.
template <class Joint>
class HostJoint final : public Joint {
 public:
  template <class... Args>
  explicit HostJoint(std::string type, Args&&... args) : Joint(std::forward<Args>(args)...), type_(std::move(type)) {}
  std::string_view type() const override { return type_; }

 private:
  std::string type_;
};

/// A function of y = x, y, z (m), e0, e1, e2, e3 and t (s) that writes, of each row, its value, its gradient by these
/// eight variables, and its second derivatives, 8 x 8 row by row. All are zero before the call.
using PhiNumbers = std::function<void(const double* y, double* value, double* gradient, double* second)>;

/// phi, n rows of such a function, by the chain rule from its gradient g and its second derivatives H:
///
///   f' = g_i y_i',  f'' = g_i y_i'' + H_ij y_i' y_j'
template <int n>
struct NumericPhi {
  static constexpr PhiSpec spec{.rows = n, .counts_turns = false};  ///< of all seven coordinates
  static constexpr std::size_t n_variables = 8;                     ///< of y
  PhiNumbers numbers;                                               ///< the function

  /// The rows with their derivatives.
  template <class T>
  auto operator()(const LockCoords<T>& y) const {
    const std::array<T, n_variables> of{y.x, y.y, y.z, y.e0, y.e1, y.e2, y.e3, y.t};
    std::array<double, n_variables> at;
    for (std::size_t i = 0; i < n_variables; ++i) at[i] = of[i].v;
    std::array<double, n> f{};
    std::array<double, n * n_variables> g{};
    std::array<double, n * n_variables * n_variables> H{};
    numbers(at.data(), f.data(), g.data(), H.data());
    std::array<T, n> rows;
    for (std::size_t k = 0; k < n; ++k) {
      T& r = rows[k] = T(f[k]);
      for (std::size_t i = 0; i < n_variables; ++i) {
        const double *const gi = &g[k * n_variables + i], *const Hi = &H[(k * n_variables + i) * n_variables];
        r.d += *gi * of[i].d, r.h += *gi * of[i].h, r.g += *gi * of[i].g;
        for (std::size_t j = 0; j < n_variables; ++j) r.h += Hi[j] * of[i].d * of[j].d;
      }
    }
    if constexpr (n == 1)
      return rows[0];
    else
      return rows;
  }
};

/// The joint of a function with 1 to n rows.
template <int n = 3>
std::unique_ptr<Lock> numeric_joint(const std::string& type, const Attachment& a, Mask mask, int rows,
                                    PhiNumbers numbers) {
  if constexpr (n > 1)
    if (rows < n) return numeric_joint<n - 1>(type, a, mask, rows, std::move(numbers));
  return std::make_unique<HostJoint<PhiLock<NumericPhi<n>>>>(type, a.name, a.p(), a.s(), mask,
                                                             NumericPhi<n>{std::move(numbers)});
}

/// A method of fixed steps without a history. The end of each step is put onto the constraints.
class HostIntegrator : public Integrator {
 public:
  /// Moves a state by h, s, except for its time.
  using Move = std::function<void(Dynamics&, State&, double h)>;
  HostIntegrator(std::string type, int order, Move move)
      : type_(std::move(type)), order_(order), move_(std::move(move)) {}
  IntegratorInfo info() const override { return {type_, order_, false, false, order_}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    State end = state;
    move_(dynamics, end, h);
    end.t = state.t + h;
    const ProjectReport landed = project_end_or_throw(dynamics, end, type_.c_str(), state.t, h);
    state = std::move(end);
    return {.h = h, .violation = landed.before, .violation_after = landed.after};
  }

 private:
  std::string type_;
  int order_;
  Move move_;
};

}  // namespace lockstep
