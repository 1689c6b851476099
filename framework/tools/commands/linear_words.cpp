// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/linear_words.h"

#include <lockstep/equilibrium.h>
#include "framework/mechanism/params/read.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/findings.h"

namespace lockstep {
namespace {

// "1,0,0": three numbers with commas.
Vec3 read_spin(const std::string& text) {
  const std::vector<std::string> parts = split_at(',', text);
  Vec3 x;
  for (int k = 0; k < 3; ++k) {
    const std::optional<double> number = parts.size() == 3 ? number_in<double>(parts[k]) : std::nullopt;
    if (!number || !std::isfinite(*number))
      throw UsageError("--spin: \"" + text + "\" is not a vector; write three finite numbers, as in --spin 0,0,8");
    x[k] = *number;
  }
  return x;
}

}  // namespace

Options motion_command_options() {
  return join(
      {scene_options(),
       {kAt,
        kJson,
        {"--spin", "X,Y,Z", "angular velocity of the axes of a steady rotation, rad/s; default: found from the state"},
        Option{"--equilibrium", "", "start from the static equilibrium, as `lockstep statics` finds it"}.without(
            "--spin"),
        {"--frozen", "", "use the coefficients of a state that is neither an equilibrium nor steady"}}});
}

LinearMotionOptions motion_options(const Arguments& args) {
  LinearMotionOptions options;
  if (!args["--spin"].empty()) options.spin = read_spin(args["--spin"]);
  options.frozen = args.has("--frozen");
  return options;
}

MechanismAt motion_state(std::unique_ptr<Mechanism> mechanism, const Registry& registry, const Arguments& args) {
  MechanismAt at = state_at(std::move(mechanism), registry, instant_of(args));
  if (args.has("--equilibrium"))
    CommandFindings::add(find_equilibrium(*at.dynamics, at.state, {.friction = false}).notes);
  return at;
}

}  // namespace lockstep
