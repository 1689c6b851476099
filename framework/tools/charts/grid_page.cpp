// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/charts/grid_page.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/tools/charts/chart_style.h"

namespace lockstep {
namespace {

constexpr double kBelowTitle = 14, kLegendRow = 23, kRemark = 19, kRightOfAll = 24, kAboveRemarks = 22;  // pixels

}  // namespace

GridPage::GridPage(const std::string& title, const std::vector<std::string>& remarks, std::size_t n_plots,
                   std::size_t n_columns, std::size_t n_legend_rows, int width, int cell_height, const Edges& edges)
    : title_(title), remarks_(remarks), edges_(edges), width_(width), cell_height_(cell_height) {
  n_columns_ = std::clamp<std::size_t>(n_columns, 1, n_plots);
  const auto n = static_cast<double>(n_columns_), n_rows = std::ceil(static_cast<double>(n_plots) / n);
  legend_ = kBelowTitle + chart_style::title_height(title);
  top_ = legend_ + kLegendRow * static_cast<double>(n_legend_rows);
  plot_width_ = (inner_width(width, edges) - edges.between * (n - 1)) / n;
  height_ = top_ + cell_height * n_rows +
            (remarks.empty() ? 0 : kRemark * static_cast<double>(remarks.size()) + kAboveRemarks);
}

double GridPage::inner_width(int width, const Edges& edges) { return width - edges.left - kRightOfAll; }

// An invisible plot that fills the page, for what is placed by page coordinates.
void GridPage::whole(Script& out) const {
  out.line(
      "unset border\nunset tics\nunset xlabel\nunset ylabel\nunset object\nunset label\nunset logscale\nunset title");
  out.line("set xrange [0:1]\nset yrange [0:1]");
  chart_style::margins(out, 0, 1, 1, 0);
}

void GridPage::begin(Script& out, std::vector<std::string> entries, std::size_t maxcols, double letters) const {
  chart_style::begin_page(out, 1, title_);
  whole(out);
  out.line(fmt::format("set key at screen {:.5f}, screen {:.5f} left top horizontal maxcols {} width {}",
                       edges_.left / width_, 1 - (legend_ - 6) / height_, maxcols, letters));
  entries.insert(entries.begin(), "2 notitle");
  chart_style::plot(out, entries);
  out.line("unset key\nset border 3 lc rgb '#555555' lw 1\nset tics nomirror out textcolor rgb '#333333'");
}

void GridPage::place(Script& out, std::size_t k) const {
  const std::size_t row = k / n_columns_;
  const double left = edges_.left + static_cast<double>(k % n_columns_) * (plot_width_ + edges_.between);
  const double above = top_ + static_cast<double>(row) * cell_height_;
  chart_style::margins(out, left / width_, (left + plot_width_) / width_, 1 - (above + edges_.above) / height_,
                       1 - (above + cell_height_ - edges_.below) / height_);
}

void GridPage::draw_to(const std::string& path, Script& out) const {
  if (!remarks_.empty()) whole(out);
  for (std::size_t i = 0; i < remarks_.size(); ++i)
    out.line(fmt::format(
        "set label {} {} at screen {:.5f}, screen {:.5f} left noenhanced font ',10' textcolor rgb '#444444'", i + 1,
        quoted_text(remarks_[i]), edges_.left / width_,
        (kRemark * static_cast<double>(remarks_.size() - i) - 2) / height_));
  if (!remarks_.empty()) out.line("plot 2 notitle");
  chart_style::draw_page(out, path, static_cast<int>(width_), static_cast<int>(std::lround(height_)));
}

}  // namespace lockstep
