// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/check_dependencies.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <lockstep/text.h>

namespace lockstep {

std::string words_of(const Dependency& d) {
  return d.too_many > 0 ? fmt::format("    {}: {} too many\n", first_of(d.rows), d.too_many) : std::string();
}

namespace {

std::string decided_words(const NearDependency& d, NearlyRedundant choice) {
  if (d.in_passing) return "in this position only, beside a singular one";
  if (!d.undecided.empty())
    return fmt::format("not decided: {}; solvers may differ; make them agree, or leave one out", d.undecided);
  if (choice == NearlyRedundant::told || !d.decided)
    return "solvers may differ there; say whether they hold: \"nearly_redundant\": \"held\" or \"free\" "
           "(--nearly-redundant)";
  const char* const are = d.left_out.size() == 1 ? "is" : "are";
  if (choice != NearlyRedundant::free)
    return (d.left_out.empty() ? "held"
                               : fmt::format("held, and {} {} left out, which depend{} on others exactly",
                                             first_of(d.left_out), are, d.left_out.size() == 1 ? "s" : "")) +
           (choice == NearlyRedundant::held
                ? ""
                : "; if they are not meant to hold, say \"nearly_redundant\": \"free\" (--nearly-redundant)");
  return fmt::format("free, {} {} left out, and violated by some {:.1g} m as it moves; \"held\" holds {}",
                     first_of(d.left_out), are, d.violation, d.left_out.size() == 1 ? "it" : "them");
}

}  // namespace

Finding finding_of(const NearDependency& d, NearlyRedundant choice) {
  Finding f{&finding::nearly_redundant, first_of(d.rows)};
  f.message = fmt::format("{}: {} too many but for {:.2g}: ", first_of(d.rows), d.nearly, d.singular_value) +
              decided_words(d, choice);
  f.value = d.singular_value;
  return f;
}

std::string words_of(const NearDependency& d, NearlyRedundant choice) {
  return "  nearly redundant    " + finding_of(d, choice).message + "\n";
}
namespace {

std::string decision(const NearDependency& d, NearlyRedundant choice) {
  if (choice == NearlyRedundant::told) return "told";
  if (!d.decided) return choice == NearlyRedundant::automatic && d.undecided.empty() ? "told" : "undecided";
  return choice == NearlyRedundant::free ? "free" : "held";
}

}  // namespace

nlohmann::ordered_json near_json(const std::vector<NearDependency>& near, NearlyRedundant choice) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const NearDependency& d : near)
    all.push_back({{"rows", d.rows},
                   {"nearly", d.nearly},
                   {"singular_value", d.singular_value},
                   {"in_passing", d.in_passing},
                   {"decided", decision(d, choice)},
                   {"undecided", d.undecided},
                   {"violation", d.violation},
                   {"left_out", d.left_out}});
  return all;
}

std::vector<std::string> columns_not_unique(const RunSettings& run, const UniquenessReport& reactions) {
  std::vector<std::string> names;
  for (const ChannelRequest& request : run.record)
    if (!reactions.unique(request.channel)) names.push_back(request.column());
  return names;
}

std::string words_of(const UniquenessReport& reactions, const RunSettings& run) {
  if (reactions.all_unique()) return {};
  std::string out = fmt::format("  reactions not unique  {}\n", first_of(reactions.rows));
  const std::vector<std::string> columns = columns_not_unique(run, reactions);
  if (!columns.empty())
    out += fmt::format("    recorded          {}: how the redundant rows share this is the solver's choice\n",
                       first_of(columns));
  return out;
}

nlohmann::ordered_json dependencies_json(const MobilityReport& r) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Dependency& d : r.dependencies)
    all.push_back({{"rows", d.rows}, {"too_many", d.too_many}, {"nearly", d.nearly}, {"pivot", d.pivot}});
  return all;
}

}  // namespace lockstep
