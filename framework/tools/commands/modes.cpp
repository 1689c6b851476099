// SPDX-License-Identifier: BSD-3-Clause
// The command modes: frequencies, damping ratios and shapes.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <lockstep/modes.h>
#include <lockstep/text.h>
#include "framework/tools/commands/linear_words.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/report/modes_page.h"
#include "framework/tools/report/page.h"

namespace lockstep {
namespace {

const char* word(Mode::Kind kind) {
  constexpr const char* kWords[] = {"rigid", "oscillation", "decay", "growth"};
  return kWords[static_cast<std::size_t>(kind)];
}

// "undamped", "unstable", ...
std::string stability_of(const Mode& m) {
  if (m.kind == Mode::Kind::rigid) return "no restoring force";
  if (m.is_marginal()) return m.kind == Mode::Kind::oscillation ? "undamped" : "zero within its error";
  if (m.value.real() > 0) return "UNSTABLE";
  return m.kind == Mode::Kind::decay ? "aperiodic" : "damped";
}

// An amplitude: with its phase if it is not in phase with the largest.
std::string amplitude(std::complex<double> z, const char* unit) {
  if (std::abs(z.imag()) <= 1e-6 * std::abs(z)) return fmt::format("{:.3g} {}", z.real(), unit);
  return fmt::format("{:.3g} {} at {:.0f} deg", std::abs(z), unit, std::arg(z) * 180 / kPi);
}

constexpr double kShown = 1e-3;  // of the largest amplitude

// "'rod' rotates 1 rad about z, moves -0.5 m along x": the three bodies that move most.
std::vector<std::string> shape_words(const Mode& mode, double length) {
  constexpr std::size_t kMost = 3;
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
          words.push_back(turn ? fmt::format("rotates {} about {}", amplitude(z, "rad"), "xyz"[k])
                               : fmt::format("moves {} along {}", amplitude(z, "m"), "xyz"[k]));
      }
    if (!words.empty()) parts.push_back({size, "'" + of.body + "' " + text::join(words, ", ")});
  }
  std::ranges::stable_sort(parts, std::greater{}, &Part::size);
  std::vector<std::string> out;
  for (std::size_t k = 0; k < std::min(parts.size(), kMost); ++k) out.push_back(parts[k].words);
  if (parts.size() > kMost) out.push_back(fmt::format("{} more", parts.size() - kMost));
  return out;
}

// A line for each mode, with its shape.
std::string csv_text(const Modes& found) {
  std::vector<std::vector<std::string>> lines{
      {"mode", "kind", "frequency [Hz]", "omega [rad/s]", "damping", "re [1/s]", "im [1/s]", "bound [1/s]"}};
  if (!found.modes.empty())
    for (const BodyShape& of : found.modes.front().shape)
      for (const char* name : {"x", "y", "z", "turn_x", "turn_y", "turn_z"})
        for (const char* part : {"re", "im"})
          lines[0].push_back(fmt::format("{}.{}.{} [{}]", of.body, name, part, name[0] == 't' ? "rad" : "m"));
  for (const Mode& m : found.modes) {
    std::vector<double> numbers{m.frequency(), m.omega(), m.damping(), m.value.real(), m.value.imag(), m.bound};
    for (const BodyShape& of : m.shape)
      for (const Eigen::Vector3cd& part : {of.move, of.turn})
        for (const std::complex<double> z : part) numbers.insert(numbers.end(), {z.real(), z.imag()});
    std::vector<std::string>& line = lines.emplace_back();
    line = {std::to_string(lines.size() - 1), word(m.kind)};
    for (const double x : numbers) line.push_back(text::number(x));
  }
  return csv_of(lines);
}

struct FoundModes {
  StateFound state;
  Modes found;
};

struct NumberedMode {
  std::size_t number;
  Mode mode;
  double length;  // of the mechanism
};
const Fields<BodyShape> kShapeFields{
    {"body", "", "", &BodyShape::body}, {"move", "m", "", &BodyShape::move}, {"turn", "rad", "", &BodyShape::turn}};
const Fields<NumberedMode> kModeFields{
    {"mode", "", "mode", &NumberedMode::number},
    {"kind", "", "kind", [](const NumberedMode& m) { return word(m.mode.kind); }},
    {"frequency", "Hz", "frequency [Hz]", [](const NumberedMode& m) { return m.mode.frequency(); }, unless_zero},
    {"omega", "rad/s", "omega [rad/s]", [](const NumberedMode& m) { return m.mode.omega(); }, unless_zero},
    {"damping", "", "damping ratio", [](const NumberedMode& m) { return m.mode.is_marginal() ? 0 : m.mode.damping(); },
     [](const Json& d) { return std::abs(d.get<double>()) < 1 ? number_text(d) : ""; }},
    {"decay_rate", "1/s", "decay rate",
     [](const NumberedMode& m) { return m.mode.is_marginal() ? 0 : -m.mode.value.real(); }},
    {"eigenvalue", "1/s", "", [](const NumberedMode& m) { return m.mode.value; }},
    {"bound", "1/s", "", [](const NumberedMode& m) { return m.mode.bound; }},
    {"stability", "", "stability", [](const NumberedMode& m) { return stability_of(m.mode); }},
    {"moves", "", "shape", [](const NumberedMode& m) { return shape_words(m.mode, m.length); }},
    {"shape", "", [](const NumberedMode& m) { return m.mode.shape; }, kShapeFields}};
const Fields<Modes> kModesFields{{"modes", "modes",
                                  [](const Modes& m) {
                                    std::vector<NumberedMode> all;
                                    for (const Mode& each : m.modes) all.push_back({all.size() + 1, each, m.length});
                                    return all;
                                  },
                                  kModeFields},
                                 {"length", "m", "1 rad counts as", &Modes::length},
                                 {"freedoms", "", "remaining degrees of freedom", &Modes::freedoms},
                                 {"zeros", "", "zero eigenvalues", &Modes::zeros},
                                 {"zero_bound", "1/s", "  zero below", &Modes::zero_bound},
                                 {"complete", "", "all modes", &Modes::complete}};
const Fields<FoundModes> kFoundModesFields =
    Fields<FoundModes>{}.with(&FoundModes::found, kModesFields).with(&FoundModes::state, kStateFields);

// A line of the list: "3: 12.5 Hz", "1: rigid".
std::string title_of(const Mode& mode, std::size_t number) {
  if (mode.kind == Mode::Kind::oscillation) return fmt::format("{}: {:.5g} Hz", number, mode.frequency());
  return fmt::format("{}: {}", number, word(mode.kind));
}

std::string sentence_of(const Mode& mode) {
  if (mode.kind == Mode::Kind::rigid) return "rigid-body mode: " + stability_of(mode);
  if (mode.kind != Mode::Kind::oscillation)
    return fmt::format("{}: no oscillation, proportional to exp({:.6g} 1/s t)", stability_of(mode), mode.value.real());
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
  text.facts.emplace_back("remaining degrees of freedom", std::to_string(found.freedoms));
  if (found.modes.size() > kMost)
    text.facts.emplace_back("modes", fmt::format("the first {} of {}", kMost, found.modes.size()));
  for (const Finding& note : found.notes) text.facts.emplace_back("", note.text());
  std::vector<report::ShownMode> modes;
  for (std::size_t k = 0; k < std::min(found.modes.size(), kMost); ++k) modes.push_back(shown(found.modes[k], k + 1));
  const Sample rest(*at.dynamics, at.state, StepReport{});
  report::write_whole(file, report::modes_page(text, rest, *at.mechanism, modes, found.length));
}

Result analyse_modes(const Arguments& args) {
  const Loaded loaded = load(args);
  ModesOptions options;
  if (!args["--count"].empty())
    options.count = whole_number("--count", args["--count"], std::numeric_limits<int>::max(),
                                 "is not a number of modes; give a whole number from 1, as in --count 10");
  options.motion = motion_options(args);
  if (!args["--csv"].empty()) check_overwrites(args["--csv"], loaded.scene);
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], args["--csv"], loaded.scene);
  const MechanismAt at =
      motion_state(std::make_unique<Mechanism>(build_mechanism(loaded.scene, loaded.registry)), loaded.registry, args);
  const Modes found = with_advice(kAdvice, [&] { return find_modes(*at.dynamics, at.state, options); });
  CommandFindings::add(found.notes);
  Result result(loaded, kFoundModesFields, FoundModes{{at.state.t, found.spin, found.unrest}, found});
  if (!args["--csv"].empty()) result.write(args["--csv"], csv_text(found));
  if (!report.empty()) write_modes_report(report, args, loaded, at, found), result.files.push_back(report);
  return result;
}

}  // namespace

Command modes_command() {
  return {
      "modes",
      join({motion_command_options(),
            {{"--count", "N", "number of lowest modes; default: all for up to 1200 unknown velocities, otherwise 20"},
             {"--csv", "FILE.csv", "one row per mode, with its shape"},
             {"--report", "FILE.html", "one HTML file that animates each mode"}}}),
      analyse_modes,
      R"(The state must be an equilibrium (--equilibrium finds one) or a steady rotation. Modes are in space, also
of a planar motion, unless the key "planar" or --planar gives a plane. The largest rotation of a shape is 1 rad, or its
largest translation the length that counts as 1 rad. The pendulum of the example hangs: gravity is along its arm.

Example:
  lockstep modes samples/scenes/pendulum.json --set gravity.0=9.81 --set gravity.1=0)",
      {&kFoundModesFields.schema()}};
}

}  // namespace lockstep
