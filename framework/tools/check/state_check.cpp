// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/check/state_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include <lockstep/author/passes.h>
#include <lockstep/author/relative.h>
#include <lockstep/text.h>

namespace lockstep {

TestState start_of(const System& system, double t) {
  const State start = system.start();
  TestState at{t, {}, start.s, start.z};
  passes::motions(system, start, at.motions);
  return at;
}

TestState random_state(const System& system, const TestState& about, Draw& draw, double reach, double turn) {
  std::vector<int> slots(system.n_slots());
  std::iota(slots.begin(), slots.end(), 0);
  const double L = slots.empty() ? 1.0 : std::max(Differences::distance(slots, about.in()), system.length());
  TestState at = about;
  for (const int k : slots) {
    Motion& O = at.slot(k);
    O.x += draw.vector(reach * L);
    O.v = draw.vector(L);
    const Quat q = draw.turn(turn);
    O.w = draw.vector(2.0);
    if (system.slot(k).freedoms == Freedoms::particle)
      O.w.setZero();
    else
      O.e = normalized(O.e * q), O.A = rotation(O.e);
  }
  return at;
}

TestState coasted(const TestState& from, double x) {
  TestState to = from;
  to.t += x;
  for (Motion& O : to.motions) {
    O.x += x * O.v;
    O.e = O.e * exponential(x * O.w);
    O.A = rotation(O.e);
  }
  return to;
}

StateCheck::StateCheck(const System& system, CheckReport& report, const CheckOptions& options,
                       const Remembering* remembering, int first_memory)
    : system_(system),
      report_(report),
      options_(options),
      remembering_(remembering),
      first_memory_(first_memory),
      n_(system.n_slots()) {}

void StateCheck::add(const std::string& key, const std::string& what, std::string look, double weight) {
  report_.add(key, {what + here(), std::move(look)}, weight);
}

std::string StateCheck::here() const {
  return index_ < 0 ? "" : fmt::format(" (seed {}, state {})", options_.seed, index_);
}
int StateCheck::n_freedoms(int slot) const { return system_.slot(slot).freedoms == Freedoms::particle ? 3 : 6; }

std::string StateCheck::unknown_name(int slot, int k) const {
  constexpr const char* kMotion[] = {"translation", "rotation", "velocity", "angular velocity"};
  return fmt::format("the {} of body '{}' {} {} axis", kMotion[k / 3], body(slot),
                     k / 3 % 2 == 0 ? "along the world's" : "about its", "xyz"[k % 3]);
}

std::string StateCheck::why_not_finite() const {
  return "a division by a length or a speed that may be zero, a root or an arc sine out of its range";
}

void StateCheck::run() {
  completes(
      report_, [&] { in_context([&] { return context(); }, [&] { run_all(); }); }, [&] { return place(state_); });
}

void StateCheck::run_all() {
  if (!description()) return;
  length_ = std::max(Differences::distance(slots_, start_of(system_, options_.from).in()), 1e-3);
  Draw draw(options_.seed);
  for (index_ = 0; index_ < options_.states; ++index_) {
    if (!find_state(draw)) return;
    same_again();
    at_state();
    memory();
  }
  index_ = -1;
  jumps();
  turns();
}

// A random state with finite numbers, at a random time; of a link closer to the start if it has none far from it.
bool StateCheck::find_state(Draw& draw) {
  quiet_ = 0.02 * (options_.to - options_.from);
  for (int i = 0; i < 30; ++i, quiet_ *= 0.8) {
    std::vector<double> jumps;
    state_.t = draw.number(options_.from, options_.to);
    breakpoints(state_.t - quiet_, state_.t + quiet_, jumps);
    if (jumps.empty()) break;
  }
  const TestState start = start_of(system_, state_.t);
  double share = is_link_ && index_ == 0 ? 0.05 : 1.0;
  for (int i = 0; i < (is_link_ ? 7 : 1); ++i, share *= 0.5) {
    state_ = random_state(system_, start, draw, share * options_.reach, share * options_.turn);
    accept_step(state_);
    is_ = numbers(state_);
    if (!is_.allFinite()) continue;
    if (i > 0 && index_ > 0)
      report_.note("some states were moved closer to the start, as its constraints are not finite further away");
    return true;
  }
  const std::string known = place(state_);
  for (int k = 0; k < is_.rows(); ++k)
    for (int c = 0; c < is_.cols(); ++c) {
      if (std::isfinite(is_(k, c))) continue;
      add("finite",
          fmt::format("{} is not finite at {}t = {} s", name(k, c), known.empty() ? "" : known + ", ",
                      text::brief(state_.t)),
          why_not_finite());
      return false;
    }
  return false;
}

// Also for q and -q, which are the same orientation.
void StateCheck::same_again() {
  Draw draw(options_.seed + 77);
  numbers(random_state(system_, start_of(system_, state_.t), draw, 0.1, 0.1));
  if (numbers(state_) != is_)
    add("same",
        fmt::format("{} in a second call with the same inputs",
                    is_link_ ? "has other constraints" : "exerts another force"),
        "members that change between calls: its numbers follow from the Inputs alone, memory belongs to z "
        "(n_memory())");
  for (const int slot : slots_) {
    TestState on = state_;
    on.slot(slot).e = -on.slot(slot).e;
    const MatX r = numbers(on);
    for (int k = 0; k < is_.rows(); ++k) {
      Eigen::Index c = 0;
      const double sign = is_link_ && (r.row(k) + is_.row(k)).norm() < (r.row(k) - is_.row(k)).norm() ? -1 : 1;
      if ((r.row(k) - sign * is_.row(k)).cwiseAbs().maxCoeff(&c) > kNegligible * (1 + is_.row(k).norm()))
        add("sign",
            fmt::format("{} changes with the sign of the quaternion of body '{}', which is the same orientation",
                        name(k, c), body(slot)),
            "its use of e0 ... e3: take products of two of them, the matrix A, or angle_z()");
    }
  }
}

// The memory at one state converges: of a link within some calls, as it may iterate, of a force at once.
void StateCheck::memory() {
  if (remembering_ == nullptr) return;
  TestState on = state_;
  double second = 0, last = 0;  // change of z by one more accept_step()
  for (int i = 0; i < (is_link_ ? 8 : 2); ++i) {
    const VecX before = on.z;
    accept_step(on);
    if (!on.z.allFinite()) return add("memory", "accept_step() writes a number that is not finite", "accept_step()");
    last = (on.z - before).norm();
    if (i == 1) second = last;
  }
  if (last > kNegligible * (1 + on.z.norm()) && last > 0.999 * second)
    add("memory", "repeated accept_step() at one state adds the same each time, or does not converge",
        "accept_step(): remember the present value, such as the nearest branch of an angle, not a sum over calls");
}

void StateCheck::jumps() {
  TestState on = state_;
  on.stop();  // the memory may extrapolate with the velocities
  on.t = options_.from;
  accept_step(on);
  const auto at = [&](double t) -> VecX {
    on.t = t;
    return numbers(on).leftCols(n_timed_).reshaped();
  };
  const auto n = static_cast<int>(is_.rows());
  check_jumps({at, [&](int c) { return name(c % n, c / n); },
               [&](double t0, double t1, std::vector<double>& out) { breakpoints(t0, t1, out); },
               "breakpoints(): append those of all its laws, and of its markers' laws"},
              options_, report_, 200, n);
}

// A jump of J makes third differences of up to 2 J in steps of any size; those of a corner are in proportion to the
// step. Other causes make much smaller ones in smaller steps, also if the memory, which goes along, is a little late.
void StateCheck::turn_about_z(int slot, const Marker& s, double sense, const std::string& who) {
  if (slot == kGround || n_freedoms(slot) == 3) return;
  constexpr int kSteps = 600, kFiner = 64;
  constexpr double kStep = 3 * kTwoPi / kSteps;
  const TestState start = start_of(system_, options_.from);
  const MarkerInWorld S = in_world(MarkerFrame(s), start.in());
  const auto turned = [&](Motion O, double angle) {
    const Quat turn = axis_angle(Vec3(sense * S.A.col(2)), angle);
    O.x = S.x + rotation(turn) * (O.x - S.x);
    O.e = turn * O.e;
    O.A = rotation(O.e);
    return O;
  };
  const auto walk = [&](TestState on, double from, double step, int n) {
    std::vector<TestState> way;
    MatX g(is_.rows() * n_turned_, n + 1);
    for (int i = 0; i <= n; ++i) {
      on.slot(slot) = turned(start.slot(slot), from + i * step);
      g.col(i) = numbers(on).leftCols(n_turned_).reshaped();
      way.push_back(on);
      accept_step(on);
    }
    const MatX third = g.rightCols(n - 2) - g.leftCols(n - 2) - 3 * (g.middleCols(2, n - 2) - g.middleCols(1, n - 2));
    return std::tuple(way, MatX(third.cwiseAbs()), g.cwiseAbs().maxCoeff());
  };
  const auto [way, third, size] = walk(start, 0, kStep, kSteps);
  const double least = std::max(2e-5 * size, kNegligible);  // an iteration for a point of a curve leaves less
  for (int c = 0; c < third.rows() && third.allFinite(); ++c) {
    Eigen::Index i = 0, k = 0;
    const double most = third.row(c).maxCoeff();
    if (most < least) continue;
    while (third(c, i) < 0.99 * most) ++i;  // the first of equal ones
    const auto [fine_way, fine, fine_size] = walk(way[i], static_cast<double>(i) * kStep, kStep / kFiner, 3 * kFiner);
    const double jump = 0.5 * fine.row(c).maxCoeff(&k);
    const int row = c % static_cast<int>(is_.rows());
    const std::string its = name(row, c / is_.rows()), known = place(fine_way[k + 2]);
    const std::string where =
        known.empty()
            ? fmt::format("a rotation of {:.0f} deg of {} about z of '{}'",
                          (static_cast<double>(i) + static_cast<double>(k) / kFiner) * kStep * 180 / kPi, who, s.name)
            : known;
    // The Jacobian is continuous across an uncounted angle.
    const auto J = [&, &steps = fine_way](Eigen::Index at) -> VecX { return numbers(steps[at]).row(row).tail(6 * n_); };
    if (is_link_ && !known.empty() && remembering_ == nullptr) {
      between(way[i], way[i + 3]);
      continue;
    }
    if (4 * jump < most) continue;
    const std::string what = fmt::format("{} jumps at {} by {:.3g}", its, where, jump);
    if (is_link_ && bends(J(k), J(k + 3)))
      report_.note(what + "; harmless only if it is off the constraint");
    else if (remembering_ != nullptr)
      add("turns", what, "accept_step() and start_memory(), or count_angles(), which counts an angle");
    else if (is_link_)
      add("turns", what,
          "branches of the function (`? :`, `if`, abs), or at its angles: with .counts_turns = true, y.angle_z() "
          "counts revolutions");
    else
      report_.note(what + "; if it has to count revolutions, use count_angles()");
  }
}

// Counted angles take the branch nearest to the last: the states come from no motion.
void StateCheck::accept_step(TestState& at) const {
  VecX s = at.s;
  for (const auto& angle : system_.counted_angles()) angle->set(at.in(), angle->expected(at.in().s), s);
  at.s = s;
  if (remembering_ == nullptr) return;
  VecX z = at.z;
  remembering_->accept_step(at.in(), {z.data() + first_memory_, static_cast<std::size_t>(remembering_->n_memory())});
  at.z = z;
}

Slope StateCheck::derivative(const TestState& at, int slot, int k, const Output& f) const {
  const Motion& O = at.slot(slot);
  const double reach[] = {0.05 * length_, 0.1, 0.05 * std::max(1.0, O.v.norm()), 0.05 * std::max(1.0, O.w.norm())};
  TestState on = at;
  const auto moved = [&](double x) {
    on.slot(slot) = Differences::moved(O, k, x);
    return f(on);
  };
  return first_derivative(moved, reach[k / 3]);
}

void StateCheck::check_tangent(const TangentSum& sum, bool damping, const Output& f, double scale) {
  const char* const letter = damping ? "D" : "K";
  const auto look = [&](int) {
    return is_link_ ? blame("tangent(); without it, the library differences gather() for implicit methods")
                    : fmt::format(
                          "tangent(), {} = -df/d({}), or at value_of() in act(), which hides derivatives; without "
                          "tangent(), the library differences apply() for implicit methods",
                          letter, damping ? "v, w" : "x, rotation");
  };
  MatX T = MatX::Zero(6 * n_, 6 * n_);
  for (std::size_t p = 0; p < sum.pairs().size(); ++p)
    T.block<6, 6>(6 * sum.pairs()[p].row, 6 * sum.pairs()[p].column) += damping ? sum.D(p) : sum.K(p);
  for (const int slot : slots_)
    for (int k = 0; k < n_freedoms(slot); ++k) {
      const int unknown = damping ? k + 6 : k;
      const Slope d = derivative(state_, slot, unknown, f);
      VecX is = T.col(6 * slot + k);
      for (int i = 0; i < 6 * n_; ++i)
        if (i % 6 >= n_freedoms(i / 6)) is[i] = d.value[i];  // a particle takes no moment
      const double size = std::max({T.cwiseAbs().maxCoeff(), d.value.cwiseAbs().maxCoeff(), scale});
      compare(report_,
              {fmt::format("{} {} {}", letter, slot, k >= 3), is, VecX::Constant(6 * n_, size),
               [&](int i) {
                 return fmt::format("tangent(): {} of the {} on body '{}' along its {} axis with {}",
                                    is_link_ ? "the change" : letter, i % 6 < 3 ? "force" : "moment", body(i / 6),
                                    "xyz"[i % 3], unknown_name(slot, unknown));
               },
               fmt::format("finite differences of {} give", is_link_ ? "Jh^T lambda" : "apply()"), here(), look,
               1e-7,  // a default tangent() is differenced too, to about 1e-9 of its size
               6},
              d);
    }
}

}  // namespace lockstep
