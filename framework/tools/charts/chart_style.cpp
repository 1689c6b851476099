// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/charts/chart_style.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <lockstep/error.h>

namespace lockstep::chart_style {
namespace {

// Okabe and Ito, "Color universal design" (2008), darkest first.
constexpr std::array<std::string_view, 7> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                  "#e69f00", "#56b4e9", "#000000"};
constexpr std::size_t kMostPoints = 3000, kMostOfPath = 40'000;

bool is_color(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         std::all_of(text.begin() + 1, text.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
}

// Of each run of points the first, the least and the largest: a picture 1000 pixels wide shows no more. Of a path, whose
// points are not ordered along x, evenly spread ones.
std::vector<std::size_t> thinned(const Series& s) {
  std::vector<std::size_t> keep;
  const std::size_t n = s.y.size();
  const bool joined = s.style == SeriesStyle::lines || s.style == SeriesStyle::dashes;
  if (joined && !std::ranges::is_sorted(s.x)) {
    for (std::size_t i = 0; i < n; i += 1 + n / kMostOfPath) keep.push_back(i);
    if (keep.back() + 1 != n) keep.push_back(n - 1);
    return keep;
  }
  const std::size_t run = joined && n > kMostPoints ? (3 * n + kMostPoints - 1) / kMostPoints : 1;
  for (std::size_t i = 0; i < n; i += run) {
    const std::size_t end = std::min(i + run, n);
    std::size_t low = i, high = i, hole = end;
    for (std::size_t k = i; k < end; ++k) {
      if (!std::isfinite(s.y[k])) hole = k;
      if (s.y[k] < s.y[low]) low = k;
      if (s.y[k] > s.y[high]) high = k;
    }
    std::set<std::size_t> some{i, low, high};
    if (hole < end) some.insert(hole);
    if (end == n) some.insert(n - 1);
    keep.insert(keep.end(), some.begin(), some.end());
  }
  return keep;
}

// The last position at or before byte `at` that does not split a UTF-8 character.
std::size_t character_end(const std::string& text, std::size_t at) {
  while (at > 0 && at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80) --at;
  return std::min(at, text.size());
}

constexpr std::size_t kTitleLetters = 84;  // in a line: 870 pixels

// A title in one or two lines of one size; what is longer is cut off.
std::string fitted(const std::string& title) {
  const char* const font = "noenhanced font ',14'";
  if (title.size() <= kTitleLetters) return fmt::format("{} {}", quoted_text(title), font);
  std::size_t first = title.rfind(' ', kTitleLetters);
  if (first == std::string::npos || first < kTitleLetters / 3) first = character_end(title, kTitleLetters);
  std::string rest = title.substr(first + (title[first] == ' ' ? 1 : 0));
  if (rest.size() > kTitleLetters) rest = rest.substr(0, character_end(rest, kTitleLetters - 3)) + "...";
  return fmt::format("{}.\"\\n\".{} {}", quoted_text(title.substr(0, first)), quoted_text(rest), font);
}

}  // namespace

double title_height(const std::string& title) { return title.empty() ? 0 : title.size() <= kTitleLetters ? 40 : 62; }

std::string color_or(const std::string& wanted, std::size_t n, const std::string& what) {
  if (wanted.empty()) return std::string(kColors[n % kColors.size()]);
  if (!is_color(wanted))
    throw ModelError(fmt::format("{}: \"{}\" is not a colour; write it like \"#0072b2\", or omit it", what, wanted));
  return wanted;
}

void begin_page(Script& out, std::size_t n, const std::string& title) {
  out.line("set encoding utf8")
      .line("set border 3 lc rgb '#555555' lw 1")
      .line("set tics nomirror out textcolor rgb '#333333'")
      .line("set grid back lc rgb '#dddddd' lw 0.8 lt 1 dt 1")
      .line("set key above left horizontal Left reverse samplen 2.5 spacing 1.15 noenhanced textcolor rgb '#222222'")
      .line("set lmargin 13")
      .line("set rmargin 4")
      .line("set datafile missing 'NaN'")
      .line("set pointsize 0.9");
  const std::string text = title.empty() ? "" : fmt::format(" title {}", fitted(title));
  out.line(fmt::format("set multiplot layout {},1{}", n, text));
}

void draw_page(Script& out, const std::string& path, int width, int height) {
  draw(out.line("unset multiplot"), path, width, height);
}

void axis(Script& out, char a, const std::string& label, bool log, double low, double high) {
  out.line(fmt::format("set {}label {} noenhanced textcolor rgb '#222222'", a, quoted_text(label)));
  out.line(fmt::format("set {}tics autofreq", a));
  if (!log) {
    out.line(fmt::format("unset logscale {}", a)).line(fmt::format("set format {} '%.6g'", a));
    return;
  }
  out.line(fmt::format("set logscale {}", a));
  const bool plain = low >= 1e-4 && high <= 1e5;  // easier to read than powers of ten
  out.line(fmt::format("set format {} '{}'", a, plain ? "%g" : "10^{%T}"));
  if (a == 'x' && high / low > 1e8) out.line("set xtics 100");  // in a narrow map every decade is too close
  if (high / low >= 30) return;
  std::string ticks;  // a decade or less: 1, 2 and 5 of each
  for (int d = static_cast<int>(std::floor(std::log10(low))); d <= std::ceil(std::log10(high)); ++d)
    for (int n : {1, 2, 5}) ticks += fmt::format("{}{}e{}", ticks.empty() ? "" : ", ", n, d);
  out.line(fmt::format("set format {0} '%g'\nset {0}tics ({1})", a, ticks));
}

void notes(Script& out, const std::vector<Note>& all) {
  out.line("unset label");
  for (const Note& n : all) {
    if (!std::isfinite(n.x) || !std::isfinite(n.y)) continue;
    out.line(fmt::format(
        "set label {} at first {},{} noenhanced front textcolor rgb '#222222' point pt 7 ps 0.5 offset 0.8,0.5",
        quoted_text(n.text), n.x, n.y));
  }
}

void series_data(Script& out, const std::string& name, const Series& s) {
  out.begin_data(name);
  for (const std::size_t i : thinned(s)) {
    const double row[] = {s.x[i], s.y[i]};
    const bool shown = std::isfinite(s.x[i]) && std::isfinite(s.y[i]);
    out.row(std::span(row, shown ? 2 : 0));
  }
  out.end_data();
}

std::string plot_clause(const std::string& name, const Series& s, std::size_t n) {
  constexpr std::array<int, 7> kMarks{7, 5, 9, 13, 6, 4, 8};
  const std::string tint = color_or(s.color, n, "series \"" + s.label + "\"");
  const std::string legend = s.label.empty() ? "notitle" : "title " + quoted_text(s.label);
  const int dash = s.style == SeriesStyle::dashes ? 2 : n < kColors.size() ? 1 : 4;
  const std::string line = fmt::format("lc rgb '{}' lw 1.8 dt {}", tint, dash);
  const std::string mark = fmt::format("pt {}", kMarks[n % kMarks.size()]);
  std::string how = "lines " + line;
  if (s.style == SeriesStyle::points) how = fmt::format("points {} lc rgb '{}'", mark, tint);
  if (s.style == SeriesStyle::band) how = fmt::format("lines lc rgb '{}' lw 7 dt 1", tint);
  if (s.style == SeriesStyle::crosses) how = fmt::format("points pt 2 ps 0.8 lw 1.8 lc rgb '{}'", tint);
  if (s.style == SeriesStyle::rings) how = fmt::format("points pt 6 ps 0.9 lw 1.2 lc rgb '{}'", tint);
  if (s.style == SeriesStyle::linespoints) how = fmt::format("linespoints {} {}", mark, line);
  return fmt::format("${} using 1:2 with {} {}", name, how, legend);
}

std::string block_name(std::size_t panel, std::size_t series) { return fmt::format("p{}s{}", panel, series); }

void plot(Script& out, const std::vector<std::string>& clauses) {
  out.line(fmt::format("plot {}", fmt::join(clauses, ", \\\n     ")));
}

void ranges(Script& out, const Range& x, const Range& y) {
  out.line(fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]", x.first, x.second, y.first, y.second));
}

void margins(Script& out, double left, double right, double top, double bottom) {
  out.line(fmt::format("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}", left, right));
  out.line(fmt::format("set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}", top, bottom));
}

std::size_t legend_columns(double width, double letters, double letter_width) {
  constexpr double kSample = 70;  // pixels of the line in front of a label
  return static_cast<std::size_t>(std::clamp(width / (letter_width * letters + kSample), 1.0, 20.0));
}

void check(const Series& s, const std::string& chart) {
  if (s.x.size() != s.y.size())
    throw ModelError(fmt::format("chart \"{}\": series \"{}\" has {} x and {} y; give both the same number", chart,
                                 s.label, s.x.size(), s.y.size()));
}

void Extent::take(std::span<const double> values, bool log) {
  for (double v : values) {
    if (!std::isfinite(v) || (log && v <= 0)) continue;
    low = any ? std::min(low, v) : v;
    high = any ? std::max(high, v) : v;
    any = true;
  }
}

Extent extent_of(const std::vector<Series>& all, std::vector<double> Series::*part, bool log) {
  Extent e{};
  for (const Series& s : all) e.take(s.*part, log);
  return e;
}

void check_panel(const std::vector<Series>& series, bool log_x, bool log_y, const std::string& chart,
                 const std::string& panel, const std::string& advice) {
  for (const Series& s : series) check(s, chart);
  if (!extent_of(series, &Series::x, log_x).any || !extent_of(series, &Series::y, log_y).any)
    throw ModelError(fmt::format("chart \"{}\": panel \"{}\" has nothing to draw; give it {}", chart, panel, advice));
}

}  // namespace lockstep::chart_style
