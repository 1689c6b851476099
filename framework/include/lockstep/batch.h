// SPDX-License-Identifier: BSD-3-Clause
// Copies: eight copies of one mechanism at once, one per vector lane: parameter studies, ensembles, differences.
//
// One evaluation serves all eight, on packs of eight numbers (framework/docs/solvers.md, section 3). Each copy has its
// own masses, markers, gravity, laws, forces, start, time and step.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lockstep/author/integrator.h>
#include <lockstep/dynamics_options.h>
#include <lockstep/system.h>

namespace lockstep {

class Registry;

/// Vector instructions of the processor.
enum class Instructions {
  best,   ///< the widest that the machine has
  plain,  ///< the baseline of the architecture
  fma,    ///< AVX with FMA
  avx512  ///< AVX-512
};

/// Method, tolerances and steps of a batch.
struct CopiesOptions {
  std::string integrator = "dop853";  ///< dop853, dopri5 (error control), rk4 (fixed step), or any with a scheme()
  Tolerance tolerance;                ///< where there is error control
  double step = 0;              ///< fixed step: the step, s; else the first one in lanes, 0: the method's own guess
  double max_step = 0;          ///< s; 0: no limit
  long max_steps = 0;           ///< steps of one copy, after which it fails; 0: no limit but that of StepLoop
  Stabilization stabilization;  ///< project or none
  /// Lanes run in joint coordinates. automatic: but for mechanisms that lose digits there (slender bodies), which have no
  /// lanes; joint: those, too.
  Formulation formulation = Formulation::automatic;
  bool lanes = true;  ///< false: every copy by the ordinary Dynamics and integrator, for comparison
  Instructions instructions = Instructions::best;  ///< others are for comparison
  const Registry* registry = nullptr;              ///< where the integrator is; null: builtin_registry()
};

/// How the run of one copy ended.
struct CopyReport {
  double t = 0;          ///< time that it reached, s
  long steps = 0;        ///< accepted steps
  long rejected = 0;     ///< rejected attempts
  bool finished = true;  ///< whether it reached the last time
  bool alone = false;    ///< whether it ran, from some instant on, by the ordinary Dynamics and integrator
  UnmetTolerance unmet;  ///< of the steps that it made alone; in lanes every step meets the tolerance
  std::string error;     ///< why it did not finish; "" if it did
};

/// Many copies of one mechanism that run at once, one per vector lane.
class LOCKSTEP_API Copies {
 public:
  static constexpr int kLanes = 8;  ///< copies that one evaluation serves

  /// Copies of one mechanism: equal bodies, links (type, mask, bodies, drives) and integrated states; any number, eight
  /// at a time. The systems are set up and must outlive the copies. Throws ModelError with the difference between two
  /// of them, with the reason why the mechanism cannot run in lanes, or for wrong options.
  explicit Copies(std::vector<System*> systems, CopiesOptions options = {});
  ~Copies();

  /// Why this mechanism cannot run in lanes, in words; "" if it can. The system is set up. `formulation`: as that of the
  /// options.
  static std::string unsuited(System&, Formulation formulation = Formulation::automatic);

  int size() const;                      ///< number of copies
  const CopiesOptions& options() const;  ///< as given

  /// Receives the state of a copy (its number, from 0) at one of the times (its number, from 0), in the slots' own
  /// coordinates: the copies in any order, the times of one copy in theirs.
  using Output = std::function<void(int copy, std::size_t time, const State&)>;
  /// Receives the state of a copy (its number, from 0), in the slots' own coordinates, after each of its steps, before
  /// what is told of the same instant as an output; where the jump of a law acts there, once more behind it, `jumped`.
  using Step = std::function<void(int copy, const State&, bool jumped)>;
  /// Asked again and again, with the time that all copies of eight have reached, s; false breaks all of them off.
  using GoOn = std::function<bool(double t)>;
  /// Runs all copies from their starts (assembled, in the slots' own coordinates; each may have its own t) through all
  /// `times` (ascending, s), on which their steps end. A copy that fails does not stop the others; its report says why.
  /// One whose start violates the constraints by more than 1e-6 m fails, as one whose steps become too many does
  /// (StepLoopOptions::max_steps). `step`: who follows every step, as what counts turns does. Throws ModelError for wrong
  /// arguments, and what these functions throw.
  std::vector<CopyReport> run(std::span<const State> starts, std::span<const double> times, const Output& output,
                              const Step& step = {}, const GoOn& go_on = {});

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lockstep
