// check_lock: the link's description, its memory, and what its rows may depend on.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <set>

#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/tools/check/jumps.h"
#include "framework/tools/check/lock_check.h"
#include "framework/tools/check/sample_system.h"

namespace lockstep {

LockCheck::LockCheck(const System& system, const Lock& link, const Lock* sibling, CheckReport& report,
                     const CheckOptions& options)
    : StateCheck(system, report, options, link.remembering(), link.first_memory()),
      link_(link),
      sibling_(sibling),
      bench_(system, link),
      m_(link.row_count()) {
  for (int i = 0; i < link.slots().n; ++i) slots_.push_back(link.slots()[i]);
}

void LockCheck::run() {
  if (!description()) return;
  Draw draw(options_.seed);
  for (index_ = 0; index_ < options_.states; ++index_) {
    if (!find_state(draw)) return;
    everything_written();
    same_again();
    other_sign();
    pose_alone();
    jacobian();
    time_derivative();
    right_side();
    tangent();
    memory();
  }
  jumps();
  for (const auto& [p, s] : link_.pairs()) turn_about_z(*p, *s);
}

bool LockCheck::description() {
  if (m_ < 1 || m_ > kMaxRows) {
    add("rows", fmt::format("has {} rows; a link has 1 to {}", m_, kMaxRows), "plan_rows()");
    return false;
  }
  const int n_drives = link_.driven() ? link_.driven()->n_drives() : 0;
  std::set<std::string> names;
  for (int k = 0; k < m_; ++k) {
    if (link_.row_name(k).empty()) add("names", fmt::format("row {} has no name", k), "plan_rows()");
    if (!names.insert(link_.row_name(k)).second)
      add("names", fmt::format("two rows are called '{}'", link_.row_name(k)), "plan_rows()");
    if (const int drive = link_.row(k).drive; drive < -1 || drive >= n_drives)
      add("drives", fmt::format("{} belongs to drive {}, of {} drives", row(k), drive, n_drives),
          "plan_rows() (LinkRow::drive) and n_drives()");
  }
  if (link_.pairs().empty()) add("pairs", "names no pair of markers", "pairs()");
  std::vector<int> touched;
  for (const auto& [p, s] : link_.pairs())
    for (const Marker* marker : {p, s}) {
      if (marker == nullptr || marker->body == nullptr) {
        add("pairs", "names a pair with a marker that is not there", "pairs()");
        return false;
      }
      const int slot = marker->body->slot;
      if (slot == kGround) continue;
      touched.push_back(slot);
      if (link_.slots().position(slot) < 0)
        add("slots",
            fmt::format("slots() leaves out body '{}', on which its marker '{}' is", marker->body->name, marker->name),
            "the slots that plan_rows() returns");
    }
  if (n_ == 0 || touched.empty()) {
    add("slots", "touches no body that moves, so that nothing can be checked", "the bodies of its markers");
    return false;
  }
  length_ = std::max(Differences::distance(touched, start_of(system_, options_.from).in()), 1e-3);
  if (const Observable* own = link_.observable())
    for (const Quantity& q : own->quantities())
      if (q.name.empty()) add("quantities", "has a quantity without a name", "quantities()");
  return true;
}

// A random state with finite rows; closer to the start if the link has none far from it.
bool LockCheck::find_state(Draw& draw) {
  const double t = draw_time(draw, [&](double t0, double t1, std::vector<double>& out) {
    if (link_.driven()) link_.driven()->breakpoints(t0, t1, out);
  });
  const TestState start = start_of(system_, t);
  double share = index_ == 0 ? 0.05 : 1.0;
  for (int i = 0; i < 7; ++i, share *= 0.5) {
    state_ = random_state(system_, start, draw, share * options_.reach, share * options_.turn);
    accept_step(state_);
    rows_ = bench_.rows(state_);
    if (!rows_.all_finite()) continue;
    if (i > 0 && index_ > 0)
      report_.note(
          fmt::format("some states had to be taken nearer to the start, where its rows are finite (state {})", index_));
    return true;
  }
  for (int k = 0; k < m_; ++k)
    for (int p = 0; p < 4; ++p) {
      if (p < 3 ? std::isfinite(rows_.parts(k, p)) : rows_.J.row(k).allFinite()) continue;
      const std::string fault = link_.driven() ? link_.driven()->diagnose(t) : "";
      add("finite",
          fmt::format("{} is not finite at t = {} s near the start {}",
                      p < 3 ? part(p, k) : "the jacobian of " + row(k), text::number(t), here()),
          fault.empty() ? "a division by a length that may be zero, a root or an arc sine out of its range" : fault);
      return false;
    }
  return false;
}

void LockCheck::everything_written() {
  const LockRows a = bench_.rows(state_, std::numeric_limits<double>::quiet_NaN()), b = bench_.rows(state_, 3e99);
  const auto unwritten = [&](const std::string& what) {
    add("written " + what, what + " is not written: what stood there before shows through",
        "gather(): it writes every number of every row and slot, by set(), also those that are zero");
  };
  for (int k = 0; k < m_; ++k) {
    for (int p = 0; p < 3; ++p)
      if (!(a.parts(k, p) == b.parts(k, p))) unwritten(part(p, k));
    for (const int slot : slots_)
      if (!(a.J.block<1, 6>(k, 6 * slot) == b.J.block<1, 6>(k, 6 * slot)))
        unwritten(fmt::format("the jacobian of {} on body '{}'", row(k), body(slot)));
  }
  if (bench_.wrote_outside())
    add("outside", "writes outside of its rows",
        "gather(): row numbers below row_count(), slots from slots().position()");
  if (bench_.wrote_padding())
    add("padding", "writes rows that it does not have", "gather(): row numbers go from 0 to row_count() - 1");
}

void LockCheck::same_again() {
  bench_.rows(other_state());
  if (!(bench_.rows(state_) == rows_))
    add("same", fmt::format("says something else when it is asked again at the same inputs {}", here()),
        "what the class keeps between two calls: rows follow from the Inputs alone, memory belongs into z "
        "(n_memory())");
  const bool grouped = sibling_ != nullptr && sibling_->pattern() == link_.pattern() && sibling_->row_count() == m_ &&
                       sibling_->slots().n == link_.slots().n;
  const Lock& other = grouped ? *sibling_ : link_;
  const LockRows alone = LockBench(system_, other).rows(state_);
  const auto [first, second] = bench_.rows_of_group(state_, other);
  // Equal up to rounding: a group may be gathered in packs.
  const auto near = [](const MatX& a, const MatX& b) { return (a - b).norm() <= 1e-10 * (1 + b.norm()); };
  const auto all_near = [&](const LockRows& a, const LockRows& b) {
    return near(a.parts.col(0), b.parts.col(0)) && near(a.parts.col(1), b.parts.col(1)) &&
           near(a.parts.col(2), b.parts.col(2)) && near(a.J, b.J);
  };
  if (!all_near(first, rows_) || !all_near(second, alone))
    add("group", fmt::format("two links gathered as one group are not what they are alone {}", here()),
        "gather(): for each i, links[i] (not this) writes into out.lane(i)");
}

// q and -q are the same orientation: a row may change its sign as a whole, and nothing else.
void LockCheck::other_sign() {
  for (const int slot : slots_) {
    TestState on = state_;
    on.slot(slot).e = -on.slot(slot).e;
    const LockRows r = bench_.rows(on);
    for (int k = 0; k < m_; ++k) {
      const auto off = [&](double sign) {
        return (r.parts.row(k) - sign * rows_.parts.row(k)).cwiseAbs().sum() +
               (r.J.row(k) - sign * rows_.J.row(k)).cwiseAbs().sum();
      };
      if (std::min(off(1), off(-1)) <= 1e-9 * (1 + rows_.parts.row(k).cwiseAbs().sum())) continue;
      add("sign",
          fmt::format("{} is another one when the quaternion of body '{}' changes its sign, which is the same "
                      "orientation {}",
                      row(k), body(slot), here()),
          "its use of e0 ... e3: take products of two of them, or angle_z()");
    }
  }
}

void LockCheck::pose_alone() {
  TestState on = state_;
  for (Motion& O : on.motions) O.v *= 1.7, O.w *= -0.6;
  const LockRows r = bench_.rows(on);
  const auto differ = [](const auto& a, const auto& b) {
    return (a - b).cwiseAbs().sum() > 1e-9 * (1 + b.cwiseAbs().sum());
  };
  for (int k = 0; k < m_; ++k)
    for (int p : {0, 1, 3}) {
      if (p < 3 ? !differ(r.parts.block<1, 1>(k, p), rows_.parts.block<1, 1>(k, p))
                : !differ(r.J.row(k), rows_.J.row(k)))
        continue;
      add(fmt::format("velocity {}", k),
          fmt::format("{} changes with the velocities {}", p < 3 ? part(p, k) : "the jacobian of " + row(k), here()),
          "gather(): C, Ct and the jacobian follow from the pose and the time; velocities go into Qhat alone");
      break;
    }
}

void LockCheck::memory() {
  if (link_.n_own_memory() == 0) return;
  TestState on = state_;
  double second = 0, last = 0;  // change of z by one more accept_step()
  for (int i = 0; i < 8; ++i) {
    const VecX before = on.z;
    accept_step(on);
    if (!on.z.allFinite())
      return add("memory", fmt::format("accept_step() writes a number that is not finite {}", here()), "accept_step()");
    last = (on.z - before).norm();
    if (i == 1) second = last;
  }
  if (last > 1e-9 * (1 + on.z.norm()) && std::abs(last - second) < 1e-3 * second)
    add("memory",
        fmt::format("accept_step() at one state, called again and again there, adds the same each time {}", here()),
        "accept_step(): what is remembered is where the link is, as the nearest branch of an angle, and no sum over "
        "calls");
}

void LockCheck::jumps() {
  TestState on = state_;
  on.stop();  // the memory may extrapolate with the velocities
  on.t = options_.from;
  accept_step(on);
  const auto parts = [&](double t, VecX& out) {
    on.t = t;
    const LockRows r = bench_.rows(on);
    out = r.parts.reshaped();
  };
  std::vector<double> listed;
  if (link_.driven()) link_.driven()->breakpoints(options_.from, options_.to, listed);
  for (const auto& [c, all] : find_jumps(parts, options_.from, options_.to, listed, 200))
    add(fmt::format("jump {}", c % m_),
        fmt::format("{} jumps by {:.3g} at t = {:.9g} s, which breakpoints() does not tell{}", part(c / m_, c % m_),
                    all.front().size, all.front().t,
                    all.size() > 1 ? fmt::format("; there are {} more", all.size() - 1) : ""),
        "breakpoints(): append those of every law that the link uses, and of its markers' laws");
}

// Three turns of P about z of S in steps: C has to change by what the jacobian says, past every half turn.
void LockCheck::turn_about_z(const Marker& p, const Marker& s) {
  const bool move_p = p.body->slot != kGround;
  const int slot = move_p ? p.body->slot : s.body->slot;
  if (slot == kGround || n_freedoms(slot) == 3) return;
  constexpr int kSteps = 300;
  const double step = 3 * kTwoPi / kSteps;
  TestState on = start_of(system_, options_.from);
  const Motion start = on.slot(slot);
  const MarkerInWorld S = in_world(MarkerFrame(s), on.in());
  const Vec3 axis = (move_p ? 1.0 : -1.0) * S.A.col(2);
  const auto rows_at = [&](double angle) {
    on.slot(slot) = turned(start, S.x, axis, angle);
    return bench_.rows(on);
  };
  const auto rate_at = [&](const LockRows& r) -> VecX {  // of C by the angle, at the present angle
    const Motion& O = on.slot(slot);
    return r.J.middleCols<3>(6 * slot) * cross(axis, Vec3(O.x - S.x)) +
           r.J.middleCols<3>(6 * slot + 3) * (O.A.transpose() * axis);
  };
  MatX off(m_, kSteps);  // change of C in each step that the jacobian does not account for
  std::vector<VecX> memories;
  VecX C, rate;
  for (int i = 0; i <= kSteps; ++i) {
    const LockRows r = rows_at(i * step);
    if (!r.C().allFinite() || !r.J.allFinite()) return;
    const VecX rate_now = rate_at(r);
    if (i > 0) off.col(i - 1) = (r.C() - C - 0.5 * step * (rate + rate_now)).cwiseAbs();
    C = r.C(), rate = rate_now;
    memories.push_back(on.z);
    accept_step(on);
  }
  for (int k = 0; k < m_; ++k) {
    int worst = 0;
    const double most = off.row(k).maxCoeff(&worst);
    std::vector<double> sorted(off.row(k).begin(), off.row(k).end());
    std::nth_element(sorted.begin(), sorted.begin() + kSteps / 2, sorted.end());
    if (!(most > 1e-6 && most > 20 * sorted[kSteps / 2])) continue;
    // A jump is as large in a step 64 times smaller, beyond what the jacobian says. The jacobian is continuous across an uncounted angle; where a
    // link passes to another point of its curve, the jacobian jumps with C.
    on.z = memories[worst];
    double jump = 0, bend = 0;
    LockRows before = rows_at(worst * step);
    double rate_before = rate_at(before)[k];
    for (int i = 1; i <= 64; ++i) {
      accept_step(on);
      const LockRows r = rows_at((worst + i / 64.0) * step);
      const double rate_then = rate_at(r)[k], way = 0.5 * (step / 64) * (rate_before + rate_then);
      rate_before = rate_then;
      if (const double change = std::abs(r.C()[k] - before.C()[k] - way); change > jump) {
        jump = change;
        bend = (r.J.row(k) - before.J.row(k)).norm() / r.J.row(k).norm();
      }
      before = r;
    }
    if (jump < 0.5 * most) continue;
    const std::string what =
        fmt::format("{} jumps by {:.3g} where '{}' has turned by {:.0f} degrees about z of '{}'", row(k), jump,
                    move_p ? p.name : s.name, (worst + 0.5) * step * 180 / kPi, s.name);
    if (bend > 0.01)
      report_.note(what + ", far off the constraint, and its jacobian with it: it passes to another place there");
    else
      add("turns", what,
          link_.n_own_memory() > 0
              ? "accept_step() and start_memory(), or count_angles(), which counts an angle for it"
              : "its angles: kCountsTurns = true and y.angle_z(), so that they run on past a full turn");
  }
}

CheckReport check_lock(System& system, const Lock& link, const CheckOptions& options) {
  const auto& all = system.links();
  if (std::none_of(all.begin(), all.end(), [&](const auto& l) { return l.get() == &link; }))
    throw ModelError(fmt::format("check_lock: link '{}' is not in the system; add it by System::add", link.name()));
  CheckReport report(fmt::format("link '{}' ({})", link.name(), link.type()), options.seed);
  if (set_up(system, report)) LockCheck(system, link, nullptr, report, options).run();
  return report;
}

CheckReport check_lock(const Registry& registry, const std::string& type, const Params& params,
                       const CheckOptions& options) {
  return check_in_samples(fmt::format("link type '{}'", type), options, [&](SampleSystem& sample) {
    const auto add = [&](const char* name) {
      return &sample.system.add(
          registry.links.make(type, sample.attachment(name), params, &registry, fmt::format("link '{}'", name)));
    };
    const Lock *first = add("first"), *second = add("second");  // for the test of groups
    return [=, &sample, &options](CheckReport& report) {
      LockCheck(sample.system, *first, second, report, options).run();
    };
  });
}

}  // namespace lockstep
