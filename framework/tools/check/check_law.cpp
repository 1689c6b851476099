#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/tools/check/draw.h"
#include "framework/tools/check/jumps.h"
#include "framework/tools/check/slope.h"

namespace lockstep {
namespace {

// A law of any kind as numbers on three levels: value, first and second derivative. A rotation's value is its matrix.
struct Levels {
  int n[3];                        // numbers on each level
  std::vector<std::string> names;  // of all numbers
  const char* level_names[3];
  std::function<void(double t, VecX& out)> at;              // all numbers
  std::function<void(double t, double x, VecX& out)> move;  // change of the value from t to t + x, as n[1] numbers
  std::function<void(double, double, std::vector<double>&)> breakpoints{};

  int first(int level) const { return level == 0 ? 0 : level == 1 ? n[0] : n[0] + n[1]; }
};

class LawCheck {
 public:
  LawCheck(Levels law, CheckReport& report, const CheckOptions& options)
      : law_(std::move(law)), report_(report), options_(options), span_(options.to - options.from) {
    if (!(span_ > 0) || !std::isfinite(span_))
      throw ModelError(fmt::format("check_law: from {} s to {} s is no time to look at; give a later end", options.from,
                                   options.to));
  }

  void run() {
    if (!finite()) return;
    listed_ = breakpoints();
    derivatives();
    jumps();
  }

 private:
  static constexpr int kInstants = 200;
  double instant(int i) const { return options_.from + span_ * i / kInstants; }

  bool finite() {
    VecX f, again, other;
    for (int i = 0; i <= kInstants; ++i) {
      const double t = instant(i);
      law_.at(t, f);
      size_ = i == 0 ? f.cwiseAbs() : VecX(size_.cwiseMax(f.cwiseAbs()));
      for (Eigen::Index c = 0; c < f.size(); ++c)
        if (!std::isfinite(f[c])) {
          report_.add("finite", {fmt::format("{} is {} at t = {} s", name(c), f[c], text::number(t)),
                                 "its formula there: a division by zero, a root or a logarithm of a negative number"});
          return false;
        }
      law_.at(instant(kInstants - i), other);
      law_.at(t, again);
      if (again != f)
        report_.add("same", {fmt::format("says something else at t = {} s when it is asked again", text::number(t)),
                             "what it keeps between two calls: a law is a function of t alone"});
    }
    for (int level = 0; level < 3; ++level) {  // the size of a number is that of its whole level
      auto sizes = size_.segment(law_.first(level), law_.n[level]);
      sizes.setConstant(sizes.maxCoeff());
    }
    return true;
  }

  std::vector<double> breakpoints() {
    constexpr double kMark = -12345.5;
    std::vector<double> out{kMark};
    law_.breakpoints(options_.from, options_.to, out);
    if (out.empty() || out.front() != kMark)
      report_.add("append", {"breakpoints() does not keep what was in the list", "breakpoints(): it has to append"});
    std::erase(out, kMark);
    for (const double t : out)
      if (!(t > options_.from && t < options_.to))
        report_.add("outside", {fmt::format("breakpoints({}, {}) tells {} s, which is not between them",
                                            text::number(options_.from), text::number(options_.to), text::number(t)),
                                "breakpoints(): it appends the instants in (t0, t1) only"});
    std::sort(out.begin(), out.end());
    return out;
  }

  void derivatives() {
    Draw draw(options_.seed);
    for (int i = 0; i < 8 * options_.states; ++i) {
      const double t = draw.number(options_.from, options_.to);
      double reach = std::min({span_ / 50, t - options_.from, options_.to - t});
      for (const double b : listed_) reach = std::min(reach, 0.9 * std::abs(t - b));
      if (reach < 1e-6 * span_) continue;
      const auto value = [&](double x, VecX& out) { law_.move(t, x, out); };
      const auto rate = [&](double x, VecX& out) {
        VecX all;
        law_.at(t + x, all);
        out = all.segment(law_.first(1), law_.n[1]);
      };
      VecX here;
      law_.at(t, here);
      compare(1, first_derivative(value, reach), here, t);
      compare(2, first_derivative(rate, reach), here, t);
    }
  }

  void compare(int level, const Slope& slope, const VecX& here, double t) {
    for (int k = 0; k < law_.n[level]; ++k) {
      const Eigen::Index c = law_.first(level) + k;
      const double is = here[c], should_be = slope.value[k], room = slope.error[k] + 1e-11 * size_[c];
      if (!std::isfinite(slope.error[k])) continue;
      report_.compared(slope.error[k] / std::max(size_[c], std::abs(should_be)));
      if (std::abs(is - should_be) <= room) continue;
      report_.add(fmt::format("slope {}", c),
                  {fmt::format("{} at t = {} s is {:.6g}, differences of {} say {:.6g}{}", name(c), text::number(t), is,
                               name_below(level, k), should_be, likeness(is, should_be)),
                   fmt::format("the formula of {}, and at the terms that come with the chain rule", name(c))},
                  std::abs(is - should_be) / std::max(size_[c], 1e-300));
    }
  }

  void jumps() {
    for (const auto& [c, all] : find_jumps(law_.at, options_.from, options_.to, listed_)) {
      std::vector<std::string> instants;
      for (const Jump& j : all) instants.push_back(fmt::format("{:.9g}", j.t));
      const std::size_t n = instants.size();
      if (n > 3) instants.resize(3);
      report_.add(fmt::format("jump {}", c),
                  {fmt::format("{} jumps at t = {} s{} (by {:.3g} at the first), which breakpoints() does not tell",
                               name(c), text::join(instants, n > 3 ? ", " : " and "),
                               n > 3 ? fmt::format(" and {} more", n - 3) : "", all.front().size),
                   "breakpoints(): append every instant where the value or one of its two derivatives jumps"});
    }
  }

  const std::string& name(Eigen::Index c) const { return law_.names[c]; }
  std::string name_below(int level, int k) const {
    return law_.n[level - 1] == law_.n[level] ? name(law_.first(level - 1) + k) : law_.level_names[level - 1];
  }

  Levels law_;
  CheckReport& report_;
  const CheckOptions& options_;
  double span_;
  std::vector<double> listed_;
  VecX size_;
};

template <class Law>
CheckReport checked(const Law& law, const char* kind, const std::string& name, const CheckOptions& options,
                    Levels levels) {
  CheckReport report(name.empty() ? kind : fmt::format("{} '{}'", kind, name), options.seed);
  levels.breakpoints = [&](double t0, double t1, std::vector<double>& out) { law.breakpoints(t0, t1, out); };
  LawCheck(std::move(levels), report, options).run();
  return report;
}

}  // namespace

CheckReport check_law(const MotionLaw& law, const CheckOptions& options, const std::string& name) {
  const auto at = [&](double t, VecX& out) {
    const LawValue v = law.at(t);
    out = Vec3(v.y, v.yd, v.ydd);
  };
  const auto move = [&](double t, double x, VecX& out) { out = VecX::Constant(1, law.at(t + x).y); };
  return checked(law, "law", name, options, {{1, 1, 1}, {"y", "yd", "ydd"}, {"y", "yd", "ydd"}, at, move});
}

CheckReport check_law(const TranslationLaw& law, const CheckOptions& options, const std::string& name) {
  const auto at = [&](double t, VecX& out) {
    const TranslationValue v = law.at(t);
    out.resize(9);
    out << v.x, v.v, v.a;
  };
  const auto move = [&](double t, double x, VecX& out) { out = law.at(t + x).x; };
  return checked(
      law, "translation law", name, options,
      {{3, 3, 3}, {"x[0]", "x[1]", "x[2]", "v[0]", "v[1]", "v[2]", "a[0]", "a[1]", "a[2]"}, {"x", "v", "a"}, at, move});
}

CheckReport check_law(const RotationLaw& law, const CheckOptions& options, const std::string& name) {
  std::vector<std::string> names;
  for (int k = 0; k < 9; ++k) names.push_back(fmt::format("the rotation matrix of q [{}][{}]", k % 3, k / 3));
  for (int k = 0; k < 6; ++k) names.push_back(fmt::format("{}[{}]", "wa"[k / 3], k % 3));
  const auto at = [&](double t, VecX& out) {
    const RotationValue v = law.at(t);
    const Mat3 A = rotation(v.q);
    out.resize(15);
    out << A.reshaped(), v.w, v.a;
  };
  // (1.13): w is the rate of the rotation vector of q(t)' q(t + x) at x = 0, in the moved frame's own axes
  const auto move = [&](double t, double x, VecX& out) {
    out = rotation_vector(conjugate(law.at(t).q) * law.at(t + x).q);
  };
  CheckReport report =
      checked(law, "rotation law", name, options, {{9, 3, 3}, std::move(names), {"q", "w", "a"}, at, move});
  for (int i = 0; i <= 200; ++i) {
    const double t = options.from + (options.to - options.from) * i / 200, n = std::sqrt(norm2(law.at(t).q));
    if (std::isfinite(n) && std::abs(n - 1) > 1e-12)
      report.add("unit",
                 {fmt::format("q at t = {} s has length {:.9g}, not 1", text::number(t), n), "its normalisation"},
                 std::abs(n - 1));
  }
  return report;
}

}  // namespace lockstep
