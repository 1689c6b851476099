// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/lock.h>

#include <algorithm>

#include <lockstep/author/relative.h>
#include <lockstep/body.h>
#include <lockstep/error.h>
#include "framework/foundation/support/clones.h"
#include "framework/mechanism/lock/dispatch.h"
#include "framework/mechanism/lock/pair_setup.h"

namespace lockstep {
namespace {

constexpr int kPoseNumbers = 7;  // origin and quaternion of a pose that is held

MarkerMotion at_rest(const MarkerAtRest& home) {
  MarkerMotion m;
  m.u = home.u, m.A = home.A, m.q = home.q;
  return m;
}

LawValue value(const Drive& d, double t, std::span<const double> s) {
  const LawValue l = d.law->at(t);
  return d.speed ? LawValue{s[d.state], l.y, l.yd} : l;
}

}  // namespace

MarkerLock::MarkerLock(std::string name, Marker& p, Marker& s, Mask mask)
    : Lock(std::move(name)), p_(&p), s_(&s), mask_(mask), rows_(mask) {
  if (p.body == s.body)
    throw ModelError("joint '" + this->name() + "': both markers are on body '" + p.body->name +
                     "'; a joint connects two bodies, put P or S on another");
}
MarkerLock::~MarkerLock() = default;

bool MarkerLock::has_laws() const { return (laws_ & with::all_laws) != 0; }

const ImposedMotion& MarkerLock::imposed() const {
  static const ImposedMotion kNone;
  return lawful_ ? lawful_->imposed : kNone;
}

MarkerLock::Lawful& MarkerLock::lawful() {
  if (!lawful_) lawful_ = std::make_unique<Lawful>();
  return *lawful_;
}

MarkerMotion MarkerLock::P_at(double t) const { return lawful_ ? lawful_->P.at(t) : at_rest(P_); }
MarkerMotion MarkerLock::S_at(double t) const { return lawful_ ? lawful_->S.at(t) : at_rest(S_); }

void MarkerLock::refuse_when_set_up(const std::string& what) const {
  if (slots().n == 0) return;
  throw ModelError({.thing = {"joint", name(), std::string(type()), origin()},
                    .problem = what + " is added after the system was set up",
                    .advice = "give every law before the first evaluation"});
}

void MarkerLock::move(LawPtr<TranslationLaw> law) {
  refuse_when_set_up("a translation law");
  if (!overlaps(mask_, Mask::xyz))
    throw ModelError("joint '" + name() + "': a translation law moves the constraints x y z, but the mask \"" +
                     to_string(mask_) + "\" has none of them; drive a free axis instead");
  lawful().imposed.move = std::move(law);
}

void MarkerLock::turn(LawPtr<RotationLaw> law) {
  refuse_when_set_up("a rotation law");
  if (!overlaps(mask_, Mask::e123))
    throw ModelError("joint '" + name() + "': a rotation law moves the constraints e1 e2 e3, but the mask \"" +
                     to_string(mask_) + "\" has none of them; drive a free axis instead");
  lawful().imposed.turn = std::move(law);
}

void MarkerLock::drive(Axis axis, LawPtr<MotionLaw> law) { add_drive({axis, std::move(law), false, 0}); }

void MarkerLock::drive_speed(Axis axis, LawPtr<MotionLaw> law) {
  add_drive({axis, std::move(law), true, n_states()});
  ++lawful().n_states;
}

void MarkerLock::hold() {
  refuse_when_set_up("\"hold\"");
  if (mask_ == Mask::none)
    throw ModelError("joint '" + name() + "': its mask is empty, so \"hold\" constrains nothing; give it a mask");
  lawful().imposed.hold = true;
  lawful().n_states = kPoseNumbers;
}

void MarkerLock::add_drive(Drive drive) {
  const std::string what = "drive on " + std::string(to_string(drive.axis));
  const Mask bit = row_of(drive.axis);
  const auto reject = [&](const std::string& problem, const std::string& advice) {
    throw ModelError(
        {.thing = {"joint", name(), std::string(type()), origin()}, .problem = what + problem, .advice = advice});
  };
  refuse_when_set_up("a " + what);
  if (!drive.law) reject(" has no law", "give it one");
  if (includes(mask_, bit)) {
    std::string free;
    for (int k = 0; k < 6; ++k)
      if (const Axis axis = static_cast<Axis>(k); !includes(rows_, row_of(axis)))
        free += (free.empty() ? "" : ", ") + std::string(to_string(axis));
    reject(
        ": the joint holds this coordinate",
        (free.empty() ? "this joint has no free one: use another type, or " : "drive a free one (" + free + "), or ") +
            "prescribe this one by move or turn; the axis of a joint is z of its marker S");
  }
  if (includes(rows_, bit)) reject(": this axis is driven already", "one law per axis");
  if (is_rotation(drive.axis) && !includes(mask_ | bit, Mask::e123))
    reject(": the other two rotations are not both constrained (mask \"" + to_string(mask_) +
               "\"), so the driven angle has no axis",
           "constrain them, or drive a revolute joint");
  rows_ = rows_ | bit;
  lawful().imposed.drives.push_back(std::move(drive));
}

std::string MarkerLock::diagnose(double t) const {
  for (const Drive& d : imposed().drives)
    if (std::string f = law_fault("the law of drive " + std::string(to_string(d.axis)), d.law, t); !f.empty()) return f;
  if (std::string f = law_fault("the imposed translation law", imposed().move, t); !f.empty()) return f;
  if (std::string f = law_fault("the imposed rotation law", imposed().turn, t); !f.empty()) return f;
  std::string at_p = marker_fault(*p_, t);
  return at_p.empty() ? marker_fault(*s_, t) : at_p;
}

Quantity MarkerLock::drive(int d) const {
  const Axis axis = imposed().drives[d].axis;
  return {std::string(to_string(axis)), is_rotation(axis) ? "rad" : "m"};
}

void MarkerLock::breakpoints(double t0, double t1, std::vector<double>& out) const {
  MarkerFrame(*p_).breakpoints(t0, t1, out);
  MarkerFrame(*s_).breakpoints(t0, t1, out);
  const ImposedMotion& laws = imposed();
  if (laws.move) laws.move->breakpoints(t0, t1, out);
  if (laws.turn) laws.turn->breakpoints(t0, t1, out);
  for (const Drive& d : laws.drives) d.law->breakpoints(t0, t1, out);
}

RowPlan MarkerLock::plan_rows() {
  if (overlaps(rows_, Mask::e123)) refuse_particles(name(), to_string(rows_ & Mask::e123), *p_, *s_);
  const MarkerFrame P(*p_), S(*s_);
  P_ = {P.u0, P.A0, P.q0}, S_ = {S.u0, S.A0, S.q0};
  slot1_ = P.slot, slot2_ = S.slot;
  flat_ = nullptr;
  RowPlan plan;
  plan.slots.add(slot1_);
  plan.slots.add(slot2_);
  if (plan.slots.n == 0)
    throw ModelError("joint '" + name() + "': neither '" + p_->body->name + "' nor '" + s_->body->name +
                     "' can move; join at least one moving body");
  side1_ = static_cast<signed char>(plan.slots.position(slot1_));
  side2_ = static_cast<signed char>(plan.slots.position(slot2_));

  const ImposedMotion& imposed = this->imposed();
  plan.rows.reserve(count_rows(rows_));
  for (int k = 0; k < 6; ++k) {
    if (!includes(rows_, row_bit(k))) continue;
    row_[plan.rows.size()] = static_cast<signed char>(k);
    const auto driven = std::find_if(imposed.drives.begin(), imposed.drives.end(),
                                     [k](const Drive& d) { return axis_index(d.axis) == k; });
    plan.rows.push_back({k < 3 ? RowKind::translation : RowKind::rotation, std::string(lockstep::row_name(k)),
                         driven == imposed.drives.end() ? -1 : static_cast<int>(driven - imposed.drives.begin())});
  }
  n_rows_ = static_cast<signed char>(plan.rows.size());

  laws_ = with::nothing;
  if (P.translation_law) laws_ |= with::uP;
  if (P.rotation_law) laws_ |= with::qP;
  if (S.translation_law) laws_ |= with::uS;
  if (S.rotation_law) laws_ |= with::qS;
  if (imposed.move) laws_ |= with::p;
  if (imposed.turn) laws_ |= with::qD;
  for (const Drive& d : imposed.drives) laws_ |= is_rotation(d.axis) ? with::qD : with::p;
  if (imposed.hold && (imposed.move || imposed.turn || !imposed.drives.empty() || unilateral() != nullptr))
    throw ModelError("joint '" + name() + "': \"hold\" excludes laws and one-sided joints; remove one of the two");
  if (imposed.hold && overlaps(mask_, Mask::xyz)) laws_ |= with::p;
  if (imposed.hold && overlaps(mask_, Mask::e123)) laws_ |= with::qD;
  if (P.parallel() && S.parallel()) laws_ |= with::parallel;
  const auto grounded = static_cast<unsigned char>((side1_ < 0 ? 1 : 0) | (side2_ < 0 ? 2 : 0));
  plan.pattern = {laws_, rows_, mask_, grounded};
  plan.layout = includes(rows_, Mask::xyz) ? RowLayout::triple : RowLayout::dense;
  plan.sign = side1_ >= 0 ? 1.0 : -1.0;

  if ((laws_ & with::all_laws) == 0) {
    lawful_ = nullptr;
    return plan;
  }
  Lawful& own = lawful();
  own.P = P, own.S = S;
  own.states_start.assign(own.n_states, 0.0);
  if (own.n_states > 0) take_states(pose_at_start(*p_, *s_, P, S), 0.0, own.states_start);
  return plan;
}

/// rho_k, or the turn of P against S (turned by q_D) about the axis.
double MarkerLock::coordinate(const Drive& d, Pose rel, double t) const {
  const int k = axis_index(d.axis) % 3;
  if (!is_rotation(d.axis)) return rel.x[k];
  if (imposed().turn) rel.q = conjugate(imposed().turn->at(t).q) * rel.q;
  return 2.0 * std::atan2(rel.q.vec()[k], rel.q.w);
}

void MarkerLock::engage(const Inputs& in, std::span<double> s) const {
  const auto pose_of = [&](int slot, const MarkerMotion& m) {
    const Motion& O = in.slot(slot);
    return Pose{O.x, O.e} * Pose{m.u, m.q};
  };
  take_states(inverse(pose_of(slot2_, S_at(in.t))) * pose_of(slot1_, P_at(in.t)), in.t, s);
}

void MarkerLock::take_states(const Pose& rel, double t, std::span<double> s) const {
  for (const Drive& d : imposed().drives)
    if (d.speed) s[d.state] = coordinate(d, rel, t);
  if (!imposed().hold) return;
  const Vec4 q = rel.q.coefficients();
  std::copy(rel.x.begin(), rel.x.end(), s.begin());
  std::copy(q.begin(), q.end(), s.begin() + 3);
}

void MarkerLock::start_states(std::span<double> s) const {
  if (lawful_) std::copy(lawful_->states_start.begin(), lawful_->states_start.end(), s.begin());
}

void MarkerLock::state_rates(const Inputs& in, std::span<double> sd) const {
  if (imposed().hold) std::fill(sd.begin(), sd.end(), 0.0);
  for (const Drive& d : imposed().drives)
    if (d.speed) sd[d.state] = d.law->at(in.t).y;
}

// ---------------------------------------------------------------------------------------------------------- evaluation

ImposedTranslation ImposedMotion::translation(double t, std::span<const double> s) const {
  ImposedTranslation D;
  if (move) {
    const TranslationValue l = move->at(t);
    D.p = l.x, D.pd = l.v, D.pdd = l.a;
  }
  if (hold) D.p = Vec3(s[0], s[1], s[2]);
  for (const Drive& d : drives) {
    if (is_rotation(d.axis)) continue;
    const int k = axis_index(d.axis);
    const LawValue l = value(d, t, s);
    D.p[k] = l.y, D.pd[k] = l.yd, D.pdd[k] = l.ydd;
  }
  return D;
}

ImposedRotation ImposedMotion::rotation(double t, std::span<const double> s) const {
  ImposedRotation D;
  if (turn) {
    const RotationValue l = turn->at(t);
    D.q = l.q, D.w = l.w, D.a = l.a;
  }
  if (hold) D.q = Quat::from(s[3], Vec3(s[4], s[5], s[6]));
  for (const Drive& d : drives) {  // q_D <- q_D Rot_k(y): at most one, since the other two turns are held
    if (!is_rotation(d.axis)) continue;
    const Vec3 n = Vec3::Unit(axis_index(d.axis) % 3);
    const LawValue l = value(d, t, s);
    const Quat r = Quat::from(std::cos(0.5 * l.y), Vec3(std::sin(0.5 * l.y) * n));
    const Mat3 At = lockstep::rotation(r).transpose();
    const Vec3 w = At * D.w;
    D.a = At * D.a + cross(w, Vec3(l.yd * n)) + l.ydd * n;
    D.w = w + l.yd * n;
    D.q = D.q * r;
  }
  D.A = lockstep::rotation(D.q);
  return D;
}

// The inner loops: one instance per set of laws that is worth its own code (theory, (5.4)).

template <unsigned kWith>
void MarkerLock::gather_translations(Group links, const Inputs& in, RowSpan out) {
  ImposedTranslation D;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& lock = static_cast<const MarkerLock&>(*links[i]);
    const RowBlock block = out.lane(i);
    const auto put = [&](const auto& C, const auto& Ct, const auto& Qhat, const auto& row, const auto&)
        __attribute__((always_inline)) {
      int at = 0;
      const auto values = [&]<int k>() __attribute__((always_inline)) {
        block.C(at) = vec::get<k>(C), block.Qhat(at) = vec::get<k>(Qhat);
        block.Ct(at) = vec::number<double>(vec::get<k>(Ct));
      };
      if constexpr (kWith & with::world_rows) {
        kernel::for_rows(
            Mask::xyz, 0, [&]<int k>() __attribute__((always_inline)) { values.template operator()<k>(), ++at; });
        const auto x = row(vec::Unit<0>{});
        const auto y = row(vec::Unit<1>{});
        const auto z = row(vec::Unit<2>{});
        block.set_R(vec::columns(x.v, y.v, z.v));
        block.set_A(lock.side1_, vec::Matrix{x.w1, y.w1, z.w1});
        block.set_A(lock.side2_, vec::Matrix{x.w2, y.w2, z.w2});
      } else {
        kernel::for_rows(
            lock.rows_, 0, [&]<int k>() __attribute__((always_inline)) {
              values.template operator()<k>();
              const auto r = row(vec::Unit<k>{});
              block.set(lock.side1_, at, r.v, vec::numbers<double>(r.w1));
              block.set(lock.side2_, at, -r.v, vec::numbers<double>(r.w2));
              ++at;
            });
      }
    };
    if constexpr (kWith & with::p) D = lock.imposed_translation(in);
    const Motion &O1 = in.slot(lock.slot1_), &O2 = in.slot(lock.slot2_);
    if constexpr (kWith & (with::uP | with::uS | with::qS))
      translation<kWith>(O1, O2, lock.lawful_->P.at(in.t), lock.lawful_->S.at(in.t), D, put);
    else
      translation<kWith>(O1, O2, lock.P_, lock.S_, D, put);
  }
}

template <unsigned kWith>
void MarkerLock::gather_rotations(Group links, const Inputs& in, RowSpan out) {
  ImposedRotation D;
  const int first = count_rows(static_cast<const MarkerLock&>(*links[0]).rows_ & Mask::xyz);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& lock = static_cast<const MarkerLock&>(*links[i]);
    const RowBlock block = out.lane(i);
    const auto put = [&](const auto& e, const auto& Ct, const auto& Qhat, const auto& row, const auto&)
        __attribute__((always_inline)) {
      int at = first;
      kernel::for_rows(
          lock.rows_, 3, [&]<int k>() __attribute__((always_inline)) {
            block.C(at) = vec::get<k>(e.v), block.Qhat(at) = vec::get<k>(Qhat.v);
            block.Ct(at) = vec::number<double>(vec::get<k>(Ct.v));
            const auto r = row(vec::Quaternion{vec::Zero{}, vec::Unit<k>{}});
            block.set(lock.side1_, at, Vec3::Zero(), vec::numbers<double>(r.w1));
            block.set(lock.side2_, at, Vec3::Zero(), vec::numbers<double>(r.w2));
            ++at;
          });
    };
    if constexpr (kWith & with::qD) D = lock.imposed_rotation(in);
    const Motion &O1 = in.slot(lock.slot1_), &O2 = in.slot(lock.slot2_);
    if constexpr (kWith & (with::qP | with::qS))
      rotation<kWith>(O1, O2, lock.lawful_->P.at(in.t), lock.lawful_->S.at(in.t), D, put);
    else
      rotation<kWith>(O1, O2, lock.P_, lock.S_, D, put);
  }
}

// Gathers MarkerLock's rows only: a class that adds rows calls this with its whole group.
LOCKSTEP_FLAT_CLONES void MarkerLock::gather_all(Group links, const Inputs& in, RowSpan out) const {
  if (layout() == RowLayout::triple)
    choose_translation<with::world_rows>(rows_, laws_, [&](auto with) { gather_translations<with>(links, in, out); });
  else
    choose_translation(rows_, laws_, [&](auto with) { gather_translations<with>(links, in, out); });
  choose_rotation(rows_, laws_, [&](auto with) { gather_rotations<with>(links, in, out); });
}
void MarkerLock::gather(Group links, const Inputs& in, RowSpan out) const { gather_all(links, in, out); }

}  // namespace lockstep
