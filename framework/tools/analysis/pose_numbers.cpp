// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/pose_numbers.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include <lockstep/author/lock.h>
#include <lockstep/author/solver.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {
namespace {

/// visit(link, name, part) for every joint with markers, and for its drives.
template <class Visit>
void for_each_reaction(const System& system, Visit&& visit) {
  for (const auto& link : system.links()) {
    if (link->pairs().empty() || system.merged(*link)) continue;
    visit(*link, link->name(), Reactions::kJoint);
    if (link->driven() != nullptr && link->driven()->n_drives() > 0)
      visit(*link, link->name() + ".drive", Reactions::kDrives);
  }
}

/// Returns the multipliers of an equilibrium and no accelerations.
class SolverAtRest final : public LinearSolver {
 public:
  explicit SolverAtRest(const VecX& lambda) : lambda_(lambda) {}
  std::string_view name() const override { return "at rest"; }
  bool reads_rows() const override { return true; }
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override { return std::make_unique<Known>(lambda_); }

 private:
  class Known final : public Factorization {
   public:
    explicit Known(const VecX& lambda) : lambda_(lambda) {}
    void compute(const Kkt&) override { solved_ = false; }
    // The loads of friction, which follow, change nothing.
    SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override {
      a.setZero(f.size());
      if (solved_) lambda.setZero(c.size());
      if (!solved_) lambda = lambda_;
      solved_ = true;
      SolveReport report;
      report.detector = HUGE_VAL;
      return report;
    }

   private:
    const VecX& lambda_;
    bool solved_ = false;
  };
  const VecX& lambda_;
};

}  // namespace

Dynamics dynamics_at_rest(System& system, const VecX& lambda) {
  return {system, std::make_unique<SolverAtRest>(lambda)};
}

std::vector<Channel> pose_channels(System& system) {
  std::vector<Channel> all;
  for (const Body& body : system.bodies())
    for (const std::string_view q : {"x", "y", "z", "qw", "qx", "qy", "qz"})
      if (!body.fixed && (q.size() == 1 || body.freedoms != Freedoms::particle))
        all.push_back(make_channel(system, fmt::format("{}.{}", body.name, q)));
  for_each_reaction(system, [&](const Lock&, const std::string& name, int) {
    for (const char* what : {"force", "torque"})
      for (const char axis : {'x', 'y', 'z'})
        all.push_back(make_channel(system, fmt::format("{}.{}_on_p_world_{}", name, what, axis)));
  });
  return all;
}

std::vector<Channel> load_channels(System& system) {
  std::vector<Channel> all;
  for (const auto& force : system.forces())
    if (const Observable* shows = force->reacting() == nullptr ? force->observable() : nullptr)
      for (const Quantity& own : shows->quantities())
        if (own.unit != "W" && !own.unit.ends_with("/s"))
          all.push_back(make_channel(system, force->name() + "." + own.name));
  return all;
}

std::vector<std::pair<std::string, NamedReaction>> reactions_at_rest(Dynamics& dynamics, const State& state,
                                                                     const EquilibriumReport& report,
                                                                     const UniquenessReport& unique) {
  const System& system = dynamics.system();
  const Evaluation& e = dynamics.gather(state);
  const VecX still = VecX::Zero(6 * system.n_slots());
  const double force = kNegligible * report.largest_force, moment = force * system.length();
  const Evaluated v{e.inputs(), still, report.lambda, e.rows()};
  std::vector<std::pair<std::string, NamedReaction>> all;
  for_each_reaction(system, [&](const Lock& link, const std::string& name, int part) {
    const bool holds = Reactions(v).in_force(link);
    if (!holds && system.left_out(link) == 0) return;
    const Marker& P = *link.pairs().front().first;
    LinkWrench wrench = Reactions(v).on_body_of(MarkerFrame(P), link, v.in, part);
    for (double& x : wrench.force) x = std::abs(x) <= force ? 0 : x;
    for (double& x : wrench.moment) x = std::abs(x) <= moment ? 0 : x;
    const auto is_of = [&](const std::string& channel) {
      return channel.starts_with(name + ".force_on_p_world_") || channel.starts_with(name + ".torque_on_p_world_");
    };
    const bool differs = std::ranges::any_of(unique.channels, is_of);  // from other reactions that are possible
    all.push_back({name, {name, P.body->name, wrench, !holds ? "left out" : differs ? "not unique" : ""}});
  });
  return all;
}

NamedPoses named_poses(const System& system, const State& state) {
  NamedPoses all;
  for (const Body& body : system.bodies())
    if (!body.fixed) all.emplace_back(body.name, body_pose(body, state));
  return all;
}

}  // namespace lockstep
