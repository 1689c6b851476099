// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/mobility_findings.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <lockstep/assembly.h>
#include <lockstep/error.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/rank/motion_words.h"
#include "framework/tools/rank/unknowns.h"

namespace lockstep {
namespace {

constexpr int kMostMotions = 12;        // told in words
constexpr double kNearPosition = 1e-2;  // singular value of rows of length 1

State counted_start(Dynamics& dynamics, Mechanism& m, const State& typed, MobilityFindings& found) {
  NearRows& near = found.near;
  State start = decided_start(dynamics, m, &near);
  try {
    if (m.run.assemble)
      assemble(dynamics, start, m.start_speeds, m.assembly);
    else
      check_start(dynamics, start, StepLoopOptions().start_limit);
    refuse_locked(dynamics, start);
  } catch (const Error&) {
    found.refused = std::current_exception(), start = typed;
  }
  if (!near.looked) near = {true, nearly_redundant_at(dynamics, m, start)};
  return start;
}

nlohmann::ordered_json position_json(const MobilityFindings& found) {
  const BranchPoint& position = found.position;
  if (!position.known) return nullptr;
  return {{"in", position.singular},       {"near", position.singular || position.nearness < kNearPosition},
          {"smallest", position.nearness}, {"motions", position.motions},
          {"branches", found.branches},    {"all_branches", position.all}};
}

}  // namespace

MobilityFindings mobility_of(Dynamics& dynamics, Mechanism& m, const State& typed) {
  MobilityFindings found;
  const State counted = counted_start(dynamics, m, typed, found);
  const MobilityReport& r = found.mobility = mobility(dynamics, counted);
  if (r.redundant > 0 || !found.near.all.empty()) found.reactions = uniqueness(dynamics, counted);
  for (const NearDependency& d : found.near.all) CommandFindings::add(finding_of(d, m.run.nearly_redundant));
  if (!found.reactions.all_unique())
    CommandFindings::add({&finding::reactions_not_unique, first_of(found.reactions.rows),
                          "redundant rows share these reactions as the solver chooses"});
  found.position = branch_point(dynamics, counted);
  State at = counted;
  dynamics.to_slots(at);
  for (const VecX& tangent : found.position.tangents)
    found.branches.push_back(motion_words(dynamics.system(), dynamics.inputs(at), tangent));
  found.position_words = found.position.text(dynamics, counted);
  if (r.freedoms > 0 && r.freedoms <= kMostMotions && r.unknowns <= kDenseUnknowns)
    found.moves = driven_by(dynamics, counted);
  return found;
}

void print_freedoms(const MobilityFindings& found) {
  const MobilityReport& r = found.mobility;
  fmt::print("  bodies that move    {}\n  unknown velocities  {}\n  rows                {}\n  degrees of freedom  {}\n",
             r.bodies, r.unknowns, r.rows, r.freedoms);
  for (const std::string& words : found.moves.free) fmt::print("    {}\n", words);
  if (found.position.singular)
    fmt::print("  singular position   the start lies in one: {}\n", found.position_words);
  else if (found.position.known && found.position.nearness < kNearPosition)
    fmt::print("  singular position   near: a combination of rows is down to {:.2g} of their size\n",
               found.position.nearness);
}

void print_dependencies(const MobilityFindings& found, const RunSettings& run) {
  const MobilityReport& r = found.mobility;
  if (r.redundant > 0) fmt::print("  redundant rows      {} (in {})\n", r.redundant, first_of(r.redundant_links));
  for (const Dependency& d : r.dependencies) fmt::print("{}", words_of(d));
  for (const NearDependency& d : found.near.all) fmt::print("{}", words_of(d, run.nearly_redundant));
  fmt::print("{}", words_of(found.reactions, run));
}

void put_mobility(nlohmann::ordered_json& j, const MobilityFindings& found, const RunSettings& run) {
  const MobilityReport& r = found.mobility;
  j["bodies"] = r.bodies, j["unknowns"] = r.unknowns, j["rows"] = r.rows, j["rank"] = r.rank;
  j["freedoms"] = r.freedoms, j["redundant"] = r.redundant, j["redundant_links"] = r.redundant_links;
  j["dependencies"] = dependencies_json(r);
  j["nearly_redundant"] = near_json(found.near.all, run.nearly_redundant);
  j["rows_not_unique"] = found.reactions.rows;
  j["columns_not_unique"] = columns_not_unique(run, found.reactions);
  j["free_motions"] = found.moves.free;
  j["singular_position"] = position_json(found);
}

}  // namespace lockstep
