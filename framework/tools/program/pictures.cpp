// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/pictures.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>

#include <lockstep/charts.h>
#include <lockstep/text.h>
#include "framework/foundation/support/thrown.h"
#include "framework/tools/charts/chart_path.h"
#include "framework/tools/charts/gnuplot.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;

// "X:Y" of the command line, columns that are recorded.
PictureRequest picture_of(const std::string& text, const Table& columns) {
  for (std::size_t colon = text.find(':'); colon != std::string::npos; colon = text.find(':', colon + 1)) {
    const PictureRequest picture{text.substr(0, colon), text.substr(colon + 1)};
    if (columns.has(picture.x) && columns.has(picture.y)) return picture;
  }
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos)
    throw UsageError("--picture " + text + ": expected X:Y, two recorded columns, as in --picture crank.x:crank.y");
  for (const std::string& name : {text.substr(0, colon), text.substr(colon + 1)})
    if (!columns.has(name))
      throw UsageError("--picture " + text + ": \"" + name + "\" is not recorded" +
                       text::suggestion(name, columns.names()));
  return {};
}

// One panel per unit of these columns, in the order in which they come.
std::vector<Panel> panels_by_unit(const Table& table, const std::vector<std::string>& names,
                                  std::size_t most_panels = SIZE_MAX, std::size_t most_curves = SIZE_MAX) {
  std::vector<Panel> panels;
  for (const std::string& name : names) {
    const std::string& unit = table.column(name).unit;
    const std::string label = unit.empty() ? "1" : unit;
    auto panel = std::find_if(panels.begin(), panels.end(), [&](const Panel& p) { return p.y_label == label; });
    if (panel == panels.end()) {
      if (panels.size() == most_panels) continue;
      panel = panels.insert(panel, {label, {}});
    }
    if (panel->series.size() < most_curves)
      panel->series.push_back(table_series(table, table.columns().front().name, name, name));
  }
  return panels;
}

// The requested panels, each split by unit; without any, as many columns as a picture can hold.
std::vector<Panel> panels_of(const Table& table, const Panels& draw) {
  constexpr std::size_t kMostPanels = 4, kMostCurves = 6;
  const std::vector<std::string> names = table.names();
  if (draw.empty()) return panels_by_unit(table, {names.begin() + 1, names.end()}, kMostPanels, kMostCurves);
  std::vector<Panel> panels;
  for (const std::vector<std::string>& panel : draw)
    for (Panel& of_unit : panels_by_unit(table, panel)) panels.push_back(std::move(of_unit));
  return panels;
}

std::set<std::string> names_in(const std::vector<Panel>& panels) {
  std::set<std::string> names;
  for (const Panel& panel : panels)
    for (const Series& series : panel.series) names.insert(series.label);
  return names;
}

// One column against another, in the order of time.
void draw_path(const std::string& base, const std::string& title, const Table& table, const PictureRequest& picture) {
  const Column &x = table.column(picture.x), &y = table.column(picture.y);
  write_path(base, {.title = title,
                    .x_label = column_title(x),
                    .y_label = column_title(y),
                    .x = x.values,
                    .y = y.values,
                    .equal_scales = x.unit == y.unit && x.unit == "m"});
}

// Why a table is not drawn; "" if it is.
std::string why_not(const std::string& csv, const Table& table) {
  std::error_code none;
  if (table.n_rows() < 2) return "nothing to draw: a curve needs two rows";
  if (table.n_columns() < 2) return "nothing to draw: no column except the time is recorded";
  if (!fs::is_regular_file(csv, none)) return "'" + csv + "' is not a regular file";
  return find_gnuplot().empty() ? "gnuplot is not installed (apt install gnuplot-nox)" : "";
}

}  // namespace

RunOutputs checked_outputs(const Loaded& loaded, const Arguments& args, const Table& columns, const std::string& csv) {
  RunOutputs out = outputs_of(loaded.scene);
  if (!args["--headers"].empty()) out.units = args["--headers"] == "units";
  for (const std::string& text : args.all("--picture")) {
    const PictureRequest picture = picture_of(text, columns);
    const auto is_same = [&](const PictureRequest& p) { return p.x == picture.x && p.y == picture.y; };
    if (std::ranges::none_of(out.pictures, is_same)) out.pictures.push_back(picture);
  }
  check_overwrites(csv, loaded.scene, out.pictures);
  return out;
}

std::set<std::string> drawn_columns(const Table& columns, const Panels& draw,
                                    const std::vector<PictureRequest>& pictures) {
  std::set<std::string> names = names_in(panels_of(columns, draw));
  for (const PictureRequest& picture : pictures) names.insert({picture.x, picture.y});
  return names;
}

std::unique_ptr<PictureRows> picture_rows(Mechanism& m, const std::string& csv, const Recorder& rows,
                                          const RunOutputs& outputs, const Arguments& args) {
  std::error_code error;
  const bool can_draw = !args["--checkpoint"].empty() || !find_gnuplot().empty();
  const bool draws = !args.has("--no-picture") && csv != "-" && !m.run.record.empty() && can_draw &&
                     (!std::filesystem::exists(csv, error) || std::filesystem::is_regular_file(csv, error));
  if (!draws) return nullptr;
  const std::set<std::string> drawn = drawn_columns(rows.table(), m.run.draw, outputs.pictures);
  return std::make_unique<PictureRows>(make_recorder(m, &drawn), rows,
                                       picture_spacing(loop_options(m.run), m.run.until));
}

bool draw_run(const Arguments& args, const std::string& csv, const std::string& title, const RowEnvelope& rows,
              const PictureRows* details, const RunSettings& run, const RunOutputs& outputs,
              std::vector<std::string>& files, std::vector<std::string>& notes) {
  if (args.has("--no-picture") || csv == "-") return true;
  if (rows.n_rows() <= 1) details = nullptr;
  const auto with_details = [&](const Table& own) { return details != nullptr ? details->together(own) : own; };
  std::vector<Panel> panels;
  try {
    const Table table = with_details(rows.table());
    if (const std::string why = why_not(csv, table); !why.empty()) {
      notes.push_back("no picture: " + why);
      return true;
    }
    panels = panels_of(table, run.draw);
    const std::string base = fs::path(csv).replace_extension().string();
    write_chart(base, {title, column_title(table.columns().front()), panels});
    files.insert(files.end(), {base + ".svg", base + ".png"});
    const Table paths = outputs.pictures.empty() ? Table() : with_details(rows.path_table());
    for (const PictureRequest& picture : outputs.pictures) {
      const std::string own = picture_base(csv, picture);
      draw_path(own, title, paths, picture);
      files.insert(files.end(), {own + ".svg", own + ".png"});
    }
  } catch (const std::exception& error) {
    notes.push_back("no picture: " + what_of(error));
    return false;
  }
  if (details != nullptr && details->joins_steps())
    notes.push_back("curves connect the ends of steps: " + run.integrator.type + " has no dense output");
  if (!outputs.pictures.empty() && rows.path_every() > 1)
    notes.push_back(fmt::format("the pictures of paths connect one row in {}", rows.path_every()));
  const std::size_t n = rows.n_rows() > 0 ? rows.n_columns() - 1 : 0, n_drawn = names_in(panels).size();
  if (run.draw.empty() && n_drawn < n)
    notes.push_back(fmt::format("drawn: {} of {} columns, at most six per panel; choose with run.draw", n_drawn, n));
  return true;
}

void draw_told(const Arguments& args, const std::string& csv, const std::string& title, const RowEnvelope& rows,
               const PictureRows* details, const RunSettings& run, const RunOutputs& outputs,
               std::vector<std::string>& files) {
  std::vector<std::string> notes;
  if (!draw_run(args, csv, title, rows, details, run, outputs, files, notes) || !args.has("--quiet"))
    for (const std::string& note : notes) tell(fmt::format("note: {}\n", note));
}

}  // namespace lockstep
