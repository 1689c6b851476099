// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/minimize.h"

#include <algorithm>
#include <exception>

#include <lockstep/error.h>
#include "framework/tools/program/commands.h"

#if LOCKSTEP_NLOPT
#include <nlopt.h>

#include <memory>
#endif

namespace lockstep {

#if LOCKSTEP_NLOPT

namespace {

/// What NLopt calls. It asks for f and for the conditions one after the other, each once at a point.
struct Called {
  const Minimization& of;
  nlopt_opt nlopt;
  std::vector<double> u{}, values{};
  std::exception_ptr error{};

  const std::vector<double>& at(const double* point) {
    const std::span<const double> asked(point, of.start.size());
    if (error || (!values.empty() && std::ranges::equal(asked, u))) return values;
    u.assign(asked.begin(), asked.end());
    try {
      values = of.evaluate(u);
    } catch (...) {
      error = std::current_exception();
      nlopt_force_stop(nlopt);
    }
    values.resize(1 + of.n_conditions);
    return values;
  }
};

double objective(unsigned, const double* u, double*, void* called) { return static_cast<Called*>(called)->at(u)[0]; }
void conditions(unsigned m, double* c, unsigned, const double* u, double*, void* called) {
  std::copy_n(static_cast<Called*>(called)->at(u).begin() + 1, m, c);
}

nlopt_algorithm algorithm_of(const Minimization& m) {
  if (m.method == "direct") return NLOPT_GN_ORIG_DIRECT_L;
  return m.method == "cobyla" || (m.method.empty() && m.n_conditions > 0) ? NLOPT_LN_COBYLA : NLOPT_LN_SBPLX;
}

}  // namespace

std::string minimize(const Minimization& m) {
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> nlopt(
      nlopt_create(algorithm_of(m), static_cast<unsigned>(m.start.size())), nlopt_destroy);
  if (!nlopt) throw std::bad_alloc();
  Called called{m, nlopt.get()};
  nlopt_set_lower_bounds1(nlopt.get(), 0);
  nlopt_set_upper_bounds1(nlopt.get(), 1);
  nlopt_set_xtol_abs1(nlopt.get(), m.tolerance);
  nlopt_set_maxeval(nlopt.get(), m.most);
  nlopt_set_min_objective(nlopt.get(), objective, &called);
  const std::vector<double> slack(m.n_conditions, m.tolerance);
  if (m.n_conditions > 0 && nlopt_add_inequality_mconstraint(nlopt.get(), static_cast<unsigned>(m.n_conditions),
                                                             conditions, &called, slack.data()) != NLOPT_SUCCESS)
    throw UsageError("--method: " + std::string(m.method) + " takes no conditions; use cobyla or direct");
  std::vector<double> u = m.start;
  double least = 0;
  const nlopt_result why = nlopt_optimize(nlopt.get(), u.data(), &least);
  if (called.error) std::rethrow_exception(called.error);
  if (why == NLOPT_MAXEVAL_REACHED) return "the number of runs was reached (--runs)";
  return why > 0 || why == NLOPT_ROUNDOFF_LIMITED ? "converged" : "the method failed";
}

#else

std::string minimize(const Minimization&) {
  throw FileError(
      "the library NLopt was missing when lockstep was built; install it (Debian: libnlopt-dev), configure and build "
      "again");
}

#endif

}  // namespace lockstep
