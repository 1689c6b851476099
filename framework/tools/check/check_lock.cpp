// SPDX-License-Identifier: BSD-3-Clause
// check_lock: the check of any link, and that of a function.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <Eigen/QR>
#include <algorithm>

#include <lockstep/author/function_links.h>
#include <lockstep/detail/phi_rows.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/tools/check/lock_check.h"
#include "framework/tools/check/sample_system.h"

namespace lockstep {
namespace {

/// Of a joint that is made of a function of its coordinates: the derivatives of the function, its branches, and its
/// gradient at its solutions.
class FunctionCheck final : public LockCheck {
 public:
  FunctionCheck(const System& system, const Lock& link, const Lock* sibling, const PhiRows& function,
                CheckReport& report, const CheckOptions& options)
      : LockCheck(system, link, sibling, report, options), function_(function) {}

 private:
  static constexpr const char* kBranches =
      "the branches of the function (`? :`, `if`, abs), which must meet with equal value, slope and curvature";

  void at_state() override {
    if (index_ == 0) gradient_at_solution();
    between(index_ == 0 ? start_of(system_, state_.t) : last_, state_);
    last_ = state_;
    LockCheck::at_state();
  }

  void turns() override {
    LockCheck::turns();
    if (report_.ok())
      report_.note("not tested: whether the equation is the intended one, and branches that the check did not cross");
  }

  std::string blame(std::string) const override { return kBranches; }

  // Newton's method halves the distance to a double root: so much smaller is its gradient then.
  void gradient_at_solution() {
    const MatX met = numbers(on_rows(state_));
    for (int k = m_ - function_.spec().rows; k < m_; ++k)
      if (!(met.row(k).tail(6 * n_).norm() >= 10 * kSlight * is_.row(k).tail(6 * n_).norm()))
        doubled_ = true, add(fmt::format("solution {}", k), row(k) + " has no gradient at its solutions",
                             "its equation: x^2 = 0, for example, holds nothing at x = 0; write x = 0");
  }

  // The values of phi, or their derivatives, as coordinate i of pair k (0 to 6; 7: the time) changes by x.
  Curve phi_along(int k, int i, double Time::*part) const {
    return [=, this](double x) {
      auto y = function_.along_motion(state_.in(), state_.z.data() + first_memory_);
      for (int pair = 0; pair < function_.spec().pairs; ++pair) {
        LockCoords<Time>& c = y[pair];
        int j = 0;
        for (Time* one : {&c.x, &c.y, &c.z, &c.e0, &c.e1, &c.e2, &c.e3, &c.t})
          *one = j++ == i && (i == 7 || pair == k) ? Time(one->v + x, 1, 0) : Time(one->v);
      }
      std::array<Time, kMaxRows> rows;
      function_.values({y.data(), static_cast<std::size_t>(function_.spec().pairs)}, rows);
      VecX f(function_.spec().rows);
      for (int r = 0; r < f.size(); ++r) f[r] = rows[r].*part;
      return f;
    };
  }

  // C and Jh of a row at a state, over the length of Jh.
  VecX scaled(const TestState& at, int k) {
    const MatX r = numbers(at);
    return (VecX(1 + 6 * n_) << r(k, 0), r.row(k).tail(6 * n_).transpose()).finished() / r.row(k).tail(6 * n_).norm();
  }
  // The translation and rotation of each slot from a to b.
  VecX motion(const TestState& a, const TestState& b) const {
    VecX x(6 * n_);
    for (int i = 0; i < n_; ++i)
      x.segment<6>(6 * i) << b.slot(i).x - a.slot(i).x, rotation_vector(conjugate(a.slot(i).e) * b.slot(i).e);
    return x;
  }
  TestState moved(TestState on, const VecX& by) const {
    for (int i = 0; i < n_; ++i) on.slot(i).v = by.segment<3>(6 * i), on.slot(i).w = by.segment<3>(6 * i + 3);
    on = coasted(on, 1), on.t -= 1;
    accept_step(on);
    return on;
  }
  TestState on_rows(TestState on) {  // of the joint without its drives, by Newton's method
    for (int i = 0; i < 20; ++i) {
      MatX r = numbers(on);
      for (int k = 0; k < m_; ++k)
        if (link_.row(k).drive >= 0) r.row(k).setZero();
      if (r.allFinite() && r.col(0).norm() > kRoundOff * length_)
        on = moved(on, -r.rightCols(6 * n_).completeOrthogonalDecomposition().solve(r.col(0)));
    }
    return on;
  }

  // Bisects between two states on the rows of the joint, along them and then on the straight line: always into the
  // half with the larger departure from the linear function of its ends.
  void between(const TestState& from, const TestState& to) override {
    if (remembering_ != nullptr || doubled_) return;
    const auto departure = [&](const TestState& a, const VecX& A, const TestState& b, const VecX& B) {
      const VecX x = motion(a, b);
      return std::abs(B[0] - A[0] - x.dot(A.tail(6 * n_))) + std::abs(B[0] - A[0] - x.dot(B.tail(6 * n_)));
    };
    for (int k = m_ - function_.spec().rows; k < m_; ++k) {
      TestState a = on_rows(from), b = on_rows(to);
      b.t = a.t;
      VecX A = scaled(a, k), B = scaled(b, k);
      for (const bool along : {true, false})
        for (int i = 0; i < 40; ++i) {
          TestState m = moved(a, 0.5 * motion(a, b));
          if (along) m = on_rows(m);
          const VecX M = scaled(m, k);
          const bool left = departure(a, A, m, M) > departure(m, M, b, B);
          (left ? b : a) = m, (left ? B : A) = M;
        }
      const bool on = A[0] * B[0] <= 0 || std::abs(A[0]) <= kSlight * length_;
      const double jump = std::abs(numbers(b)(k, 0) - numbers(a)(k, 0));
      if (on && std::abs(B[0] - A[0]) > kSlight * length_)
        add("turns", fmt::format("{} jumps at {} by {:.3g}", name(k, 0), place(a), jump),
            kBranches + std::string(reads_uncounted_angles()
                                        ? ", or its angles: with .counts_turns = true, y.angle_z() "
                                          "counts revolutions"
                                        : ""),
            jump);
      else if (on && bends(A.tail(6 * n_), B.tail(6 * n_)))
        add("turns", fmt::format("{} has a corner at {}: its slope jumps", name(k, 0), place(a)), kBranches);
    }
  }

  bool reads_uncounted_angles() const {
    const PhiSpec& spec = function_.spec();
    bool reads = false;
    for (int k = 0; k < spec.pairs; ++k) reads = reads || spec.reads_of(k, Reads::rotation);
    return reads && !spec.counts_turns.value_or(false);
  }

  // The derivatives of a function, from which all its other numbers follow.
  bool fits() override {
    const PhiSpec& spec = function_.spec();
    const int first = m_ - spec.rows;
    const VecX size = is_.bottomRightCorner(spec.rows, 6 * n_).cwiseAbs().rowwise().maxCoeff();
    bool fit = true;
    for (int k = 0; k < spec.pairs; ++k)
      for (int i = spec.first(k); i < 8; i = i + 1 == spec.end(k) ? 7 : i + 1) {
        const std::string in = coordinate(k, i);
        const double reach = (i < 3 ? length_ : 1) * std::min(0.05, quiet_);
        const auto wrong = [&](double x, CheckReport& report) {
          const Curve f = phi_along(k, i, &Time::v);
          return compare(report,
                         {"phi " + in, phi_along(k, i, &Time::d)(x), size,
                          [&](int r) { return fmt::format("the derivative of {} in {}", row(first + r), in); },
                          "finite differences of the function give", here(),
                          [&](int) { return in + ": value_of() or a plain `double` hides it from the derivatives"; }},
                         first_derivative([&](double d) { return f(x + d); }, reach));
        };
        CheckReport at_state("", 0), aside("", 0);
        const bool found = wrong(0, at_state);
        // Right on one side: the state is at a branch, which between() judges.
        if (found && !(wrong(-2 * reach, aside) && wrong(2 * reach, aside))) return false;
        report_.take(at_state), fit = fit && !found;
      }
    if (!fit) report_.note("Jacobian, Ct, Qhat and tangent follow from the function, and were not compared");
    return fit;
  }

  // Coordinate i of pair k of the function: "e1 of pair 2".
  std::string coordinate(int k, int i) const {
    constexpr const char* kNames[] = {"x", "y", "z", "e0", "e1", "e2", "e3", "t"};
    return kNames[i] + (function_.spec().pairs > 1 && i < 7 ? fmt::format(" of pair {}", k + 1) : "");
  }

  std::string place(const TestState& at) const override {
    std::vector<std::string> words;
    for (int k = 0; k < function_.spec().pairs; ++k) {
      const LockCoords<Time> y = function_.along_motion(at.in(), at.z.data() + first_memory_)[k];
      const double is[] = {y.x.v, y.y.v, y.z.v, y.e0.v, y.e1.v, y.e2.v, y.e3.v};
      for (int i = function_.spec().first(k); i < function_.spec().end(k); ++i)
        words.push_back(fmt::format("{} = {:.2g}{}", coordinate(k, i), std::abs(is[i]) < 1e-3 * length_ ? 0 : is[i],
                                    i < 3 ? " m" : ""));
    }
    return text::join(words);
  }

  const PhiRows& function_;
  TestState last_;        // under test before
  bool doubled_ = false;  // a row has no gradient at its solutions
};

void check(const System& system, const Lock& link, const Lock* sibling, CheckReport& report,
           const CheckOptions& options) {
  if (const auto* of = dynamic_cast<const LinkFunction*>(&link))
    FunctionCheck(system, link, sibling, of->function(), report, options).run();
  else
    LockCheck(system, link, sibling, report, options).run();
}

}  // namespace

CheckReport check_lock(System& system, const Lock& link, const CheckOptions& options) {
  if (std::ranges::none_of(system.links(), [&](const auto& l) { return l.get() == &link; }))
    throw ModelError(fmt::format("check_lock: joint '{}' is not in the system; add it by System::add", link.name()));
  CheckReport report(fmt::format("joint '{}' ({})", link.name(), link.type()), options.seed);
  if (completes(report, [&] { system.setup(); })) check(system, link, nullptr, report, options);
  return report;
}

CheckReport check_lock(const Registry& registry, const std::string& type, const Params& params,
                       const CheckOptions& options) {
  return check_in_samples(fmt::format("joint type '{}'", type), options, [&](SampleSystem& sample) {
    const auto add = [&](const char* name) {
      return &sample.system.add(
          registry.links.make(type, sample.attachment(name), params, &registry, fmt::format("joint '{}'", name)));
    };
    const Lock *first = add("sample"), *second = add("sibling");  // for the test of groups
    return [=, &sample, &options](CheckReport& report) { check(sample.system, *first, second, report, options); };
  });
}

}  // namespace lockstep
