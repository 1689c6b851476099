// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/law_types.h"
#include "motionlaws/spline_curve.h"

namespace lockstep {

void add_spline_keys(Keys& keys) {
  keys.push_back({"degree", Form::integer, Unit::none, 3, "3: continuous acceleration; 5: also jerk and its rate"});
  keys.push_back(
      {"ends", Form::choice, Unit::none, "natural", "condition at both ends", {"natural", "clamped", "periodic"}});
  keys.push_back({"outside",
                  Form::choice,
                  Unit::none,
                  "refuse",
                  "behaviour before and after the points",
                  {"refuse", "hold", "repeat"}});
}

Keys spline_keys(const char* points, std::initializer_list<std::pair<const char*, const char*>> columns) {
  Keys keys{value_key("points", Form::points, kOptional, points),
            {"file", Form::text, Unit::none, kOptional,
             "CSV file, in SI or with units in its header; path from the scene's folder"},
            {"t_column", Form::text, Unit::none, "t", "name or number of the column of times"}};
  for (const auto& [name, of] : columns)
    keys.push_back({name + std::string("_column"), Form::text, Unit::none, name,
                    std::string("name or number of the column of ") + of});
  add_spline_keys(keys);
  return keys;
}

SplineSettings spline_settings(const Params& p) {
  SplineSettings k;
  k.degree = p.integer("degree");
  const std::string ends = p.text("ends"), outside = p.text("outside");
  if (ends == "clamped") k.ends = SplineEnds::clamped;
  if (ends == "periodic") k.ends = SplineEnds::periodic;
  if (outside == "hold") k.outside = SplineOutside::hold;
  if (outside == "repeat") k.outside = SplineOutside::repeat;
  return k;
}

void check_end_keys(const Params& p, const SplineSettings& k, std::initializer_list<const char*> first,
                    std::initializer_list<const char*> second) {
  for (const auto& keys : {first, second})
    for (const char* key : keys)
      if (p.has(key) && k.ends != SplineEnds::clamped)
        p.refuse(key, "is used with clamped ends only; set ends to \"clamped\"");
  for (const char* key : second)
    if (p.has(key) && k.degree != 5) p.refuse(key, "is used with degree 5 only; set degree to 5");
}

Columns points_of(const Params& p, std::size_t n_components, const std::string& t_column,
                  const std::vector<std::string>& y_columns) {
  if (p.has("points") == p.has("file")) p.refuse("points", "and file: give one of the two");
  if (p.has("file")) return read_columns(p.text("file"), t_column, y_columns);
  const auto points = p.points("points");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].size() != n_components + 1)
      p.refuse("points", "has " + std::to_string(points[i].size()) + " numbers in point " + std::to_string(i + 1) +
                             "; must be " + std::to_string(n_components + 1) + ", the time first");
  return columns_of(points, n_components);
}

}  // namespace lockstep
