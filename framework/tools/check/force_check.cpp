#include "framework/tools/check/force_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/tools/check/jumps.h"
#include <lockstep/relative.h>
#include <lockstep/text.h>

namespace lockstep {

ForceCheck::ForceCheck(const System& system, const Force& force, CheckReport& report, const CheckOptions& options)
    : system_(system), force_(force), report_(report), options_(options), n_(system.n_slots()) {}

void ForceCheck::run() {
  if (!description()) return;
  draw_reactions();
  Draw draw(options_.seed);
  for (state_ = 0; state_ < options_.states; ++state_) {
    if (!find_place(draw)) return;
    same_again();
    other_bodies();
    balance();
    tangent();
    memory();
  }
  jumps();
  turns();
}

std::string ForceCheck::here() const { return fmt::format("(seed {}, state {})", options_.seed, state_); }
void ForceCheck::add(const std::string& key, std::string what, std::string look, double weight) {
  report_.add(key, {std::move(what), std::move(look)}, weight);
}
bool ForceCheck::particle(int slot) const { return system_.slot(slot).freedoms == Freedoms::particle; }
std::span<double> ForceCheck::memory_of(VecX& z) const {
  return {z.data() + force_.first_memory(), static_cast<std::size_t>(force_.n_own_memory())};
}

void ForceCheck::apply(const Place& at, VecX& f) const {
  f.setZero(6 * n_);
  WrenchSum sum(at.motions, f);
  force_.apply(at.in(), sum);
  if (reads()) force_.reacting()->react(at.in(), reactions(), sum);
}

double ForceCheck::loss(const Place& at) const {
  return force_.dissipation(at.in()) + (reads() ? force_.reacting()->friction_loss(at.in(), reactions()) : 0.0);
}

std::vector<Quantity> ForceCheck::quantities() const {
  if (const Reacting* own = force_.reacting()) return own->quantities();
  return force_.observable() ? force_.observable()->quantities() : std::vector<Quantity>{};
}

void ForceCheck::draw_reactions() {
  if (force_.reacting() == nullptr) return;
  for (const Lock* link : force_.reacting()->reads())
    if (link == nullptr) return add("reads", "reads the reactions of a link that is not there", "reads()");
  system_.lay_out(std::vector<bool>(system_.links().size(), true), rows_);
  Draw draw(options_.seed + 5);
  lambda_.resize(rows_.n_rows);
  for (double& x : lambda_) x = draw.number(-20, 20);
}

double ForceCheck::power(const Place& at) const {
  VecX f;
  apply(at, f);
  double P = 0;
  for (int k = 0; k < n_; ++k) P += f.segment<3>(6 * k).dot(at.slot(k).v) + f.segment<3>(6 * k + 3).dot(at.slot(k).w);
  return P;
}

bool ForceCheck::description() {
  for (const Marker* m : force_.markers())
    if (m == nullptr || m->body == nullptr) {
      add("markers", "tells a marker that is not there", "markers()");
      return false;
    }
  if (force_.slots().empty()) {
    add("markers", "acts at no marker of a body that moves, so that nothing can be checked", "markers()");
    return false;
  }
  for (const Quantity& q : quantities())
    if (q.name.empty()) add("quantities", "tells a quantity without a name", "quantities()");
  length_ = std::max(Differences::distance(force_.slots(), home_of(system_, options_.from).in()), 1e-3);
  return true;
}

bool ForceCheck::find_place(Draw& draw) {
  double t = draw.number(options_.from, options_.to);
  std::vector<double> jumps;
  quiet_ = 0.02 * (options_.to - options_.from);
  for (int i = 0; i < 30; ++i, jumps.clear()) {
    force_.breakpoints(t - quiet_, t + quiet_, jumps);
    if (jumps.empty()) break;
    t = draw.number(options_.from, options_.to), quiet_ *= 0.8;
  }
  place_ = drawn_about(system_, home_of(system_, t), draw, options_.reach, options_.turn);
  if (force_.n_own_memory() > 0) force_.remembering()->accept_step(place_.in(), memory_of(place_.z));
  apply(place_, f_);
  const auto told = [&](const std::string& what, const std::string& look) {
    add("finite", fmt::format("{} at t = {} s {}", what, text::number(t), here()), look);
    return false;
  };
  if (!f_.allFinite()) return told("its force is not finite", "a division by a length or a speed that may be zero");
  const double V = force_.potential(place_.in()), D = loss(place_), S = force_.supply(place_.in());
  if (!std::isfinite(V)) return told("potential() is not finite", "potential()");
  if (!std::isfinite(D)) return told("dissipation() is not finite", "dissipation()");
  if (!std::isfinite(S)) return told("supply() is not finite", "supply()");
  const std::vector<Quantity> all = quantities();
  for (int k = 0; k < static_cast<int>(all.size()); ++k)
    if (!reads() && !std::isfinite(force_.observable()->quantity(k, place_.in())))
      return told(fmt::format("quantity '{}' is not finite", all[static_cast<std::size_t>(k)].name),
                  "quantity()");
  return true;
}

void ForceCheck::same_again() {
  VecX elsewhere, again;
  Draw draw(options_.seed + 77);
  apply(drawn_about(system_, home_of(system_, place_.t), draw, 0.1, 0.1), elsewhere);
  apply(place_, again);
  if (again != f_)
    add("same", fmt::format("pushes otherwise when it is asked again at the same inputs {}", here()),
        "what the class keeps between two calls: a force follows from the Inputs alone, memory belongs into z");
  for (const int slot : force_.slots()) {
    Place turned = place_;
    turned.slot(slot).e = -turned.slot(slot).e;
    apply(turned, again);
    if ((again - f_).norm() > 1e-9 * (1 + f_.norm()))
      add("sign",
          fmt::format("pushes otherwise when the quaternion of body '{}' changes its sign, which is the same "
                      "orientation {}",
                      system_.body_of_slot(slot).name, here()),
          "its use of e: take products of two components, or the matrix A");
  }
}

void ForceCheck::other_bodies() {
  for (int k = 0; k < n_; ++k) {
    const auto& on = force_.slots();
    if (std::find(on.begin(), on.end(), k) != on.end() || f_.segment<6>(6 * k).isZero(0)) continue;
    add("bodies", fmt::format("pushes body '{}', on which none of its markers() is", system_.body_of_slot(k).name),
        "markers(): they say on which bodies it acts, to messages, to the tangent and to planar motion");
  }
}

bool ForceCheck::Balance::wrong() const { return std::abs(rest) > error + 1e-10 * size; }

ForceCheck::Balance ForceCheck::balance_of(const Place& at) const {
  const Slope dV = first_derivative(
      [&](double x, VecX& out) {
        Place on;
        coast(at, x, on);
        out = VecX::Constant(1, force_.potential(on.in()));
      },
      std::min(0.05, quiet_));
  const double P = power(at), D = loss(at), S = force_.supply(at.in());
  return {P + dV.value[0] + D - S, dV.error[0],
          std::max({std::abs(P), std::abs(dV.value[0]), std::abs(D), std::abs(S)})};
}

void ForceCheck::balance() {
  if (const double D = loss(place_); D < 0)
    add("dissipation", fmt::format("dissipation() is {:.6g} W, below zero {}", D, here()),
        "dissipation(): what dampers take out; what is put in belongs into supply()");
  const Balance b = balance_of(place_);
  report_.compared(b.size > 0 ? b.error / b.size : 0);
  if (!b.wrong()) return;
  const double P = power(place_), D = loss(place_), S = force_.supply(place_.in());
  add("balance",
      fmt::format(
          "gives {:.6g} W to the bodies, and -dV/dt - dissipation() + supply() are {:.6g} W (dissipation {:.6g}, "
          "supply {:.6g}) {}",
          P, P - b.rest, D, S, here()),
      "potential(), dissipation() and supply(); the energy balance of a run rests on them", std::abs(b.rest));
  diagnose_balance();
}

// Which part: the force at rest, component by component, or what goes with the velocities.
void ForceCheck::diagnose_balance() {
  VecX f;
  bool found = false;
  for (const int slot : force_.slots())
    for (int k = 0; k < (particle(slot) ? 3 : 6); ++k) {
      const auto with = [&](double speed) {
        Place on = place_;
        for (Motion& O : on.motions) O.v.setZero(), O.w.setZero();
        (k < 3 ? on.slot(slot).v : on.slot(slot).w)[k % 3] = speed;
        return balance_of(on);
      };
      const Balance plus = with(1e-3), minus = with(-1e-3);  // slow: dampers give next to nothing
      const double odd = 0.5e3 * (plus.rest - minus.rest), error = 0.5e3 * (plus.error + minus.error);
      if (std::abs(odd) <= 10 * error + 1e-7 * f_.norm()) continue;
      Place still = place_;
      for (Motion& O : still.motions) O.v.setZero(), O.w.setZero();
      apply(still, f);
      const double is = f[6 * slot + k];
      found = true;
      add(fmt::format("gradient {} {}", slot, k >= 3),
          fmt::format(
              "its {} on body '{}' along {} {} axis is {:.6g} at rest, and potential() and supply() say {:.6g}{} "
              "{}",
              k < 3 ? "force" : "moment", system_.body_of_slot(slot).name, k < 3 ? "the world's" : "its", "xyz"[k % 3],
              is, is - odd, likeness(is - odd, is), here()),
          "potential(), whose gradient is minus the force, or at supply(), if a law or motor makes the force",
          std::abs(odd));
    }
  if (!found)
    add("damping",
        fmt::format(
            "its force at rest fits potential() and supply(), so that what goes with the velocities is wrong {}",
            here()),
        "dissipation(): minus the force of the damper times the speed it damps");
}

// K = -df/d(x, turn), D = -df/d(v, w).
void ForceCheck::tangent() {
  TangentSum sum;
  sum.lay_out(n_);
  force_.tangent(place_.in(), sum);
  if (reads()) force_.reacting()->react_tangent(place_.in(), reactions(), sum);
  MatX K = MatX::Zero(6 * n_, 6 * n_), D = K;
  for (std::size_t p = 0; p < sum.pairs().size(); ++p) {
    const auto [row, column] = sum.pairs()[p];
    K.block<6, 6>(6 * row, 6 * column) += sum.K(p), D.block<6, 6>(6 * row, 6 * column) += sum.D(p);
  }
  for (const int slot : force_.slots())
    for (int k = 0; k < 6; ++k) {
      if (particle(slot) && k >= 3) continue;
      compare_column(slot, k, K, false);
      compare_column(slot, k, D, true);
    }
}

void ForceCheck::compare_column(int slot, int k, const MatX& T, bool velocity) {
  Place on = place_;
  const double speed = std::max(1.0, k < 3 ? place_.slot(slot).v.norm() : place_.slot(slot).w.norm());
  const Slope d = first_derivative(
      [&](double x, VecX& out) {
        on.slot(slot) = Differences::moved(place_.slot(slot), velocity ? k + 6 : k, x);
        apply(on, out);
        out = -out;
      },
      velocity ? 0.05 * speed
      : k < 3  ? 0.05 * length_
               : 0.1);
  const double size = std::max({T.cwiseAbs().maxCoeff(), d.value.cwiseAbs().maxCoeff(), 1e-6 * f_.norm()});
  const std::string letter = velocity ? "D" : "K";
  for (int i = 0; i < 6 * n_; ++i) {
    if (particle(i / 6) && i % 6 >= 3) continue;
    const double is = T(i, 6 * slot + k), should_be = d.value[i];
    report_.compared(d.error[i] / std::max(size, 1e-300));
    // the default tangent() differences too, to some 1e-9 of what it finds
    if (std::abs(is - should_be) <= d.error[i] + 1e-7 * size) continue;
    add(fmt::format("{} {} {} {}", letter, i / 6, slot, k >= 3),
        fmt::format(
            "tangent(): {} of the {} on body '{}' along its {} axis with {} is {:.6g}, differences of apply() say "
            "{:.6g}{} {}",
            letter, i % 6 < 3 ? "force" : "moment", system_.body_of_slot(i / 6).name, "xyz"[i % 3],
            velocity ? velocity_name(system_, slot, k) : move_name(system_, slot, k), is, should_be,
            likeness(is, should_be), here()),
        fmt::format("tangent(), {} = -df/d({}); leave it out, and the library differences apply() for implicit methods",
                    letter, velocity ? "v, w" : "x, turn"),
        std::abs(is - should_be));
  }
}

void ForceCheck::memory() {
  if (force_.n_own_memory() == 0) return;
  Place on = place_;
  force_.remembering()->accept_step(on.in(), memory_of(on.z));
  VecX twice = on.z;
  force_.remembering()->accept_step(on.in(), memory_of(twice));
  if (!(on.z - twice).isZero(1e-9 * (1 + on.z.norm())))
    add("memory", fmt::format("accept_step() at one state, called again there, remembers something else {}", here()),
        "accept_step(): what is remembered follows from the inputs and the memory, as the nearest branch does");
}

void ForceCheck::jumps() {
  Place on = place_;
  std::vector<double> listed;
  force_.breakpoints(options_.from, options_.to, listed);
  const auto f = [&](double t, VecX& out) {
    on.t = t;
    apply(on, out);
  };
  const std::vector<Jump> all = find_jumps(f, options_.from, options_.to, listed, 200);
  if (all.empty()) return;
  const int k = all.front().component;
  add("jump",
      fmt::format("its {} on body '{}' jumps by {:.3g} at t = {:.9g} s, which breakpoints() does not tell",
                  k % 6 < 3 ? "force" : "moment", system_.body_of_slot(k / 6).name, all.front().size, all.front().t),
      "breakpoints(): append those of every law that the force uses, and of its markers' laws");
}

// Three turns of its first body about z of its last marker: no jump of the force.
void ForceCheck::turns() {
  const Marker &p = *force_.markers().front(), &s = *force_.markers().back();
  const int slot = force_.slots().front();
  if (particle(slot)) return;
  constexpr int kSteps = 600;
  Place on = home_of(system_, options_.from);
  const Motion home = on.slot(slot);
  const Marker& about = &p == &s ? p : s;
  const MarkerInWorld S = in_world(MarkerFrame(about), on.in());
  const auto put = [&](double angle) {
    Motion& O = on.slot(slot);
    const Quat turn = axis_angle(Vec3(S.A.col(2)), angle);
    O.x = S.x + rotation(turn) * (home.x - S.x);
    O.e = turn * home.e;
    O.A = rotation(O.e);
  };
  const auto accept = [&] {
    VecX z = on.z;
    if (force_.n_own_memory() > 0) force_.remembering()->accept_step(on.in(), memory_of(z));
    on.z = z;
  };
  // largest change of the wrench in n steps over [a, b], and where
  const auto largest = [&](double a, double b, int n, double& at) {
    VecX f, before;
    double most = 0;
    for (int i = 0; i <= n; ++i) {
      put(a + (b - a) * i / n);
      apply(on, f);
      if (i > 0 && (f - before).norm() > most) most = (f - before).norm(), at = a + (b - a) * (i - 1) / n;
      before = f;
      accept();
    }
    return most;
  };
  double at = 0, ignored = 0;
  const double step = 3 * kTwoPi / kSteps, most = largest(0, 3 * kTwoPi, kSteps, at);
  on = home_of(system_, options_.from);
  if (at > 0) largest(0, at, std::max(1, static_cast<int>(at / step)), ignored);  // with the memory of the way there
  const double fine = largest(at, at + step, 64, ignored);
  if (!(most > 1e-9 && fine > 0.5 * most)) return;
  const std::string what = fmt::format("jumps by {:.3g} where body '{}' has turned by {:.0f} degrees about z of '{}'",
                                       fine, system_.body_of_slot(slot).name, at * 180 / kPi, about.name);
  if (force_.n_own_memory() > 0)
    add("turns", what, "accept_step() and start_memory(): the angle at the last accepted step is remembered in z");
  else
    report_.note("it " + what + "; if it is to run on past full turns, count them: n_memory() and accept_step()");
}

}  // namespace lockstep
