// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/meshes.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace lockstep::report {
namespace {

constexpr float kMost = 65535;

nlohmann::ordered_json json_of(const TriangleMesh& mesh, Numbers& numbers) {
  Eigen::AlignedBox3f box;
  for (const auto& p : mesh.points) box.extend(Eigen::Vector3f::Map(p.data()));
  const Eigen::Vector3f low = box.min(), size = box.sizes();
  std::vector<std::uint16_t> points;
  points.reserve(3 * mesh.points.size());
  for (const auto& p : mesh.points)
    for (int k = 0; k < 3; ++k) {
      const float part = size[k] > 0 ? (p[k] - low[k]) / size[k] : 0;
      points.push_back(static_cast<std::uint16_t>(std::lround(kMost * std::clamp(part, 0.0F, 1.0F))));
    }
  nlohmann::ordered_json json{{"low", {low[0], low[1], low[2]}}, {"size", {size[0], size[1], size[2]}}};
  json["points"] = numbers.add(std::span<const std::uint16_t>(points));
  const auto corners = [&]<class Number>(Number) {
    std::vector<Number> all;
    all.reserve(3 * mesh.triangles.size());
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle) all.push_back(static_cast<Number>(corner));
    return numbers.add(std::span<const Number>(all));
  };
  json["triangles"] = mesh.points.size() <= 65536 ? corners(std::uint16_t{}) : corners(std::uint32_t{});
  return json;
}

}  // namespace

std::size_t Meshes::number(const std::shared_ptr<const TriangleMesh>& mesh) {
  const auto same = [&](const auto& kept) {
    return kept == mesh || (kept->points == mesh->points && kept->triangles == mesh->triangles);
  };
  const auto found = std::ranges::find_if(kept_, same);
  if (found != kept_.end()) return static_cast<std::size_t>(found - kept_.begin());
  list_.push_back(json_of(*mesh, *numbers_));
  kept_.push_back(mesh);
  return kept_.size() - 1;
}

}  // namespace lockstep::report
