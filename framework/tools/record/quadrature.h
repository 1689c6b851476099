// SPDX-License-Identifier: BSD-3-Clause
// Quadrature: a number that is integrated along with the motion, such as the work of a drive.
#pragma once

#include <functional>
#include <string>

#include <lockstep/detail/rows.h>
#include <lockstep/system.h>

namespace lockstep {

/// What the rate of a quadrature is made of. Impulses add to powers of laws as forces do.
enum class Integrand {
  motion,  ///< no solution
  drive,   ///< lambda . Ct over some rows of links
  laws     ///< Evaluated::law_power
};

class LOCKSTEP_API Quadrature final : public Auxiliary {
 public:
  Quadrature(std::string name, std::function<double(const Evaluated&)> rate, Integrand of = Integrand::motion)
      : Auxiliary(std::move(name)), rate_(std::move(rate)), of_(of) {}
  int size() const override { return 1; }
  bool reads_solution() const override { return of_ != Integrand::motion; }
  bool vanishes_without_laws() const override { return of_ != Integrand::motion; }
  bool reads_law_power_alone() const override { return of_ == Integrand::laws; }
  bool controls_error() const override { return false; }  // what is only recorded must not change the run
  void rates(const Evaluated& values, std::span<double> sd) const override { sd[0] = rate_(values); }
  void impact(const Evaluated& impulses, std::span<double> s) const override {
    if (of_ != Integrand::motion) s[0] += rate_(impulses);
  }
  double value(const State& s) const { return s.s[first()]; }

 private:
  std::function<double(const Evaluated&)> rate_;
  Integrand of_;
};

/// The system's quadrature of that name, added if it does not exist. Throws ModelError if another state has the name.
LOCKSTEP_API const Quadrature& quadrature(System&, const std::string& name,
                                          const std::function<double(const Evaluated&)>& rate,
                                          Integrand of = Integrand::motion);

}  // namespace lockstep
