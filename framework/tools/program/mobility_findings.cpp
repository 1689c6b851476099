// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/mobility_findings.h"

#include <spdlog/fmt/fmt.h>

#include <optional>

#include <lockstep/error.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/run_warnings.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/rank/motion_words.h"
#include "framework/tools/rank/unknowns.h"

namespace lockstep {
namespace {

constexpr int kMostMotions = 12;        // reported in words
constexpr double kNearPosition = 1e-2;  // singular value of rows of length 1

void evaluate_first(Dynamics& dynamics, const State& start) try {
  dynamics.evaluate(start);
} catch (const Error& error) {
  rethrow_with(cause_of_stop(dynamics, start), error);
}

State counted_start(Dynamics& dynamics, Mechanism& m, const State& typed, MobilityFindings& found) {
  NearRows& near = found.near;
  State start = decided_start(dynamics, m, &near);
  try {
    if (m.run.assemble)
      assemble_scene(dynamics, m, start, near);
    else
      check_start(dynamics, start, StepLoopOptions().start_limit);
    refuse_locked(dynamics, start);
    refuse_driven_lock(dynamics, start);
    refuse_short_laws(m, dynamics, start);
    StepLoop run(dynamics, make_integrator(m.run, *m.methods), loop_options(m.run));
    run.set_state(start), run.run_until(start.t);  // as a run begins
    found.position = warn_of_branches(dynamics, run);
    warn_of_no_freedom(m, dynamics, run, kManyVelocities);
    CommandFindings::add(share_findings(system_of(m), m, {&run.state()}));
    evaluate_first(dynamics, run.state());
  } catch (const Error& error) {
    found.error = in_lines(error), found.exit_code = exit_code_of(error);
    if (dynamics.violation(start) > StepLoopOptions().start_limit) start = typed;
  }
  if (!near.looked) near = {true, nearly_redundant_at(dynamics, m, start)};
  return start;
}

bool is_near(const BranchPoint& position) { return position.singular || position.nearness < kNearPosition; }

std::string plane_text(const Json& normal) {
  if (normal.get_ref<const std::string&>().empty()) return "";
  return "normal " + normal.get<std::string>() +
         "; out-of-plane constraints and reactions are left out (--full counts them)";
}

std::string unique_text(const Json& all) { return all.get<bool>() ? "all are unique" : ""; }

std::string position_text(const Json& position) {
  if (position["in"]) return "at the start: " + position["what"].get<std::string>();
  if (!position["near"]) return "";
  return fmt::format("near: smallest relative singular value {:.2g}", position["smallest"].get<double>());
}

}  // namespace

MobilityFindings mobility_of(Dynamics& dynamics, Mechanism& m, const State& typed) {
  MobilityFindings found;
  const State counted = counted_start(dynamics, m, typed, found);
  MobilityReport& r = found.mobility = mobility(dynamics, counted);
  found.choice = m.run.nearly_redundant;
  if (const Plane plane = m.system.plane()) found.plane = "xyz"[plane.n];
  if (r.redundant > 0 || !found.near.all.empty()) found.reactions = uniqueness(dynamics, counted);
  note_near(found.near.all, m.run.nearly_redundant);
  if (!found.position.known) found.position = branch_point(dynamics, counted);
  State at = counted;
  dynamics.to_slots(at);
  for (const VecX& tangent : found.position.tangents)
    found.branches.push_back(motion_words(dynamics.system(), dynamics.inputs(at), tangent));
  found.position_words = found.position.text(dynamics, counted);
  const System::InSpace look = dynamics.look_in_space();
  const MobilityReport in_space = mobility(dynamics, at);
  if (r.freedoms + r.driven == 0 && in_space.freedoms > 0) {  // it moves out of the plane alone
    r = in_space, found.plane = {};
    if (r.redundant > 0) found.reactions = uniqueness(dynamics, at);
  }
  r.freedoms = in_space.freedoms, r.driven = in_space.driven, r.drives = in_space.drives;
  found.columns_not_unique = columns_not_unique(m.run.record, found.reactions);
  if (r.freedoms + r.driven == 0 && r.drives.empty() && found.error.empty())
    found.laws = moved_by_laws(dynamics, at, m.run.until > 0 ? m.run.until : 1).value_or(std::vector<std::string>());
  if (r.freedoms > 0 && r.freedoms <= kMostMotions && in_space.unknowns <= kDenseUnknowns)
    found.moves = driven_by(dynamics, at);
  return found;
}

const Fields<MobilityFindings>& mobility_fields() {
  using Found = MobilityFindings;
  static const Fields<MobilityReport> kReport{
      {"bodies", "", "moving bodies", &MobilityReport::bodies},
      {"unknowns", "", "  velocity components", &MobilityReport::unknowns},
      {"rows", "", "constraints", &MobilityReport::rows},
      {"rank", "", "rank", &MobilityReport::rank},
      {"degrees_of_freedom", "", "degrees of freedom", [](const MobilityReport& r) { return r.freedoms + r.driven; }},
      {"freedoms", "", "  free", &MobilityReport::freedoms},
      {"driven", "", "  prescribed by drives", &MobilityReport::driven, unless_zero},
      {"drives", "", "  drives", &MobilityReport::drives},
      {"redundant", "", "redundant constraints", &MobilityReport::redundant},
      {"redundant_links", "", "", &MobilityReport::redundant_links},
      {"dependencies", "dependent constraints", &MobilityReport::dependencies, kDependencyFields}};
  static const Fields<Found> kPosition{{"in", "", "", [](const Found& f) { return f.position.singular; }},
                                       {"near", "", "", [](const Found& f) { return is_near(f.position); }},
                                       {"what", "", "", &Found::position_words},
                                       {"smallest", "", "", [](const Found& f) { return f.position.nearness; }},
                                       {"motions", "", "", [](const Found& f) { return f.position.motions; }},
                                       {"branches", "", "", &Found::branches},
                                       {"all_branches", "", "", [](const Found& f) { return f.position.all; }}};
  const auto near = [](const Found& f) { return decided(f.near.all, f.choice); };
  const auto all_unique = [](const Found& f) { return f.mobility.redundant == 0 && f.reactions.all_unique(); };
  const auto position = [](const Found& f) { return f.position.known ? std::optional(f) : std::nullopt; };
  static const Fields<Found> kFields =
      Fields<Found>{{"plane", "", "plane", &Found::plane, plane_text}}
          .with(&Found::mobility, kReport)
          .with({{"free_motions", "", "free motions", [](const Found& f) { return f.moves.free; }},
                 {"moved_by_laws", "", "moved by laws of", &Found::laws},
                 {"singular_position", "singular configuration", position, kPosition, position_text},
                 {"nearly_redundant", "", near, kNearFields},
                 {"reactions_unique", "", "reactions", all_unique, unique_text},
                 {"rows_not_unique", "", "reactions not unique", [](const Found& f) { return f.reactions.rows; },
                  grouped_text},
                 {"columns_not_unique", "", "  recorded", &Found::columns_not_unique},
                 {"error", "", "", &Found::error}});
  return kFields;
}

}  // namespace lockstep
