// SPDX-License-Identifier: BSD-3-Clause
// The drawing of a joint in addition to the symbol of its mask.
#include <cmath>
#include <nlohmann/json.hpp>

#include <lockstep/couplings.h>
#include <lockstep/detail/phi_function.h>
#include <lockstep/joints.h>
#include "framework/mechanism/links/cam_functions.h"
#include "framework/mechanism/links/curve_functions.h"
#include "framework/mechanism/links/gear_functions.h"
#include "framework/tools/report/outline.h"

namespace lockstep::report {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kPoints = 240;  // of a curve

void put(Json& points, const Vec3& x) {
  for (int k = 0; k < 3; ++k) points.push_back(x[k]);
}

// The used part of a path, and a little more. A law that ends cuts it off.
Json path(const CurvePoint& curve, std::pair<double, double> range) {
  const auto [low, high] = range;
  const double more = 0.1 * (high - low) + 1e-9;
  Json points = Json::array();
  for (int k = 0; k <= kPoints; ++k) {
    const double s = low - more + (high - low + 2 * more) * k / kPoints;
    try {
      const Vec3 x = curve.path()->at(s).x;
      if (x.allFinite()) put(points, x);
    } catch (const std::exception&) {
      continue;
    }
  }
  return {{"pair", 0}, {"side", "s"}, {"closed", false}, {"points", std::move(points)}};
}

Json profile(const CamProfile& cam) {
  Json points = Json::array();
  for (int k = 0; k < kPoints; ++k) {
    const CamProfile::Vec2 c = cam.at(kTwoPi * k / kPoints).c;
    put(points, {c[0], c[1], 0});
  }
  return {{"pair", 0}, {"side", "s"}, {"closed", true}, {"points", std::move(points)}};
}

// A circle about z of a marker.
Json circle(std::size_t pair, const char* side, double radius) {
  Json points = Json::array();
  const int n = 96;
  for (int k = 0; k < n; ++k) put(points, radius * Vec3(std::cos(kTwoPi * k / n), std::sin(kTwoPi * k / n), 0));
  return {{"pair", pair}, {"side", side}, {"closed", true}, {"points", std::move(points)}};
}

// Pitch circles of gears on parallel axes, from the distance of their axes at the start.
Json pitch_circles(const Gear& gear) {
  const auto pairs = gear.pairs();
  const auto home = [](const Marker* m) { return m->body->home * m->local; };
  const Pose first = home(pairs[0].first), second = home(pairs[1].first);
  const Vec3 axis = rotation(first.q).col(2), across = second.x - first.x;
  if (std::abs(std::abs(axis.dot(rotation(second.q).col(2))) - 1) > 1e-6) return Json::array();
  const auto& [a, b] = phi_of<TurnsOfTwo>(gear.function()).factors;
  const double distance = (across - across.dot(axis) * axis).norm(), ratio = std::abs(b / a);
  const bool internal = a * b < 0;
  if (!(distance > 0) || (internal && ratio == 1)) return Json::array();
  const double radius = internal ? distance / std::abs(ratio - 1) : distance / (1 + ratio);
  return Json::array({circle(0, "p", radius), circle(1, "p", radius * ratio)});
}

}  // namespace

Json drawing_of(const Lock& link, std::pair<double, double> path_range) {
  Json json = Json::object();
  if (const auto* curve = dynamic_cast<const PointOnCurve*>(&link))
    json["curves"] = Json::array({path(phi_of<OnCurve>(curve->function()).curve, path_range)});
  else if (const auto* follower = dynamic_cast<const PathFollower*>(&link))
    json["curves"] = Json::array({path(phi_of<OnPath>(follower->function()).curve, path_range)});
  else if (const auto* roller = dynamic_cast<const CamRoller*>(&link)) {
    const auto& on = phi_of<RollerOnCam>(roller->function());
    json["curves"] = Json::array({profile(on.profile)});
    if (on.roller > 0) json["curves"].push_back(circle(0, "p", on.roller));
  } else if (const auto* flat = dynamic_cast<const CamFlat*>(&link))
    json["curves"] = Json::array({profile(phi_of<FaceOnCam>(flat->function()).profile)});
  else if (const auto* gear = dynamic_cast<const Gear*>(&link))
    json["curves"] = pitch_circles(*gear);
  else if (const auto* belt = dynamic_cast<const Belt*>(&link)) {
    const auto& [a, b] = phi_of<TurnsOfTwo>(belt->function()).factors;
    json["curves"] = Json::array({circle(0, "p", std::abs(a)), circle(1, "p", std::abs(b))});
    json["belt"] = {{"radii", {std::abs(a), std::abs(b)}}, {"crossed", a * b > 0}};
  } else if (const auto* rolling = dynamic_cast<const RollingRack*>(&link)) {
    const double radius = phi_of<RollingPinion>(rolling->function()).radius;
    json["curves"] = Json::array({circle(0, "p", std::abs(radius))});
    json["rack"] = radius;
  } else if (const auto* rack = dynamic_cast<const RackAndPinion*>(&link))
    json["curves"] = Json::array({circle(0, "p", std::abs(phi_of<PinionAndSlide>(rack->function()).radius))});
  return json;
}

}  // namespace lockstep::report
