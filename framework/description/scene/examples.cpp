// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/describe.h"

#include <algorithm>
#include <map>

#include "framework/description/registry/shelves.h"
#include "framework/description/scene/json.h"

namespace lockstep {
namespace {

const std::map<std::string, const char*>& samples() {
  static const std::map<std::string, const char*> all = {
      {"link lock", R"({"mask": "x z e2"})"},
      {"link stop", R"({"coordinate": "rz", "low": -0.5})"},
      {"link screw", R"({"lead": 0.2, "offset": {"type": "sine", "omega": 2, "amplitude": 0.1}})"},
      {"link rack_and_pinion", R"({"radius": 0.3})"},
      {"link gear", R"({"teeth_1": 20, "teeth_2": 30})"},
      {"link belt", R"({"radius_1": 0.2, "radius_2": 0.3})"},
      {"link differential", R"({"ratio": 2.5})"},
      {"link cam_roller", R"({"radius": {"type": "fourier", "omega": 1, "offset": 0.4, "cosines": [0.05]},
                             "roller": 0.1})"},
      {"link cam_flat", R"({"radius": {"type": "fourier", "omega": 1, "offset": 0.4, "cosines": [0.05]}})"},
      {"link point_on_curve", R"({"path": {"type": "components", "x": {"type": "ramp", "slope": 2},
                                  "y": {"type": "sine", "omega": 1, "amplitude": 0.3}}})"},
      {"link path_follower", R"({"path": {"type": "components", "x": {"type": "ramp", "slope": 2},
                                 "y": {"type": "sine", "omega": 1, "amplitude": 0.3}},
                                 "turning": {"type": "axis_rotation", "axis": [1, 2, 2],
                                             "law": {"type": "sine", "omega": 1, "amplitude": 0.5}}})"},
      {"link function", R"~({"phi": ["=x*y + 0.3*z - R*sin(2*t) + (t > 0.7 ? 2*(t - 0.7)^2 : 0)",
                                    "=rz - 2*x*e1*e2 + max(0, t - 1.1)"], "parameters": {"R": "100 mm"}})~"},
      {"law formula", R"~({"y": "=0.1*sin(w*t) + (t > 1 ? 2*(t - 1)^2 : 0)", "parameters": {"w": 3}})~"},
      {"law constant", R"({"value": 0.3})"},
      {"law input", R"({"name": "u", "value": 0.2})"},
      {"law ramp", R"({"slope": 2, "t0": 0.2})"},
      {"law sine", R"({"omega": 3, "phase": 0.4})"},
      {"law fourier", R"({"omega": 2, "cosines": [1, 0.3], "sines": [0.2, 0.7]})"},
      {"law polynomial", R"({"coefficients": [1, 2, -0.5, 0.3]})"},
      {"law poly345", R"({"rise": 0.3, "duration": 1.1, "t0": 0.2})"},
      {"law cycloid", R"({"rise": 0.3, "duration": 1.1, "t0": 0.2})"},
      {"law harmonic_rise", R"({"rise": 0.3, "duration": 1.1, "t0": 0.2})"},
      {"law trapezoid", R"({"distance": 1, "speed": 2, "duration": 0.8, "t0": 0.3})"},
      {"law spline", R"({"points": [[0, 1], [0.5, 3], [1.2, 2], [2, 2.5]], "outside": "hold"})"},
      {"law sequence", R"({"laws": [{"type": "ramp", "slope": 1}, {"type": "sine", "omega": 2}],
                           "durations": [0.7, 0.9], "outside": "run_on"})"},
      {"law repeat", R"({"law": {"type": "cycloid", "rise": 1, "duration": 0.4}, "period": 0.6})"},
      {"law sum", R"({"laws": [{"type": "ramp", "slope": 1}, {"type": "sine", "omega": 2}]})"},
      {"law product", R"({"laws": [{"type": "ramp", "slope": 1}, {"type": "sine", "omega": 2}]})"},
      {"law scale", R"({"law": {"type": "sine", "omega": 2}, "factor": 3, "offset": 1})"},
      {"law shift", R"({"law": {"type": "cycloid", "rise": 1, "duration": 0.4}, "delay": 0.3})"},
      {"translation law constant", R"({"value": [1, 2, 3]})"},
      {"translation law components", R"({"x": {"type": "sine", "omega": 2}, "z": {"type": "ramp", "slope": 1}})"},
      {"translation law along", R"({"axis": [1, 2, 2], "law": {"type": "sine", "omega": 2}})"},
      {"translation law path", R"({"points": [[0, 0, 0, 0], [0.7, 1, 0.5, 0], [1.5, 1, 2, 1], [2, 0, 1, 1]],
                                   "outside": "hold"})"},
      {"rotation law constant", R"({"orientation": {"axis": [1, 2, 2], "angle": 0.7}})"},
      {"rotation law axis_rotation", R"({"axis": [1, 2, 2], "law": {"type": "sine", "omega": 2}})"},
      {"rotation law spline_rotation", R"({"points": [[0, [1, 0, 0, 0]], [1, {"axis": "x", "angle": 0.8}],
                                  [2, {"axis": [1, 1, 0], "angle": 1.2}]], "outside": "hold"})"},
      {"rotation law product", R"({"first": {"type": "axis_rotation", "axis": "x", "law": {"type": "ramp", "slope": 1}},
                                   "second": {"type": "axis_rotation", "axis": "z", "law": {"type": "sine", "omega": 2}}})"},
      {"force joint_friction", R"({"mu": 0.2, "mu_static": 0.3, "radius": 0.05, "viscous_turn": 0.1})"},
      {"force function_force", R"~({"torque": "=-3*q^3 - 0.5*qd*abs(qd) + sin(2*t) + (t > 0.6 ? 2 : 0)"})~"},
      {"force applied_force", R"({"force": [1, 2, 3]})"},
      {"force applied_torque", R"({"torque": [1, 2, 3]})"},
      {"force spring_damper", R"({"stiffness": 30, "damping": 2, "free_length": 0.1, "preload": 4})"},
      {"force torsion_spring_damper", R"({"stiffness": 30, "damping": 2, "free_angle": 0.1, "preload": 4})"},
      {"force force_motor", R"({"force": {"type": "sine", "omega": 2}})"},
      {"force torque_motor", R"({"torque": {"type": "sine", "omega": 2}})"},
      {"force bushing", R"({"stiffness": [10, 20, 30], "damping": [1, 2, 3], "torsion_stiffness": [4, 5, 6],
                            "torsion_damping": [0.1, 0.2, 0.3]})"},
  };
  return all;
}

// The keys of a joint or force besides those of its type.
const char* places_of(const Description& d) {
  const std::string& type = d.info.name;
  const int pairs = d.shelf == "links" ? example_pairs(type) : 1;
  if (pairs > 1) return pairs == 2 ? R"({"pairs": ["A", "B"]})" : R"({"pairs": ["A", "B", "C"]})";
  if (type == "joint_friction") return R"({"link": "A"})";
  if (type != "spring_damper" && type != "distance") return R"({"p": "arm", "s": "ground", "at": [0, 0, 0]})";
  return R"({"p": "arm", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0]})";
}

// The keys of a type without a sample. One of a plugin may want one of several keys that each may be left out, as 'drag'
// a coefficient or an area: the first number among them is shown.
std::string keys_of_plugin(const Description& d) {
  if (d.origin == "built in") return "{}";
  for (const Key& key : d.info.keys)
    if ((key.form == Form::number || key.form == Form::integer) && !key.required() && key.default_value() == nullptr)
      return "{\"" + key.name + "\": 1}";
  return "{}";
}

}  // namespace

std::string example_keys(const std::string& kind, const std::string& type) {
  const auto at = samples().find(kind + " " + type);
  return at == samples().end() ? "{}" : at->second;
}

int example_pairs(const std::string& type) {
  return type == "differential" ? 3 : type == "gear" || type == "belt" ? 2 : 1;
}

std::string example_of(const Description& d) {
  if (d.shelf == "scene") return "";
  const std::string kind = kind_on(d.shelf), keys = example_keys(kind, d.info.name);
  const bool needs = std::any_of(d.info.keys.begin(), d.info.keys.end(), [](const Key& key) {
    return key.required() && key.name != "name" && key.name != "type";
  });
  if (needs && keys == "{}") return "";
  const bool placed = kind == "link" || kind == "force";
  Value::Object all{{"type", Value(d.info.name), {}}};
  if (placed)
    all.insert(all.begin(), {"name", kind == "force" ? "F" : example_pairs(d.info.name) > 1 ? "gears" : "C", {}});
  for (const std::string& part : {std::string(placed ? places_of(d) : "{}"), keys == "{}" ? keys_of_plugin(d) : keys}) {
    const Value read = read_json(part, "example of " + d.info.name);
    all.insert(all.end(), read.object()->begin(), read.object()->end());
  }
  return write_json_line(Value(std::move(all)));
}

}  // namespace lockstep
