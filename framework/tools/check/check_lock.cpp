// SPDX-License-Identifier: BSD-3-Clause
// check_lock: the link's description, its memory, and what its rows may depend on.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <set>

#include <lockstep/error.h>
#include "framework/tools/check/lock_check.h"
#include "framework/tools/check/sample_system.h"

namespace lockstep {

LockCheck::LockCheck(const System& system, const Lock& link, const Lock* sibling, CheckReport& report,
                     const CheckOptions& options)
    : StateCheck(system, report, options, link.remembering(), link.first_memory()),
      link_(link),
      sibling_(sibling),
      m_(link.row_count()) {
  is_link_ = true, n_timed_ = 3, n_turned_ = 1;
  for (int i = 0; i < link.slots().n; ++i) slots_.push_back(link.slots()[i]);
}

std::string LockCheck::name(Eigen::Index k, Eigen::Index column) const {
  constexpr const char* kParts[] = {"C of ", "Ct of ", "Qhat of "};
  const std::string its = row(static_cast<int>(k));
  if (column < 3) return kParts[column] + its;
  return fmt::format("the jacobian of {} on body '{}'", its, body(static_cast<int>(column - 3) / 6));
}

void LockCheck::breakpoints(double t0, double t1, std::vector<double>& out) const {
  if (link_.driven()) link_.driven()->breakpoints(t0, t1, out);
}

std::string LockCheck::why_not_finite() const {
  const std::string fault = link_.driven() ? link_.driven()->diagnose(state_.t) : "";
  return fault.empty() ? StateCheck::why_not_finite() : fault;
}

void LockCheck::at_state() {
  everything_written();
  group();
  pose_alone();
  jacobian();
  time_derivatives();
  tangent();
}

bool LockCheck::description() {
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
  bool moves = false;
  for (const auto& [p, s] : link_.pairs())
    for (const Marker* marker : {p, s}) {
      const int slot = marker->body->slot;
      if (slot == kGround) continue;
      moves = true;
      if (link_.slots().position(slot) < 0)
        add("slots",
            fmt::format("slots() leaves out body '{}', on which its marker '{}' is", marker->body->name, marker->name),
            "the slots that plan_rows() returns");
    }
  if (const Observable* own = link_.observable())
    for (const Quantity& q : own->quantities())
      if (q.name.empty()) add("quantities", "has a quantity without a name", "quantities()");
  if (n_ == 0 || !moves)
    add("slots", "touches no body that moves, so that nothing can be checked", "the bodies of its markers");
  return n_ > 0 && moves;
}

void LockCheck::everything_written() {
  const Lock* self = &link_;
  bool outside = false;
  const MatX r = gathered(system_, Group(&self, 1), state_, std::numeric_limits<double>::quiet_NaN(), &outside)[0];
  for (int k = 0; k < m_; ++k)
    for (int c = 0; c < r.cols(); ++c)
      if (std::isnan(r(k, c)))
        add("written " + name(k, c), name(k, c) + " is not written: what stood there before shows through",
            "gather(): it writes every number of every row and slot, by set(), also those that are zero");
  if (outside)
    add("outside", "writes outside of its rows",
        "gather(): row numbers from 0 to row_count() - 1, slots from slots().position()");
}

void LockCheck::group() {
  const bool grouped = sibling_ != nullptr && sibling_->pattern() == link_.pattern() && sibling_->row_count() == m_ &&
                       sibling_->slots().n == link_.slots().n;
  const Lock& other = grouped ? *sibling_ : link_;
  const Lock* both[2] = {&link_, &other};
  const std::vector<MatX> as_one = gathered(system_, Group(both, 2), state_);
  // Equal up to rounding: a group may be gathered in packs.
  const auto near = [](const MatX& a, const MatX& b) {
    return ((a - b).colwise().norm().array() <= kRounding * (1 + b.colwise().norm().array())).all();
  };
  if (!near(as_one[0], is_) || !near(as_one[1], rows_of(system_, other, state_)))
    add("group", "two links gathered as one group are not what they are alone",
        "gather(): for each i, links[i] (not this) writes into out.lane(i)");
}

void LockCheck::pose_alone() {
  TestState on = state_;
  for (Motion& O : on.motions) O.v *= 1.7, O.w *= -0.6;
  MatX r = numbers(on);
  r.col(2) = is_.col(2);
  for (int k = 0; k < m_; ++k)
    for (int c = 0; c < r.cols(); ++c)
      if (std::abs(r(k, c) - is_(k, c)) > kNegligible * (1 + std::abs(is_(k, c))))
        add(fmt::format("velocity {}", k), name(k, c) + " changes with the velocities",
            "gather(): C, Ct and the jacobian follow from the pose and the time; velocities go into Qhat alone");
}

void LockCheck::turns() {
  for (const auto& [p, s] : link_.pairs()) {
    const bool move_p = p->body->slot != kGround;
    turn_about_z((move_p ? p : s)->body->slot, *s, move_p ? 1 : -1, fmt::format("'{}'", (move_p ? p : s)->name));
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
