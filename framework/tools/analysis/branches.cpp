// The assemblies of a mechanism, from many random starts.
#include <lockstep/branches.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <lockstep/assembly.h>
#include <lockstep/error.h>
#include <lockstep/kinematics.h>

namespace lockstep {
namespace {

/// Random numbers that are the same everywhere.
class Scatter {
 public:
  explicit Scatter(unsigned seed) : engine_(seed) {}
  double number(double size) { return size * (0x1p-52 * static_cast<double>(engine_() >> 11) - 1); }
  Vec3 vector(double size) {
    const double x = number(size), y = number(size), z = number(size);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

void scatter(const System& system, double size, Scatter& random, State& state) {
  const Plane plane = system.plane();
  for (int k = 0; k < system.n_slots(); ++k) {
    Pose pose = state.slot_pose(k);
    Vec3 move = random.vector(size), turn = random.vector(kPi);
    if (plane) {
      move[plane.n] = 0;
      turn = turn[plane.n] * Vec3::Unit(plane.n);
    }
    pose.x += move;
    if (system.slot(k).freedoms == Freedoms::spatial) pose.q = normalized(pose.q * exponential(turn));
    state.set_slot_pose(k, pose);
  }
}

/// Newton's method onto the rows, with halved steps where one does not reduce |C|. False where it ends elsewhere.
bool fit(Dynamics& dynamics, State& state) {
  constexpr int kRounds = 60;
  constexpr double kFits = 1e-12, kShortest = 1e-3;
  const double goal = kFits * std::max(1.0, dynamics.system().length());
  VecX C, Cd, d, lambda;
  const VecX zero = VecX::Zero(state.v.size());
  const auto residual = [&] {
    const Evaluation& e = dynamics.gather(state);
    e.residuals(C, Cd);
    return e.norm(C);
  };
  double now = residual();
  for (int round = 0; round < kRounds && now > goal; ++round) {
    const Evaluation& e = dynamics.gather(state);
    dynamics.factor(e).solve(e, zero, VecX(-C), d, lambda);
    if (!d.allFinite()) return false;
    const State from = state;
    double next = now;
    for (double share = 1; share > kShortest; share *= 0.5) {
      state = from;
      advance_state(state, share, d);
      normalize_state(state);
      next = residual();
      if (next < now) break;
    }
    if (!(next < 0.999 * now)) return next < 1e2 * goal;
    now = next;
  }
  return now <= goal;
}

double apart(const System& system, const State& a, const State& b, std::string& body) {
  double most = 0;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Pose p = a.slot_pose(k), q = b.slot_pose(k);
    const double turn = system.slot(k).freedoms == Freedoms::spatial
                            ? rotation_vector(conjugate(normalized(p.q)) * normalized(q.q)).norm()
                            : 0.0;
    if (const double d = std::max((p.x - q.x).norm(), system.length() * turn); d > most)
      most = d, body = system.body_of_slot(k).name;
  }
  return most;
}

}  // namespace

BranchReport find_branches(Dynamics& dynamics, const State& start, const BranchOptions& options) {
  const System& system = dynamics.system();
  State first = start;
  dynamics.to_slots(first);
  first.v.setZero();
  if (!fit(dynamics, first)) {
    State again = start;
    assemble(dynamics, again);  // says which rows do not fit
    first = again;
  }
  if (const DriveReport driven = driven_by(dynamics, first); driven.freedoms > 0)
    throw ModelError("branches are counted where every coordinate is held or driven; here " + driven.text());
  const double same = options.same * system.length();
  BranchReport report;
  report.branches.push_back({first, 1, 0, ""});
  report.starts = 1;
  Scatter random(options.seed);
  for (; report.starts <= options.starts; ++report.starts) {
    State state = first;
    scatter(system, 2 * system.length(), random, state);
    bool fits = false;
    try {
      fits = fit(dynamics, state);
    } catch (const SolveError&) {
    }
    if (!fits) {
      ++report.failed;
      continue;
    }
    std::string body;
    const auto known = std::ranges::find_if(
        report.branches, [&](const AssemblyBranch& b) { return apart(system, b.state, state, body) <= same; });
    if (known != report.branches.end()) {
      ++known->found;
      continue;
    }
    const double distance = apart(system, first, state, body);
    report.branches.push_back({std::move(state), 1, distance, body});
  }
  std::ranges::stable_sort(report.branches, {}, &AssemblyBranch::distance);
  return report;
}

}  // namespace lockstep
