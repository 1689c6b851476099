// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/cause.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include <lockstep/analysis.h>
#include <lockstep/author/lock.h>
#include <lockstep/system.h>
#include <lockstep/text.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/simulate/contacts.h"
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/dynamics/simulate/start_rows.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/scales.h"
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/rank/branch_point.h"
#include "framework/tools/rank/loop_rows.h"

namespace lockstep {
namespace {

using Names = std::vector<std::string>;

// -- loops that cannot close: one body is longer than all others together

/// A joint that holds a point of one body at a point of another, without a law, or that slides along an axis of S and
/// holds all rotations.
struct LoopJoint {
  const Lock* link;
  const Marker *p, *s;
  int slide = -1;  // the axis
};

std::vector<LoopJoint> loop_joints(const System& system, const State& state) {
  std::vector<LoopJoint> all;
  for (const auto& link : system.links()) {
    const Jointed* joint = link->jointed();
    if (joint == nullptr || !state.modes[link->number()]) continue;
    const auto [p, s] = link->pairs().front();
    if (joint->imposed().move || joint->imposed().hold || p->translation_law || s->translation_law) continue;
    const Mask points = joint->mask() & Mask::xyz;
    LoopJoint& made = all.emplace_back(LoopJoint{link.get(), p, s});
    if (points == Mask::xyz) continue;
    for (const Axis axis : {Axis::x, Axis::y, Axis::z})
      if (!includes(points, row_of(axis))) made.slide = axis_index(axis);
    if (count_rows(points) != 2 || (joint->mask() & Mask::e123) != Mask::e123) all.pop_back();
  }
  return all;
}

Pose frame_in_slot(const Marker& m) { return (m.body->slot == kGround ? m.body->home : m.body->in_slot) * m.local; }

/// A part of a loop between two of its joints: a body, or bodies that do not rotate relative to each other.
struct Span {
  Names bodies;
  const LoopJoint *from, *to;
  Pose a, b;  // the frames of its markers, in the slot of its first body
  int slot;
  Names drives{};
  Vec3 slide = Vec3::Zero();  // a direction in which it changes its length; none: zero
  double length() const { return (b.x - a.x - (b.x - a.x).dot(slide) * slide).norm(); }  // the least
  bool slides() const { return !slide.isZero(0); }
};

Span span_of(const LoopJoint& from, const LoopJoint& to, int slot) {
  const auto on = [slot](const LoopJoint& j) { return j.p->body->slot == slot ? *j.p : *j.s; };
  return {{on(from).body->name}, &from, &to, frame_in_slot(on(from)), frame_in_slot(on(to)), slot};
}

// The loop that each joint closes with those before it, which are a tree.
std::vector<std::vector<Span>> loops(const std::vector<LoopJoint>& joints, int n_slots) {
  std::vector<std::vector<Span>> all;
  std::vector<std::vector<std::size_t>> of_slot(n_slots + 1);  // joints of the tree, by slot + 1
  Parts parts(n_slots + 1);
  for (std::size_t last = 0; last < joints.size(); ++last) {
    const int a = joints[last].p->body->slot, b = joints[last].s->body->slot;
    if (a == b) continue;
    if (join(parts, a + 1, b + 1)) {
      of_slot[a + 1].push_back(last), of_slot[b + 1].push_back(last);
      continue;
    }
    std::map<int, std::size_t> by{{a, last}};  // the joint by which a slot is reached from a
    std::vector<int> queue{a};
    for (std::size_t i = 0; i < queue.size(); ++i)
      for (const std::size_t k : of_slot[queue[i] + 1]) {
        const int p = joints[k].p->body->slot, next = p == queue[i] ? joints[k].s->body->slot : p;
        if (by.emplace(next, k).second) queue.push_back(next);
      }
    std::vector<Span>& loop = all.emplace_back();
    std::size_t out = last;
    for (int slot = b;;) {
      const std::size_t in = by.at(slot);
      loop.push_back(span_of(joints[out], joints[in], slot));
      if (slot == a) break;
      const int p = joints[in].p->body->slot;
      slot = p == slot ? joints[in].s->body->slot : p, out = in;
    }
  }
  return all;
}

/// Makes one span of two whose joint allows no rotation, or none but what its drive prescribes if `driven`.
void merge_spans(std::vector<Span>& loop, double t, bool driven) {
  for (std::size_t i = 0; i < loop.size() && loop.size() > 2;) {
    const std::size_t next = (i + 1) % loop.size();
    Span &one = loop[i], &two = loop[next];
    const LoopJoint& joint = *one.to;
    const Jointed& jointed = *joint.link->jointed();
    const ImposedMotion& laws = jointed.imposed();
    const Mask held = driven ? jointed.rows() : jointed.mask();
    const bool slides = (held & Mask::xyz) != Mask::xyz;
    if ((held & Mask::e123) != Mask::e123 || joint.p->rotation_law || joint.s->rotation_law ||
        (slides && (one.slides() || two.slides())) || std::ranges::any_of(laws.drives, &Drive::speed)) {
      ++i;
      continue;
    }
    const Pose of_p = named(*joint.link, t, [&] { return Pose{laws.translation(t, {}).p, laws.rotation(t, {}).q}; });
    const bool has_s = joint.s->body->slot == one.slot;
    const Pose across = one.b * (has_s ? of_p : inverse(of_p)), to_one = across * inverse(two.a);
    if (slides)
      one.slide = rotation(has_s ? one.b.q : across.q).col(joint.slide);
    else if (two.slides())
      one.slide = rotation(to_one.q) * two.slide;
    one.b = to_one * two.b;
    one.bodies.insert(one.bodies.end(), two.bodies.begin(), two.bodies.end()), one.to = two.to;
    if (driven && !laws.empty()) one.drives.push_back(joint.link->name());
    for (const std::string& name : two.drives) one.drives.push_back(name);
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(next));
    if (next < i) --i;
  }
}

Cause cause_of_loop(const std::vector<Span>& loop) {
  const auto n_slides = std::ranges::count_if(loop, &Span::slides);
  if (n_slides > 1 || std::ranges::any_of(loop, [](const Span& s) { return s.to->slide >= 0; })) return {};
  const auto longest =
      n_slides == 1 ? std::ranges::find_if(loop, &Span::slides) : std::ranges::max_element(loop, {}, &Span::length);
  double rest = 0;
  Names others, drives;
  for (const Span& s : loop) {
    if (&s != &*longest) rest += s.length(), others.insert(others.end(), s.bodies.begin(), s.bodies.end());
    drives.insert(drives.end(), s.drives.begin(), s.drives.end());
  }
  const double length = longest->length(), open = length - rest;
  if (!(open > kNegligible * length)) return {};
  const std::string from = longest->from->link->name(), to = longest->to->link->name();
  const bool one = drives.size() == 1;
  const std::string at_start = drives.empty() ? ""
                               : one          ? "with drive " + drives[0] + " at its start, "
                                              : "with drives " + text::join(drives) + " at their starts, ";
  const std::string elsewhere = drives.empty() ? ""
                                : one          ? ", or let drive " + drives[0] + " begin elsewhere"
                                               : ", or let one of the drives begin elsewhere";
  const int digits = fmt::format("{:.3g}", length) == fmt::format("{:.3g}", rest) ? 9 : 3;
  const std::string bodies = text::join(longest->bodies);
  Cause cause;
  cause.fact = fmt::format(
      "the mechanism cannot be assembled: {}a loop is open by {:.3g} m. {} {} {:.{}g} m from joint {} to joint {}, but "
      "{} {:.{}g} m{}",
      at_start, open, bodies,
      (longest->bodies.size() > 1 ? "together span" : "spans") + std::string(longest->slides() ? " at least" : ""),
      length, digits, from, to, text::join(others) + (others.size() > 1 ? " reach" : " reaches"), rest, digits,
      others.size() > 1 ? " together" : "");
  const bool apart = longest->slot == kGround || !longest->drives.empty() || longest->slides();
  if (length > 100 * rest)  // a unit is wrong
    cause.hint =
        fmt::format("check the unit of {}: \"200 mm\" is 0.2",
                    apart ? "the places of joints " + from + " and " + to + " on " + bodies : "a length of " + bodies);
  else if (apart)
    cause.hint =
        fmt::format("place joints {} and {} at least {:.3g} m nearer to each other, or make the other bodies longer",
                    from, to, open) +
        elsewhere;
  else
    cause.hint = fmt::format("make {} at least {:.3g} m shorter, or the other bodies longer", bodies, open) + elsewhere;
  if (drives.size() > 1) cause.hint = "remove one of the drives " + text::join(drives) + ", or " + cause.hint;
  return cause;
}

Cause open_loop(const System& system, const State& state) {
  const std::vector<LoopJoint> joints = loop_joints(system, state);
  const std::vector<std::vector<Span>> all = loops(joints, system.n_slots());
  for (const bool driven : {false, true})
    for (std::vector<Span> loop : all) {
      merge_spans(loop, state.t, driven);
      if (Cause cause = cause_of_loop(loop); cause.found()) return cause;
    }
  return {};
}

// -- rows that contradict, or lock

/// "1 rad/s": this part of the rate that a drive prescribes; or "1 rad" of its position.
std::string asked(const NamedRow& row, double t, double part, bool rate = true) {
  const int d = row.link->row(row.own).drive;
  const Jointed* joint = row.link->jointed();
  if (joint == nullptr || d >= static_cast<int>(joint->imposed().drives.size())) return "";
  const Drive& drive = joint->imposed().drives[d];
  const LawValue law = drive.law->at(t);
  return fmt::format("{:.4g} {}{}", part * (rate && !drive.speed ? law.yd : law.y), row.link->driven()->drive(d).unit,
                     rate ? "/s" : "");
}

/// A combination of rows that is zero, although laws prescribe its change: the drives, stops and joints in it.
struct Contradiction {
  Names drives, stops, joints, guides;  // guides: joints with a free translation
  std::string wrong, rates;             // the last drive that moves; its rate, and that which agrees with the others
  Names positions;                      // of the drives
};

std::optional<Contradiction> contradiction(const System& system, const Evaluation& e, const VecX& rates, double t) {
  const RowTable& table = e.rows();
  for (const std::vector<int>& entries : loops_of(system, table)) {
    const LoopRows rows(system, table, entries);
    const Dependencies found(rows.Jt, kNearlyDependent);
    for (Eigen::Index c = 0; c < found.circuits.cols(); ++c) {
      double sum = 0, size = 0;
      bool opens = false;
      const auto takes_part = [&](int k) { return std::abs(found.circuits(k, c)) > kNearlyDependent; };
      for (int k = 0; k < rows.n(); ++k) {
        const double part = takes_part(k) ? found.circuits(k, c) * rates[rows.numbers[k]] : 0;
        sum += part, size += std::abs(part);
      }
      for (int k = 0; k < rows.n(); ++k)
        if (const Unilateral* side = NamedRow(system, table, rows.numbers[k]).link->unilateral(); side && takes_part(k))
          opens = opens || side->sign() * sum * found.circuits(k, c) > 0;
      if (opens || !(std::abs(sum) > kNearlyDependent * size)) continue;
      Contradiction who;
      for (int k = 0; k < rows.n(); ++k) {
        if (!takes_part(k)) continue;
        const NamedRow row(system, table, rows.numbers[k]);
        if (const std::string drive = row.drive(); !drive.empty()) {
          who.drives.push_back(drive), who.positions.push_back(asked(row, t, 1, false));
          if (const double part = found.circuits(k, c) * rates[rows.numbers[k]]; part != 0)
            who.wrong = drive,
            who.rates = fmt::format("{} prescribes {}, but {}", drive, asked(row, t, 1), asked(row, t, 1 - sum / part));
        } else {
          add_name(row.link->name(), row.link->unilateral() != nullptr ? who.stops : who.joints);
          const Jointed* joint = row.link->jointed();
          if (joint != nullptr && (joint->mask() & Mask::xyz) != Mask::xyz) add_name(row.link->name(), who.guides);
        }
      }
      return who;
    }
  }
  return {};
}

/// Active joints whose mask holds these coordinates of a group, and their axes z of S.
std::vector<std::pair<const Lock*, Vec3>> axes_of(Dynamics& dynamics, const State& state, Mask held, Mask group) {
  std::vector<std::pair<const Lock*, Vec3>> axes;
  const Inputs& in = dynamics.inputs(state);
  for (const auto& link : dynamics.system().links()) {
    const Jointed* joint = link->jointed();
    if (joint == nullptr || !state.modes[link->number()] || (joint->mask() & group) != held) continue;
    const auto [p, s] = link->pairs().front();
    axes.emplace_back(link.get(), in_world(MarkerFrame(*s), in).A.col(2));
  }
  return axes;
}
double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(cross(a, b).norm(), std::abs(a.dot(b))); }

/// Advice for a guide that slides along the axis of hinges, as it does without "axis"; "" if there is none.
std::string to_plane(Dynamics& dynamics, const State& state) {
  const Mask guided = Mask::x | Mask::y | Mask::e1 | Mask::e2;  // prismatic, or cylindrical
  for (const auto& [guide, along] : axes_of(dynamics, state, guided, guided | Mask::z)) {
    Names hinges;
    for (const auto& [hinge, axis] : axes_of(dynamics, state, Mask::e1 | Mask::e2, Mask::e123))
      if (hinge != guide && angle_between(axis, along) <= kNearlyDependent) hinges.push_back(hinge->name());
    if (hinges.size() > 1)
      return fmt::format(
          "joint {} slides along the normal of the plane in which joints {} move; give it an axis in that "
          "plane, such as \"axis\": \"{}\"",
          guide->name(), text::join(hinges), 2 * std::abs(along[0]) < 1 ? "x" : "y");
  }
  return {};
}

Cause locked(Dynamics& dynamics, const State& state) {
  const MobilityReport mobile = mobility(dynamics, state);
  if (mobile.locked.empty()) return {};
  Cause cause;
  cause.fact = fmt::format("{} is locked: its joints leave no degree of freedom, so drive {} cannot move it",
                           mobile.freedoms > 0 ? "a loop" : "the mechanism", text::join(mobile.locked));
  cause.kind = Error::Kind::assembly;
  if (const std::string odd = odd_axis(dynamics, state); !odd.empty())
    cause.hint = odd;
  else if (cause.hint = to_plane(dynamics, state); !cause.hint.empty())
    return cause;
  else if (!mobile.redundant_links.empty())
    cause.hint =
        fmt::format("release one constraint of joints {}, or correct their axes", text::join(mobile.redundant_links));
  else
    cause.hint = "release a constraint, or remove a joint (lockstep check --verbose)";
  return cause;
}

// -Qhat, 1 per row.
VecX accelerations_asked(const Evaluation& e) {
  VecX asked = VecX::Zero(e.rows().n_rows);
  for (const RowEntry& entry : e.rows().entries)
    for (int k = 0; k < entry.m; ++k) asked[entry.first_row + k] = -e.rows().block(entry).Qhat(k);
  return asked;
}

/// One-sided joints at contact as closed.
void close_stops(Dynamics& dynamics, State& state) {
  const double length = dynamics.system().length();
  Contacts contacts;
  contacts.lay_out(dynamics.system(), dynamics.options().stabilization);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts.watched(i, state) &&
        contacts.gap(i, dynamics.inputs(state)).c * length_per_unit(contacts[i].link->row_kind(0), length) <=
            kSlight * length)
      contacts.put(i, true, state);
}

Cause contradicting(Dynamics& dynamics, const State& at) {
  State moving = dynamics.in_slots(at);
  close_stops(dynamics, moving);
  State still = moving;
  still.v.setZero();
  const Evaluation& e = dynamics.gather_rows(still);
  VecX C, rates;
  e.residuals(C, rates);
  const System& system = dynamics.system();
  std::optional<Contradiction> who = contradiction(system, e, rates, at.t);
  Names leading;  // joints whose laws change them
  for (int k = 0; k < rates.size(); ++k)
    if (rates[k] != 0) add_name(NamedRow(system, e.rows(), k).link->name(), leading);
  bool is_open = false;
  if (!who && dynamics.violation(still) > StepLoopOptions().start_limit) {
    who = contradiction(system, e, C, at.t);
    if (who && who->drives.size() < 2) who.reset();
    is_open = who.has_value();
  }
  if (!who) {
    const Evaluation& of_motion = dynamics.gather_rows(moving);
    if ((who = contradiction(system, of_motion, accelerations_asked(of_motion), at.t))) who->rates.clear();
  }
  if (!who) return {};
  const std::string when = fmt::format("at t = {:.4g} s", at.t);
  const std::string guide = to_plane(dynamics, still);
  const std::string first = tests_first(system, who->joints);
  const std::string joints = (who->joints.size() > 1 ? "the loop of joints " : "joint ") + text::join(who->joints);
  const std::string other_lengths =
      !guide.empty()
          ? guide
          : first + "change the lengths" + (who->guides.empty() ? "" : " or the axis of " + text::join(who->guides));
  const std::string mover = !who->drives.empty() ? "drive " + who->drives.front()
                            : leading.empty()    ? ""
                                                 : "the law of '" + leading.front() + "'";
  if (!who->stops.empty() && !mover.empty())
    return Cause{fmt::format("{} runs into stop {} {}", mover, text::join(who->stops), when),
                 "end the motion before the stop, or move the stop", Error::Kind::assembly};
  if (who->drives.empty() && guide.empty() && branch_point(dynamics, still).singular)
    return Cause{fmt::format("the configuration {} is singular: the direction in which {} continues, if there is one, "
                             "is undetermined",
                             when, joints),
                 first + "start near it, on the intended side, or " +
                     (mover.empty() ? "give every joint of the loop a velocity along one branch" : other_lengths),
                 Error::Kind::step, at.t};
  if (who->drives.empty())
    return Cause{fmt::format("{}{} allows no further motion {}: the configuration is singular",
                             mover.empty() ? "" : mover + " cannot continue: ", joints, when),
                 other_lengths + ", or release one constraint of these joints", Error::Kind::step, at.t};
  if (who->drives.size() > 1) {
    const std::string fact = fmt::format("drives {} contradict {}: ", text::join(who->drives, " and "), when);
    std::erase(who->drives, who->wrong);
    return Cause{
        fact + (is_open ? "the positions that they prescribe do not agree, " + text::join(who->positions, " and ")
                : who->rates.empty() ? "they prescribe accelerations that do not agree"
                                     : who->rates + " is required of it by " + text::join(who->drives, " and ")),
        first + "remove one of them, or make their motions agree"};
  }
  if (Cause cause = locked(dynamics, still); cause.found()) return cause;
  return Cause{fmt::format("drive {} has reached a limit position (dead centre) {}: {} allows no further motion",
                           who->drives.front(), when, joints),
               other_lengths + (at.t > 0 ? ", or end the motion before it" : ", or begin away from it"),
               Error::Kind::step, at.t};
}

// The evaluation that a fact needs may be what fails: then there is no fact.
Cause first_found(std::initializer_list<std::function<Cause()>> finders) {
  for (const auto& find : finders) try {
      if (Cause cause = find(); cause.found()) return cause;
    } catch (const Error&) {
    }
  return {};
}

}  // namespace

std::string odd_axis(Dynamics& dynamics, const State& state) {
  const auto axes = axes_of(dynamics, state, Mask::e1 | Mask::e2, Mask::e123);
  const Inputs& in = dynamics.inputs(state);
  for (std::size_t i = 0; i < axes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const auto [p, s] = axes[i].first->pairs().front();
      const auto [p2, s2] = axes[k].first->pairs().front();
      if (std::minmax(p->body->slot, s->body->slot) != std::minmax(p2->body->slot, s2->body->slot)) continue;
      if (angle_between(axes[i].second, axes[k].second) > kNearlyDependent) continue;
      const Vec3 way = in_world(MarkerFrame(*s2), in).x - in_world(MarkerFrame(*s), in).x;
      if (const double apart = cross(way, axes[i].second).norm(); apart > kNegligible * way.norm())
        return fmt::format(
            "correct the place of joint {} or {}: both connect the same bodies, but their axes are {:.3g} m apart",
            axes[k].first->name(), axes[i].first->name(), apart);
    }
  if (axes.size() < 3) return {};
  for (const auto& [of, shared] : axes) {
    std::vector<std::pair<const Lock*, double>> odd;
    for (const auto& [link, axis] : axes) {
      const double angle = angle_between(shared, axis);
      if (angle > kNegligible) odd.emplace_back(link, angle);
    }
    if (odd.size() == 1)
      return fmt::format("correct the axis of joint {}: it is {:.3g} deg off the axes of all other joints",
                         odd.front().first->name(), degrees(odd.front().second));
  }
  return {};
}

// Rates that drives prescribe are compared at the assembled pose, if there is one.
Cause cause_of_start(Dynamics& dynamics, const State& given) {
  const auto assembled = [&] {
    State pose = dynamics.in_slots(given);
    return approach_links(dynamics, pose, kRoundOff * dynamics.system().length()) ? pose : given;
  };
  const auto misplaced = [&] {
    const std::string advice = odd_axis(dynamics, given);
    if (advice.empty() || mobility(dynamics, given).freedoms > 0) return Cause{};
    return Cause{"the mechanism is locked: its joints leave no degree of freedom", advice};
  };
  return first_found({[&] { return open_loop(dynamics.system(), given); },
                      [&] { return contradicting(dynamics, assembled()); }, [&] { return locked(dynamics, given); },
                      misplaced});
}

Cause cause_of_lock(Dynamics& dynamics, const State& at) {
  return first_found({[&] { return locked(dynamics, at); }});
}

Cause cause_of_stop(Dynamics& dynamics, const State& at) {
  return first_found({[&] { return contradicting(dynamics, at); }});
}

void rethrow_with(const Cause& cause, const Error& error, const std::string& lines) {
  if (!cause.found() && lines.empty()) throw;
  ErrorData about = error.data();
  std::string sentence = error.what();
  if (cause.found() && error.kind() != Error::Kind::user_code) {
    about.problem = cause.fact, about.advice = cause.hint;
    if (std::isnan(about.t)) about.t = cause.t;
    sentence = cause.fact + "; " + cause.hint;
  }
  if (!lines.empty()) sentence += "\n" + lines.substr(0, lines.size() - 1);
  if (about.problem != error.problem && about.problem != error.fact())
    sentence += (lines.empty() ? "; " : "\n  ") + ("solver: " + error.fact());
  const Error::Kind kind = cause.kind == Error::Kind::other ? error.kind() : cause.kind;
  if (kind == Error::Kind::assembly) throw AssemblyError(sentence, about);
  if (kind == Error::Kind::solve) throw SolveError(sentence, about);
  if (kind == Error::Kind::step) throw StepError(sentence, about);
  if (kind == Error::Kind::non_finite) throw NonFiniteError(sentence, about);
  if (kind == Error::Kind::user_code) throw UserCodeError(sentence, about);
  throw;
}

}  // namespace lockstep
