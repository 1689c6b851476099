// SPDX-License-Identifier: BSD-3-Clause
// check_law: the derivatives of a law against differences, and its jumps.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/tools/check/compare.h"
#include "framework/tools/check/draw.h"

namespace lockstep {
namespace {

constexpr int kInstants = 200;

VecX numbers(const LawValue& v) { return Vec3(v.y, v.yd, v.ydd); }
VecX numbers(const TranslationValue& v) { return (VecX(9) << v.x, v.v, v.a).finished(); }
VecX numbers(const RotationValue& v) { return (VecX(15) << rotation(v.q).reshaped(), v.w, v.a).finished(); }

VecX change(const LawValue& from, const LawValue& to) { return VecX::Constant(1, to.y - from.y); }
VecX change(const TranslationValue& from, const TranslationValue& to) { return to.x - from.x; }
// (1.13): w is the rate of the rotation vector of q(t)' q(t + x) at x = 0, in the moved frame's own axes
VecX change(const RotationValue& from, const RotationValue& to) { return rotation_vector(conjugate(from.q) * to.q); }

/// A law of any kind as numbers: its value, and as many first as second derivatives. A rotation's value is its matrix.
struct LawNumbers {
  std::array<const char*, 3> levels;               ///< "x", "v", "a"
  TimedNumbers all;                                ///< over time
  std::function<VecX(double t, double x)> change;  ///< of the value from t to t + x
  int n, n_values;                                 ///< numbers of a derivative, and of the value

  std::string name(int c) const {
    if (c < n_values && n_values > n) return fmt::format("the rotation matrix of {} [{}][{}]", levels[0], c % 3, c / 3);
    const int level = c < n_values ? 0 : 1 + (c - n_values) / n;
    return n == 1 ? levels[level] : fmt::format("{}[{}]", levels[level], (c + n - n_values) % n);
  }
};

// Where `begun` becomes true between t0 and t1.
template <class Begun>
double beginning(double t0, double t1, const Begun& begun) {
  for (double m = 0.5 * (t0 + t1); t0 < m && m < t1; m = 0.5 * (t0 + t1)) (begun(m) ? t1 : t0) = m;
  return t1;
}

// The largest of each number; empty if one is not finite. Reports where the law begins or ceases to be constant
// unlisted; a change that is slight within a whole interval is only noted.
VecX sizes(const LawNumbers& law, const std::vector<double>& listed, const CheckOptions& options, CheckReport& report) {
  const double cell = (options.to - options.from) / kInstants;
  const auto instant = [&](int i) { return options.from + i * cell; };
  std::vector<VecX> f;
  VecX size = law.all.at(options.from).cwiseAbs();
  for (int i = 0; i <= kInstants; ++i) {
    const double t = instant(i);
    f.push_back(law.all.at(t));
    for (int c = 0; c < f[i].size(); ++c)
      if (!std::isfinite(f[i][c])) {
        const auto ends = [&](double x) { return !std::isfinite(law.all.at(x)[c]); };
        report.add("finite",
                   {fmt::format("{} is {} from about t = {} s", law.name(c), f[i][c],
                                text::brief(i > 0 ? beginning(instant(i - 1), t, ends) : t)),
                    "its formula at that time: a division by zero, a root or a logarithm of a negative number"});
        return {};
      }
    size = size.cwiseMax(f[i].cwiseAbs());
    law.all.at(instant(i / 2));
    if (law.all.at(t) != f[i])
      report.add("same", {fmt::format("returns another value at t = {} s in a second call", text::number(t)),
                          "members that change between calls: a law is a function of t alone"});
  }
  if (std::ranges::all_of(f, [&](const VecX& x) { return x == f[0]; }))
    report.note("it is constant during this time; test a time in which it moves, as by {.from = 2, .to = 10}");
  for (int i = 1; i < kInstants; ++i) {
    const bool rests = f[i] == f[i - 1];  // before instant i, and not after it; or the reverse
    if (rests == (f[i + 1] == f[i])) continue;
    const int from = rests ? i : i - 1;
    const double t =
        beginning(instant(from), instant(from + 1), [&](double x) { return rests != (law.all.at(x) == f[i]); });
    if (std::ranges::any_of(listed, [&](double b) { return 2 * std::abs(b - t) < 3 * cell; })) continue;
    const auto change = [&](double x) -> VecX {
      return (law.all.at(std::clamp(rests ? t + x : t - x, options.from, options.to)) - f[i]).cwiseAbs();
    };
    const double near = kNegligible * cell;
    const std::string what = fmt::format("{} {} to change at ", law.levels[0], rests ? "begins" : "ceases"),
                      when = fmt::format("t = {} s, which breakpoints() does not list", text::brief(t));
    if ((change(cell).array() <= kSlight * size.array()).all())
      report.note(what + "about " + when + ": a run may step over it");
    else if ((2 * change(near).array() <= change(16 * near).array()).all())  // else check_jumps() reports a jump
      report.add(what, {what + when + ", so an adaptive method may step over it", "breakpoints(): append this time"});
  }
  return size;
}

// First derivatives against the change of the value, second ones against the first, or against the value if the first
// are wrong.
void check_rates(const LawNumbers& law, const VecX& size, const std::vector<double>& listed,
                 const CheckOptions& options, CheckReport& report) {
  const double span = options.to - options.from;
  bool wrong = false;  // the first derivatives
  for (const int level : {1, 2}) {
    Draw draw(options.seed);
    const bool twice = level == 2 && wrong;
    for (int i = 0; i < 8 * options.states; ++i) {
      const double t = draw.number(options.from, options.to);
      double reach = std::min({span / 50, t - options.from, options.to - t});
      for (const double b : listed) reach = std::min(reach, 0.9 * std::abs(t - b));
      if (reach < kSlight * span) continue;
      const Curve value = [&](double x) { return law.change(t, x); };
      const Curve rate = [&](double x) -> VecX { return law.all.at(t + x).segment(law.n_values, law.n); };
      const int first = law.n_values + (level - 1) * law.n;
      const auto what = [&](int k) { return fmt::format("{} at t = {} s", law.name(first + k), text::brief(t)); };
      const auto look = [&](int k) {
        return fmt::format("the formula of {}, and at the terms of the chain rule", law.name(first + k));
      };
      const bool found = compare(
          report,
          {fmt::format("slope {}", level), law.all.at(t).segment(first, law.n),
           VecX::Constant(law.n, size.segment(first, law.n).maxCoeff()), what,
           fmt::format("{}finite differences of {} give", twice ? "second " : "", law.levels[twice ? 0 : level - 1]),
           "", look},
          twice ? second_derivative(value, reach) : first_derivative(level == 1 ? value : rate, reach));
      wrong = wrong || found;
    }
  }
}

// At a listed jump the law has its later numbers; a value that jumps cannot drive a joint.
void check_listed(const LawNumbers& law, const VecX& size, const std::vector<double>& listed,
                  const CheckOptions& options, CheckReport& report) {
  const double near = kRounding * (options.to - options.from);
  for (const double b : listed) {
    const auto across = [&](double x) -> VecX { return law.all.at(b + x) - law.all.at(b - x); };
    const VecX jump = across(near), wide = across(16 * near), ahead = law.all.at(b + near) - law.all.at(b);
    for (int c = 0; c < size.size(); ++c) {
      if (!(std::abs(jump[c]) > std::max(kSlight * size[c], 0.5 * std::abs(wide[c])))) continue;
      const std::string what =
          fmt::format("{} jumps by {:.3g} at its breakpoint t = {} s", law.name(c), jump[c], text::number(b));
      if (2 * std::abs(ahead[c]) > std::abs(jump[c]))
        report.add("listed", {what + ", but at(t) returns the new value only after t",
                              "its comparison: t itself with that time, t >= t1, and not (t - t0)/T >= 1"});
      else if (c < law.n_values)
        report.note(what + ": it cannot drive a joint");
    }
  }
}

template <class Law>
CheckReport checked(const Law& law, const char* kind, const std::string& name, const CheckOptions& options,
                    const std::array<const char*, 3>& levels) {
  if (!(options.to > options.from) || !std::isfinite(options.to - options.from))
    throw ModelError(fmt::format("check_law: the end {1} s must be after the start {0} s; give a later end",
                                 options.from, options.to));
  CheckReport report(
      fmt::format("{} from t = {} to {} s", Thing{.kind = kind, .name = name}.words(), options.from, options.to),
      options.seed);
  LawNumbers own{levels, {}, {}, 0, 0};
  const auto own_code = [&](double t, const auto& act) {
    return in_context([&] { return ErrorContext{.thing = {.kind = kind, .name = name}, .t = t}; }, act);
  };
  const auto at = [&](double t) { return own_code(t, [&] { return law.at(t); }); };
  own.all = {
      [&](double t) { return numbers(at(t)); }, [&](int c) { return own.name(c); },
      [&](double t0, double t1, std::vector<double>& out) { own_code(t0, [&] { law.breakpoints(t0, t1, out); }); },
      "breakpoints(): append every time at which the value or one of its two derivatives jumps"};
  own.change = [&](double t, double x) { return change(at(t), at(t + x)); };
  completes(report, [&] {
    const auto n_all = static_cast<int>(own.all.at(options.from).size());
    own.n = static_cast<int>(own.change(options.from, 0).size()), own.n_values = n_all - 2 * own.n;
    const std::vector<double> listed = listed_breakpoints(own.all, options, report);
    const VecX size = sizes(own, listed, options, report);
    if (size.size() == 0) return;
    check_rates(own, size, listed, options, report);
    check_listed(own, size, listed, options, report);
    check_jumps(own.all, options, report, 400, n_all);
    if constexpr (std::is_same_v<Law, RotationLaw>)
      for (int i = 0; i <= kInstants; ++i) {
        const double t = options.from + (options.to - options.from) * i / kInstants, n = std::sqrt(norm2(at(t).q));
        if (std::abs(n - 1) > kRoundOff)
          report.add("unit",
                     {fmt::format("q at t = {} s has length {:.9g}, not 1", text::number(t), n), "its normalisation"},
                     std::abs(n - 1));
      }
  });
  return report;
}

}  // namespace

CheckReport check_law(const MotionLaw& law, const CheckOptions& options, const std::string& name) {
  return checked(law, "law", name, options, {"y", "yd", "ydd"});
}

CheckReport check_law(const TranslationLaw& law, const CheckOptions& options, const std::string& name) {
  return checked(law, "translation law", name, options, {"x", "v", "a"});
}

CheckReport check_law(const RotationLaw& law, const CheckOptions& options, const std::string& name) {
  return checked(law, "rotation law", name, options, {"q", "w", "a"});
}

}  // namespace lockstep
