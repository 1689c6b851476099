// SPDX-License-Identifier: BSD-3-Clause
// Checks that a run can continue from a state, and corrections so that it can. Internal to the step loop; limits in m
// and m/s.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>

namespace lockstep {

/// C and Jh v + Ct of the rows of an evaluation.
struct Residuals {
  explicit Residuals(const Evaluation& at) { at.residuals(C, Cd); }
  bool operator==(const Residuals&) const = default;
  VecX C, Cd;
};
/// Names of the three rows with the largest sizes, with these.
std::string worst_rows(const Evaluation&, const VecX& sizes);
/// Throws AssemblyError for a row whose gradient vanishes here, as that of a distance to the centre of a curve: the
/// direction of motion of its bodies is undefined.
void check_gradients(const Evaluation&);
/// Of a joint that holds one rotation alone: what is left of its constraint, 0 where it is folded by 180 deg about an axis
/// normal to that of the rotation; 1 of other joints.
LOCKSTEP_API double unfolded(const Lock&, const Inputs&);
/// How far each row is from being met, m: its residual C as Evaluation::norm counts it, or |C| / |grad C|, the distance to
/// the nearest pose that meets it, if that is more. A function with a small gradient is off by far more than its value.
/// Rotations are as they are, since 180 deg has no gradient. C: one number a row, of this evaluation.
VecX start_distances(const Evaluation&, const VecX& C);
/// The largest of them; NaN if one is.
double start_distance(const Evaluation&, const VecX& C);
/// Throws AssemblyError, naming the row that is violated most, if a start violates the constraints.
LOCKSTEP_API void check_start(Dynamics&, const State&, double limit);
/// Throws AssemblyError, naming `cause` and the rows that are violated most, if velocities violate the constraints by
/// `left`, more than the limit. `advice`: what else may be done.
void check_velocities(Dynamics&, const State&, double left, double limit, const std::string& cause,
                      const char* advice = "");
/// Initialises the own states of links that are activated: a driven speed starts from the present coordinate.
void engage_links(Dynamics&, State&, const std::vector<std::string>& links);
/// Throws AssemblyError, naming `cause`, unless the constraints of these links already hold.
void check_links(Dynamics&, const State&, const std::vector<std::string>& links, const std::string& cause,
                 double limit);
/// Projects positions onto the constraints if the stabilisation does so (throws AssemblyError if they are off by more
/// than the limit), and always velocities: an inelastic impact. Then updates the memory.
LOCKSTEP_API void make_consistent(Dynamics&, State&, const std::string& cause, double limit);

/// The time before the jump of a law at `jump` at which a step ends, so that no stage sees its far side, s; `span`: of the
/// run. Wider than the part of its own duration by which a law may count a time as the jump (motionlaws/side.h), for
/// laws up to a hundred times as long as the run.
LOCKSTEP_API double before_jump(double jump, double span);
/// Crosses what is left to t with the rates now, in the slots' own coordinates. `rate`: scratch.
LOCKSTEP_API void cross_rest(Dynamics&, State&, double t, StateRate& rate);

/// Whether rows change at an instant at which time crosses the jump of a law, or an input that laws read was set: then the
/// law jumps in position.
class LOCKSTEP_API PositionJump {
 public:
  struct Prescribed {  ///< the coordinate of a drive
    const Lock* link;
    std::string name, unit;  ///< "drive A.rz"
    double y, yd;            ///< of a drive of a speed yd alone
  };
  /// Before the jump.
  PositionJump(Dynamics&, const State&);
  /// After it, at the same state: whether it changes a row's residual, or its rate, by any number.
  bool changes_rows(Dynamics&, const State&) const;
  /// After it: what jumps, "the jump of drive A.rz in speed, an impact ...", "the jump of a law".
  std::string cause(const System&, const State&) const;
  /// After it: why no motion follows, naming the drive or joint that jumped most, if one did by more than the limit.
  std::optional<AssemblyError> refusal(Dynamics&, const State&, double limit) const;

 private:
  Residuals before_;
  std::vector<Prescribed> prescribed_;
};

}  // namespace lockstep
