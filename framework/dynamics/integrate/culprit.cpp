#include "framework/dynamics/integrate/culprit.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/stepping.h>
#include <lockstep/text.h>
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

constexpr double kContradict = 1e-6;     // residual of a row that cannot hold together with others
constexpr double kNotableChange = 1e-2;  // relative change

// What links and forces say at one state.
struct Said {
  std::vector<VecX> forces;  // 6 per slot, of each force
  VecX asked;                // Qhat, 1 per row
  std::vector<VecX> rows;    // the jacobian of each row, slot by slot
};

Said listen(Dynamics& dynamics, const State& state) {
  Said said;
  const Solution& solution = dynamics.evaluate(state);
  const Evaluation& e = solution.evaluation;
  const Reactions reactions(solution);
  const System& system = dynamics.system();
  for (const auto& force : system.forces()) {
    VecX f = VecX::Zero(6 * system.n_slots());
    WrenchSum sum(e.inputs().motions, f);
    if (force->acts(e.inputs()))
      named(*force, state.t, [&] {
        force->apply(e.inputs(), sum);
        if (force->reacting()) force->reacting()->react(e.inputs(), reactions, sum);
      });
    said.forces.push_back(std::move(f));
  }
  said.asked.resize(e.rows().n_rows);
  said.rows.resize(static_cast<std::size_t>(e.rows().n_rows));
  for (const RowEntry& entry : e.rows().entries) {
    const RowView block = e.rows().block(entry);
    for (int k = 0; k < entry.m; ++k) {
      said.asked[entry.first_row + k] = block.Qhat(k);
      VecX& row = said.rows[static_cast<std::size_t>(entry.first_row + k)];
      row.resize(6 * entry.slots.n);
      for (int i = 0; i < entry.slots.n; ++i) {
        const auto r = block.J(i, k);
        for (int j = 0; j < 6; ++j) row[6 * i + j] = r[static_cast<std::size_t>(j)];
      }
    }
  }
  return said;
}

double change_of(const VecX& from, const VecX& to, double least) {
  const double size = std::max({from.norm(), to.norm(), least});
  return size > 0 ? (to - from).norm() / size : 0.0;
}

std::string place_of(const Force& force, const System& system, const Inputs& in) {
  if (force.slots().empty()) return {};
  const int slot = force.slots().front();
  const Vec3& x = in.slot(slot).x;
  return fmt::format(", body '{}' at [{:.6g}, {:.6g}, {:.6g}]", system.body_of_slot(slot).name, x[0], x[1], x[2]);
}

std::string in_words(Dynamics& dynamics, const State& state, const Said& from, const Said& to, double after) {
  const System& system = dynamics.system();
  double largest = kNotableChange, all_forces = 0, all_asked = 0;
  std::string words;
  for (const VecX& f : from.forces) all_forces = std::max(all_forces, f.norm());
  if (from.asked.size() > 0) all_asked = std::max(from.asked.cwiseAbs().maxCoeff(), to.asked.cwiseAbs().maxCoeff());
  for (std::size_t k = 0; k < from.forces.size(); ++k) {
    const double change = change_of(from.forces[k], to.forces[k], 1e-3 * all_forces);
    if (change <= largest) continue;
    largest = change;
    const Force& force = *system.forces()[k];
    const auto size = [](const VecX& f) { return f.size() > 0 ? f.cwiseAbs().maxCoeff() : 0.0; };
    words = fmt::format(
        "force '{}' ({}) changes most there: from {:.4g} to {:.4g} (N, N m) within {:.2g} s{}; if it is that "
        "stiff, take an implicit method (--integrator radau5), if it jumps, let it change smoothly",
        force.name(), force.type(), size(from.forces[k]), size(to.forces[k]), after,
        place_of(force, system, dynamics.inputs(state)));
  }
  const Evaluation& e = dynamics.gather(state);
  for (int row = 0; row < from.asked.size(); ++row) {
    const auto r = static_cast<std::size_t>(row);
    const double turns = change_of(from.rows[r], to.rows[r], 0),
                 asks = change_of(from.asked.segment<1>(row), to.asked.segment<1>(row), 1e-3 * all_asked);
    const double change = std::max(turns, asks);
    if (change <= largest) continue;
    largest = change;
    words = fmt::format(
        "{} changes most there, {} within {:.2g} s; look at its laws, and whether its markers come to where it "
        "has no direction",
        system.row_name(e.rows(), row),
        turns >= asks
            ? fmt::format("its direction by {:.2g} of itself", turns)
            : fmt::format("the acceleration that it asks for from {:.4g} to {:.4g}", from.asked[row], to.asked[row]),
        after);
  }
  return words;
}

// Links in force whose rows move with the time, Ct beyond rounding: by a law of theirs, or of a marker.
std::vector<std::string> moved_by_laws(Dynamics& dynamics, const State& state) {
  constexpr double kMoves = 1e-9;  // m/s
  State at = state;
  dynamics.to_slots(at);
  at.v.setZero();
  const Evaluation& e = dynamics.gather(at);
  VecX C, Cd;
  e.residuals(C, Cd);
  std::vector<std::string> names;
  for (const RowEntry& entry : e.rows().entries)
    if (Cd.segment(entry.first_row, entry.m).cwiseAbs().maxCoeff() > kMoves)
      names.push_back("'" + dynamics.system().links()[static_cast<std::size_t>(entry.link)]->name() + "'");
  return names;
}

// What makes rows contradict each other, by how many of them laws move.
std::string why_contradict(const std::vector<std::string>& moved, const std::string& stops) {
  constexpr std::size_t kNamed = 4;
  std::vector<std::string> names = moved;
  if (names.size() > kNamed) names.resize(kNamed), names.push_back("others");
  if (moved.size() > 1)
    return fmt::format("two laws may part{}, or the mechanism is locked (laws move {})", stops, text::join(names));
  return (moved.empty() ? std::string("the mechanism is locked")
                        : fmt::format("the law that moves {} leads into a dead centre, or the mechanism is locked",
                                      moved.front())) +
         stops;
}

}  // namespace

std::string who_varies(Dynamics& dynamics, const State& state, double after) {
  try {
    const double off = dynamics.violation(state) / dynamics.system().length();
    const Solution& now = dynamics.evaluate(state);
    if (const SolveReport report = now.full_report();
        report.worst_row >= 0 && report.residual > std::max(kContradict, kLeftPerViolation * off))
      return fmt::format("{} cannot hold together with the others there ({:.2g} % of its right side is left over): {}",
                         dynamics.system().row_name(now.rows, report.worst_row), 100 * report.residual,
                         why_contradict(moved_by_laws(dynamics, state), or_against_stops(dynamics.system(), now.rows)));
    const Said from = listen(dynamics, state);
    State then = state;
    StateRate rate;
    dynamics.rates(state, rate);
    then.q += after * rate.q, then.v += after * rate.v;
    then.s += after * rate.s;
    then.t += after;
    dynamics.normalize(then);
    std::string words = in_words(dynamics, state, from, listen(dynamics, then), after);
    if (const std::vector<std::string> moved = moved_by_laws(dynamics, state); moved.size() == 1 && !words.empty())
      words += "; a law moves " + moved.front();
    return words;
  } catch (const Error& error) {
    return fmt::format("within {:.2g} s from there: {}", after, error.what());
  }
}

std::string most_violated(Dynamics& dynamics, const State& state) {
  const Evaluation& e = dynamics.gather(state);
  VecX C, Cd;
  e.residuals(C, Cd);
  VecX one = VecX::Zero(C.size());
  int worst = -1;
  double most = -1;
  for (int row = 0; row < C.size(); ++row) {
    one[row] = C[row];
    const double size = e.norm(one);
    one[row] = 0;
    if (size > most) most = size, worst = row;
  }
  return worst < 0 ? "" : fmt::format("{} by {:.2g} m", e.system().row_name(e.rows(), worst), most);
}

StepError end_not_projected_by(Dynamics& dynamics, const State& end, const ProjectReport& report,
                               const std::string& method, double t, double h) {
  const std::string row = most_violated(dynamics, end);
  return StepError(end_not_projected(report, method, t, h).what() + (row.empty() ? "" : "; most of all " + row), t);
}

}  // namespace lockstep
