#include "framework/dynamics/simulate/start_turns.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <lockstep/forces.h>
#include <lockstep/log.h>
#include <lockstep/relative.h>
#include "framework/dynamics/simulate/coordinate_row.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr double kNearlyHalf = kPi - 1e-6;  // rad: of an angle beyond, either half turn may be read off the poses
constexpr double kStage = 0.5 * kPi;        // rad: counters tell a way from its rest up to half a turn
constexpr double kMostTurns = 1e4;
constexpr double kDegrees = 180 / kPi;

double nearest_to(double about, double angle) { return angle + kTwoPi * std::round((about - angle) / kTwoPi); }

/// An angle that a start asks for.
struct AskedTurn {
  const Lock* link;
  Axis axis;
  double angle;  // rad
  bool driven;
  double now = 0;  // where the pair is on its way there, rad
  std::string name() const { return fmt::format("{}.{}", link->name(), to_string(axis)); }
};

/// The law's value at t of the drive about this axis; nothing without one, or where the link turns by another law, too.
std::optional<double> driven_angle(const Lock& link, double t, int axis) {
  const Jointed* joint = link.jointed();
  if (joint == nullptr || joint->imposed().turn) return {};
  for (const Drive& drive : joint->imposed().drives) {
    if (!is_rotation(drive.axis) || axis_index(drive.axis) % 3 != axis || drive.speed) continue;
    return named(link, t, [&] { return drive.law->at(t).y; });
  }
  return {};
}

bool is_active(const State& state, const Lock& link) { return state.modes[static_cast<std::size_t>(link.number())]; }

std::vector<AskedTurn> turns_of_drives(const System& system, const State& state) {
  constexpr Axis kAxes[] = {Axis::rx, Axis::ry, Axis::rz};
  std::vector<AskedTurn> asked;
  for (const auto& link : system.links()) {
    if (!is_active(state, *link)) continue;
    for (int k = 0; k < 3; ++k)
      if (const auto angle = driven_angle(*link, state.t, k); angle && std::isfinite(*angle))
        asked.push_back({link.get(), kAxes[k], *angle, true});
  }
  return asked;
}

// What is wrong with names and numbers is said by those who read them.
std::vector<AskedTurn> turns_asked(const System& system, const State& state, const AssemblyOptions& options) {
  std::vector<AskedTurn> asked = turns_of_drives(system, state);
  for (const CoordinateTarget& target : options.coordinates)
    for (const auto& link : system.links())
      if (link->name() == target.link && !link->pairs().empty() && is_rotation(target.axis) &&
          std::isfinite(target.value))
        asked.push_back({link.get(), target.axis, target.value, false});
  return asked;
}

void measure(Dynamics& dynamics, const State& state, std::vector<AskedTurn>& asked) {
  for (AskedTurn& turn : asked)
    turn.now = nearest_to(turn.now, coordinate_row(dynamics, state, turn.link->name(), turn.axis).value);
}

// Whether the other two turns are held.
bool has_one_axis(const AskedTurn& turn) {
  const Jointed* joint = turn.link->jointed();
  return joint != nullptr && includes(joint->rows() | row_of(turn.axis), Mask::e123);
}

/// The bodies on one side of a joint.
struct Side {
  std::vector<int> slots;
  double sign = 1;     // -1: that of S
  bool whole = false;  // all that hangs on it, by open chains; else one body of a loop
};

std::pair<int, int> slots_of(const Lock& link) {
  const auto [p, s] = link.pairs().front();
  return {MarkerFrame(*p).slot, MarkerFrame(*s).slot};
}

// The bodies that `first` carries when it turns against `other`; none where it is ground or part of a loop.
std::vector<int> carried(const System& system, const State& state, int first, int other) {
  if (first == kGround) return {};
  std::vector<int> slots{first};
  for (std::size_t i = 0; i < slots.size(); ++i)
    for (const auto& each : system.links()) {
      if (!is_active(state, *each) || each->unilateral() || each->pairs().size() != 1) continue;
      auto [a, b] = slots_of(*each);
      if (b == slots[i]) std::swap(a, b);
      if (a != slots[i] || a == b) continue;
      if (a == first && b == other) continue;  // the joint, and what else is between its two bodies
      if (b == kGround || b == other) return {};
      if (std::ranges::find(slots, b) == slots.end()) slots.push_back(b);
    }
  return slots;
}

Side side_of(const System& system, const State& state, const Lock& link) {
  const auto [p, s] = slots_of(link);
  if (std::vector<int> slots = carried(system, state, p, s); !slots.empty()) return {std::move(slots), 1, true};
  if (std::vector<int> slots = carried(system, state, s, p); !slots.empty()) return {std::move(slots), -1, true};
  return p != kGround ? Side{{p}, 1, false} : Side{{s}, -1, false};
}

// Turns P against S about an axis of S, through the origin of P.
void turn(Dynamics& dynamics, State& state, const AskedTurn& asked, const Side& side, double angle) {
  const auto [p, s] = asked.link->pairs().front();
  const Inputs& in = dynamics.inputs(state);
  const Vec3 axis = in_world(MarkerFrame(*s), in).A.col(axis_index(asked.axis) % 3),
             pivot = in_world(MarkerFrame(*p), in).x;
  const Quat by = exponential(Vec3(side.sign * angle * axis));
  const Mat3 A = rotation(by);
  for (const int slot : side.slots) {
    Pose pose = state.slot_pose(slot);
    pose.x = pivot + A * Vec3(pose.x - pivot);
    pose.q = normalized(by * pose.q);
    state.set_slot_pose(slot, pose);
  }
}

bool is_asked_beyond(const std::vector<AskedTurn>& asked) {
  double sum = 0;
  for (const AskedTurn& turn : asked) {
    if (std::abs(turn.angle) > kNearlyHalf) return true;
    sum += std::abs(turn.angle - turn.now);
  }
  return sum > kNearlyHalf;
}

// Says so where an angle that is asked for cannot be led to.
void drop_unled(std::vector<AskedTurn>& asked) {
  std::erase_if(asked, [](const AskedTurn& turn) {
    const bool free = !has_one_axis(turn), far = std::abs(turn.angle - turn.now) > kMostTurns * kTwoPi;
    if ((free || far) && std::abs(turn.angle) > kPi + 1e-6)
      log_warning(fmt::format(
          "start by {}: {:.9g} deg is asked for and {:.9g} deg taken by what counts its turns: {}", turn.name(),
          kDegrees * turn.angle, kDegrees * nearest_to(0, turn.angle),
          free ? "P turns about other axes of S, too, so that its turns about one have no number; ask for an angle "
                 "within half a turn"
               : fmt::format("it is beyond {:.0f} turns; take whole turns off it", kMostTurns)));
    return free || far;
  });
}

void lead(Dynamics& dynamics, State& state, std::vector<AskedTurn>& asked) {
  constexpr int kPasses = 2;  // a body of a loop that turns alone takes the next joint's angle along
  for (int pass = 0; pass < kPasses; ++pass)
    for (AskedTurn& to : asked) {
      const Side side = side_of(dynamics.system(), state, *to.link);
      for (int left = static_cast<int>(std::ceil(std::abs(to.angle - to.now) / kStage)); left > 0; --left) {
        turn(dynamics, state, to, side, (to.angle - to.now) / left);
        follow_turns(dynamics, state);
        measure(dynamics, state, asked);
      }
    }
}

}  // namespace

bool begin_turns(Dynamics& dynamics, State& state, const AssemblyOptions& options) {
  const System& system = dynamics.system();
  std::vector<AskedTurn> asked = turns_asked(system, state, options);
  if (asked.empty()) return false;
  State home = system.start();
  if (state.z != home.z) return false;
  home.t = state.t, home.modes = state.modes;
  measure(dynamics, home, asked);
  if (!is_asked_beyond(asked)) return false;
  drop_unled(asked);
  if (system.n_memory() == 0) return false;
  home.v.setZero();
  lead(dynamics, home, asked);
  state.z = home.z;
  return true;
}

void follow_turns(Dynamics& dynamics, State& state) {
  if (state.z.size() == 0) return;
  const Inputs& in = dynamics.inputs(state);
  const auto accept = [&](const auto& owner) {
    const Remembering& own = *owner.remembering();
    named(owner, in.t, [&] {
      own.accept_step(in, {state.z.data() + owner.first_memory(), static_cast<std::size_t>(own.n_memory())});
    });
  };
  for (const auto& link : dynamics.system().links())
    if (link->remembering() != nullptr && link->remembering()->counts_turns_alone()) accept(*link);
  for (const auto& force : dynamics.system().forces())
    if (force->remembering() != nullptr) accept(*force);
}

void keep_led_turns(const System& system, const VecX& home, const VecX& led, State& state) {
  const auto keep = [&](const auto& owner) {
    const int first = owner.first_memory(), n = owner.n_own_memory();
    if (n > 0 && std::abs(led[first] - home[first]) > kPi) state.z.segment(first, n) = led.segment(first, n);
  };
  for (const auto& link : system.links())
    if (link->unilateral() != nullptr) keep(*link);
  for (const auto& force : system.forces()) keep(*force);
}

bool has_counting_links(const System& system) {
  return std::ranges::any_of(system.links(), [](const auto& link) {
    return link->remembering() != nullptr && link->remembering()->counts_turns_alone();
  });
}

bool turn_to_drives(Dynamics& dynamics, State& state) {
  bool any = false;
  std::vector<AskedTurn> asked = turns_of_drives(dynamics.system(), state);
  measure(dynamics, state, asked);
  for (AskedTurn& to : asked) {
    const double way = nearest_to(0, to.angle - to.now);
    if (!(std::abs(way) > kStage)) continue;
    any = true;
    if (const Side side = side_of(dynamics.system(), state, *to.link); side.whole) turn(dynamics, state, to, side, way);
  }
  return any;
}

std::string farthest_drive(Dynamics& dynamics, const State& state) {
  std::vector<AskedTurn> asked = turns_of_drives(dynamics.system(), state);
  measure(dynamics, state, asked);
  const AskedTurn* farthest = nullptr;
  double most = kStage;
  for (const AskedTurn& turn : asked)
    if (const double way = std::abs(nearest_to(0, turn.angle - turn.now)); way > most) most = way, farthest = &turn;
  if (farthest == nullptr) return "";
  return fmt::format(
      " (drive {} of link '{}' begins at {:.6g} deg, {:.6g} deg from the poses given: put its bodies there)",
      to_string(farthest->axis), farthest->link->name(), kDegrees * farthest->angle, kDegrees * most);
}

std::optional<double> known_turn(const System& system, const State& state, const Lock& link, int axis) {
  if (link.pairs().empty()) return {};
  if (is_active(state, link))
    if (const auto angle = driven_angle(link, state.t, axis)) return angle;
  if (axis != 2) return {};
  const auto pair = link.pairs().front();
  for (const auto& each : system.links()) {  // three numbers for each pair
    const Remembering* own = each->remembering();
    const auto pairs = each->pairs();
    if (own == nullptr || !own->counts_turns_alone() || own->n_memory() != 3 * static_cast<int>(pairs.size())) continue;
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (pairs[k] == pair) return state.z[each->first_memory() + 3 * static_cast<int>(k)];
  }
  for (const auto& force : system.forces()) {
    const auto* spring = dynamic_cast<const TorsionSpringDamper*>(force.get());
    if (spring != nullptr && &spring->p() == pair.first && spring->s() == pair.second &&
        state.z[spring->first_memory() + 3] != 0)
      return state.z[spring->first_memory()];
  }
  return {};
}

}  // namespace lockstep
