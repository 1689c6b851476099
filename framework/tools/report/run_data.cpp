// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/run_data.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "framework/tools/record/row_envelope.h"

namespace lockstep::report {
namespace {

using Json = nlohmann::ordered_json;

Json range_json(const ColumnRange& r) {
  return {{"least", r.least}, {"t_least", r.t_least}, {"most", r.most}, {"t_most", r.t_most}, {"resolved", r.resolved}};
}

}  // namespace

Json table_json(const Table& table, std::span<const ColumnRange> ranges, std::size_t most_bytes, Numbers& numbers) {
  std::size_t row = sizeof(double);
  for (const Column& c : table.columns()) row += Numbers::bytes_of(c.values);
  const bool all = table.n_rows() * row <= most_bytes;
  RowEnvelope some(table, all ? 0 : std::max<std::size_t>(2, most_bytes / (8 * row)) * 4);  // twice that many rows
  for (std::size_t i = 0; !all && i < table.n_rows(); ++i) some.add(table, i);
  const Table rows = all ? Table() : some.path_table(), curves = all ? Table() : some.table();
  Json json{{"rows", table.n_rows()}, {"stride", some.path_every()}, {"columns", Json::array()}};
  const auto add = [&](const Table& from, std::size_t k) {
    const std::vector<double>& values = from.columns()[k].values;
    return k == 0 ? numbers.add(std::span<const double>(values)) : numbers.add_column(values);
  };
  for (std::size_t k = 0; k < table.n_columns(); ++k) {
    const Column& column = table.columns()[k];
    Json& own = json["columns"].emplace_back(Json{{"name", column.name}, {"unit", column.unit}});
    own["values"] = add(all ? table : rows, k);
    if (!all) own["curve"] = add(curves, k);
    if (k > 0 && k <= ranges.size()) own["range"] = range_json(ranges[k - 1]);
  }
  return json;
}

Json frames_json(const Frames& frames, Numbers& numbers) {
  Json jumps = Json::array(), marks = Json::array(), later = Json::array();
  for (std::size_t k = 0; k < frames.times().size(); ++k)
    if (frames.after_jump()[k]) jumps.push_back(k);
  for (const Mark& mark : frames.marks()) marks.push_back({{"t", mark.t}, {"what", mark.what}});
  for (const Switch& s : frames.switches()) later.push_back({{"t", s.t}, {"link", s.link}, {"active", s.active}});
  Json kept{{"n", frames.times().size()},
            {"stride", frames.stride()},
            {"width", frames.width()},
            {"times", numbers.add(std::span<const double>(frames.times()))},
            {"rows", numbers.add(std::span<const float>(frames.rows()))},
            {"jumps", jumps}};
  Json switches{{"at_start", frames.modes_at_start()}, {"later", later}};
  return {{"frames", kept}, {"marks", marks}, {"switches", switches}};
}

std::string kept_part(std::initializer_list<std::pair<const char*, std::size_t>> one_in) {
  std::string words;
  for (const auto& [what, n] : one_in)
    if (n > 1) words += fmt::format("{}1 {} in {}", words.empty() ? "" : ", ", what, n);
  return words;
}

}  // namespace lockstep::report
