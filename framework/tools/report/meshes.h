// SPDX-License-Identifier: BSD-3-Clause
// Meshes of a report: each once, however many bodies have it.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include <lockstep/solid.h>
#include "framework/tools/report/numbers.h"

namespace lockstep::report {

/// The meshes of a page. The points of one are whole numbers from 0 to 65535 of its extent along each axis; its triangles
/// are numbers of points, of 16 bits where these are enough.
class Meshes {
 public:
  explicit Meshes(Numbers& numbers) : numbers_(&numbers) {}
  /// The number of a mesh in the list; it is added when no equal one is there.
  std::size_t number(const std::shared_ptr<const TriangleMesh>&);
  /// {"low": [x, y, z], "size": [x, y, z], "points": place, "triangles": place} of each.
  const nlohmann::ordered_json& list() const { return list_; }

 private:
  Numbers* numbers_;
  std::vector<std::shared_ptr<const TriangleMesh>> kept_;
  nlohmann::ordered_json list_ = nlohmann::ordered_json::array();
};

}  // namespace lockstep::report
