#include "framework/dynamics/simulate/start_turns.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <lockstep/log.h>
#include <lockstep/relative.h>
#include "framework/dynamics/simulate/coordinate_row.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr double kNearlyHalf = kPi - 1e-6;  // rad: of an angle beyond, either half turn may be read off the poses
constexpr double kStage = 0.5 * kPi;        // rad: counters tell a way from its rest up to half a turn
constexpr double kReached = 1e-9;           // rad
constexpr double kMostTurns = 1e4;
constexpr double kDegrees = 180 / kPi;
constexpr Axis kAxes[] = {Axis::rx, Axis::ry, Axis::rz};

double nearest_to(double about, double angle) { return angle + kTwoPi * std::round((about - angle) / kTwoPi); }

/// An angle that a start asks for.
struct AskedTurn {
  const Lock* link;
  Axis axis;
  double angle;  // rad
  bool driven;
  double now = 0;  // where the pair is on its way there, rad
  double way() const { return angle - now; }
  std::string name() const {
    return driven ? fmt::format("drive {} of link '{}'", to_string(axis), link->name())
                  : fmt::format("start by {}.{}", link->name(), to_string(axis));
  }
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
    turn.now = nearest_to(turn.now, coordinate_value(dynamics, state, *turn.link, turn.axis));
}

double expected(const CountedAngle& angle, const State& state) {
  return angle.expected({state.s.data(), static_cast<std::size_t>(state.s.size())});
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

/// Which slots hang together by two-sided links of one pair.
class BodyGraph {
 public:
  BodyGraph(const System& system, const State& state) : of_(static_cast<std::size_t>(system.n_slots())) {
    for (const auto& link : system.links()) {
      if (!is_active(state, *link) || link->unilateral() || link->pairs().size() != 1) continue;
      const auto [a, b] = slots_of(*link);
      if (a == b) continue;
      if (a != kGround) of_[static_cast<std::size_t>(a)].push_back(b);
      if (b != kGround) of_[static_cast<std::size_t>(b)].push_back(a);
    }
  }

  Side side_of(const Lock& link) const {
    const auto [p, s] = slots_of(link);
    if (std::vector<int> slots = carried(p, s); !slots.empty()) return {std::move(slots), 1, true};
    if (std::vector<int> slots = carried(s, p); !slots.empty()) return {std::move(slots), -1, true};
    return p != kGround ? Side{{p}, 1, false} : Side{{s}, -1, false};
  }

 private:
  // The bodies that `first` carries when it turns against `other`; none where it is ground or part of a loop.
  std::vector<int> carried(int first, int other) const {
    if (first == kGround) return {};
    std::vector<int> slots{first};
    std::vector<bool> is_in(of_.size());
    is_in[static_cast<std::size_t>(first)] = true;
    for (std::size_t i = 0; i < slots.size(); ++i)
      for (const int b : of_[static_cast<std::size_t>(slots[i])]) {
        if (i == 0 && b == other) continue;  // the joint, and what else is between its two bodies
        if (b == kGround || b == other) return {};
        if (is_in[static_cast<std::size_t>(b)]) continue;
        is_in[static_cast<std::size_t>(b)] = true;
        slots.push_back(b);
      }
    return slots;
  }

  std::vector<std::vector<int>> of_;
};

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
    sum += std::abs(turn.way());
  }
  return sum > kNearlyHalf;
}

std::string not_led(const AskedTurn& turn, double taken, const std::string& why) {
  return fmt::format("{}: {:.9g} deg is asked for and {:.9g} deg taken by what counts its turns: {}", turn.name(),
                     kDegrees * turn.angle, kDegrees * taken, why);
}

// Says so where an angle that is asked for cannot be led to.
void drop_unled(std::vector<AskedTurn>& asked, std::vector<std::string>& warnings) {
  std::erase_if(asked, [&](const AskedTurn& turn) {
    const bool free = !turns_about_one_axis(*turn.link, turn.axis), far = std::abs(turn.way()) > kMostTurns * kTwoPi;
    if ((free || far) && std::abs(turn.angle) > kPi + 1e-6)
      warnings.push_back(not_led(
          turn, nearest_to(0, turn.angle),
          free ? "P turns about other axes of S, too, so that its turns about one have no number; ask for an angle "
                 "within half a turn"
               : fmt::format("it is beyond {:.0f} turns; take whole turns off it", kMostTurns)));
    return free || far;
  });
}

// A body of a loop that turns alone takes the angles of its other joints along: these are led once more.
void lead(Dynamics& dynamics, State& state, std::vector<AskedTurn>& asked, std::vector<std::string>& warnings) {
  const BodyGraph graph(dynamics.system(), state);
  const auto is_off = [](const AskedTurn& to) { return std::abs(to.way()) > kReached; };
  const auto all = [&] {
    double sum = 0;
    for (const AskedTurn& to : asked) sum += std::abs(to.way());
    return sum;
  };
  for (double before = HUGE_VAL, now = all(); now < before && std::ranges::any_of(asked, is_off);
       before = now, now = all())
    for (AskedTurn& to : asked) {
      if (!is_off(to)) continue;
      const Side side = graph.side_of(*to.link);
      for (int left = static_cast<int>(std::ceil(std::abs(to.way()) / kStage)); left > 0; --left) {
        turn(dynamics, state, to, side, to.way() / left);
        follow_turns(dynamics, state);
        measure(dynamics, state, asked);
      }
    }
  for (const AskedTurn& to : asked)
    if (is_off(to))
      warnings.push_back(
          not_led(to, to.now, "other joints that are asked for turn it away, as in a loop; ask for fewer of them"));
}

}  // namespace

bool turns_about_one_axis(const Lock& link, Axis axis) {
  const Jointed* joint = link.jointed();
  return joint != nullptr && includes(joint->rows() | row_of(axis), Mask::e123);
}

bool begin_turns(Dynamics& dynamics, State& state, const AssemblyOptions& options, std::vector<std::string>& warnings) {
  const System& system = dynamics.system();
  std::vector<AskedTurn> asked = turns_asked(system, state, options);
  const bool counts = !system.counted_angles().empty();
  if (!counts)  // there is nothing to lead, but what may be warned of
    std::erase_if(asked, [](const AskedTurn& turn) { return !(std::abs(turn.angle) > kPi + 1e-6); });
  if (asked.empty() || !turns_begin(system, state)) return false;
  State home = system.start();
  home.t = state.t, home.modes = state.modes;
  measure(dynamics, home, asked);
  if (!is_asked_beyond(asked)) return false;
  drop_unled(asked, warnings);
  if (!counts) return false;
  home.v.setZero();
  for (AskedTurn& turn : asked) {  // half a turn has two names
    const auto [p, s] = turn.link->pairs().front();
    if (const CountedAngle* angle = system.counted(*p, *s, axis_index(turn.axis) % 3))
      turn.now = nearest_to(expected(*angle, home), turn.now);
  }
  lead(dynamics, home, asked, warnings);
  for (const auto& angle : system.counted_angles())
    state.s.segment(angle->first(), CountedAngle::kStates) = home.s.segment(angle->first(), CountedAngle::kStates);
  return true;
}

void begin_turns(Dynamics& dynamics, State& state) {
  std::vector<std::string> warnings;
  begin_turns(dynamics, state, {}, warnings);
  for (const std::string& warning : warnings) log_warning(warning);
}

double short_share(int n_slots, const VecX& d, double length) {
  constexpr double kShort = 0.25 * kPi;
  double most = 0;
  for (int k = 0; k < n_slots; ++k) most = std::max(most, d.segment<3>(6 * k + 3).norm() / length);
  return most > kShort ? kShort / most : 1.0;
}

void follow_turns(Dynamics& dynamics, State& state) {
  if (dynamics.system().counted_angles().empty()) return;
  const Inputs& in = dynamics.inputs(state);
  for (const auto& angle : dynamics.system().counted_angles())
    named(*angle, in.t, [&] { angle->set(in, expected(*angle, state), state.s); });
}

bool turns_begin(const System& system, const State& state) {
  if (system.counted_angles().empty()) return true;
  const VecX home = system.start().s;
  return std::ranges::all_of(system.counted_angles(), [&](const auto& angle) {
    return state.s.segment(angle->first(), CountedAngle::kStates) ==
           home.segment(angle->first(), CountedAngle::kStates);
  });
}

void settle_turns(Dynamics& dynamics, const State& given, State& state) {
  const System& system = dynamics.system();
  if (system.counted_angles().empty()) return;
  const Inputs& in = dynamics.inputs(state);
  for (const auto& angle : system.counted_angles()) {
    const double began = expected(*angle, given), now = expected(*angle, state);
    const bool led = std::abs(began) > kNearlyHalf;
    if (angle->coupled() || (!led && std::abs(now - began) > kNearlyHalf)) continue;
    named(*angle, in.t, [&] { angle->set(in, led ? began : 0.0, state.s); });
  }
}

void count_from(Dynamics& dynamics, State& state) {
  const bool begins = turns_begin(dynamics.system(), state);
  const State given = state;
  follow_turns(dynamics, state);
  if (begins) settle_turns(dynamics, given, state);
}

bool has_coupled_angles(const System& system) {
  return std::ranges::any_of(system.counted_angles(), [](const auto& angle) { return angle->coupled(); });
}

bool has_drives(const System& system, const State& state) {
  return std::ranges::any_of(system.links(), [&](const auto& link) {
    const Jointed* joint = is_active(state, *link) ? link->jointed() : nullptr;
    return joint != nullptr &&
           std::ranges::any_of(joint->imposed().drives, [](const Drive& drive) { return !drive.speed; });
  });
}

bool turn_to_drives(Dynamics& dynamics, State& state) {
  bool any = false;
  std::vector<AskedTurn> asked = turns_of_drives(dynamics.system(), state);
  measure(dynamics, state, asked);
  const BodyGraph graph(dynamics.system(), state);
  for (AskedTurn& to : asked) {
    const double way = nearest_to(0, to.way());
    if (!(std::abs(way) > kStage)) continue;
    any = true;
    if (const Side side = graph.side_of(*to.link); side.whole) turn(dynamics, state, to, side, way);
  }
  return any;
}

std::string farthest_drive(Dynamics& dynamics, const State& state) {
  std::vector<AskedTurn> asked = turns_of_drives(dynamics.system(), state);
  measure(dynamics, state, asked);
  const AskedTurn* farthest = nullptr;
  double most = kStage;
  for (const AskedTurn& turn : asked)
    if (const double way = std::abs(nearest_to(0, turn.way())); way > most) most = way, farthest = &turn;
  if (farthest == nullptr) return "";
  return fmt::format(
      " (drive {} of link '{}' begins at {:.6g} deg, {:.6g} deg from the poses given: put its bodies there)",
      to_string(farthest->axis), farthest->link->name(), kDegrees * farthest->angle, kDegrees * most);
}

}  // namespace lockstep
