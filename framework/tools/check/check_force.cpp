// SPDX-License-Identifier: BSD-3-Clause
// check_force: a force against the energies that it reports, and its tangent against differences.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/author/passes.h>
#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include "framework/mechanism/system/diagnose.h"
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
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { force_.breakpoints(t0, t1, out); }

  ErrorContext context() const override { return context_of(force_, state_.t); }

  Reactions reactions() const { return {rows_, {lambda_.data(), static_cast<std::size_t>(lambda_.size())}}; }
  bool reads() const { return lambda_.size() > 0; }

  // With react(), if it reads reactions.
  VecX applied(const TestState& at) const {
    VecX f = VecX::Zero(6 * n_);
    WrenchSum sum(at.motions, f);
    force_.apply(at.in(), sum);
    if (reads()) force_.reacting()->react(at.in(), reactions(), sum);
    return f;
  }

  // dissipation(), and friction_loss() likewise.
  double loss(const TestState& at) const {
    return force_.dissipation(at.in()) + (reads() ? force_.reacting()->friction_loss(at.in(), reactions()) : 0.0);
  }

  MatX numbers(const TestState& at) override {
    const Inputs in = at.in();
    const auto n_own = reads() ? 0 : static_cast<Eigen::Index>(quantities_.size());
    MatX all(1, 6 * n_ + 3 + n_own);
    all << applied(at).transpose(), force_.potential(in), loss(at), force_.supply(in), Eigen::RowVectorXd::Zero(n_own);
    for (Eigen::Index k = 0; k < n_own; ++k) all(0, 6 * n_ + 3 + k) = force_.observable()->quantity(k, in);
    return all;
  }

  std::string name(Eigen::Index, Eigen::Index column) const override {
    constexpr const char* kPowers[] = {"potential()", "dissipation()", "supply()"};
    const auto k = static_cast<int>(column);
    if (k < 6 * n_) return fmt::format("its {} on body '{}'", k % 6 < 3 ? "force" : "moment", body(k / 6));
    return k < 6 * n_ + 3 ? kPowers[k - 6 * n_] : "quantity '" + quantities_[k - 6 * n_ - 3].name + "'";
  }

  bool description() override {
    if (slots_.empty()) {
      add("markers", "acts at no marker of a moving body, so nothing can be checked", "markers()");
      return false;
    }
    const Reacting* const own = force_.reacting();
    if (own || force_.observable()) quantities_ = own ? own->quantities() : force_.observable()->quantities();
    for (const Quantity& q : quantities_)
      if (q.name.empty()) add("quantities", "has a quantity without a name", "quantities()");
    if (own == nullptr) return true;
    const std::vector<const Lock*> read = own->reads();
    if (std::ranges::find(read, nullptr) != read.end()) {
      add("reads", "reads the reactions of a missing joint", "reads()");
      return true;
    }
    passes::lay_out(system_, std::vector<bool>(system_.links().size(), true), rows_);
    Draw draw(options_.seed + 5);
    lambda_.resize(rows_.n_rows);
    for (double& x : lambda_) x = draw.number(-20, 20);
    return true;
  }

  void at_state() override {
    for (int k = 0; k < n_; ++k)
      if (std::ranges::find(slots_, k) == slots_.end() && !is_.middleCols<6>(6 * k).isZero(0))
        add("bodies", fmt::format("acts on body '{}', which has none of its markers()", body(k)),
            "markers(): they declare the bodies on which it acts, for messages, the tangent and planar motion");
    balance();
    tangent();
  }

  // f.v + dV/dt + dissipation - supply = 0 along a motion. If it is not, either the force at rest is not the gradient,
  // or its part that depends on velocities is wrong: D - S = -(f.v + dV/dt).
  void balance() {
    const Slope dV = first_derivative(
        [&](double x) { return VecX::Constant(1, force_.potential(coasted(state_, x).in())); }, std::min(0.05, quiet_));
    const double D = is_(0, 6 * n_ + 1), S = is_(0, 6 * n_ + 2);
    double P = 0;
    for (int k = 0; k < n_; ++k)
      P += is_.row(0).segment<3>(6 * k).dot(state_.slot(k).v) + is_.row(0).segment<3>(6 * k + 3).dot(state_.slot(k).w);
    if (D < 0)
      add("dissipation", fmt::format("dissipation() is {:.6g} W, below zero", D),
          "dissipation(): the power taken by dampers; power that is put in belongs to supply()");
    const double size = std::max({std::abs(P), std::abs(dV.value[0]), std::abs(D), std::abs(S)});
    const double off = std::abs(P + dV.value[0] + D - S);
    report_.compared(size > 0 ? dV.error[0] / size : 0);
    if (off <= dV.error[0] + kRounding * size) return;
    add("balance",
        fmt::format("gives {:.6g} W to the bodies, but -dV/dt - dissipation() + supply() is {:.6g} W (dissipation "
                    "{:.6g}, supply {:.6g})",
                    P, S - D - dV.value[0], D, S),
        "potential(), dissipation() and supply(); the energy balance of a run depends on them", off);
    if (gradient()) return;
    const std::string damper = "dissipation(): minus the force of the damper times the speed it damps";
    add("damping",
        fmt::format("its force at rest fits potential() and supply(), so its part that depends on velocities is wrong: "
                    "dissipation() - supply() is {:.6g} W, but the force gives {:.6g} W",
                    D - S, -P - dV.value[0]),
        S != 0                 ? damper + "; or at supply(): the power that laws and motors put in"
        : -P - dV.value[0] < 0 ? "supply(): the power that laws and motors put in; a damping force has the wrong sign"
                               : damper);
  }

  // Whether the force at rest is not -dV/d(x, rotation) + dS/d(v, w).
  bool gradient() {
    TestState still = state_;
    still.stop();
    const VecX f = applied(still);
    Slope asked{f, VecX::Zero(6 * n_)};
    for (const int slot : slots_)
      for (int k = 0; k < n_freedoms(slot); ++k) {
        const Slope V = derivative(still, slot, k,
                                   [&](const TestState& at) { return VecX::Constant(1, force_.potential(at.in())); });
        const Slope S = derivative(still, slot, k + 6,
                                   [&](const TestState& at) { return VecX::Constant(1, force_.supply(at.in())); });
        asked.value[6 * slot + k] = S.value[0] - V.value[0], asked.error[6 * slot + k] = S.error[0] + V.error[0];
      }
    return compare(
        report_,
        {"gradient", f, VecX::Constant(6 * n_, is_.leftCols(6 * n_).norm()),
         [&](int k) {
           return fmt::format("{} along {} {} axis", name(0, k), k % 6 < 3 ? "the world's" : "its", "xyz"[k % 3]);
         },
         "at rest, but potential() and supply() give", here(),
         [](int) {
           return "potential(), whose gradient is minus the force, or at supply(), if a law or motor makes the force";
         },
         1e-7, 3},
        asked);
  }

  // K = -df/d(x, rotation), D = -df/d(v, w).
  void tangent() {
    TangentSum sum;
    sum.lay_out(n_);
    force_.tangent(state_.in(), sum);
    if (reads()) force_.reacting()->react_tangent(state_.in(), reactions(), sum);
    const auto minus_f = [&](const TestState& at) -> VecX { return -applied(at); };
    for (const bool damping : {false, true})
      check_tangent(sum, damping, minus_f, kSlight * is_.leftCols(6 * n_).norm());
  }

  // Its first body about z of its last marker.
  void turns() override {
    turn_about_z(slots_.front(), *force_.markers().back(), 1, fmt::format("body '{}'", body(slots_.front())));
  }

  const Force& force_;
  std::vector<Quantity> quantities_;
  RowTable rows_;  // with multipliers drawn once, for a force that reads reactions
  VecX lambda_;
};

}  // namespace

CheckReport check_force(System& system, const Force& force, const CheckOptions& options) {
  if (std::ranges::none_of(system.forces(), [&](const auto& f) { return f.get() == &force; }))
    throw ModelError(fmt::format("check_force: force '{}' is not in the system; add it by System::add", force.name()));
  CheckReport report(fmt::format("force '{}' ({})", force.name(), force.type()), options.seed);
  if (completes(report, [&] { system.setup(); })) ForceCheck(system, force, report, options).run();
  return report;
}

CheckReport check_force(const Registry& registry, const std::string& type, const Params& params,
                        const CheckOptions& options) {
  return check_in_samples(fmt::format("force type '{}'", type), options, [&](SampleSystem& sample) {
    Attachment attachment = sample.attachment("sample");
    attachment.link =
        &sample.system.add<Revolute>("hinge", attachment.p(), attachment.s());  // for forces that act in a link
    const Force* force =
        &sample.system.add(registry.forces.make(type, attachment, params, &registry, "force 'sample'"));
    return [=, &sample, &options](CheckReport& report) {
      if (sample.kind.p_fixed && force->slots().empty()) return;  // it acts at P alone
      ForceCheck(sample.system, *force, report, options).run();
    };
  });
}

}  // namespace lockstep
