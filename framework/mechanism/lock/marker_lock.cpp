#include "framework/mechanism/lock/marker_lock.h"

#include <algorithm>

#include "framework/foundation/support/clones.h"
#include "framework/foundation/support/error.h"
#include "framework/mechanism/lock/dispatch.h"
#include "framework/mechanism/lock/marker_lock_gather.h"
#include "framework/mechanism/lock/pair_setup.h"
#include "framework/mechanism/model/law_fault.h"

namespace lockstep {

MarkerLock::MarkerLock(std::string name, Marker& p, Marker& s, Mask mask)
    : Lock(std::move(name)), p_(&p), s_(&s), mask_(mask), rows_(mask) {
  if (p.body == s.body)
    throw ModelError("link '" + this->name() + "': both markers are on body '" + p.body->name +
                     "'; a link joins two bodies, put P or S on another one");
}
MarkerLock::~MarkerLock() = default;

void MarkerLock::refuse_when_set_up(const std::string& what) const {
  if (slots().n == 0) return;
  throw ModelError("link '" + name() + "': " + what +
                   " comes after the system was set up, when its rows are counted already; "
                   "give every law before the first evaluation");
}

void MarkerLock::move(LawPtr<TranslationLaw> law) {
  refuse_when_set_up("a translation law");
  if (!any(mask_, Mask::xyz))
    throw ModelError("link '" + name() + "': a translation law moves rows x y z, and the mask \"" + to_string(mask_) +
                     "\" holds none of them; drive a free axis instead");
  move_ = std::move(law);
}

void MarkerLock::turn(LawPtr<RotationLaw> law) {
  refuse_when_set_up("a rotation law");
  if (!any(mask_, Mask::e123))
    throw ModelError("link '" + name() + "': a rotation law turns rows e1 e2 e3, and the mask \"" + to_string(mask_) +
                     "\" holds none of them; drive a free axis instead");
  turn_ = std::move(law);
}

void MarkerLock::drive(Axis axis, LawPtr<MotionLaw> law) { add_drive({axis, std::move(law), false, 0}); }

void MarkerLock::drive_speed(Axis axis, LawPtr<MotionLaw> law) {
  add_drive({axis, std::move(law), true, n_speeds_});
  ++n_speeds_;
}

void MarkerLock::add_drive(Drive drive) {
  const std::string what = "link '" + name() + "': drive on " + std::string(to_string(drive.axis));
  const Mask bit = row_of(drive.axis);
  refuse_when_set_up("a drive on " + std::string(to_string(drive.axis)));
  if (!drive.law) throw ModelError(what + " has no law; give it one");
  if (has(mask_, bit))
    throw ModelError(what + ": row " + std::string(lockstep::row_name(index(drive.axis))) + " is held by the mask \"" +
                     to_string(mask_) + "\"; drive a free axis, or give the link a law by move or turn");
  if (has(rows_, bit)) throw ModelError(what + ": this axis is driven already; one law an axis");
  if (is_rotation(drive.axis) && !has(mask_ | bit, Mask::e123))
    throw ModelError(what + ": the other two turns are not both held (mask \"" + to_string(mask_) +
                     "\"), so the driven angle has no axis; hold them, or drive a revolute joint");
  rows_ = rows_ | bit;
  drives_.push_back(std::move(drive));
}

std::string MarkerLock::diagnose(double t) const {
  for (const Drive& d : drives_)
    if (std::string f = law_fault("the law of drive " + std::string(to_string(d.axis)), d.law, t); !f.empty()) return f;
  if (std::string f = law_fault("the imposed translation law", move_, t); !f.empty()) return f;
  if (std::string f = law_fault("the imposed rotation law", turn_, t); !f.empty()) return f;
  std::string at_p = marker_fault(*p_, t);
  return at_p.empty() ? marker_fault(*s_, t) : at_p;
}

Quantity MarkerLock::drive(int d) const {
  const Axis axis = drives_[static_cast<std::size_t>(d)].axis;
  return {std::string(to_string(axis)), is_rotation(axis) ? "rad" : "m"};
}

void MarkerLock::breakpoints(double t0, double t1, std::vector<double>& out) const {
  MarkerFrame(*p_).breakpoints(t0, t1, out);
  MarkerFrame(*s_).breakpoints(t0, t1, out);
  if (move_) move_->breakpoints(t0, t1, out);
  if (turn_) turn_->breakpoints(t0, t1, out);
  for (const Drive& d : drives_) d.law->breakpoints(t0, t1, out);
}

RowPlan MarkerLock::plan_rows() {
  if (any(rows_, Mask::e123)) refuse_particles(name(), to_string(rows_ & Mask::e123), *p_, *s_);
  P_ = MarkerFrame(*p_);
  S_ = MarkerFrame(*s_);
  RowPlan plan;
  plan.slots.add(P_.slot);
  plan.slots.add(S_.slot);
  if (plan.slots.n == 0)
    throw ModelError("link '" + name() + "': neither '" + p_->body->name + "' nor '" + s_->body->name +
                     "' can move; join at least one moving body");
  side1_ = plan.slots.position(P_.slot);
  side2_ = plan.slots.position(S_.slot);

  n_rows_ = 0;
  for (int k = 0; k < 6; ++k) {
    if (!has(rows_, row_bit(k))) continue;
    row_[static_cast<std::size_t>(n_rows_++)] = k;
    const auto driven =
        std::find_if(drives_.begin(), drives_.end(), [k](const Drive& d) { return index(d.axis) == k; });
    plan.rows.push_back({k < 3 ? RowKind::translation : RowKind::rotation, std::string(lockstep::row_name(k)),
                         driven == drives_.end() ? -1 : static_cast<int>(driven - drives_.begin())});
  }

  laws_ = with::nothing;
  if (P_.slide) laws_ |= with::uP;
  if (P_.spin) laws_ |= with::qP;
  if (S_.slide) laws_ |= with::uS;
  if (S_.spin) laws_ |= with::qS;
  if (move_) laws_ |= with::p;
  if (turn_) laws_ |= with::qD;
  for (const Drive& d : drives_) laws_ |= is_rotation(d.axis) ? with::qD : with::p;
  if (P_.parallel() && S_.parallel()) laws_ |= with::parallel;
  const auto grounded = static_cast<unsigned char>((side1_ < 0 ? 1 : 0) | (side2_ < 0 ? 2 : 0));
  plan.pattern = {laws_, rows_, mask_, grounded};
  plan.layout = has(rows_, Mask::xyz) ? RowLayout::triple : RowLayout::dense;
  plan.sign = side1_ >= 0 ? 1.0 : -1.0;

  speed_start_.assign(static_cast<std::size_t>(n_speeds_), 0.0);
  for (const Drive& d : drives_)
    if (d.speed) speed_start_[static_cast<std::size_t>(d.state)] = coordinate(d, pose_at_start(*p_, *s_, P_, S_), 0.0);
  return plan;
}

/// rho_k, or the turn of P against S (turned by q_D) about the axis.
double MarkerLock::coordinate(const Drive& d, Pose rel, double t) const {
  const int k = index(d.axis) % 3;
  if (!is_rotation(d.axis)) return rel.x[k];
  if (turn_) rel.q = conjugate(turn_->at(t).q) * rel.q;
  return 2.0 * std::atan2(rel.q.vec()[k], rel.q.w);
}

void MarkerLock::engage(const Inputs& in, std::span<double> s) const {
  const auto pose_of = [&](const MarkerFrame& f) {
    const Motion& O = in.slot(f.slot);
    const MarkerMotion m = f.at(in.t);
    return Pose{O.x, O.e} * Pose{m.u, m.q};
  };
  const Pose rel = inverse(pose_of(S_)) * pose_of(P_);
  for (const Drive& d : drives_)
    if (d.speed) s[static_cast<std::size_t>(d.state)] = coordinate(d, rel, in.t);
}

void MarkerLock::start_states(std::span<double> s) const {
  std::copy(speed_start_.begin(), speed_start_.end(), s.begin());
}

void MarkerLock::state_rates(const Inputs& in, std::span<double> sd) const {
  for (const Drive& d : drives_)
    if (d.speed) sd[static_cast<std::size_t>(d.state)] = d.law->at(in.t).y;
}

// ---------------------------------------------------------------------------------------------------------- evaluation

// The inner loop: one instance for each set of laws that is worth its own code (theory, (5.4)); an absent law in a
// larger set enters as zero.

template <unsigned kLaws>
void MarkerLockGather::translations(Group links, RowSpan out) const {
  TranslationRowsT<double> r;
  ImposedTranslationT<double> D;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& lock = static_cast<const MarkerLock&>(*links[i]);
    if constexpr (kLaws & with::p) D = imposed_translation(lock);
    const Mask rows = kLaws & with::world_rows ? Mask::xyz : lock.rows_;
    const Motion &O1 = in.slot(lock.P_.slot), &O2 = in.slot(lock.S_.slot);
    if constexpr (kLaws & (with::uP | with::uS | with::qS))
      translation<kLaws>(O1, O2, lock.P_.at(in.t), lock.S_.at(in.t), D, rows, r);
    else
      translation<kLaws>(O1, O2, lock.P_.home, lock.S_.home, D, rows, r);
    const RowBlock block = out.lane(i);
    if constexpr (kLaws & with::world_rows) {
      for (int k = 0; k < 3; ++k) block.C(k) = r.C[k], block.Ct(k) = r.Ct[k], block.Qhat(k) = r.Qhat[k];
      block.set_R(r.Jv.transpose());
      block.set_A(lock.side1_, r.Jw1);
      block.set_A(lock.side2_, r.Jw2);
      continue;
    }
    for (int k = 0; k < lock.n_rows_ && lock.row_[static_cast<std::size_t>(k)] < 3; ++k) {
      const int j = lock.row_[static_cast<std::size_t>(k)];
      block.C(k) = r.C[j], block.Ct(k) = r.Ct[j], block.Qhat(k) = r.Qhat[j];
      block.set(lock.side1_, k, r.Jv.row(j), r.Jw1.row(j));
      block.set(lock.side2_, k, -r.Jv.row(j), r.Jw2.row(j));
    }
  }
}

template <unsigned kLaws>
void MarkerLockGather::rotations(Group links, RowSpan out) const {
  RotationRowsT<double> r;
  ImposedRotationT<double> D;
  const int first = count(static_cast<const MarkerLock&>(*links[0]).rows_ & Mask::xyz);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& lock = static_cast<const MarkerLock&>(*links[i]);
    if constexpr (kLaws & with::qD) D = imposed_rotation(lock);
    const Motion &O1 = in.slot(lock.P_.slot), &O2 = in.slot(lock.S_.slot);
    if constexpr (kLaws & (with::qP | with::qS))
      rotation<kLaws>(O1, O2, lock.P_.at(in.t), lock.S_.at(in.t), D, lock.rows_, r);
    else
      rotation<kLaws>(O1, O2, lock.P_.home, lock.S_.home, D, lock.rows_, r);
    const RowBlock block = out.lane(i);
    for (int k = first; k < lock.n_rows_; ++k) {
      const int j = lock.row_[static_cast<std::size_t>(k)] - 3;
      block.C(k) = r.C[j], block.Ct(k) = r.Ct[j], block.Qhat(k) = r.Qhat[j];
      block.set(lock.side1_, k, Vec3::Zero(), r.Jw1.row(j));
      block.set(lock.side2_, k, Vec3::Zero(), r.Jw2.row(j));
    }
  }
}

LOCKSTEP_FLAT_CLONES void MarkerLockGather::both(const MarkerLock& first, Group links, RowSpan out) const {
  if (first.layout() == RowLayout::triple)
    choose_translation<with::world_rows>(first.rows_, first.laws_, [&](auto with) { translations<with>(links, out); });
  else
    choose_translation(first.rows_, first.laws_, [&](auto with) { translations<with>(links, out); });
  choose_rotation(first.rows_, first.laws_, [&](auto with) { rotations<with>(links, out); });
}

void MarkerLock::gather(Group links, const Inputs& in, RowSpan out) const {
  MarkerLockGather{in}.both(*this, links, out);
}

}  // namespace lockstep
