// Explicit Runge-Kutta methods as data: Integrator::scheme().
#pragma once

#include <array>
#include <cstddef>

#include "framework/foundation/support/export.h"

namespace lockstep {

/// Coefficients of a method; the arrays live as long as the program.
struct Tableau {
  int order = 1;
  int n_stages = 1;           ///< of a step
  int n_all = 1;              ///< with those that only dense output needs
  int stride = 1;             ///< numbers in a row of `a`
  const double* a = nullptr;  ///< n_all rows, those above the diagonal are not read
  const double* b = nullptr;
  const double* c = nullptr;
};

/// The weights of a combination of stages that are not zero.
struct LOCKSTEP_API Weights {
  static constexpr int kMost = 16;
  std::size_t n = 0;
  std::array<std::size_t, kMost> stage{};
  std::array<double, kMost> w{};

  Weights() = default;
  Weights(const double* all, int n_all);
};

/// The numbers of an explicit method, embedded or with a fixed step; the arrays live as long as the program.
struct EmbeddedScheme {
  const char* name = "";
  Tableau tableau;  ///< its stage `end_stage` is the rate at the end of the step
  int end_stage = 0;
  int late_stage = 0;              ///< another one at c = 1
  double stability = 0;            ///< h |lambda| at the end of its interval of stability on the negative axis
  const double* error = nullptr;   ///< error = h sum e_i k_i; null: fixed step, none of the others count
  const double* second = nullptr;  ///< a second, coarser one, or null: then error e5^2 / sqrt(e5^2 + 0.01 e3^2)
  int n_dense = 0;                 ///< polynomials of the dense output beyond the cubic ones: h sum d_i k_i
  const double* d = nullptr;       ///< n_dense rows of tableau.n_all
};

}  // namespace lockstep
