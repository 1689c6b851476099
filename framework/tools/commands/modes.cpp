// SPDX-License-Identifier: BSD-3-Clause
// The verb modes: frequencies, damping ratios and shapes.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include <lockstep/modes.h>
#include <lockstep/text.h>
#include "framework/tools/commands/linear_words.h"
#include "framework/tools/commands/state_at.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/report/modes_page.h"

namespace lockstep {
namespace {

const char* word(Mode::Kind kind) {
  switch (kind) {
    case Mode::Kind::rigid:
      return "rigid";
    case Mode::Kind::oscillation:
      return "oscillation";
    case Mode::Kind::decay:
      return "decay";
    case Mode::Kind::growth:
      return "growth";
  }
  return "";
}

int count_of(const Arguments& args) {
  if (args["--count"].empty()) return 0;
  int n = 0;
  const auto [end, error] = std::from_chars(args["--count"].data(), args["--count"].data() + args["--count"].size(), n);
  if (error != std::errc() || end != args["--count"].data() + args["--count"].size() || n < 1)
    throw UsageError("--count: \"" + args["--count"] +
                     "\" is no number of modes; give a whole number from 1 on, as in --count 10");
  return n;
}

// "undamped", "unstable", ...
std::string stability_of(const Mode& m) {
  if (m.kind == Mode::Kind::rigid) return "stays where it is put";
  if (m.is_marginal()) return "undamped";
  if (m.value.real() > 0) return "UNSTABLE";
  return m.kind == Mode::Kind::decay ? "overdamped" : "damped";
}

// An amplitude: with its phase where it is not in step with the largest.
std::string amplitude(std::complex<double> z, const char* unit) {
  if (std::abs(z.imag()) <= 1e-6 * std::abs(z)) return fmt::format("{:.3g} {}", z.real(), unit);
  return fmt::format("{:.3g} {} at {:.0f} deg", std::abs(z), unit, std::arg(z) * 180 / kPi);
}

constexpr double kShown = 1e-3;  // of the largest amplitude

// "rod turns 1 about z, moves -0.5 m along x": what moves most, at most `most` bodies.
std::string shape_words(const Mode& mode, double length, std::size_t most) {
  struct Part {
    double size;
    std::string words;
  };
  std::vector<Part> parts;
  for (const BodyShape& of : mode.shape) {
    std::vector<std::string> words;
    double size = 0;
    for (const bool turn : {true, false})
      for (int k = 0; k < 3; ++k) {
        const std::complex<double> z = turn ? of.turn[k] : of.move[k];
        const double share = std::abs(z) / (turn ? 1.0 : length);
        size = std::max(size, share);
        if (share > kShown)
          words.push_back(turn ? fmt::format("turns {} about {}", amplitude(z, "rad"), "xyz"[k])
                               : fmt::format("moves {} along {}", amplitude(z, "m"), "xyz"[k]));
      }
    if (!words.empty()) parts.push_back({size, "'" + of.body + "' " + text::join(words, ", ")});
  }
  std::ranges::stable_sort(parts, std::greater{}, &Part::size);
  std::string out;
  for (std::size_t k = 0; k < std::min(parts.size(), most); ++k) out += "       " + parts[k].words + "\n";
  if (parts.size() > most) out += fmt::format("       and {} more\n", parts.size() - most);
  return out;
}

nlohmann::ordered_json complex_json(const Eigen::Vector3cd& z) {
  auto out = nlohmann::ordered_json::array();
  for (int k = 0; k < 3; ++k) out.push_back({z[k].real(), z[k].imag()});
  return out;
}

nlohmann::ordered_json json_of(const Modes& found) {
  auto all = nlohmann::ordered_json::array();
  for (const Mode& m : found.modes) {
    auto shape = nlohmann::ordered_json::array();
    for (const BodyShape& of : m.shape)
      shape.push_back({{"body", of.body}, {"move", complex_json(of.move)}, {"turn", complex_json(of.turn)}});
    all.push_back({{"kind", word(m.kind)},
                   {"frequency", m.frequency()},
                   {"omega", m.omega()},
                   {"damping", m.damping()},
                   {"eigenvalue", {m.value.real(), m.value.imag()}},
                   {"bound", m.bound},
                   {"stability", stability_of(m)},
                   {"shape", shape}});
  }
  return all;
}

void write_modes(const std::string& file, const Modes& found) {
  GrowingFile out(file);
  std::string header = "mode,kind,frequency [Hz],omega [rad/s],damping,re [1/s],im [1/s],bound [1/s]";
  if (!found.modes.empty())
    for (const BodyShape& of : found.modes.front().shape)
      for (const char* name : {"x", "y", "z", "turn_x", "turn_y", "turn_z"})
        for (const char* part : {"re", "im"})
          header += fmt::format(",{}.{}.{} [{}]", of.body, name, part, name[0] == 't' ? "rad" : "m");
  out.append(header + "\n");
  for (std::size_t k = 0; k < found.modes.size(); ++k) {
    const Mode& m = found.modes[k];
    std::string line = fmt::format("{},{}", k + 1, word(m.kind));
    const auto add = [&line](double x) { line += "," + text::number(x); };
    add(m.frequency()), add(m.omega()), add(m.damping()), add(m.value.real()), add(m.value.imag()), add(m.bound);
    for (const BodyShape& of : m.shape)
      for (const Eigen::Vector3cd& part : {of.move, of.turn})
        for (int c = 0; c < 3; ++c) add(part[c].real()), add(part[c].imag());
    out.append(line + "\n");
  }
  out.write(), out.commit();
}

void print_modes(const Modes& found) {
  fmt::print("  freedoms   {}\n", found.freedoms);
  if (found.modes.empty()) {
    fmt::print("  nothing is free to move: there are no modes\n");
    return;
  }
  const auto rigid = std::ranges::count(found.modes, Mode::Kind::rigid, &Mode::kind);
  if (found.zeros > 0)
    fmt::print(
        "  zeros      {} eigenvalue{} zero (|l| below {:.2g} 1/s is round-off or unrest): {} direction{} in which "
        "nothing pulls back{}\n",
        found.zeros, found.zeros == 1 ? " is" : "s are", found.zero_bound, rigid, rigid == 1 ? "" : "s",
        found.zeros > rigid ? ", in which it can drift" : "");
  fmt::print("\n  {:>4}  {:>14}  {:>14}  {:>12}  {}\n", "mode", "frequency Hz", "omega rad/s", "damping", "");
  constexpr std::size_t kMost = 40;
  for (std::size_t k = 0; k < std::min(found.modes.size(), kMost); ++k) {
    const Mode& m = found.modes[k];
    if (m.kind == Mode::Kind::oscillation)
      fmt::print("  {:>4}  {:>14.8g}  {:>14.8g}  {:>12}  {}\n", k + 1, m.frequency(), m.omega(),
                 m.is_marginal() ? "0" : fmt::format("{:.6g}", m.damping()), stability_of(m));
    else
      fmt::print("  {:>4}  {:>14}  {:>14}  {:>12}  {}{}\n", k + 1, "-", "-", "-", stability_of(m),
                 m.kind == Mode::Kind::rigid ? "" : fmt::format(": exp({:.8g} 1/s t)", m.value.real()));
    fmt::print("{}", shape_words(m, found.length, 3));
  }
  if (found.modes.size() > kMost) fmt::print("  and {} more (--json and --csv have all)\n", found.modes.size() - kMost);
  if (!found.complete) fmt::print("  these are the lowest, not all (--count)\n");
}

// What a line of the list says: "3: 12.5 Hz", "1: rigid".
std::string title_of(const Mode& mode, std::size_t number) {
  if (mode.kind == Mode::Kind::oscillation) return fmt::format("{}: {:.5g} Hz", number, mode.frequency());
  return fmt::format("{}: {}", number, word(mode.kind));
}

std::string sentence_of(const Mode& mode) {
  if (mode.kind == Mode::Kind::rigid) return "nothing pulls back: " + stability_of(mode);
  if (mode.kind != Mode::Kind::oscillation)
    return fmt::format("{}: does not swing, goes with exp({:.6g} 1/s t)", stability_of(mode), mode.value.real());
  return fmt::format("{}, {:.6g} rad/s{}", stability_of(mode), mode.omega(),
                     mode.is_marginal() ? "" : fmt::format(", damping ratio {:.4g}", mode.damping()));
}

report::ShownMode shown(const Mode& mode, std::size_t number) {
  report::ShownMode out{title_of(mode, number), sentence_of(mode)};
  if (mode.kind == Mode::Kind::oscillation) out.frequency = mode.frequency(), out.damping = mode.damping();
  for (const BodyShape& of : mode.shape)
    out.shape.push_back({of.move[0], of.move[1], of.move[2], of.turn[0], of.turn[1], of.turn[2]});
  return out;
}

void write_modes_report(const std::string& file, const Arguments& args, const Loaded& loaded, const MechanismAt& at,
                        const Modes& found) {
  constexpr std::size_t kMost = 200;
  ReportText text = text_of(args, loaded);
  text.facts.emplace_back("state", fmt::format("t = {:.6g} s", at.state.t));
  text.facts.emplace_back("freedoms", std::to_string(found.freedoms));
  if (found.modes.size() > kMost)
    text.facts.emplace_back("modes", fmt::format("the first {} of {}", kMost, found.modes.size()));
  for (const Finding& note : found.notes) text.facts.emplace_back("", note.text());
  std::vector<report::ShownMode> modes;
  for (std::size_t k = 0; k < std::min(found.modes.size(), kMost); ++k) modes.push_back(shown(found.modes[k], k + 1));
  report::write_modes(file, text, Sample(*at.dynamics, at.state, StepReport{}), *at.mechanism, modes, found.length);
}

}  // namespace

int modes_command(const Arguments& args) {
  const Loaded loaded = load(args);
  ModesOptions options;
  options.count = count_of(args);
  options.motion = motion_options(args);
  if (!args["--csv"].empty()) check_overwrites(args["--csv"], loaded.scene);
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], args["--csv"], loaded.scene);
  const MechanismAt at = state_at(loaded, instant_of(args));
  const Modes found = with_words_of_program([&] { return find_modes(*at.dynamics, at.state, options); });
  if (!args["--csv"].empty()) write_modes(args["--csv"], found);
  if (!report.empty()) write_modes_report(report, args, loaded, at, found);
  if (args.has("--json")) {
    nlohmann::ordered_json j = {
        {"scene", loaded.scene.file},     {"t", at.state.t},
        {"freedoms", found.freedoms},     {"zeros", found.zeros},
        {"zero_bound", found.zero_bound}, {"complete", found.complete},
        {"length", found.length},         {"state", state_json(found.spin, found.unrest, found.notes)},
        {"modes", json_of(found)}};
    print_result(j);
    return kExitOk;
  }
  fmt::print("{}\n{}", loaded.title(), state_words(at.state.t, found.spin, found.unrest, found.notes));
  print_modes(found);
  for (const std::string& file : {args["--csv"], report})
    if (!file.empty()) fmt::print("  written    {}\n", file);
  return kExitOk;
}

}  // namespace lockstep
