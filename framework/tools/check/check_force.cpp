// check_force: a force against the energies that it reports, and its tangent against differences.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/text.h>
#include "framework/tools/check/sample_system.h"
#include "framework/tools/check/state_check.h"

namespace lockstep {
namespace {

class ForceCheck final : public StateCheck {
 public:
  ForceCheck(const System& system, const Force& force, CheckReport& report, const CheckOptions& options)
      : StateCheck(system, report, options, force.remembering(), force.first_memory()), force_(force) {
    slots_ = force.slots(), n_timed_ = n_turned_ = 6 * n_;
  }

 private:
  /// f.v + dV/dt + dissipation - supply, which is zero, with the error of the difference and the size of its terms.
  struct Balance {
    double rest = 0, error = 0, size = 0;
  };

  MatX numbers(const TestState& at) override { return applied(at).transpose(); }
  std::string name(Eigen::Index, Eigen::Index k) const override { return wrench_name(static_cast<int>(k)); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { force_.breakpoints(t0, t1, out); }
  std::string otherwise(int) const override { return "pushes otherwise"; }
  bool description() override;
  void at_state() override;
  void turns() override;
  void jumped(int k, const MatX& before, const MatX& after, const std::string& what) override;

  bool finite();
  void balance();
  void diagnose_balance();
  void diagnose_losses();
  void tangent();

  Reactions reactions() const { return {rows_, {lambda_.data(), static_cast<std::size_t>(lambda_.size())}}; }
  bool reads() const { return lambda_.size() > 0; }
  std::vector<Quantity> quantities() const;
  VecX applied(const TestState&) const;     ///< with react(), if it reads reactions
  double loss(const TestState&) const;      ///< dissipation(), and friction_loss() likewise
  double power(const TestState& at) const;  ///< f.v
  Balance balance_of(const TestState&) const;
  std::string wrench_name(int k) const {
    return fmt::format("its {} on body '{}'", k % 6 < 3 ? "force" : "moment", body(k / 6));
  }

  const Force& force_;
  RowTable rows_;  // with multipliers drawn once, for a force that reads reactions
  VecX lambda_;
};

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

bool ForceCheck::description() {
  for (const Marker* m : force_.markers())
    if (m == nullptr || m->body == nullptr) {
      add("markers", "tells a marker that is not there", "markers()");
      return false;
    }
  if (slots_.empty()) {
    add("markers", "acts at no marker of a body that moves, so that nothing can be checked", "markers()");
    return false;
  }
  for (const Quantity& q : quantities())
    if (q.name.empty()) add("quantities", "tells a quantity without a name", "quantities()");
  if (force_.reacting() == nullptr) return true;
  for (const Lock* link : force_.reacting()->reads())
    if (link == nullptr) {
      add("reads", "reads the reactions of a link that is not there", "reads()");
      return true;
    }
  system_.lay_out(std::vector<bool>(system_.links().size(), true), rows_);
  Draw draw(options_.seed + 5);
  lambda_.resize(rows_.n_rows);
  for (double& x : lambda_) x = draw.number(-20, 20);
  return true;
}

void ForceCheck::at_state() {
  if (!finite()) return;
  for (int k = 0; k < n_; ++k)
    if (std::ranges::find(slots_, k) == slots_.end() && !is_.middleCols<6>(6 * k).isZero(0))
      add("bodies", fmt::format("pushes body '{}', on which none of its markers() is", body(k)),
          "markers(): they say on which bodies it acts, to messages, to the tangent and to planar motion");
  balance();
  tangent();
}

bool ForceCheck::finite() {
  const Inputs in = state_.in();
  bool all = true;
  const auto look_at = [&](double x, const std::string& what, const char* look) {
    if (!std::isfinite(x))
      add("finite", fmt::format("{} is not finite at t = {} s", what, text::number(state_.t)), look);
    all = all && std::isfinite(x);
  };
  look_at(force_.potential(in), "potential()", "potential()");
  look_at(loss(state_), "dissipation()", "dissipation()");
  look_at(force_.supply(in), "supply()", "supply()");
  const std::vector<Quantity> own = reads() ? std::vector<Quantity>{} : quantities();
  for (std::size_t k = 0; k < own.size(); ++k)
    look_at(force_.observable()->quantity(k, in), "quantity '" + own[k].name + "'", "quantity()");
  return all;
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
    add("dissipation", fmt::format("dissipation() is {:.6g} W, below zero", D),
        "dissipation(): what dampers take out; what is put in belongs into supply()");
  const Balance b = balance_of(state_);
  report_.compared(b.size > 0 ? b.error / b.size : 0);
  if (std::abs(b.rest) <= b.error + kRounding * b.size) return;
  add("balance",
      fmt::format("gives {:.6g} W to the bodies, and -dV/dt - dissipation() + supply() are {:.6g} W (dissipation "
                  "{:.6g}, supply {:.6g})",
                  P, P - b.rest, D, S),
      "potential(), dissipation() and supply(); the energy balance of a run rests on them", std::abs(b.rest));
  diagnose_balance();
}

// Which part is wrong: a component of the force at rest, or what depends on the velocities.
void ForceCheck::diagnose_balance() {
  TestState still = state_;
  still.stop();
  const VecX f = applied(still);
  bool found = false;
  for (const int slot : slots_)
    for (int k = 0; k < n_freedoms(slot); ++k) {
      const auto with = [&](double speed) {
        TestState on = still;
        (k < 3 ? on.slot(slot).v : on.slot(slot).w)[k % 3] = speed;
        return balance_of(on);
      };
      const Balance plus = with(1e-3), minus = with(-1e-3);  // slow, so that damping is negligible
      const double odd = 0.5e3 * (plus.rest - minus.rest), error = 0.5e3 * (plus.error + minus.error);
      if (std::abs(odd) <= 10 * error + 1e-7 * is_.norm()) continue;
      const double is = f[6 * slot + k];
      found = true;
      add(fmt::format("gradient {} {}", slot, k >= 3),
          fmt::format("{} along {} {} axis is {:.6g} at rest, and potential() and supply() say {:.6g}{}",
                      wrench_name(6 * slot + k), k < 3 ? "the world's" : "its", "xyz"[k % 3], is, is - odd,
                      likeness(is - odd, is)),
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
                  "dissipation() - supply() is {:.6g} W, and the force asks for {:.6g} W",
                  D - S, asked),
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
    check_tangent(sum, damping, minus_f, 1e-6 * is_.norm(),
                  {letter, "apply()",
                   fmt::format("tangent(), {} = -df/d({}); leave it out, and the library differences apply() for "
                               "implicit methods",
                               letter, damping ? "v, w" : "x, turn")});
  }
}

// Its first body about z of its last marker.
void ForceCheck::turns() {
  turn_about_z(slots_.front(), *force_.markers().back(), 1, fmt::format("body '{}'", body(slots_.front())));
}

void ForceCheck::jumped(int, const MatX&, const MatX&, const std::string& what) {
  if (remembering_ != nullptr)
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
