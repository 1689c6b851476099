// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/linear_words.h"

#include <spdlog/fmt/fmt.h>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/tools/commands/state_at.h"
#include "framework/tools/program/findings.h"

namespace lockstep {

LinearMotionOptions motion_options(const Arguments& args) {
  LinearMotionOptions options;
  if (!args["--spin"].empty()) options.spin = read_vector("--spin", args["--spin"]);
  options.frozen = args.has("--frozen");
  return options;
}

std::string state_words(double t, const Vec3& spin, const Unrest& unrest, const std::vector<Finding>& notes) {
  std::string words = fmt::format("  state      t = {:.6g} s; ", t);
  const bool still = unrest.is_still();
  if (spin.isZero(0))
    words += still ? "at rest" : "neither at rest nor steady";
  else
    words += fmt::format("{} with [{:.6g}, {:.6g}, {:.6g}] rad/s, seen from axes that turn with it",
                         still ? "in steady rotation" : "not steady, turning", spin[0], spin[1], spin[2]);
  words += "\n  unrest     " +
           (unrest.accelerates.empty() ? "no acceleration"
                                       : fmt::format("{:.2g} m/s^2 of '{}' (limit {:.2g})", unrest.acceleration,
                                                     unrest.accelerates, unrest.acceleration_limit)) +
           (unrest.moves.empty() ? "" : fmt::format(", {:.2g} m/s of '{}'", unrest.speed, unrest.moves)) + "\n";
  for (const Finding& note : notes) words += "  note       " + note.text() + "\n";
  return words;
}

nlohmann::ordered_json state_json(const Vec3& spin, const Unrest& unrest, const std::vector<Finding>& notes) {
  CommandFindings::add(notes);
  return {{"spin", {spin[0], spin[1], spin[2]}},
          {"still", unrest.is_still()},
          {"acceleration", unrest.acceleration},
          {"acceleration_limit", unrest.acceleration_limit},
          {"accelerates", unrest.accelerates},
          {"speed", unrest.speed},
          {"speed_limit", unrest.speed_limit},
          {"moves", unrest.moves},
          {"notes", texts_of(notes)}};
}

void rethrow_with_options(const ModelError& error) {
  const std::string words = error.what();
  if (words.find("neither an equilibrium") == std::string::npos) throw error;
  throw ModelError(words + " (--at T another instant, --spin x,y,z the turning of the axes, --frozen this one)");
}

}  // namespace lockstep
