// SPDX-License-Identifier: BSD-3-Clause
// The minimum of a function of several numbers, by NLopt.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lockstep {

/// f(u) with all u from 0 to 1, and conditions c(u) <= 0.
struct Minimization {
  std::vector<double> start;
  std::size_t n_conditions = 0;
  std::string_view method;  ///< one of kMinimizers; "": sbplx without conditions, else cobyla
  double tolerance = 0;     ///< of u, and of conditions
  int most = 0;             ///< evaluations
  /// f, then each c. An exception ends the search, and is thrown again.
  std::function<std::vector<double>(std::span<const double> u)> evaluate;
};

inline constexpr std::string_view kMinimizers = "cobyla,sbplx,direct";

/// Why it ended. Throws FileError in a build without NLopt, UsageError for a method that takes no conditions.
std::string minimize(const Minimization&);

}  // namespace lockstep
