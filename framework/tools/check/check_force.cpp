// check_force: a force against the energies that it reports, and its tangent against differences.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/text.h>
#include "framework/tools/check/jumps.h"
#include "framework/tools/check/sample_system.h"
#include "framework/tools/check/state_check.h"

namespace lockstep {
namespace {

class ForceCheck : private StateCheck {
 public:
  ForceCheck(const System& system, const Force& force, CheckReport& report, const CheckOptions& options)
      : StateCheck(system, report, options, force.remembering(), force.first_memory()), force_(force) {}
  void run();

 private:
  /// f.v + dV/dt + dissipation - supply, which is zero, with the error of the difference and the size of its terms.
  struct Balance {
    double rest = 0, error = 0, size = 0;
  };

  bool description();
  void draw_reactions();
  bool find_state(Draw&);
  void same_again();
  void other_bodies();
  void balance();
  void diagnose_balance();
  void diagnose_losses();
  void tangent();
  void memory();
  void jumps();
  void turns();

  Reactions reactions() const { return {rows_, {lambda_.data(), static_cast<std::size_t>(lambda_.size())}}; }
  bool reads() const { return lambda_.size() > 0; }
  std::vector<Quantity> quantities() const;
  VecX applied(const TestState&) const;     ///< with react(), if it reads reactions
  double loss(const TestState&) const;      ///< dissipation(), and friction_loss() likewise
  double power(const TestState& at) const;  ///< f.v
  Balance balance_of(const TestState&) const;
  const char* wrench_part(int k) const { return k % 6 < 3 ? "force" : "moment"; }

  const Force& force_;
  RowTable rows_;  // with multipliers drawn once, for a force that reads reactions
  VecX lambda_;
  VecX f_;  // at the state under test
};

void ForceCheck::run() {
  if (!description()) return;
  draw_reactions();
  Draw draw(options_.seed);
  for (index_ = 0; index_ < options_.states; ++index_) {
    if (!find_state(draw)) return;
    same_again();
    other_bodies();
    balance();
    tangent();
    memory();
  }
  jumps();
  turns();
}

VecX ForceCheck::applied(const TestState& at) const {
  VecX f = VecX::Zero(6 * n_);
  WrenchSum sum(at.motions, f);
  force_.apply(at.in(), sum);
  if (reads()) force_.reacting()->react(at.in(), reactions(), sum);
  return f;
}

double ForceCheck::loss(const TestState& at) const {
  return force_.dissipation(at.in()) + (reads() ? force_.reacting()->friction_loss(at.in(), reactions()) : 0.0);
}

double ForceCheck::power(const TestState& at) const {
  const VecX f = applied(at);
  double P = 0;
  for (int k = 0; k < n_; ++k) P += f.segment<3>(6 * k).dot(at.slot(k).v) + f.segment<3>(6 * k + 3).dot(at.slot(k).w);
  return P;
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
  length_ = std::max(Differences::distance(force_.slots(), start_of(system_, options_.from).in()), 1e-3);
  return true;
}

bool ForceCheck::find_state(Draw& draw) {
  const double t =
      draw_time(draw, [&](double t0, double t1, std::vector<double>& out) { force_.breakpoints(t0, t1, out); });
  state_ = random_state(system_, start_of(system_, t), draw, options_.reach, options_.turn);
  accept_step(state_);
  f_ = applied(state_);
  const auto finite = [&](bool is, const std::string& what, const std::string& look) {
    if (!is) add("finite", fmt::format("{} is not finite at t = {} s {}", what, text::number(t), here()), look);
    return is;
  };
  const Inputs in = state_.in();
  if (!finite(f_.allFinite(), "its force", "a division by a length or a speed that may be zero") ||
      !finite(std::isfinite(force_.potential(in)), "potential()", "potential()") ||
      !finite(std::isfinite(loss(state_)), "dissipation()", "dissipation()") ||
      !finite(std::isfinite(force_.supply(in)), "supply()", "supply()"))
    return false;
  if (reads()) return true;
  const std::vector<Quantity> all = quantities();
  for (std::size_t k = 0; k < all.size(); ++k)
    if (!finite(std::isfinite(force_.observable()->quantity(k, in)), "quantity '" + all[k].name + "'", "quantity()"))
      return false;
  return true;
}

void ForceCheck::same_again() {
  applied(other_state());
  if (applied(state_) != f_)
    add("same", fmt::format("pushes otherwise when it is asked again at the same inputs {}", here()),
        "what the class keeps between two calls: a force follows from the Inputs alone, memory belongs into z");
  for (const int slot : force_.slots()) {
    TestState on = state_;
    on.slot(slot).e = -on.slot(slot).e;
    if ((applied(on) - f_).norm() > 1e-9 * (1 + f_.norm()))
      add("sign",
          fmt::format("pushes otherwise when the quaternion of body '{}' changes its sign, which is the same "
                      "orientation {}",
                      body(slot), here()),
          "its use of e: take products of two components, or the matrix A");
  }
}

void ForceCheck::other_bodies() {
  const auto& on = force_.slots();
  for (int k = 0; k < n_; ++k)
    if (std::find(on.begin(), on.end(), k) == on.end() && !f_.segment<6>(6 * k).isZero(0))
      add("bodies", fmt::format("pushes body '{}', on which none of its markers() is", body(k)),
          "markers(): they say on which bodies it acts, to messages, to the tangent and to planar motion");
}

ForceCheck::Balance ForceCheck::balance_of(const TestState& at) const {
  const auto V = [&](double x, VecX& out) { out = VecX::Constant(1, force_.potential(coasted(at, x).in())); };
  const Slope dV = first_derivative(V, std::min(0.05, quiet_));
  const double P = power(at), D = loss(at), S = force_.supply(at.in());
  return {P + dV.value[0] + D - S, dV.error[0],
          std::max({std::abs(P), std::abs(dV.value[0]), std::abs(D), std::abs(S)})};
}

void ForceCheck::balance() {
  const double P = power(state_), D = loss(state_), S = force_.supply(state_.in());
  if (D < 0)
    add("dissipation", fmt::format("dissipation() is {:.6g} W, below zero {}", D, here()),
        "dissipation(): what dampers take out; what is put in belongs into supply()");
  const Balance b = balance_of(state_);
  report_.compared(b.size > 0 ? b.error / b.size : 0);
  if (std::abs(b.rest) <= b.error + 1e-10 * b.size) return;
  add("balance",
      fmt::format("gives {:.6g} W to the bodies, and -dV/dt - dissipation() + supply() are {:.6g} W (dissipation "
                  "{:.6g}, supply {:.6g}) {}",
                  P, P - b.rest, D, S, here()),
      "potential(), dissipation() and supply(); the energy balance of a run rests on them", std::abs(b.rest));
  diagnose_balance();
}

// Which part is wrong: a component of the force at rest, or what depends on the velocities.
void ForceCheck::diagnose_balance() {
  TestState still = state_;
  still.stop();
  const VecX f = applied(still);
  bool found = false;
  for (const int slot : force_.slots())
    for (int k = 0; k < n_freedoms(slot); ++k) {
      const auto with = [&](double speed) {
        TestState on = still;
        (k < 3 ? on.slot(slot).v : on.slot(slot).w)[k % 3] = speed;
        return balance_of(on);
      };
      const Balance plus = with(1e-3), minus = with(-1e-3);  // slow, so that damping is negligible
      const double odd = 0.5e3 * (plus.rest - minus.rest), error = 0.5e3 * (plus.error + minus.error);
      if (std::abs(odd) <= 10 * error + 1e-7 * f_.norm()) continue;
      const double is = f[6 * slot + k];
      found = true;
      add(fmt::format("gradient {} {}", slot, k >= 3),
          fmt::format("its {} on body '{}' along {} {} axis is {:.6g} at rest, and potential() and supply() say "
                      "{:.6g}{} {}",
                      wrench_part(k), body(slot), k < 3 ? "the world's" : "its", "xyz"[k % 3], is, is - odd,
                      likeness(is - odd, is), here()),
          "potential(), whose gradient is minus the force, or at supply(), if a law or motor makes the force",
          std::abs(odd));
    }
  if (!found) diagnose_losses();
}

// What goes with the velocities: the powers that are said against that which the force asks for, D - S = -(f.v + dV/dt).
void ForceCheck::diagnose_losses() {
  const double D = loss(state_), S = force_.supply(state_.in()), asked = D - S - balance_of(state_).rest;
  const char* const kLoss = "dissipation(): minus the force of the damper times the speed it damps";
  const char* const kPut = "supply(): the power that laws and motors put in";
  add("damping",
      fmt::format("its force at rest fits potential() and supply(), so that what goes with the velocities is wrong: "
                  "dissipation() - supply() is {:.6g} W, and the force asks for {:.6g} W {}",
                  D - S, asked, here()),
      S != 0      ? fmt::format("{}; or at {}", kLoss, kPut)
      : asked < 0 ? fmt::format("{}; a force that is to damp has the wrong sign", kPut)
                  : kLoss);
}

// K = -df/d(x, turn), D = -df/d(v, w).
void ForceCheck::tangent() {
  TangentSum sum;
  sum.lay_out(n_);
  force_.tangent(state_.in(), sum);
  if (reads()) force_.reacting()->react_tangent(state_.in(), reactions(), sum);
  const auto minus_f = [&](const TestState& at, VecX& out) { out = -applied(at); };
  for (const bool damping : {false, true}) {
    const std::string letter = damping ? "D" : "K";
    check_tangent(sum, damping, force_.slots(), minus_f, 1e-6 * f_.norm(),
                  {letter, "apply()",
                   fmt::format("tangent(), {} = -df/d({}); leave it out, and the library differences apply() for "
                               "implicit methods",
                               letter, damping ? "v, w" : "x, turn")});
  }
}

void ForceCheck::memory() {
  if (force_.n_own_memory() == 0) return;
  TestState once = state_;
  accept_step(once);
  TestState twice = once;
  accept_step(twice);
  if (!(once.z - twice.z).isZero(1e-9 * (1 + once.z.norm())))
    add("memory", fmt::format("accept_step() at one state, called again there, remembers something else {}", here()),
        "accept_step(): what is remembered follows from the inputs and the memory, as the nearest branch does");
}

void ForceCheck::jumps() {
  TestState on = state_;
  on.stop();  // the memory may extrapolate with the velocities
  on.t = options_.from;
  accept_step(on);
  std::vector<double> listed;
  force_.breakpoints(options_.from, options_.to, listed);
  const auto f = [&](double t, VecX& out) {
    on.t = t;
    out = applied(on);
  };
  const auto all = find_jumps(f, options_.from, options_.to, listed, 200);
  if (all.empty()) return;
  const auto first = [](const auto& component) { return component.second.front().t; };
  const auto& [k, jumps] = *std::ranges::min_element(all, {}, first);
  add("jump",
      fmt::format("its {} on body '{}' jumps by {:.3g} at t = {:.9g} s, which breakpoints() does not tell",
                  wrench_part(k), body(k / 6), jumps.front().size, jumps.front().t),
      "breakpoints(): append those of every law that the force uses, and of its markers' laws");
}

// Three turns of its first body about z of its last marker: the force must not jump.
void ForceCheck::turns() {
  const Marker &p = *force_.markers().front(), &s = *force_.markers().back();
  const int slot = force_.slots().front();
  if (n_freedoms(slot) == 3) return;
  const TestState start = start_of(system_, options_.from);
  TestState on = start;
  const Marker& about = &p == &s ? p : s;
  const MarkerInWorld S = in_world(MarkerFrame(about), start.in());
  // Largest change of the wrench in n steps over [a, b], and the angle before it.
  const auto largest_change = [&](double a, double b, int n) {
    std::pair<double, double> most{0, a};
    VecX before;
    for (int i = 0; i <= n; ++i) {
      on.slot(slot) = turned(start.slot(slot), S.x, S.A.col(2), a + (b - a) * i / n);
      const VecX f = applied(on);
      if (i > 0 && (f - before).norm() > most.first) most = {(f - before).norm(), a + (b - a) * (i - 1) / n};
      before = f;
      accept_step(on);
    }
    return most;
  };
  constexpr double kEnd = 3 * kTwoPi, kStep = kEnd / 600;
  const auto [most, at] = largest_change(0, kEnd, 600);
  on = start;
  if (at > 0) largest_change(0, at, std::max(1, static_cast<int>(at / kStep)));  // for the memory on the way there
  const double fine = largest_change(at, at + kStep, 64).first;
  if (!(most > 1e-9 && fine > 0.5 * most)) return;
  const std::string what = fmt::format("jumps by {:.3g} where body '{}' has turned by {:.0f} degrees about z of '{}'",
                                       fine, body(slot), at * 180 / kPi, about.name);
  if (force_.n_own_memory() > 0)
    add("turns", what, "accept_step() and start_memory(), or count_angles(), which counts an angle for it");
  else
    report_.note("it " + what + "; if it is to run on past full turns, count them: count_angles()");
}
}  // namespace

CheckReport check_force(System& system, const Force& force, const CheckOptions& options) {
  const auto& all = system.forces();
  if (std::none_of(all.begin(), all.end(), [&](const auto& f) { return f.get() == &force; }))
    throw ModelError(fmt::format("check_force: force '{}' is not in the system; add it by System::add", force.name()));
  CheckReport report(fmt::format("force '{}' ({})", force.name(), force.type()), options.seed);
  if (set_up(system, report)) ForceCheck(system, force, report, options).run();
  return report;
}

CheckReport check_force(const Registry& registry, const std::string& type, const Params& params,
                        const CheckOptions& options) {
  return check_in_samples(fmt::format("force type '{}'", type), options, [&](SampleSystem& sample) {
    Attachment attachment = sample.attachment("tried");
    attachment.link =
        &sample.system.add<Revolute>("hinge", attachment.p(), attachment.s());  // for forces that act in a link
    const Force* force = &sample.system.add(registry.forces.make(type, attachment, params, &registry, "force 'tried'"));
    return [=, &sample, &options](CheckReport& report) {
      if (sample.kind == SampleKind::p_on_ground && force->slots().empty()) return;  // it acts at P alone
      ForceCheck(sample.system, *force, report, options).run();
    };
  });
}

}  // namespace lockstep
