// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/modes_page.h"

#include <nlohmann/json.hpp>

#include <lockstep/system.h>
#include "framework/tools/report/outline.h"
#include "framework/tools/report/page.h"
#include "framework/tools/report/run_data.h"

namespace lockstep::report {
namespace {

using Json = nlohmann::ordered_json;

// Of each moving body, the real and the imaginary parts of the twelve amplitudes of its rigid group.
Json shape_json(const std::vector<const Body*>& bodies, const ShownMode& mode) {
  Json all = Json::array();
  for (const Body* body : bodies) {
    Json numbers = Json::array();
    for (const std::complex<double>& z : mode.shape[body->slot]) numbers.push_back(z.real());
    for (const std::complex<double>& z : mode.shape[body->slot]) numbers.push_back(z.imag());
    all.push_back(std::move(numbers));
  }
  return all;
}

}  // namespace

std::string modes_page(const ReportText& text, const Sample& rest, const Mechanism& m,
                       const std::vector<ShownMode>& modes, double length) {
  Frames frames(0);  // one alone
  frames.start(rest);
  frames.output(rest);
  Numbers numbers;
  Meshes meshes(numbers);
  Json json{{"kind", "modes"}, {"text", json_of(text)}, {"mechanism", outline_of(frames, m.solids, m.looks, meshes)}};
  json["meshes"] = meshes.list();
  json.update(frames_json(frames, numbers));
  json["table"] = {{"rows", 0}, {"stride", 1}, {"columns", Json::array()}};
  json["length"] = length;
  json["pivots"] = Json::array();
  for (const Body* body : frames.bodies()) {  // they rotate about the origins of their rigid groups
    const Vec3& x = rest.inputs().slot(body->slot).x;
    json["pivots"].push_back({x[0], x[1], x[2]});
  }
  json["modes"] = Json::array();
  for (const ShownMode& mode : modes)
    json["modes"].push_back({{"name", mode.name},
                             {"words", mode.words},
                             {"frequency", mode.frequency},
                             {"damping", mode.damping},
                             {"shape", shape_json(frames.bodies(), mode)}});
  return page_with(json, numbers);
}

}  // namespace lockstep::report
