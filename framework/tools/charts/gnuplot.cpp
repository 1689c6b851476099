// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/charts/gnuplot.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/at_end.h"
#include "framework/foundation/support/child.h"
#include "framework/foundation/support/lines.h"

namespace lockstep {
namespace {
namespace fs = std::filesystem;

// A new folder for the script and for gnuplot's output.
fs::path temporary_folder() {
  std::string name = (fs::temp_directory_path() / "lockstep-chart-XXXXXX").string();
  if (!mkdtemp(name.data()))
    throw FileError(
        fmt::format("cannot create the folder \"{}\" for the script of a chart: {}; set TMPDIR to a writable folder",
                    name, std::strerror(errno)));
  return name;
}

std::string base_of(const std::string& path) {
  for (const char* ending : {".svg", ".png"})
    if (path.size() > 4 && path.ends_with(ending)) return path.substr(0, path.size() - 4);
  return path;
}

// gnuplot writes to file names that we choose: it would interpret a user's ("| command", quotes).
std::string head(const char* file, const std::string& terminal) {
  return fmt::format("set terminal {} enhanced background '#ffffff' linewidth 1.2\nset output '{}'\n", terminal, file);
}

void hand_over(const std::string& made, const std::string& file, const std::string& said) {
  std::error_code error;
  if (const auto size = fs::file_size(made, error); error || size == 0)
    throw FileError(fmt::format("gnuplot drew nothing for \"{}\"; its message: {}", file, said));
  fs::copy_file(made, file, fs::copy_options::overwrite_existing, error);
  if (error)
    throw FileError(
        fmt::format("cannot write \"{}\": {}; check the folder and the free space, or give another file name", file,
                    error.message()));
}

}  // namespace

std::string find_gnuplot() {
  const char* const path = std::getenv("PATH");
  for (const std::string& folder : lines_of(path ? path : "", ':')) {
    if (folder.empty()) continue;
    const std::string file = folder + "/gnuplot";
    std::error_code none;
    if (fs::is_regular_file(file, none) && access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

Script& Script::line(std::string_view commands) {
  text_ += commands;
  text_ += '\n';
  return *this;
}
Script& Script::begin_data(std::string_view name) { return line(fmt::format("${} << END_OF_DATA", name)); }
Script& Script::row(std::span<const double> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) text_ += ' ';
    text_ += std::isfinite(numbers[i]) ? text::number(numbers[i]) : "NaN";
  }
  text_ += '\n';
  return *this;
}
Script& Script::end_data() { return line("END_OF_DATA"); }

std::string quoted_text(std::string_view text) {
  std::string all = "'";
  for (char c : text) {
    if (c == '\'')
      all += "\u2019";
    else
      all += static_cast<unsigned char>(c) < 32 ? ' ' : c;
  }
  return all + "'";
}

void draw(const Script& script, const std::string& path, int width, int height) {
  const std::string program = find_gnuplot();
  if (program.empty())
    throw FileError(
        fmt::format("cannot draw \"{}\": gnuplot is not in PATH; install it with: apt-get install gnuplot-nox", path));
  const std::string base = base_of(path);
  if (base.empty()) throw FileError(fmt::format("cannot write a chart to \"{}\": give a file name", path));
  const fs::path folder = temporary_folder();
  const AtEnd removed([&] {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  });
  const std::string commands = folder / "chart.gp";
  {
    std::ofstream out(commands, std::ios::binary);
    out << head("chart.png", fmt::format("pngcairo size {},{} font 'sans,12'", width, height)) << script.text()
        << "set output\nreset\n"
        << head("chart.svg", fmt::format("svg size {},{} font 'sans-serif,15'", width, height)) << script.text()
        << "set output\n";
    if (!out.flush())
      throw FileError(fmt::format("cannot write \"{}\"; set TMPDIR to a folder with free space", commands));
  }
  const auto [status, said] = run_child({program, "-d", "chart.gp"}, folder, true);
  if (status != 0) throw FileError(fmt::format("gnuplot could not draw \"{}\"; its message: {}", path, said));
  hand_over(folder / "chart.svg", base + ".svg", said);
  hand_over(folder / "chart.png", base + ".png", said);
}

}  // namespace lockstep
