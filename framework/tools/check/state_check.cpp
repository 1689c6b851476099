#include "framework/tools/check/state_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numeric>

#include <lockstep/error.h>

namespace lockstep {

void TestState::stop() {
  for (Motion& O : motions) O.v.setZero(), O.w.setZero();
}

TestState start_of(const System& system, double t) {
  const State start = system.start();
  TestState at{t, {}, start.s, start.z};
  system.motions(start, at.motions);
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

Motion turned(const Motion& motion, const Vec3& center, const Vec3& axis, double angle) {
  const Quat turn = axis_angle(axis, angle);
  Motion O = motion;
  O.x = center + rotation(turn) * (motion.x - center);
  O.e = turn * motion.e;
  O.A = rotation(O.e);
  return O;
}

bool set_up(System& system, CheckReport& report) {
  try {
    system.setup();
    return true;
  } catch (const UserCodeError& error) {
    report.add("setup", {error.what(), "what it says"});
    return false;
  }
}

StateCheck::StateCheck(const System& system, CheckReport& report, const CheckOptions& options,
                       const Remembering* remembering, int first_memory)
    : system_(system),
      report_(report),
      options_(options),
      remembering_(remembering),
      first_memory_(first_memory),
      n_(system.n_slots()) {}

void StateCheck::add(const std::string& key, std::string what, std::string look, double weight) {
  report_.add(key, {std::move(what), std::move(look)}, weight);
}

std::string StateCheck::here() const { return fmt::format("(seed {}, state {})", options_.seed, index_); }
int StateCheck::n_freedoms(int slot) const { return system_.slot(slot).freedoms == Freedoms::particle ? 3 : 6; }

std::string StateCheck::unknown_name(int slot, int k) const {
  constexpr const char* kMotion[] = {"translation", "turn", "velocity", "angular velocity"};
  return fmt::format("the {} of body '{}' {} {} axis", kMotion[k / 3], body(slot),
                     k / 3 % 2 == 0 ? "along the world's" : "about its", "xyz"[k % 3]);
}

double StateCheck::draw_time(Draw& draw, const Breakpoints& breakpoints) {
  double t = draw.number(options_.from, options_.to);
  quiet_ = 0.02 * (options_.to - options_.from);
  for (int i = 0; i < 30; ++i) {
    std::vector<double> jumps;
    breakpoints(t - quiet_, t + quiet_, jumps);
    if (jumps.empty()) break;
    t = draw.number(options_.from, options_.to), quiet_ *= 0.8;
  }
  return t;
}

TestState StateCheck::other_state() const {
  Draw draw(options_.seed + 77);
  return random_state(system_, start_of(system_, state_.t), draw, 0.1, 0.1);
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

Slope StateCheck::derivative(int slot, int k, const Output& f) const {
  const Motion& O = state_.slot(slot);
  const double reach[] = {0.05 * length_, 0.1, 0.05 * std::max(1.0, O.v.norm()), 0.05 * std::max(1.0, O.w.norm())};
  TestState on = state_;
  const auto moved = [&](double x, VecX& out) {
    on.slot(slot) = Differences::moved(O, k, x);
    f(on, out);
  };
  return first_derivative(moved, reach[k / 3]);
}

void StateCheck::check_tangent(const TangentSum& sum, bool damping, const std::vector<int>& slots, const Output& f,
                               double scale, const TangentWords& words) {
  MatX T = MatX::Zero(6 * n_, 6 * n_);
  for (std::size_t p = 0; p < sum.pairs().size(); ++p)
    T.block<6, 6>(6 * sum.pairs()[p].row, 6 * sum.pairs()[p].column) += damping ? sum.D(p) : sum.K(p);
  for (const int slot : slots)
    for (int k = 0; k < n_freedoms(slot); ++k) {
      const Slope d = derivative(slot, damping ? k + 6 : k, f);
      const double size = std::max({T.cwiseAbs().maxCoeff(), d.value.cwiseAbs().maxCoeff(), scale});
      for (int i = 0; i < 6 * n_; ++i) {
        if (i % 6 >= n_freedoms(i / 6)) continue;
        const double is = T(i, 6 * slot + k), should_be = d.value[i];
        report_.compared(d.error[i] / std::max(size, 1e-300));
        // A default tangent() is differenced too, to about 1e-9 of its size.
        if (std::abs(is - should_be) <= d.error[i] + 1e-7 * size) continue;
        add(fmt::format("{} {} {} {}", damping ? "D" : "K", i / 6, slot, k >= 3),
            fmt::format("tangent(): {} of the {} on body '{}' along its {} axis with {} is {:.6g}, differences of {} "
                        "say {:.6g}{} {}",
                        words.quantity, i % 6 < 3 ? "force" : "moment", body(i / 6), "xyz"[i % 3],
                        unknown_name(slot, damping ? k + 6 : k), is, words.function, should_be, likeness(is, should_be),
                        here()),
            words.look, std::abs(is - should_be));
      }
    }
}

}  // namespace lockstep
