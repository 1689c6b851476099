// Copies: eight copies of one mechanism at once, a copy a vector lane: parameter studies, ensembles, differences.
//
// One evaluation serves all eight, with the same kernels on packs of eight numbers (framework/docs/solvers.md, section 3). Each
// copy has its own masses, markers, gravity, laws, forces, start, time and step.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/integrator.h>

namespace lockstep {

class Registry;

/// Instructions of the processor; `best` takes the widest that the machine has.
enum class Instructions { best, plain, fma, avx512 };

/// Method, tolerances and steps of a batch.
struct CopiesOptions {
  std::string integrator = "dop853";  ///< dop853, dopri5 (error control), rk4 (fixed step), or any with a scheme()
  Tolerance tolerance;                ///< where there is error control
  double step = 0;                    ///< fixed step: the step, s; else the first one, 0: the method's own guess
  double max_step = 0;                ///< s; 0: no limit
  Stabilization stabilization;        ///< project or none
  bool lanes = true;                  ///< false: every copy by the ordinary Dynamics and integrator, for comparison
  Instructions instructions = Instructions::best;  ///< others for comparison
  const Registry* registry = nullptr;              ///< that has the integrator; null: builtin_registry()
};

/// How a copy came through a run.
struct CopyReport {
  double t = 0;          ///< of its last accepted step, s
  long steps = 0;        ///< accepted
  long rejected = 0;     ///< thrown away
  bool finished = true;  ///< reached the last time
  bool alone = false;    ///< left the lanes on the way and was finished by the ordinary path
  std::string error;     ///< why it did not finish; "" if it did
};

/// Many copies of one mechanism that run at once, one per vector lane.
class LOCKSTEP_API Copies {
 public:
  static constexpr int kLanes = 8;

  /// Copies of one mechanism: equal bodies, links (type, mask, bodies, drives) and states; any number, eight at a time.
  /// Sets the systems up, which must outlive the copies. Throws ModelError naming the difference, or why the mechanism
  /// is not suited.
  explicit Copies(std::vector<System*> systems, CopiesOptions options = {});
  ~Copies();

  /// Why this mechanism cannot run in lanes, in words; "" if it can. Sets the system up.
  static std::string unsuited(System&);

  int size() const;  ///< copies
  const CopiesOptions& options() const;

  /// d/dt of q, v and s of every copy (size() states, each at its own time). False for a copy whose rows could not be
  /// met: ask the ordinary Dynamics what is the matter.
  std::vector<bool> rate(std::span<const State> states, std::span<StateRate> out);
  /// The states put on C = 0 and Jh v = -Ct, as by Dynamics::project. False where that did not converge.
  std::vector<bool> project(std::span<State> states);

  /// Called at each time, for copy after copy in any order, but for one copy in the order of the times.
  using Output = std::function<void(int copy, std::size_t time, const State&)>;
  /// From the starts (assembled; each may have its own t) through all `times` (ascending, s), on which every copy
  /// lands. A copy that fails does not stop the others; its report says why. Throws ModelError for wrong arguments.
  std::vector<CopyReport> run(std::span<const State> starts, std::span<const double> times, const Output& output);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lockstep
