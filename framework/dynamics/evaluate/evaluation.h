// Evaluation: a mechanism at one state: motions of the bodies, rows of the links, applied forces.
#pragma once

#include <memory>
#include <vector>

#include "framework/mechanism/system/system.h"

namespace lockstep {

/// Inputs together with the memory behind them. `s` and `z` are views of the state that was read.
class LOCKSTEP_API StateInputs {
 public:
  /// What links and forces see of this state; valid until the next call.
  const Inputs& at(const System&, const State&);
  const Inputs& get() const { return in_; }

 private:
  std::vector<Motion> motions_;
  Inputs in_;
};

/// Rows and forces, gathered at a state: there is none without. Neither solved nor factored (Factor). Vectors have 6
/// numbers per slot (m and rad, or N in the world and N m in slot axes) or 1 per row of rows().
class LOCKSTEP_API Evaluation {
 public:
  /// Gathers at this state; the system is set up if it was not. Throws what the code of links and forces throws, named,
  /// and ModelError where the state does not fit the system.
  Evaluation(System&, const State&);
  Evaluation(const Evaluation&) = delete;
  Evaluation& operator=(const Evaluation&) = delete;

  /// The same at another state. Lays out anew when the description or the links in force changed; otherwise nothing is
  /// allocated.
  void at(const State&);
  /// Throws NonFiniteError that names who made a number that is not finite.
  void check() const;

  const System& system() const { return system_; }
  const Inputs& inputs() const { return inputs_.get(); }
  const RowTable& rows() const { return rows_; }
  /// Gravity, -w x J w and all applied forces but what depends on reactions.
  const VecX& force() const { return f_; }

  /// C and Jh v + Ct, 1 per row.
  void residuals(VecX& C, VecX& Cd) const;
  /// Jh v + Ct at other velocities than the state's: the positions are those gathered. v: 6 per slot.
  void velocity_residual(const VecX& v, VecX& Cd) const;
  /// The largest |c| as a length (framework/docs/solvers.md): metres, radians times System::length(), half turns times twice that.
  /// NaN if one is.
  double norm(const VecX& c) const;

  /// Forces that depend on the present reactions (friction), and what they add to f at these multipliers.
  const std::vector<const Force*>& reacting() const { return reacting_; }
  void react(const VecX& lambda, VecX& f) const;

  /// What was laid out: a factor of the same layout serves this evaluation too.
  struct Layout {
    long revision = -1;       ///< of the system
    std::vector<bool> modes;  ///< links in force
    bool operator==(const Layout&) const = default;
  };
  const std::shared_ptr<const Layout>& layout() const { return layout_; }
  /// Whether at() would lay out nothing anew.
  bool covers(const State&) const;

 private:
  void lay_out(const State&);

  System& system_;
  std::shared_ptr<const Layout> layout_;
  StateInputs inputs_;
  RowTable rows_;
  VecX f_;
  std::vector<const Force*> reacting_;
};

}  // namespace lockstep
