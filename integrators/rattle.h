// rattle2, rattle4: symplectic and reversible on the constraints, for the energy of long runs (Andersen 1983).
//
//   p' = p + h/2 f(q0) - J(q0)^T mu,   q1 = drift(h, q0, p') with C(q1) = 0
//   p1 = p' + h/2 f(q1) - J(q1)^T nu   with J(q1) M^-1 p1 = -Ct
//
// Order 2; order 4 composed of five (Suzuki 1990). Bodies turn freely in the drift (FreeRotation).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "framework/dynamics/integrate/integrator.h"
#include "framework/mechanism/params/params.h"
#include "integrators/free_rotation.h"

namespace lockstep {

struct RattleScheme;

/// Fixed step; a substep costs one factor and 3 to 5 evaluations of the constraints. The energy swings about its start
/// and does not drift. Forces must not depend on velocities, and no state that is integrated along with the mechanism
/// may act on it: ModelError from begin(), with the name. Its multipliers are not found through singular positions:
/// StepError. Mere quadratures (State::s) follow the trapezoidal rule, order 2. No error estimate, no dense output.
class LOCKSTEP_API Rattle final : public Integrator {
 public:
  static TypeInfo type_info(int order);
  static std::unique_ptr<Integrator> make(int order);
  /// 2 or 4.
  explicit Rattle(int order);

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) override;
  void restore(const Snapshot&) override { ready_ = false; }

 private:
  struct Turning {
    int slot;
    FreeRotation rotation;
  };
  void refuse_unsuited(Dynamics&, const State&) const;
  void substep(Dynamics&, double h);
  const Evaluation& find_multipliers(Dynamics&, double h, double t);
  void drift(double h);
  const Evaluation& gather_next(Dynamics&);
  void kick(const Evaluation&, double h);
  bool goes_on_from(const State&) const;
  [[noreturn]] void fail(double h, double left) const;

  const RattleScheme& scheme_;
  std::vector<Turning> turning_;
  State now_, next_;     // before and after a drift
  VecX v_half_, guess_;  // velocities of the drift; what the last kick would do in 1 s
  VecX C_, Cd_, f_, d_, lambda_;
  StateRate rate0_, rate1_;
  std::optional<Factor> factor_;  // of the matrix at now_ once a kick was made
  double left_ = 0;               // |C| at now_, m
  bool ready_ = false;            // factor_ and guess_ are those of now_
};

}  // namespace lockstep
