// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/points.h"

#include <nlohmann/json.hpp>

#include "framework/tools/report/page.h"

namespace lockstep::report {

std::string points_page(const Points& points) {
  nlohmann::ordered_json json{
      {"kind", "points"}, {"text", json_of(points.text)}, {"csv", points.csv}, {"x", points.x},
      {"y", points.y},    {"color", points.color},        {"log", points.log}, {"joined", points.joined}};
  if (points.histories == nullptr) return page_with(json, Numbers());
  json["histories"] = points.histories->json();
  return page_with(json, points.histories->numbers());
}

}  // namespace lockstep::report
