// SPDX-License-Identifier: BSD-3-Clause
// Copies: a vectorised batch, eight instances of one mechanism at once: parameter studies, ensembles, differences.
//
// One evaluation computes all eight, on packs of eight numbers (framework/docs/solvers.md, section 3). Each instance
// has its own masses, markers, gravity, laws, forces, start, time and step.
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
  best,   ///< the widest of the machine
  plain,  ///< the baseline of the architecture
  fma,    ///< AVX with FMA
  avx512  ///< AVX-512
};

/// Method, tolerances and steps of a batch.
struct CopiesOptions {
  std::string integrator = "dop853";  ///< dop853, dopri5 (error control), rk4 (fixed step), or any with a scheme()
  Tolerance tolerance;                ///< for error control
  double step = 0;                    ///< fixed step: the step, s; else the first step; 0: the guess of the method
  double max_step = 0;          ///< s; 0: no limit
  long max_steps = 0;           ///< steps of one instance, after which it fails; 0: only the limit of StepLoop
  Stabilization stabilization;  ///< project or none
  /// A batch uses joint coordinates. automatic: not for mechanisms that lose digits in them (slender bodies), which are
  /// not vectorised; joint: for those, too.
  Formulation formulation = Formulation::automatic;
  bool lanes = true;  ///< false: every instance by the ordinary Dynamics and integrator, for comparison
  Instructions instructions = Instructions::best;  ///< others are for comparison
  const Registry* registry = nullptr;              ///< registry of the integrator; null: builtin_registry()
};

/// Report of the run of one instance.
struct CopyReport {
  double t = 0;          ///< time that it reached, s
  long steps = 0;        ///< accepted steps
  long rejected = 0;     ///< rejected attempts
  bool finished = true;  ///< whether it reached the last time
  bool alone = false;    ///< whether it ran, from some time on, by the ordinary Dynamics and integrator
  UnmetTolerance unmet;  ///< of the steps made alone; in the batch every step meets the tolerance
  std::string error;     ///< why it did not finish; "" if it did
};

/// Many instances of one mechanism that run at once, in vectorised batches.
class LOCKSTEP_API Copies {
 public:
  static constexpr int kLanes = 8;  ///< instances in one evaluation

  /// Instances of one mechanism: equal bodies, joints (type, mask, bodies, drives) and integrated states; any number,
  /// eight at a time. The systems are set up and must outlive the batch. Throws ModelError with the difference between
  /// two of them, with the reason why the mechanism cannot be vectorised, or for wrong options.
  explicit Copies(std::vector<System*> systems, CopiesOptions options = {});
  ~Copies();

  /// Why this mechanism cannot be vectorised, in words; "" if it can. The system is set up. `formulation`: as in the
  /// options.
  static std::string unsuited(System&, Formulation formulation = Formulation::automatic);

  int size() const;                      ///< number of instances
  const CopiesOptions& options() const;  ///< as given

  /// Receives the state of an instance (its number, from 0) at one of the times (its number, from 0), in body
  /// coordinates: the instances in any order, the times of one instance in ascending order.
  using Output = std::function<void(int copy, std::size_t time, const State&)>;
  /// Receives the state of an instance (its number, from 0), in body coordinates, after each of its steps, before an
  /// output at the same time; at the jump of a law once more after the jump, `jumped`.
  using Step = std::function<void(int copy, const State&, bool jumped)>;
  /// Called repeatedly with the time that all instances of a batch have reached, s; false stops all of them.
  using GoOn = std::function<bool(double t)>;
  /// Runs all instances from their starts (assembled, in body coordinates; each may have its own t) through all `times`
  /// (ascending, s), on which their steps end. An instance that fails does not stop the others; its report gives the
  /// reason. It fails if its start violates the constraints by more than 1e-6 m, or if it needs too many steps
  /// (StepLoopOptions::max_steps). `step`: called for every step, as counters of revolutions need it. Throws ModelError
  /// for wrong arguments, and what these functions throw.
  std::vector<CopyReport> run(std::span<const State> starts, std::span<const double> times, const Output& output,
                              const Step& step = {}, const GoOn& go_on = {});

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lockstep
