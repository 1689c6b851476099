#include <lockstep/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "framework/tools/check/draw.h"
#include "framework/tools/check/jumps.h"
#include "framework/tools/check/slope.h"
#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {

// A law of any kind as three levels of n numbers; the first may be a rotation, whose 9 numbers are its matrix.
struct Levels {
  int n[3];
  std::vector<std::string> names;                           // of all numbers
  std::function<void(double t, VecX& out)> at;              // all numbers
  std::function<void(double t, double x, VecX& out)> move;  // the first level from t to t + x, 3 or 1 numbers
  std::function<void(double, double, std::vector<double>&)> breakpoints;
  const char* words[3];  // of the levels

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
    listed_ = list();
    slopes();
    jumps();
  }

 private:
  bool finite() {
    VecX f, again, other;
    for (int i = 0; i <= 200; ++i) {
      const double t = options_.from + span_ * i / 200;
      law_.at(t, f);
      size_ = i == 0 ? f.cwiseAbs() : VecX(size_.cwiseMax(f.cwiseAbs()));
      for (Eigen::Index c = 0; c < f.size(); ++c)
        if (!std::isfinite(f[c])) {
          report_.add("finite", {fmt::format("{} is {} at t = {} s", name(c), f[c], text::number(t)),
                                 "its formula there: a division by zero, a root or a logarithm of a negative number"});
          return false;
        }
      law_.at(options_.to - span_ * i / 200, other);
      law_.at(t, again);
      if (again != f)
        report_.add("same", {fmt::format("says something else at t = {} s when it is asked again", text::number(t)),
                             "what it keeps between two calls: a law is a function of t alone"});
    }
    for (int level = 0; level < 3; ++level)  // the size of a whole level
      size_.segment(law_.first(level), law_.n[level])
          .setConstant(size_.segment(law_.first(level), law_.n[level]).maxCoeff());
    return true;
  }

  std::vector<double> list() {
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

  void slopes() {
    Draw draw(options_.seed);
    for (int i = 0; i < 8 * options_.states; ++i) {
      const double t = draw.number(options_.from, options_.to);
      double reach = std::min({span_ / 50, t - options_.from, options_.to - t});
      for (const double b : listed_) reach = std::min(reach, 0.9 * std::abs(t - b));
      if (reach < 1e-6 * span_) continue;
      VecX here, numbers;
      law_.at(t, here);
      compare(1, first_derivative([&](double x, VecX& out) { law_.move(t, x, out); }, reach), here, t);
      const Slope second = first_derivative(
          [&](double x, VecX& out) {
            law_.at(t + x, numbers);
            out = numbers.segment(law_.first(1), law_.n[1]);
          },
          reach);
      compare(2, second, here, t);
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
    std::vector<std::vector<Jump>> of(static_cast<std::size_t>(size_.size()));
    for (const Jump& j : find_jumps(law_.at, options_.from, options_.to, listed_))
      of[static_cast<std::size_t>(j.component)].push_back(j);
    for (std::size_t c = 0; c < of.size(); ++c) {
      if (of[c].empty()) continue;
      std::vector<std::string> instants;
      for (const Jump& j : of[c]) instants.push_back(fmt::format("{:.9g}", j.t));
      const std::size_t n = instants.size();
      if (n > 3) instants.resize(3);
      report_.add(fmt::format("jump {}", c),
                  {fmt::format("{} jumps at t = {} s{} (by {:.3g} at the first), which breakpoints() does not tell",
                               name(static_cast<Eigen::Index>(c)), text::join(instants, n > 3 ? ", " : " and "),
                               n > 3 ? fmt::format(" and {} more", n - 3) : "", of[c].front().size),
                   "breakpoints(): append every instant where the value or one of its two derivatives jumps"});
    }
  }

  const std::string& name(Eigen::Index c) const { return law_.names[static_cast<std::size_t>(c)]; }
  std::string name_below(int level, int k) const {
    return law_.n[level - 1] == law_.n[level] ? name(law_.first(level - 1) + k) : law_.words[level - 1];
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
  Levels l{{1, 1, 1}, {"y", "yd", "ydd"}, {}, {}, {}, {"y", "yd", "ydd"}};
  l.at = [&](double t, VecX& out) {
    const LawValue v = law.at(t);
    out = Vec3(v.y, v.yd, v.ydd);
  };
  l.move = [&](double t, double x, VecX& out) { out = VecX::Constant(1, law.at(t + x).y); };
  return checked(law, "law", name, options, std::move(l));
}

CheckReport check_law(const TranslationLaw& law, const CheckOptions& options, const std::string& name) {
  Levels l{{3, 3, 3},      {"x[0]", "x[1]", "x[2]", "v[0]", "v[1]", "v[2]", "a[0]", "a[1]", "a[2]"}, {}, {}, {},
           {"x", "v", "a"}};
  l.at = [&](double t, VecX& out) {
    const TranslationValue v = law.at(t);
    out.resize(9);
    out << v.x, v.v, v.a;
  };
  l.move = [&](double t, double x, VecX& out) { out = law.at(t + x).x; };
  return checked(law, "translation law", name, options, std::move(l));
}

CheckReport check_law(const RotationLaw& law, const CheckOptions& options, const std::string& name) {
  Levels l{{9, 3, 3}, {}, {}, {}, {}, {"q", "w", "a"}};
  for (const char* at : {"00", "10", "20", "01", "11", "21", "02", "12", "22"})
    l.names.push_back(std::string("the rotation matrix of q [") + at[0] + "][" + at[1] + "]");
  for (const char* letter : {"w", "a"})
    for (const char* k : {"[0]", "[1]", "[2]"}) l.names.push_back(std::string(letter) + k);
  l.at = [&](double t, VecX& out) {
    const RotationValue v = law.at(t);
    const Mat3 A = rotation(v.q);
    out.resize(15);
    out << Eigen::Map<const Eigen::Matrix<double, 9, 1>>(A.data()), v.w, v.a;
  };
  // (1.13): w is the rate of the rotation vector of q(t)' q(t + x) at x = 0, in the moved frame's own axes
  l.move = [&](double t, double x, VecX& out) { out = rotation_vector(conjugate(law.at(t).q) * law.at(t + x).q); };
  CheckReport report = checked(law, "rotation law", name, options, std::move(l));
  for (int i = 0; i <= 200; ++i) {
    const double t = options.from + (options.to - options.from) * i / 200, n = std::sqrt(norm2(law.at(t).q));
    if (std::isfinite(n) && std::abs(n - 1) > 1e-12)
      report.add("unit", {fmt::format("q at t = {} s has length {:.9g}, not 1", text::number(t), n), "its normalisation"},
                 std::abs(n - 1));
  }
  return report;
}

}  // namespace lockstep
