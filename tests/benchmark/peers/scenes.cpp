// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/peers/scenes.h"

#include <charconv>
#include <stdexcept>
#include <vector>

namespace lockstep::peers {

namespace {

std::string number(double x) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, x).ptr);
}
std::string list(double x, double y, double z) { return "[" + number(x) + ", " + number(y) + ", " + number(z) + "]"; }
std::string list(const Vec3& v) { return list(v[0], v[1], v[2]); }
std::string numbered(const std::string& name, int k) { return name + std::to_string(k); }

/// The lines of a scene.
struct Draft {
  std::string title;
  std::vector<std::string> bodies, links, record;
  std::string integrator = "\"dop853\"";

  void rod(const std::string& name, double mass, const Vec3& from, const Vec3& to, double axial,
           const std::string& motion = "") {
    bodies.push_back("{\"name\": \"" + name + "\", \"rod\": {\"mass\": " + number(mass) + ", \"from\": " + list(from) +
                     ", \"to\": " + list(to) + ", \"axial_inertia\": " + number(axial) + "}" + motion + "}");
  }
  void link(const std::string& name, const std::string& type, const std::string& p, const std::string& s,
            const Vec3& at, const std::string& more = "") {
    links.push_back("{\"name\": \"" + name + "\", \"type\": \"" + type + "\", \"p\": \"" + p + "\", \"s\": \"" + s +
                    "\", \"at\": " + list(at) + more + "}");
  }
  void channel(const std::string& name) { record.push_back("\"" + name + "\""); }
};

std::string lines(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "\n    " : ",\n    ") + item;
  return text;
}

std::string written(const Mechanism& m, const Draft& d) {
  std::string record;
  for (const std::string& channel : d.record) record += (record.empty() ? "" : ", ") + channel;
  return "{\n  \"lockstep\": 1,\n  \"title\": \"" + d.title + "\",\n  \"gravity\": " + list(m.gravity) +
         ",\n  \"bodies\": [" + lines(d.bodies) + "\n  ],\n  \"links\": [" + lines(d.links) +
         "\n  ],\n  \"run\": {\n    \"integrator\": " + d.integrator +
         ",\n    \"tolerance\": 1e-08,\n    \"until\": " + number(m.until) +
         ",\n    \"output\": " + number(m.until / 100) + ",\n    \"record\": [" + record + "]\n  }\n}\n";
}

Draft chain_draft(const Mechanism& m) {
  Draft d;
  const bool spatial = m.kind == Kind::spatial_chain;
  d.title = m.name == "pendulum" ? "a rod swings from the horizontal, long enough for errors to grow"
            : spatial ? std::to_string(m.n) + " rods end to end, joints alternately about z and y, tilted gravity"
                      : std::to_string(m.n) + " rods end to end fall from the horizontal";
  for (int k = 0; k < m.n; ++k) {
    d.rod(numbered("rod", k + 1), 1, {double(k), 0, 0}, {double(k + 1), 0, 0}, 0.01);
    d.link(numbered("joint", k + 1), "revolute", numbered("rod", k + 1), k > 0 ? numbered("rod", k) : "ground",
           {double(k), 0, 0}, turns_about_y(m, k) ? ", \"axis\": \"y\"" : "");
  }
  for (const char* axis : {".x", ".y", ".z"}) d.channel(numbered("rod", m.n) + axis);
  d.channel("energy.total");
  return d;
}

Draft four_bars_draft(const Mechanism& m) {
  Draft d;
  d.title = std::to_string(m.n) + " four-bars in series fall through their flat configuration";
  const std::string spin = ", \"velocity\": [0.5, 0, 0], \"omega_world\": [0, 0, -1]";
  for (int k = 0; k <= m.n; ++k) d.rod(numbered("upright", k), 1, {double(k), 0, 0}, {double(k), 1, 0}, 0.01, spin);
  for (int k = 0; k < m.n; ++k)
    d.rod(numbered("bar", k), 1, {double(k), 1, 0}, {double(k + 1), 1, 0}, 0.01, ", \"velocity\": [1, 0, 0]");
  for (int k = 0; k <= m.n; ++k)
    d.link(numbered("foot", k), "revolute", numbered("upright", k), "ground", {double(k), 0, 0});
  for (int k = 0; k < m.n; ++k) {
    d.link(numbered("left", k), "revolute", numbered("bar", k), numbered("upright", k), {double(k), 1, 0});
    d.link(numbered("right", k), "revolute", numbered("bar", k), numbered("upright", k + 1), {double(k + 1), 1, 0});
  }
  for (const char* channel : {"foot0.rz", "bar0.x", "bar0.y", "energy.total"}) d.channel(channel);
  return d;
}

Draft slider_crank_draft() {
  Draft d;
  d.title = "a slider-crank at constant speed; every link weighs 1 kg";
  d.integrator = "\"dopri5\"";
  const double end = kCrank + kRod;
  d.rod("crank", 1, {0, 0, 0}, {kCrank, 0, 0}, 1e-4);
  d.rod("rod", 1, {kCrank, 0, 0}, {end, 0, 0}, 1e-4);
  d.bodies.push_back("{\"name\": \"slider\", \"mass\": 1, \"inertia\": [0.0001, 0.001, 0.001], \"position\": " +
                     list(end, 0, 0) + "}");
  d.link("A", "revolute", "crank", "ground", {0, 0, 0},
         ", \"drive\": {\"axis\": \"rz\", \"law\": {\"type\": \"ramp\", \"slope\": " + number(kCrankSpeed) + "}}");
  d.link("B", "revolute", "rod", "crank", {kCrank, 0, 0});
  d.link("C", "revolute", "slider", "rod", {end, 0, 0});
  d.link("guide", "prismatic", "slider", "ground", {end, 0, 0}, ", \"axis\": \"x\"");
  for (const char* channel :
       {"slider.x", "A.force_on_p_world_x", "A.force_on_p_world_y", "B.force_on_p_world_x", "B.force_on_p_world_y",
        "C.force_on_p_world_x", "C.force_on_p_world_y", "guide.force_on_p_world_y", "A.drive.torque_on_p_link_z"})
    d.channel(channel);
  return d;
}

Draft heavy_top_draft(const Mechanism& m) {
  Draft d;
  d.title = "a fast heavy top on a fixed tip (Bruels, Cardona, Arnold)";
  const Mass mass = mass_of(m, 0);
  d.bodies.push_back("{\"name\": \"top\", \"mass\": " + number(mass.mass) + ", \"inertia\": " + list(mass.J) +
                     ", \"center\": [0, 1, 0], \"omega_body\": " + list(kTopSpin) + "}");
  d.link("tip", "spherical", "top", "ground", {0, 0, 0});
  for (const char* channel : {"top.center_x", "top.center_y", "top.center_z", "energy.total"}) d.channel(channel);
  return d;
}

}  // namespace

std::string scene_name(const Mechanism& m) {
  std::string name = "bench_" + m.name;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
}

bool is_generated(const Mechanism& m) { return is_described(m); }

std::string scene_text(const Mechanism& m) {
  switch (m.kind) {
    case Kind::chain:
    case Kind::spatial_chain:
      return written(m, chain_draft(m));
    case Kind::four_bars:
      return written(m, four_bars_draft(m));
    case Kind::slider_crank:
      return written(m, slider_crank_draft());
    case Kind::heavy_top:
      return written(m, heavy_top_draft(m));
    default:
      throw std::runtime_error(m.name + " has a scene of its own, tests/benchmark/scenes/" + scene_name(m) + ".json");
  }
}

}  // namespace lockstep::peers
