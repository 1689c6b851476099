// What is asked of a link once, and at each state beside its derivatives (lock_check_slopes.cpp).
#include "framework/tools/check/lock_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <lockstep/text.h>
#include "framework/tools/check/jumps.h"

namespace lockstep {

LockCheck::LockCheck(const System& system, const Lock& link, const Lock* sibling, CheckReport& report,
                     const CheckOptions& options)
    : system_(system), link_(link), sibling_(sibling), report_(report), options_(options), bench_(system, link) {}

void LockCheck::run() {
  if (!description()) return;
  Draw draw(options_.seed);
  for (state_ = 0; state_ < options_.states; ++state_) {
    if (!find_place(draw)) return;
    everything_written();
    same_again();
    other_sign();
    velocities_leave_alone();
    jacobian();
    time_derivative();
    right_side();
    tangent();
    memory();
  }
  jumps();
  turns();
}

std::string LockCheck::row(int k) const { return "row " + link_.row_name(k); }
std::string LockCheck::here() const { return fmt::format("(seed {}, state {})", options_.seed, state_); }
void LockCheck::add(const std::string& key, std::string what, std::string look, double weight) {
  report_.add(key, {std::move(what), std::move(look)}, weight);
}

bool LockCheck::description() {
  m_ = link_.row_count(), n_ = system_.n_slots();
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
  std::vector<int> slots;
  for (const auto& [p, s] : link_.pairs())
    for (const Marker* marker : {p, s}) {
      if (marker == nullptr || marker->body == nullptr) {
        add("pairs", "names a pair with a marker that is not there", "pairs()");
        return false;
      }
      if (marker->body->slot == kGround) continue;
      slots.push_back(marker->body->slot);
      if (link_.slots().position(marker->body->slot) < 0)
        add("slots",
            fmt::format("slots() leaves out body '{}', on which its marker '{}' is", marker->body->name, marker->name),
            "the slots that plan_rows() returns");
    }
  if (n_ == 0 || slots.empty()) {
    add("slots", "touches no body that moves, so that nothing can be checked", "the bodies of its markers");
    return false;
  }
  length_ = std::max(Differences::distance(slots, home_of(system_, options_.from).in()), 1e-3);
  if (const Observable* own = link_.observable())
    for (const Quantity& q : own->quantities())
      if (q.name.empty()) add("quantities", "has a quantity without a name", "quantities()");
  return true;
}

// A random state with finite rows; nearer to the start when the link makes no numbers far from it.
bool LockCheck::find_place(Draw& draw) {
  double t = draw.number(options_.from, options_.to);
  std::vector<double> jumps;
  quiet_ = 0.02 * (options_.to - options_.from);
  for (int i = 0; i < 30; ++i, jumps.clear()) {
    if (link_.driven()) link_.driven()->breakpoints(t - quiet_, t + quiet_, jumps);
    if (jumps.empty()) break;
    t = draw.number(options_.from, options_.to), quiet_ *= 0.8;
  }
  const Place home = home_of(system_, t);
  double share = state_ == 0 ? 0.05 : 1.0;
  for (int i = 0; i < 7; ++i, share *= 0.5) {
    place_ = drawn_about(system_, home, draw, share * options_.reach, share * options_.turn);
    accept_step(place_, place_.z);
    bench_.rows(place_, rows_);
    if (rows_.C.allFinite() && rows_.Ct.allFinite() && rows_.Qhat.allFinite() && rows_.J.allFinite()) {
      if (i > 0 && state_ > 0)
        report_.note(fmt::format(
            "some states had to be taken nearer to the start, where its rows are finite (state {})", state_));
      return true;
    }
  }
  for (int k = 0; k < m_; ++k) {
    const char* what = !std::isfinite(rows_.C[k])      ? "C"
                       : !std::isfinite(rows_.Ct[k])   ? "Ct"
                       : !std::isfinite(rows_.Qhat[k]) ? "Qhat"
                       : !rows_.J.row(k).allFinite()   ? "the jacobian"
                                                       : nullptr;
    if (what == nullptr) continue;
    const std::string fault = link_.driven() ? link_.driven()->diagnose(place_.t) : "";
    add("finite", fmt::format("{} of {} is not finite at t = {} s near the start {}", what, row(k), text::number(t), here()),
        fault.empty() ? "a division by a length that may be zero, a root or an arc sine out of its range" : fault);
    break;
  }
  return false;
}

void LockCheck::everything_written() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  LockRows a, b;
  bench_.rows(place_, a, nan);
  bench_.rows(place_, b, 3e99);
  const auto told = [&](const std::string& what) {
    add("written " + what, what + " is not written: what stood there before shows through",
        "gather(): it writes every number of every row and slot, by set(), also those that are zero");
  };
  for (int k = 0; k < m_; ++k) {
    if (!(a.C[k] == b.C[k])) told("C of " + row(k));
    if (!(a.Ct[k] == b.Ct[k])) told("Ct of " + row(k));
    if (!(a.Qhat[k] == b.Qhat[k])) told("Qhat of " + row(k));
    for (int i = 0; i < link_.slots().n; ++i) {
      const int slot = link_.slots()[i];
      if (!(a.J.block<1, 6>(k, 6 * slot) == b.J.block<1, 6>(k, 6 * slot)))
        told(fmt::format("the jacobian of {} on body '{}'", row(k), system_.body_of_slot(slot).name));
    }
  }
  if (bench_.wrote_outside())
    add("outside", "writes outside of its rows",
        "gather(): row numbers below row_count(), slots from slots().position()");
  if (bench_.wrote_padding())
    add("padding", "writes rows that it does not have", "gather(): row numbers go from 0 to row_count() - 1");
}

void LockCheck::same_again() {
  LockRows again, elsewhere, first, second;
  Draw draw(options_.seed + 77);
  const Place other = drawn_about(system_, home_of(system_, place_.t), draw, 0.1, 0.1);
  bench_.rows(other, elsewhere);
  bench_.rows(place_, again);
  const auto equal = [&](const LockRows& a, const LockRows& b) {
    return a.C == b.C && a.Ct == b.Ct && a.Qhat == b.Qhat && a.J == b.J;
  };
  // of one link alone and in a group: equal but for rounding, as groups may be gathered by packs
  const auto near = [](const MatX& a, const MatX& b) { return (a - b).norm() <= 1e-10 * (1 + b.norm()); };
  if (!equal(rows_, again))
    add("same", fmt::format("says something else when it is asked again at the same inputs {}", here()),
        "what the class keeps between two calls: rows follow from the Inputs alone, memory belongs into z "
        "(n_memory())");
  const bool grouped = sibling_ != nullptr && sibling_->pattern() == link_.pattern() && sibling_->row_count() == m_ &&
                       sibling_->slots().n == link_.slots().n;
  const Lock& other_link = grouped ? *sibling_ : link_;
  LockRows alone;
  LockBench(system_, other_link).rows(place_, alone);
  bench_.rows_of_two(place_, other_link, first, second);
  const auto all_near = [&](const LockRows& a, const LockRows& b) {
    return near(a.C, b.C) && near(a.Ct, b.Ct) && near(a.Qhat, b.Qhat) && near(a.J, b.J);
  };
  if (!all_near(first, rows_) || !all_near(second, alone))
    add("group", fmt::format("two links gathered as one group are not what they are alone {}", here()),
        "gather(): for each i, links[i] (not this) writes into out.lane(i)");
}

// q and -q are one orientation: each row as a whole may change its sign, and nothing else.
void LockCheck::other_sign() {
  for (int slot = 0; slot < n_; ++slot) {
    if (link_.slots().position(slot) < 0) continue;
    Place turned = place_;
    turned.slot(slot).e = -turned.slot(slot).e;
    LockRows r;
    bench_.rows(turned, r);
    for (int k = 0; k < m_; ++k) {
      const auto off = [&](double sign) {
        return std::abs(r.C[k] - sign * rows_.C[k]) + std::abs(r.Ct[k] - sign * rows_.Ct[k]) +
               std::abs(r.Qhat[k] - sign * rows_.Qhat[k]) + (r.J.row(k) - sign * rows_.J.row(k)).cwiseAbs().sum();
      };
      const double size = 1 + std::abs(rows_.C[k]) + std::abs(rows_.Ct[k]) + std::abs(rows_.Qhat[k]);
      if (std::min(off(1), off(-1)) <= 1e-9 * size) continue;
      add("sign",
          fmt::format("{} is another one when the quaternion of body '{}' changes its sign, which is the same "
                      "orientation {}",
                      row(k), system_.body_of_slot(slot).name, here()),
          "its use of e0 ... e3: take products of two of them, or angle_z()");
    }
  }
}

// The numbers of the link in z, as after an accepted step there.
void LockCheck::accept_step(const Place& at, VecX& z) const {
  if (const int n = link_.n_own_memory(); n > 0)
    link_.remembering()->accept_step(at.in(), {z.data() + link_.first_memory(), static_cast<std::size_t>(n)});
}

void LockCheck::memory() {
  if (link_.n_own_memory() == 0) return;
  VecX z = place_.z, before;
  double first = 0, last = 0;  // what one more accept_step() changes
  for (int i = 0; i < 8; ++i) {
    before = z;
    Place at = place_;
    at.z = before;
    accept_step(at, z);
    if (!z.allFinite())
      return add("memory", fmt::format("accept_step() writes a number that is not finite {}", here()), "accept_step()");
    last = (z - before).norm();
    if (i == 1) first = last;
  }
  if (last > 1e-9 * (1 + z.norm()) && std::abs(last - first) < 1e-3 * first)
    add("memory",
        fmt::format("accept_step() at one state, called again and again there, adds the same each time {}", here()),
        "accept_step(): what is remembered is where the link is, as the nearest branch of an angle, and no sum over "
        "calls");
}

void LockCheck::jumps() {
  Place still = place_;  // memory may look ahead with the velocities
  for (Motion& O : still.motions) O.v.setZero(), O.w.setZero();
  still.t = options_.from;
  Place on = still;
  accept_step(still, on.z);
  LockRows r;
  const auto f = [&](double t, VecX& out) {
    on.t = t;
    bench_.rows(on, r);
    out.resize(3 * m_);
    out << r.C, r.Ct, r.Qhat;
  };
  std::vector<double> listed;
  if (link_.driven()) link_.driven()->breakpoints(options_.from, options_.to, listed);
  std::vector<std::vector<Jump>> of(static_cast<std::size_t>(3 * m_));
  for (const Jump& j : find_jumps(f, options_.from, options_.to, listed, 200))
    of[static_cast<std::size_t>(j.component)].push_back(j);
  constexpr const char* kWhat[] = {"C", "Ct", "Qhat"};
  for (std::size_t c = 0; c < of.size(); ++c) {
    if (of[c].empty()) continue;
    const auto k = static_cast<int>(c) % m_;
    add(fmt::format("jump {}", k),
        fmt::format("{} of {} jumps by {:.3g} at t = {:.9g} s, which breakpoints() does not tell{}",
                    kWhat[static_cast<int>(c) / m_], row(k), of[c].front().size, of[c].front().t,
                    of[c].size() > 1 ? fmt::format("; there are {} more", of[c].size() - 1) : ""),
        "breakpoints(): append those of every law that the link uses, and of its markers' laws");
  }
}

}  // namespace lockstep
