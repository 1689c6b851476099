#include "framework/tools/program/check_dependencies.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <lockstep/text.h>

namespace lockstep {

namespace {

constexpr std::size_t kMostNames = 24;  // in one line

}  // namespace

std::string first_of(const std::vector<std::string>& names) {
  if (names.size() <= kMostNames) return text::join(names);
  return fmt::format("{} and {} more", fmt::join(names.begin(), names.begin() + kMostNames, ", "),
                     names.size() - kMostNames);
}

std::string words_of(const Dependency& d) {
  const std::string names = first_of(d.rows);
  std::string out;
  if (d.too_many > 0) out += fmt::format("    {}: {} too many\n", names, d.too_many);
  if (d.nearly > 0)
    out += fmt::format(
        "    {}: {} nearly too many (pivot {:.2g}): a run holds {} by forces that may be very large; make the rows "
        "agree exactly, or leave one out\n",
        names, d.nearly, d.pivot, d.nearly == 1 ? "it" : "them");
  return out;
}

std::vector<std::string> columns_not_unique(const RunSettings& run, const UniquenessReport& reactions) {
  std::vector<std::string> names;
  for (const ChannelRequest& request : run.record)
    if (!reactions.unique(request.channel)) names.push_back(request.name.empty() ? request.channel : request.name);
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
