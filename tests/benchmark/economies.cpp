// SPDX-License-Identifier: BSD-3-Clause
// Time of an evaluation of the equations of motion with each feature absent and present; CSV and bars.
#include <fstream>

#include <spdlog/fmt/fmt.h>

#include <lockstep/assembly.h>
#include <lockstep/detail/newton.h>
#include <lockstep/integrators.h>
#include <lockstep/recorder.h>
#include "framework/tools/charts/chart_style.h"
#include "framework/tools/precision/work_precision.h"
#include "samples/shared/output.h"
#include "tests/support/economies.h"

using namespace lockstep;
using namespace lockstep::economies;
using namespace lockstep::chart_style;

namespace {

/// Bars: for each category one bar of every group, side by side, with its number written on it.
struct Bars {
  std::string title, y_label;
  std::vector<std::string> categories;
  struct Group {
    std::string label;           ///< in the legend
    std::vector<double> values;  ///< one per category
    std::string color;           ///< "#rrggbb"
  };
  std::vector<Group> groups;
  int width = 1250, height = 520;  ///< pixels
};

void draw_bars(const std::string& path, const Bars& spec) {
  Extent y{};
  for (const Bars::Group& g : spec.groups) y.take(g.values, false);
  Script out;
  begin_page(out, 1, spec.title);
  axis(out, 'y', spec.y_label, false, y.low, y.high);
  out.line("set xtics scale 0 noenhanced\nset style fill solid 0.9 noborder\nunset grid\nset grid y");
  const double n = static_cast<double>(spec.groups.size()), width = 0.8 / n;
  std::string ticks;
  for (std::size_t c = 0; c < spec.categories.size(); ++c)
    ticks += fmt::format("{}{} {}", c == 0 ? "" : ", ", quoted_text(spec.categories[c]), c);
  out.line("set xtics (" + ticks + ")");
  std::size_t longest = 0;
  for (const std::string& c : spec.categories) longest = std::max(longest, c.size());
  const bool crowded = 8 * longest * spec.categories.size() > static_cast<std::size_t>(spec.width) - 150;
  out.line(crowded ? "set xtics rotate by -20" : "set xtics norotate");
  constexpr double kLeftOfBars = 104, kLegend = 30;  // pixels
  const double right = crowded ? 120 : 28, below = crowded ? 90 : 44;
  const double top = 1 - (title_height(spec.title) + kLegend) / spec.height;
  margins(out, kLeftOfBars / spec.width, 1 - right / spec.width, top, below / spec.height);
  out.line(
      fmt::format("set key at screen {:.5f}, screen {:.5f} left bottom horizontal", kLeftOfBars / spec.width, top));
  out.line(fmt::format("set xrange [-0.6:{}]", static_cast<double>(spec.categories.size()) - 0.4));
  std::size_t letters = 0;
  for (const Bars::Group& g : spec.groups)
    for (const double v : g.values) letters = std::max(letters, fmt::format("{:.4g}", v).size());
  const double pixels = (spec.width - kLeftOfBars - right) / static_cast<double>(spec.categories.size()) * width;
  const bool upright = 7.5 * static_cast<double>(letters) > pixels;  // wider than their bar
  out.line(fmt::format("set yrange [{}:{}]", std::min(0.0, y.low), upright ? fmt::format("{}", 1.15 * y.high) : "*"));
  const char* const stand = upright ? "rotate by 90 left offset 0,0.4" : "offset 0,0.6";
  std::vector<std::string> clauses;
  for (std::size_t g = 0; g < spec.groups.size(); ++g) {
    const std::string name = fmt::format("bar{}", g);
    out.begin_data(name);
    for (std::size_t c = 0; c < spec.categories.size(); ++c) {
      const double row[] = {static_cast<double>(c) + (static_cast<double>(g) - 0.5 * (n - 1)) * width,
                            spec.groups[g].values[c]};
      out.row(row);
    }
    out.end_data();
    const std::string tint = color_or(spec.groups[g].color, g, "group \"" + spec.groups[g].label + "\"");
    const std::string legend = spec.groups[g].label.empty() ? "notitle" : "title " + quoted_text(spec.groups[g].label);
    clauses.push_back(fmt::format("${} using 1:2:({}) with boxes lc rgb '{}' {}", name, 0.94 * width, tint, legend));
    clauses.push_back(fmt::format("${} using 1:2:(sprintf('%.4g',$2)) with labels {} font ',10' notitle", name, stand));
  }
  plot(out, clauses);
  draw_page(out, path, spec.width, spec.height);
}

/// Microseconds of an evaluation, the least of nine rounds; with the tangents and the matrix of an implicit method, if
/// they are wanted.
double microseconds(Chain chain, bool tangents = false) {
  Dynamics dynamics(*chain.sys, std::make_unique<SchurSolver>());
  State state = chain.sys->start();
  assemble(dynamics, state);
  StateRate rate;
  const Solution& solution = dynamics.rate(state, rate);
  NewtonMatrix matrix;
  const auto implicit = [&] {
    matrix.gather(solution.evaluation, solution.lambda);
    matrix.factor(1.0, 1e-3, 1e-6);
  };
  double best = HUGE_VAL;
  for (int round = 0; round < 9; ++round) {
    long n = 0;
    const double begin = thread_seconds();
    double spent = 0;
    for (; spent < 0.03; spent = thread_seconds() - begin)
      for (int i = 0; i < 10; ++i, ++n) {
        state.v[0] += 1e-12;
        dynamics.rate(state, rate);
        if (tangents) implicit();
      }
    best = std::min(best, 1e6 * spent / static_cast<double>(n));
  }
  return best;
}

/// Microseconds of a run by rk4 for each of its evaluations, every step recorded; the least of nine runs.
double microseconds_recorded(const std::vector<Request>& columns) {
  constexpr int kSteps = 200;
  double best = HUGE_VAL;
  for (int round = 0; round < 9; ++round) {
    Chain chain = plain();
    Recorder recorder(*chain.sys, columns);
    Dynamics dynamics(*chain.sys, std::make_unique<SchurSolver>());
    StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 1e-3, .tolerance = {}});
    run.add_observer(recorder);
    run.step();
    const double begin = thread_seconds();
    for (int i = 0; i < kSteps; ++i) run.step();
    best = std::min(best, 1e6 * (thread_seconds() - begin) / (4 * kSteps));
  }
  return best;
}

}  // namespace

int main() {
  Bars bars{"A chain of six bodies: what each feature adds to an evaluation",
            "CPU time of an evaluation [us]",
            {},
            {{"without the feature", {}, "#9fd3c7"}, {"with the feature", {}, "#385170"}}};
  const std::string file = samples::output("economies.csv");
  std::ofstream csv(file);
  csv << "feature,absent,present,unknowns absent,unknowns present,rows absent,rows present,cpu absent [us],cpu present "
         "[us]\n";
  fmt::print("{:20} {:>9} {:>9}   unknowns, rows\n", "", "absent us", "present");
  const auto add = [&](const std::string& name, const std::string& absent_is, const std::string& present_is,
                       double absent, double present, Size a, Size p) {
    bars.categories.push_back(name);
    bars.groups[0].values.push_back(absent), bars.groups[1].values.push_back(present);
    csv << fmt::format("{},{},{},{},{},{},{},{:.4g},{:.4g}\n", name, absent_is, present_is, a.unknowns, p.unknowns,
                       a.rows, p.rows, absent, present);
    fmt::print("{:20} {:9.2f} {:9.2f}   {}, {} -> {}, {}: {} -> {}\n", name, absent, present, a.unknowns, a.rows,
               p.unknowns, p.rows, absent_is, present_is);
  };
  for (const Economy& e : all())
    add(e.name, e.absent_is, e.present_is, microseconds(e.absent()), microseconds(e.present()), size(e.absent()),
        size(e.present()));
  const Size s = size(plain());
  add("implicit method", "an explicit method's evaluation", "the same with the matrix of an implicit one",
      microseconds(plain()), microseconds(plain(), true), s, s);
  const double bare = microseconds_recorded({});
  add("recorded energy", "rk4: nothing recorded", "energy recorded at every step", bare,
      microseconds_recorded({"energy.total"}), s, s);
  add("recorded reactions", "rk4: nothing recorded", "all reactions recorded at every step", bare,
      microseconds_recorded([] {
        std::vector<Request> all_forces;
        for (int i = 0; i < kRods; ++i)
          for (const char* axis : {"x", "y", "z"})
            all_forces.push_back("joint" + std::to_string(i) + ".force_on_p_world_" + axis);
        return all_forces;
      }()),
      s, s);
  draw_bars(samples::output("economies"), bars);
  fmt::print("{}, economies.svg, economies.png\n", file);
}
