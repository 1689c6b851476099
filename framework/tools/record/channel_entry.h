// SPDX-License-Identifier: BSD-3-Clause
// What the channel_*.cpp files provide for the lookup by name. Private to the room.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include "framework/mechanism/system/coordinate_names.h"
#include "framework/tools/record/frame.h"
#include "framework/tools/record/quadrature.h"

namespace lockstep::channels {

inline constexpr const char* kAxisName[3] = {"x", "y", "z"};

/// A quantity of one object: its name without the object's, and how its channel is made.
struct Entry {
  std::string name, unit, help;
  std::function<void(System&, Channel&)> make;  ///< sets value, track, restart
};
/// The quantities of one object; with a name, that one alone.
struct Entries : std::vector<Entry> {
  std::string_view only{};
  bool takes(std::string_view name) const { return only.empty() || name == only; }
};
using Value = std::function<double(const Sample&)>;

void add(Entries&, std::string name, std::string unit, std::string help, Value value);
/// Three channels: name + "x", "y", "z".
void add_vector(Entries&, const std::string& name, const std::string& unit, const std::string& help,
                std::function<Vec3(const Sample&)> value);

/// An angle with revolutions, counted by the system that `count` adds it to. A warning reports a doubtful count once.
void add_angle(Entries&, std::string name, std::string help, std::function<const CountedAngle&(System&)> count);
/// The time integral of `rate` along the motion: the system's quadrature `id`, which all channels of that id share.
void add_integral(Entries&, std::string name, std::string unit, std::string help, std::string id,
                  std::function<double(const Evaluated&)> rate, Integrand of = Integrand::motion);

/// A coordinate of m relative to n, its rate or second rate.
void add_coordinate(Entries&, const NamedCoordinate&, const Frame& m, const Frame& n);

/// A part of a link that exerts forces: the joint itself, all its drives, one of them.
struct ReactionPart {
  std::string prefix,  ///< of its channels: "", "drive.", "drive_rz."
      by;              ///< "the joint", "its drive"
  int part;            ///< Reactions::Part
};
LOCKSTEP_API std::vector<ReactionPart> parts_of(const Lock&);

/// A vector of what a part exerts at the markers of the link's first pair.
struct LOCKSTEP_API ReactionVector {
  const char *name, *unit, *help;
  bool on_p, force, world;  ///< else: on s, the moment, S axes
  Vec3 of(const LinkWrench&, const Marker& s, const Inputs&) const;
};
inline constexpr ReactionVector kReactionVectors[] = {
    {"force_on_p_world_", "N", "force on p's body at P by {}, world axes", true, true, true},
    {"force_on_p_link_", "N", "force on p's body at P by {}, S axes", true, true, false},
    {"torque_on_p_world_", "N m", "torque on p's body about P by {}, world axes", true, false, true},
    {"torque_on_p_link_", "N m", "torque on p's body about P by {}, S axes", true, false, false},
    {"force_on_s_world_", "N", "force on s's body at S by {}, world axes", false, true, true},
    {"torque_on_s_world_", "N m", "torque on s's body about S by {}, world axes", false, false, true}};
/// Power that a part puts in by these multipliers, 1 per row, W.
LOCKSTEP_API double power_of_part(const Lock&, int part, const RowTable&, const VecX& lambda);

/// The quantities of one object each.
void of_frame(const Frame&, Entries&);
void of_body(const Body&, Entries&);
void of_pair(const Frame& m, const Frame& n, Entries&);
void of_link(const System&, const Lock&, Entries&);
void of_reactions(const Lock&, Entries&);
void of_force(const Force&, Entries&);
void of_totals(Entries&);
void of_run(Entries&);

/// The owner of a channel, "body" and "crank": the object with the longest name that begins the channel's; "" of none.
LOCKSTEP_API std::pair<std::string, std::string> owner_of(const std::string& channel, const System&);
/// The rows of a link in the table; null while it is not active.
LOCKSTEP_API const RowEntry* entry_of(const Lock&, const RowTable&);
/// Quantities that an object reports itself: value(k, sample). `owner`: "spring force".
template <class F>
void add_own(Entries& out, const std::vector<Quantity>& own, const std::string& owner, F value) {
  for (int k = 0; k < static_cast<int>(own.size()); ++k)
    add(out, own[k].name, own[k].unit, own[k].help.empty() ? "quantity of a " + owner : own[k].help,
        [value, k](const Sample& s) { return value(k, s); });
}
/// Residuals C of the rows of some entries, in the system's norm, m.
double violation(const Evaluation&, std::span<const RowEntry>, VecX& scratch);
/// Of the constraints of an active joint that are left out as nearly redundant: the largest, in m.
double left_out_violation(const Lock&, const Sample&, RowTable& room);

/// What a formula of channels remembers.
class FormulaMemory : public Observer {
 public:
  /// Appends numbers; if one changes its sign, the formula may have a kink, a jump or a pole, or no value any more.
  virtual void edges(const Sample&, std::vector<double>& out) = 0;
  /// Whether its functions of the motion are those of the motion between the states that were looked at.
  virtual bool is_resolved() const = 0;
};
/// The channel of a formula of channels. `margin`: of a condition, by how much it holds, in the unit of what it compares:
/// b - a of "=a < b"; of other conditions 1 or -1.
LOCKSTEP_API Channel computed_channel(System&, const std::string& formula, bool margin = false);

/// Power that a force gives to the bodies, W, with the load by these reactions if they are given.
double power_of(const Force&, const Inputs&, const Reactions*, VecX& scratch);
/// Power taken out by the damping and friction of a force, W.
LOCKSTEP_API double loss(const Force&, const Evaluated&);

}  // namespace lockstep::channels
