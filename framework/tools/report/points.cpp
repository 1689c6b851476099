// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/points.h"

#include <nlohmann/json.hpp>

#include "framework/tools/report/page.h"

namespace lockstep::report {

std::string points_page(const Points& points) {
  nlohmann::ordered_json json{
      {"kind", "points"}, {"text", json_of(points.text)}, {"csv", points.csv}, {"x", points.x},
      {"y", points.y},    {"color", points.color},        {"log", points.log}, {"joined", points.joined}};
  std::string numbers;
  if (points.histories != nullptr) {
    json["histories"] = points.histories->json();
    numbers = points.histories->numbers().base64();
  }
  const std::string title = points.text.title.empty() ? "lockstep report" : points.text.title;
  return page_with(title, json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), numbers);
}

void write_points(const std::string& file, const Points& points) { write_whole(file, points_page(points)); }

}  // namespace lockstep::report
