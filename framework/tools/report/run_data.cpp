// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/run_data.h"

#include <nlohmann/json.hpp>

namespace lockstep::report {
namespace {

using Json = nlohmann::ordered_json;

// Every k-th value, the last one too.
std::vector<double> thinned(const std::vector<double>& values, std::size_t k) {
  if (k == 1) return values;
  std::vector<double> some;
  for (std::size_t i = 0; i < values.size(); i += k) some.push_back(values[i]);
  if ((values.size() - 1) % k != 0) some.push_back(values.back());
  return some;
}

}  // namespace

Json table_json(const Table& table, std::size_t most_cells, std::size_t fewest, Numbers& numbers) {
  const std::size_t least = std::max<std::size_t>(1, table.n_rows() / std::max<std::size_t>(1, fewest));
  const std::size_t stride = std::min(least, 1 + table.n_rows() * table.n_columns() / most_cells);
  Json json{{"rows", table.n_rows()}, {"stride", stride}, {"columns", Json::array()}};
  for (const Column& column : table.columns()) {
    const std::vector<double> values = thinned(column.values, stride);
    const bool is_time = &column == &table.columns().front();
    json["columns"].push_back(
        {{"name", column.name},
         {"unit", column.unit},
         {"values", is_time ? numbers.add(std::span<const double>(values)) : numbers.add_column(values)}});
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

}  // namespace lockstep::report
