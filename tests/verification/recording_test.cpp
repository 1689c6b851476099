// SPDX-License-Identifier: BSD-3-Clause
// The accelerations and multipliers of a mechanism in joint coordinates, recorded at one state and replayed at others: the
// recursion (dynamics/tree/number_closures.h) on numbers that write down what is done with them, and on counted ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/system_of.h"
#include "framework/dynamics/tree/number_closures.h"
#include "tests/support/arrays_of.h"
#include "tests/support/catch.h"
#include "tests/support/chain.h"
#include "tests/support/counted.h"
#include "tests/support/recorded.h"
#include "tests/support/run_scene.h"

namespace lockstep {
namespace {

using numbers::ArraysOf;
using oracle::Counted;
using oracle::Op;
using oracle::Program;
using oracle::Recorded;
using oracle::Recording;
using Varied = Jet<0, Recorded>;

}  // namespace
}  // namespace lockstep

// Pivots are taken as they are, so that all numbers make the same operations.
template <>
inline constexpr bool lockstep::bodies::kUncompared<lockstep::Jet<0, lockstep::oracle::Recorded>> = true;

namespace lockstep {
namespace {

template <class T>
struct Arrays {
  std::vector<std::vector<T>> all;
  T* add(std::size_t n) { return all.emplace_back(n).data(); }
  T* add(std::span<const double> numbers) {
    return numbers.empty() ? nullptr : all.emplace_back(numbers.begin(), numbers.end()).data();
  }
};

/// The arrays that differ from state to state.
std::vector<std::span<const double>> inputs_of(const ArraysOf& of) {
  if (of.loops.empty()) return {of.z.y, of.z.law, of.z.wrench};
  return {of.z.y, of.z.law, of.z.wrench, of.c.rows.law, of.c.rows.J, of.c.rows.c};
}
std::vector<double> inputs_now(const ArraysOf& of) {
  std::vector<double> out;
  for (const std::span<const double> array : inputs_of(of)) out.insert(out.end(), array.begin(), array.end());
  return out;
}

/// Accelerations of the coordinates, then multipliers of the closures.
template <class T, class G>
std::vector<T> evaluate_in(const ArraysOf& of, std::span<const T> inputs) {
  using Space = typename G::Space;
  Arrays<T> arrays;
  const std::vector<std::span<const double>> varying = inputs_of(of);
  const auto put = [&](std::span<double> numbers) {
    T* const to = arrays.add(numbers);
    std::size_t next = 0;
    for (const std::span<const double> array : varying) {
      if (array.data() == numbers.data())
        std::copy_n(inputs.begin() + static_cast<std::ptrdiff_t>(next), array.size(), to);
      next += array.size();
    }
    return to;
  };
  std::vector<numbers::Travel<Space>> travel(of.plan.nodes.size());
  std::vector<bodies::Coordinate<Space>> dof(of.plan.n_v);
  std::vector<typename Space::Inertia> waiting(of.plan.n_waiting);
  const numbers::NumberTree<G> tree{of.plan, {of.z.each(put), travel.data(), dof.data(), waiting.data()}};
  for (std::size_t k = 0; k < of.plan.nodes.size(); ++k) {
    const numbers::NumberNode& n = of.plan.nodes[k];
    if (n.turn != TreeTurn::hinge) continue;
    using std::cos, std::sin;
    const T half = 0.5 * tree.z.y[n.q + n.n_slides];
    tree.z.cosine[k] = cos(half), tree.z.sine[k] = sin(half);
  }
  T* const rate = arrays.add(of.plan.n_q + of.plan.n_v);
  tree.outward();
  std::vector<T> out;
  if (of.loops.empty()) {
    tree.accelerate(rate);
  } else {
    std::vector<typename Space::Wrench> K(of.loops.fronts.rows.size());
    const numbers::NumberClosures<G> closures{tree, of.loops, {of.c.each(put), K.data()}};
    closures.accelerate(rate);
    out.assign(closures.c.lambda, closures.c.lambda + of.loops.n_rows());
  }
  out.insert(out.begin(), rate + of.plan.n_q, rate + of.plan.n_q + of.plan.n_v);
  return out;
}

template <class T>
std::vector<T> evaluate(const ArraysOf& of, std::span<const T> inputs) {
  return of.plan.normal < 0 ? evaluate_in<T, numbers::Spatial<T*>>(of, inputs)
                            : evaluate_in<T, numbers::Planar<T*>>(of, inputs);
}

/// A sample at states that it is set to.
class Moved {
 public:
  explicit Moved(const std::string& name) : own_(made(name)), system_(*own_) {
    system_.setup();
    dynamics_ = std::make_unique<Dynamics>(system_, std::make_unique<SchurSolver>(),
                                           DynamicsOptions{.formulation = Formulation::joint, .stabilization = {}});
    start_ = system_.start();
    dynamics_->to_formulation(start_);
    REQUIRE(start_.coordinates != nullptr);
    arrays_ = std::make_unique<ArraysOf>(system_);
  }
  /// Coordinates and velocities away from the start, others for every k; they need not close the loops.
  void move_to(int k) {
    state_ = start_;
    state_.t = start_.t + 0.003 * k;
    const auto wave = [&](Eigen::Index i, double shift) { return std::sin(1.3 * double(i) + 0.7 * k + shift); };
    for (Eigen::Index i = 0; i < state_.q.size(); ++i) state_.q[i] += k == 0 ? 0.0 : 0.1 * wave(i, 0.0);
    for (Eigen::Index i = 0; i < state_.v.size(); ++i) state_.v[i] += wave(i, 2.0);
    see();
  }
  /// Coordinate or velocity i of the state, and how it goes on.
  double& coordinate(std::size_t i) {
    const auto n_q = static_cast<std::size_t>(state_.q.size());
    return i < n_q ? state_.q[static_cast<Eigen::Index>(i)] : state_.v[static_cast<Eigen::Index>(i - n_q)];
  }
  void see() { arrays_->see(state_, dynamics_->inputs(state_)); }
  /// As runs have them.
  VecX accelerations() {
    StateRate rate;
    dynamics_->rates(state_, rate);
    return rate.v;
  }
  const ArraysOf& arrays() const { return *arrays_; }

 private:
  static std::unique_ptr<System> made(const std::string& name) {
    if (name == "six-joint arm") return test::chain(6, 0.7);
    Mechanism mechanism = build_mechanism(in_space(read_scene(scene_path(name))), builtin_registry());
    return std::make_unique<System>(std::move(system_of(mechanism)));
  }

  std::unique_ptr<System> own_;
  System& system_;
  std::unique_ptr<ArraysOf> arrays_;
  std::unique_ptr<Dynamics> dynamics_;
  State start_, state_;
};

Program record(const Moved& sample, Recording& recording, std::size_t n_directions) {
  const std::size_t n = inputs_now(sample.arrays()).size();
  std::vector<Recorded> inputs, results;
  for (std::size_t i = 0; i < n; ++i) inputs.push_back(Recorded::input(static_cast<int>(i)));
  results = evaluate<Recorded>(sample.arrays(), inputs);
  for (std::size_t k = 0; k < n_directions; ++k) {
    std::vector<Varied> varied;
    for (std::size_t i = 0; i < n; ++i) varied.emplace_back(inputs[i], Recorded(i == k ? 1.0 : 0.0), Recorded(0.0));
    for (const Varied& y : evaluate<Varied>(sample.arrays(), varied)) results.push_back(y.d);
  }
  return {recording, results};
}

const std::array<const char*, 4> kSamples{"four_bar", "slider_crank", "six-joint arm", "stewart"};

}  // namespace

TEST_CASE("an evaluation recorded at one state gives the same bits at a hundred others") {
  const std::string name = GENERATE(from_range(kSamples));
  INFO(name);
  Moved sample(name);
  sample.move_to(0);
  Recording recording;
  const Program program = record(sample, recording, 0);
  double worst = 0;
  for (int k = 1; k <= 100; ++k) {
    sample.move_to(k);
    const std::vector<double> inputs = inputs_now(sample.arrays());
    const std::vector<double> replayed = program.replay(inputs), evaluated = evaluate<double>(sample.arrays(), inputs);
    REQUIRE(replayed.size() == evaluated.size());
    for (std::size_t i = 0; i < replayed.size(); ++i) REQUIRE(replayed[i] == evaluated[i]);
    const VecX trusted = sample.accelerations();
    const Eigen::Map<const VecX> own(replayed.data(), trusted.size());
    worst = std::max(worst, (own - trusted).lpNorm<Eigen::Infinity>() / trusted.lpNorm<Eigen::Infinity>());
  }
  CHECK(worst < 1e-13);

  // The list is no longer than what the same text computes.
  std::vector<Counted> inputs;
  for (const double x : inputs_now(sample.arrays())) inputs.emplace_back(x);
  const oracle::Operations counted =
      oracle::operations_of([&] { evaluate<Counted>(sample.arrays(), std::span<const Counted>(inputs)); });
  const long recorded = program.count({Op::add, Op::subtract, Op::multiply, Op::divide});
  CHECK(recorded <= counted.total());
  CHECK(recorded > counted.total() / 20);
  UNSCOPED_INFO(name << ": recorded " << recorded << ", counted " << counted.total() << ", of runs " << worst);
  CHECK(program.count({Op::divide}) <= counted.div);
}

// Rows that a link's own code writes, as those of the Stewart platform, are inputs.
TEST_CASE("recorded derivatives are those of the accelerations and multipliers") {
  const std::string name = GENERATE("four_bar", "slider_crank", "six-joint arm");
  INFO(name);
  Moved sample(name);
  sample.move_to(1);
  const std::size_t n = sample.arrays().plan.n_q + sample.arrays().plan.n_v;
  Recording recording;
  const Program program = record(sample, recording, n);
  sample.move_to(2);
  const auto results = [&] { return evaluate<double>(sample.arrays(), inputs_now(sample.arrays())); };
  const std::vector<double> all = program.replay(inputs_now(sample.arrays()));
  const std::size_t m = results().size();
  REQUIRE(all.size() == m * (n + 1));
  for (std::size_t k = 0; k < n; ++k) {
    // Fourth-order differences.
    const double h = 2e-4, x = sample.coordinate(k);
    const auto at = [&](double by) {
      sample.coordinate(k) = x + by;
      sample.see();
      return results();
    };
    const std::vector<double> a = at(-2 * h), b = at(-h), c = at(h), d = at(2 * h);
    sample.coordinate(k) = x;
    double size = 1;
    for (std::size_t i = 0; i < m; ++i) size = std::max(size, std::abs(all[m * (k + 1) + i]));
    for (std::size_t i = 0; i < m; ++i) {
      const double difference = (a[i] - 8 * b[i] + 8 * c[i] - d[i]) / (12 * h);
      CHECK(std::abs(all[m * (k + 1) + i] - difference) < 1e-8 * size);
    }
  }
}

TEST_CASE("a recorded number cannot be compared") {
  const Recording recording;
  const Recorded x = Recorded::input(0);
  CHECK_THROWS_AS(x < 1.0, std::logic_error);
  CHECK_THROWS_AS(x == 1.0, std::logic_error);
  CHECK_THROWS_AS(bodies::magnitude(x), std::logic_error);
}

}  // namespace lockstep
