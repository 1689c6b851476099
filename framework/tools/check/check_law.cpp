// check_law: the derivatives of a law against differences, and its jumps.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/tools/check/compare.h"
#include "framework/tools/check/draw.h"
#include "framework/tools/check/jumps.h"

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
  const char* levels[3];                           ///< "x", "v", "a"
  int n_values, n;                                 ///< numbers of the value, and of each derivative
  Curve at{};                                      ///< all of them, over time
  std::function<VecX(double t, double x)> move{};  ///< change of the value from t to t + x, n numbers
  std::function<void(double, double, std::vector<double>&)> breakpoints{};

  std::string name(int c) const {
    if (c < n_values && n_values > n) return fmt::format("the rotation matrix of {} [{}][{}]", levels[0], c % 3, c / 3);
    const int level = c < n_values ? 0 : 1 + (c - n_values) / n;
    return n == 1 ? levels[level] : fmt::format("{}[{}]", levels[level], (c + n - n_values) % n);
  }
  TimedNumbers timed() const {
    return {at, [this](int c) { return name(c); }, breakpoints,
            "breakpoints(): append every instant where the value or one of its two derivatives jumps"};
  }
};

class LawCheck {
 public:
  LawCheck(const LawNumbers& law, CheckReport& report, const CheckOptions& options)
      : law_(law), report_(report), options_(options), span_(options.to - options.from) {
    if (!(span_ > 0) || !std::isfinite(span_))
      throw ModelError(fmt::format("check_law: from {} s to {} s is no time to look at; give a later end", options.from,
                                   options.to));
  }

  void run() {
    if (!finite()) return;
    derivatives();
    check_jumps(law_.timed(), options_, report_, 400, law_.n_values + 2 * law_.n);
  }

 private:
  double instant(int i) const { return options_.from + span_ * i / kInstants; }

  bool finite() {
    for (int i = 0; i <= kInstants; ++i) {
      const double t = instant(i);
      const VecX f = law_.at(t);
      size_ = i == 0 ? f.cwiseAbs() : VecX(size_.cwiseMax(f.cwiseAbs()));
      for (int c = 0; c < f.size(); ++c)
        if (!std::isfinite(f[c])) {
          report_.add("finite", {fmt::format("{} is {} at t = {} s", law_.name(c), f[c], text::number(t)),
                                 "its formula there: a division by zero, a root or a logarithm of a negative number"});
          return false;
        }
      law_.at(instant(kInstants - i));
      if (law_.at(t) != f)
        report_.add("same", {fmt::format("says something else at t = {} s when it is asked again", text::number(t)),
                             "what it keeps between two calls: a law is a function of t alone"});
    }
    return true;
  }

  // First derivatives against the change of the value, second ones against the first.
  void derivatives() {
    const int n = law_.n;
    const std::vector<double> told = told_breakpoints(law_.timed(), options_, report_);
    Draw draw(options_.seed);
    for (int i = 0; i < 8 * options_.states; ++i) {
      const double t = draw.number(options_.from, options_.to);
      double reach = std::min({span_ / 50, t - options_.from, options_.to - t});
      for (const double b : told) reach = std::min(reach, 0.9 * std::abs(t - b));
      if (reach < 1e-6 * span_) continue;
      const VecX here = law_.at(t);
      const Curve value = [&](double x) { return law_.move(t, x); };
      const Curve rate = [&](double x) -> VecX { return law_.at(t + x).segment(law_.n_values, n); };
      for (const int level : {1, 2}) {
        const int first = law_.n_values + (level - 1) * n;
        compare(report_,
                {fmt::format("slope {}", level), here.segment(first, n),
                 VecX::Constant(n, size_.segment(first, n).maxCoeff()),
                 [&](int k) { return fmt::format("{} at t = {} s", law_.name(first + k), text::number(t)); },
                 fmt::format("differences of {} say", law_.levels[level - 1]), "",
                 [&](int k) {
                   return fmt::format("the formula of {}, and at the terms that come with the chain rule",
                                      law_.name(first + k));
                 }},
                first_derivative(level == 1 ? value : rate, reach));
      }
    }
  }

  const LawNumbers& law_;
  CheckReport& report_;
  const CheckOptions& options_;
  double span_;
  VecX size_;
};

template <class Law>
CheckReport checked(const Law& law, const char* kind, const std::string& name, const CheckOptions& options,
                    LawNumbers numbers_of) {
  CheckReport report(name.empty() ? kind : fmt::format("{} '{}'", kind, name), options.seed);
  numbers_of.at = [&](double t) { return numbers(law.at(t)); };
  numbers_of.move = [&](double t, double x) { return change(law.at(t), law.at(t + x)); };
  numbers_of.breakpoints = [&](double t0, double t1, std::vector<double>& out) { law.breakpoints(t0, t1, out); };
  LawCheck(numbers_of, report, options).run();
  return report;
}

}  // namespace

CheckReport check_law(const MotionLaw& law, const CheckOptions& options, const std::string& name) {
  return checked(law, "law", name, options, {{"y", "yd", "ydd"}, 1, 1});
}

CheckReport check_law(const TranslationLaw& law, const CheckOptions& options, const std::string& name) {
  return checked(law, "translation law", name, options, {{"x", "v", "a"}, 3, 3});
}

CheckReport check_law(const RotationLaw& law, const CheckOptions& options, const std::string& name) {
  CheckReport report = checked(law, "rotation law", name, options, {{"q", "w", "a"}, 9, 3});
  for (int i = 0; i <= kInstants; ++i) {
    const double t = options.from + (options.to - options.from) * i / kInstants, n = std::sqrt(norm2(law.at(t).q));
    if (std::isfinite(n) && std::abs(n - 1) > 1e-12)
      report.add("unit",
                 {fmt::format("q at t = {} s has length {:.9g}, not 1", text::number(t), n), "its normalisation"},
                 std::abs(n - 1));
  }
  return report;
}

}  // namespace lockstep
