#include "framework/tools/program/files.h"

#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include <lockstep/charts.h>
#include <lockstep/error.h>
#include "framework/foundation/support/thrown.h"
#include "framework/tools/charts/gnuplot.h"
#include "framework/tools/program/commands.h"

extern char** environ;

namespace lockstep {

namespace fs = std::filesystem;

std::string csv_path(const std::string& record, const std::string& scene) {
  const char* folder = std::getenv("LOCKSTEP_OUTPUT");
  fs::path file = record;
  if (record.empty()) {
    file = fs::path(folder != nullptr && *folder != 0 ? folder : ".") / fs::path(scene).stem();
    file += ".csv";
  }
  std::error_code error;
  if (!file.parent_path().empty()) fs::create_directories(file.parent_path(), error);
  if (error)
    throw FileError("folder '" + file.parent_path().string() + "' cannot be made: " + error.message() +
                    "; name another");
  return file.lexically_normal().string();
}

void check_writable(const std::string& file) {
  std::error_code error;
  const bool there = fs::exists(file, error);
  const std::ofstream out(file, std::ios::app);
  if (!out) throw FileError("file '" + file + "' cannot be written; check the folder, or name another");
  if (!there) fs::remove(file, error);
}

namespace {

// Calls visit(text) for every text in a value.
template <class Visit>
void for_each_text(const Value& value, Visit&& visit) {
  if (const std::string* text = value.text()) visit(*text);
  if (const Value::List* list = value.list())
    for (const Value& item : *list) for_each_text(item, visit);
  if (const Value::Object* object = value.object())
    for (const auto& member : *object) for_each_text(member.value, visit);
}

}  // namespace

void check_overwrites(const std::string& csv, const Scene& scene) {
  std::error_code error;
  const fs::path base = fs::path(csv).replace_extension();
  const auto refuse_if_output = [&](const fs::path& input) {
    if (!fs::is_regular_file(input, error)) return;
    for (const fs::path& output : {fs::path(csv), fs::path(csv + ".partial"), fs::path(base.string() + ".svg"),
                                   fs::path(base.string() + ".png")})
      if (fs::exists(output, error) && fs::equivalent(input, output, error))
        throw UsageError("the results would replace '" + output.string() +
                         "', from which the scene is read; name another file (--record results.csv)");
  };
  refuse_if_output(scene.file);
  for (const Value* root : {&scene.root, &scene.written})
    for_each_text(*root, [&](const std::string& text) {
      if (!text.empty() && text.size() < 4096) refuse_if_output(fs::path(scene.file).parent_path() / text);
    });
}

namespace {

// Calls visit(value, file, its name as written) for every file that a scene is read from: those that it includes, and values of
// keys "file", which are named from where they stand.
template <class Visit>
void for_each_file(const Value& value, Visit&& visit) {
  const fs::path own = value.where.file ? fs::path(*value.where.file) : fs::path();
  visit(value, own, own.string());
  if (const Value::List* list = value.list())
    for (const Value& item : *list) for_each_file(item, visit);
  if (const Value::Object* object = value.object())
    for (const auto& member : *object) {
      if (const std::string* name = member.value.text(); name != nullptr && member.key == "file")
        visit(member.value, own.parent_path() / *name, *name);
      for_each_file(member.value, visit);
    }
}

}  // namespace

void check_files(const Scene& scene) {
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(fs::absolute(scene.file).parent_path(), error);
  fs::path last = scene.file;
  for_each_file(scene.root, [&](const Value& value, const fs::path& named, const std::string& written) {
    if (named.empty() || named == last) return;
    last = named;
    const fs::path file = fs::weakly_canonical(named, error);
    const auto [end, in_file] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    if (end == folder.end()) return;
    throw UsageError(value.where.text() + ": the file \"" + written +
                     "\" is outside of the scene's folder; put it there, or allow it with --allow-files");
  });
}

namespace {

// One panel per unit, as many columns as a picture can hold.
std::vector<Panel> panels_by_unit(const Table& table) {
  constexpr std::size_t kMostPanels = 4, kMostCurves = 6;
  std::vector<Panel> panels;
  const std::vector<Column>& columns = table.columns();
  for (std::size_t k = 1; k < columns.size(); ++k) {
    const std::string label = columns[k].unit.empty() ? "1" : columns[k].unit;
    auto panel = std::find_if(panels.begin(), panels.end(), [&](const Panel& p) { return p.y_label == label; });
    if (panel == panels.end()) {
      if (panels.size() == kMostPanels) continue;
      panel = panels.insert(panel, {label, {}});
    }
    if (panel->series.size() < kMostCurves)
      panel->series.push_back(table_series(table, columns.front().name, columns[k].name, columns[k].name));
  }
  return panels;
}

std::vector<Panel> panels_of(const Table& table, const std::vector<std::vector<std::string>>& draw) {
  std::vector<Panel> panels;
  for (const std::vector<std::string>& names : draw) {
    Panel& panel = panels.emplace_back(Panel{table.column(names.front()).unit, {}});
    for (const std::string& name : names)
      panel.series.push_back(table_series(table, table.columns().front().name, name, name));
  }
  return panels;
}

}  // namespace

std::string report_path(const std::string& report, const std::string& csv, const Scene& scene) {
  const fs::path file = fs::path(report).lexically_normal();
  std::error_code error;
  if (!file.parent_path().empty()) fs::create_directories(file.parent_path(), error);
  if (error)
    throw FileError("folder '" + file.parent_path().string() + "' cannot be made: " + error.message() +
                    "; name another");
  const fs::path base = fs::path(csv).replace_extension();
  for (const fs::path& taken : {fs::path(csv), fs::path(base.string() + ".svg"), fs::path(base.string() + ".png")})
    if (file == taken.lexically_normal())
      throw UsageError("the report would replace '" + taken.string() + "', another result; name it " +
                       fs::path(file).replace_extension(".html").string());
  const auto refuse_if_input = [&](const fs::path& input) {
    std::error_code none;
    if (fs::is_regular_file(input, none) && fs::exists(file, none) && fs::equivalent(input, file, none))
      throw UsageError("the report would replace '" + file.string() +
                       "', from which the scene is read; name another file");
  };
  refuse_if_input(scene.file);
  for_each_text(scene.root, [&](const std::string& text) {
    if (!text.empty() && text.size() < 4096) refuse_if_input(fs::path(scene.file).parent_path() / text);
  });
  check_writable(file.string());
  return file.string();
}

std::string open_in_browser(const std::string& file) {
  std::string program = "xdg-open", path = fs::absolute(file).string();
  char* const words[] = {program.data(), path.data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, program.c_str(), nullptr, nullptr, words, environ);
  if (failed == ENOENT) return "xdg-open is not installed (apt install xdg-utils); open the file with a browser";
  if (failed != 0) return std::string("xdg-open cannot be started: ") + std::strerror(failed);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "" : "xdg-open found no browser; open the file with one";
}

Drawing draw_columns(const std::string& csv, const std::string& title, const Table& table,
                     const std::vector<std::vector<std::string>>& draw) {
  Drawing drawing;
  if (std::error_code none; !fs::is_regular_file(csv, none))
    drawing.reason = "nothing to draw beside '" + csv + "', which is no file";
  if (table.n_columns() < 2) drawing.reason = "nothing to draw: no column beside the time is recorded";
  if (table.n_rows() < 2) drawing.reason = "nothing to draw: a curve needs two rows";
  if (drawing.reason.empty() && find_gnuplot().empty())
    drawing.reason = "gnuplot is not installed (apt install gnuplot-nox)";
  if (!drawing.reason.empty()) return drawing;
  try {
    const ChartSpec chart{title, "t [s]", draw.empty() ? panels_by_unit(table) : panels_of(table, draw)};
    std::set<std::string> names;
    for (const Panel& panel : chart.panels)
      for (const Series& series : panel.series) names.insert(series.label);
    const std::string base = fs::path(csv).replace_extension().string();
    write_chart(base, chart);
    drawing.files = {base + ".svg", base + ".png"};
    drawing.n_drawn = names.size();
  } catch (const std::exception& error) {
    drawing.reason = what_of(error);
    drawing.failed = true;
  }
  return drawing;
}

}  // namespace lockstep
