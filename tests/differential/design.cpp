// SPDX-License-Identifier: BSD-3-Clause
#include "tests/differential/design.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

namespace lockstep::differential {

namespace {

using nlohmann::json;

// Numbers from a seed, the same on every machine: distributions of the standard library are not.
class Dice {
 public:
  explicit Dice(unsigned seed) : bits_(seed) {}
  double between(double a, double b) { return a + (b - a) * static_cast<double>(bits_() % 1000003u) / 1000003.0; }
  int below(int n) { return static_cast<int>(bits_() % static_cast<unsigned>(n)); }
  bool chance(double p) { return between(0, 1) < p; }
  Vec3 vector(double size) {
    const double x = between(-size, size), y = between(-size, size);
    return {x, y, between(-size, size)};
  }
  Quat turn() { return exponential(vector(1.5)); }

 private:
  std::mt19937 bits_;
};

// Freedoms that a joint leaves, in the plane or in space.
int freedoms(const std::string& type, bool planar) {
  if (type == "revolute" || type == "prismatic") return 1;
  if (planar) return 2;
  return type == "spherical" ? 3 : 2;
}

class Designer {
 public:
  explicit Designer(unsigned seed) : dice_(seed) {}

  Design make() {
    d_.planar = dice_.chance(0.4);
    d_.gravity = d_.planar ? Vec3(0, -9.81, 0) : Vec3(dice_.vector(6));
    const int n = 1 + dice_.below(6);
    for (int k = 0; k < n; ++k) add_body(k);
    if (n >= 2 && dice_.chance(0.5)) close_loop();
    if (dice_.chance(0.15)) d_.links.push_back(bare(d_.links[dice_.below(static_cast<int>(d_.links.size()))]));
    for (int k = dice_.below(3); k > 0; --k) add_force();
    decorate();
    return d_;
  }

 private:
  static DesignLink bare(DesignLink link) {
    link.drive = link.mu = link.stop = 0;
    return link;
  }
  Vec3 offset(double size) {
    Vec3 x = dice_.vector(size);
    x[0] += 0.3;
    if (d_.planar) x[2] = 0;
    return x;
  }
  Vec3 point(int body) { return body < 0 ? Vec3(offset(1)) : Vec3(d_.bodies[body].home.x + offset(0.3)); }

  void add_body(int k) {
    const int parent = k == 0 || dice_.chance(0.2) ? -1 : dice_.chance(0.7) ? k - 1 : dice_.below(k);
    DesignLink link;
    link.p = k, link.s = parent, link.at = point(parent);
    const char* in_space[] = {"revolute", "revolute", "spherical", "universal", "cylindrical", "prismatic"};
    const char* in_plane[] = {"revolute", "revolute", "revolute", "prismatic"};
    link.type = d_.planar ? in_plane[dice_.below(4)] : in_space[dice_.below(6)];
    if (!d_.planar)
      link.axes = dice_.turn();
    else if (link.type == "prismatic")  // z of the marker along a direction of the plane
      link.axes = exponential(Vec3(0, 0, dice_.between(-3, 3))) * exponential(Vec3(0, 0.5 * kPi, 0));
    DesignBody body;
    body.mass = dice_.between(0.5, 3);
    const double size = dice_.between(0.05, 0.3);
    body.inertia = body.mass * size * size * Vec3(dice_.between(0.6, 1), dice_.between(0.6, 1), dice_.between(0.6, 1));
    body.home.x = link.at + offset(0.3);
    body.home.q = d_.planar ? exponential(Vec3(0, 0, dice_.between(-3, 3))) : dice_.turn();
    if (dice_.chance(0.5)) {
      body.v = dice_.vector(1), body.w = dice_.vector(2);
      if (d_.planar) body.v[2] = 0, body.w[0] = body.w[1] = 0;
    }
    d_.bodies.push_back(body);
    d_.links.push_back(link);
  }

  // Links from a body to the ground.
  std::vector<std::size_t> way_down(int body) const {
    std::vector<std::size_t> way;
    for (; body >= 0; body = d_.links[way.back()].s) way.push_back(static_cast<std::size_t>(body));
    return way;
  }
  // Links on the way from body to body that a closing link between the two shuts.
  std::vector<std::size_t> way_between(int p, int s) const {
    std::vector<std::size_t> a = way_down(p), b = way_down(s);
    while (!a.empty() && !b.empty() && a.back() == b.back()) a.pop_back(), b.pop_back();
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }

  // Shuts a loop that can move: one without a freedom may be a structure next to a singular one.
  void close_loop() {
    const int n = static_cast<int>(d_.bodies.size()), p = n - 1;
    DesignLink link;
    link.p = p, link.s = d_.links[p].s >= 0 ? -1 : dice_.below(p);
    link.at = d_.bodies[p].home.x + offset(0.2);
    link.at_s = link.at + offset(0.3);
    loop_ = way_between(link.p, link.s);
    for (const std::size_t k : loop_) loop_freedoms_ += freedoms(d_.links[k].type, d_.planar);
    const int cost = d_.planar ? 2 : 3;
    if (loop_freedoms_ > cost && dice_.chance(0.7)) {
      link.type = d_.planar ? "revolute" : "spherical";
      loop_freedoms_ -= cost;
    } else if (loop_freedoms_ > 1) {
      link.type = "distance";
      --loop_freedoms_;
    } else {
      loop_.clear();
      return;
    }
    d_.links.push_back(link);
  }

  void add_force() {
    const int n = static_cast<int>(d_.bodies.size());
    DesignForce force;
    force.p = dice_.below(n), force.s = -1;
    const bool revolute = d_.links.front().type == "revolute";
    switch (dice_.below(4)) {
      case 0:
        force.kind = DesignForce::Kind::push;
        force.push = dice_.vector(5);
        if (d_.planar) force.push[2] = 0;
        break;
      case 1:
        force.kind = revolute ? DesignForce::Kind::torsion : DesignForce::Kind::spring;
        break;
      case 2:
        force.kind = revolute ? DesignForce::Kind::formula : DesignForce::Kind::spring;
        break;
      default:
        force.kind = DesignForce::Kind::spring;
    }
    force.at_p = point(force.p), force.at_s = force.at_p + offset(0.3) + Vec3(0, 0.5, 0);
    const bool turning = force.kind == DesignForce::Kind::torsion || force.kind == DesignForce::Kind::formula;
    if (turning) {
      const DesignLink& link = d_.links.front();
      force.p = link.p, force.s = link.s, force.at_p = force.at_s = link.at, force.axes = link.axes;
    }
    force.stiffness = turning ? dice_.between(1, 5) : dice_.between(10, 200);
    force.free = turning ? dice_.between(-1, 1) : dice_.between(0.1, 0.8);
    if (dice_.chance(0.4)) force.damping = turning ? dice_.between(0.05, 0.3) : dice_.between(0.5, 5);
    d_.forces.push_back(force);
  }

  // Drives, friction and stops on the joints of the tree.
  void decorate() {
    for (std::size_t k = 0; k < d_.bodies.size(); ++k) {
      DesignLink& link = d_.links[k];
      if (link.type != "revolute") continue;
      const bool in_loop = std::find(loop_.begin(), loop_.end(), k) != loop_.end();
      if ((!in_loop || loop_freedoms_ > 1) && dice_.chance(0.15)) {
        link.drive = dice_.between(0.1, 0.6);
        if (in_loop) --loop_freedoms_;
      } else if (dice_.chance(0.15)) {
        link.stop = dice_.between(0.05, 0.4);
      }
      if (loop_.empty() && dice_.chance(0.1)) link.mu = dice_.between(0.02, 0.2);
    }
  }

  Dice dice_;
  Design d_;
  std::vector<std::size_t> loop_;  // numbers of the links of the tree in it; empty: there is none
  int loop_freedoms_ = 0;
};

json list(const Vec3& x) { return {x[0], x[1], x[2]}; }
json list(const Quat& q) { return {q.w, q.x, q.y, q.z}; }
std::string body_name(int k) { return k < 0 ? "ground" : "b" + std::to_string(k); }

// Writes one design for one view.
class Writer {
 public:
  explicit Writer(const View& view) : view_(view), L_(view.length) {}

  json body(const DesignBody& b, int k) const {
    return {{"name", body_name(k)},
            {"mass", b.mass},
            {"inertia", list(Vec3(L_ * L_ * b.inertia))},
            {"position", list(place(b.home.x))},
            {"orientation", list(view_.frame.q * b.home.q)},
            {"velocity", list(Vec3(L_ * direction(b.v)))},
            {"omega_body", list(b.w)}};
  }
  json link(const DesignLink& l, std::size_t k) const {
    json j = {{"name", "l" + std::to_string(k)}, {"type", l.type}, {"p", body_name(l.p)}, {"s", body_name(l.s)}};
    if (l.type == "distance") {
      j["at_p"] = list(place(l.at)), j["at_s"] = list(place(l.at_s));
      return j;
    }
    j["at"] = list(place(l.at)), j["orientation"] = list(view_.frame.q * l.axes);
    if (l.drive != 0)
      j["drive"] = {{"axis", "rz"}, {"law", {{"type", "sine"}, {"amplitude", l.drive}, {"omega", 3.0}}}};
    if (l.mu != 0)
      j["friction"] = {
          {"mu", l.mu}, {"radius", 0.02 * L_}, {"smoothing_speed", 0.05 * L_}, {"load_smoothing", 1e-3 * L_}};
    if (l.stop != 0) j["stops"] = {{{"axis", "rz"}, {"low", -l.stop}, {"high", l.stop}, {"restitution", 0.5}}};
    return j;
  }
  json force(const DesignForce& f, std::size_t k) const {
    json j = {{"name", "f" + std::to_string(k)}, {"p", body_name(f.p)}};
    const double turning = L_ * L_;  // torque per angle, with masses and times unchanged
    switch (f.kind) {
      case DesignForce::Kind::push:
        j["type"] = "applied_force", j["at_p"] = list(place(f.at_p)), j["force"] = list(Vec3(L_ * direction(f.push)));
        return j;
      case DesignForce::Kind::spring:
        j.update({{"type", "spring_damper"},
                  {"s", body_name(f.s)},
                  {"at_p", list(place(f.at_p))},
                  {"at_s", list(place(f.at_s))},
                  {"stiffness", f.stiffness},
                  {"damping", f.damping},
                  {"free_length", L_ * f.free}});
        return j;
      case DesignForce::Kind::torsion:
        j.update({{"type", "torsion_spring_damper"},
                  {"stiffness", turning * f.stiffness},
                  {"damping", turning * f.damping},
                  {"free_angle", f.free}});
        break;
      case DesignForce::Kind::formula:
        j.update({{"type", "function_force"},
                  {"parameters", {{"k", turning * f.stiffness}, {"c", turning * f.damping}, {"a", f.free}}},
                  {"torque", f.damping == 0 ? "=-k*sin(q - a)" : "=-k*sin(q - a) - c*qd"}});
    }
    j["s"] = body_name(f.s), j["at"] = list(place(f.at_p)), j["orientation"] = list(view_.frame.q * f.axes);
    return j;
  }
  Vec3 direction(const Vec3& x) const { return rotation(view_.frame.q) * x; }

 private:
  Vec3 place(const Vec3& x) const { return view_.frame.x + L_ * direction(x); }

  const View& view_;
  double L_;
};

template <class Items, class Write>
json written(const Items& items, unsigned order, Write&& write) {
  std::vector<std::size_t> numbers(items.size());
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  Dice dice(order);
  if (order != 0)
    for (std::size_t k = numbers.size(); k > 1; --k)
      std::swap(numbers[k - 1], numbers[dice.below(static_cast<int>(k))]);
  json list = json::array();
  for (const std::size_t k : numbers) list.push_back(write(items[k], k));
  return list;
}

}  // namespace

bool Design::has_drive() const {
  return std::any_of(links.begin(), links.end(), [](const DesignLink& l) { return l.drive != 0; });
}
bool Design::has_stop() const {
  return std::any_of(links.begin(), links.end(), [](const DesignLink& l) { return l.stop != 0; });
}
bool Design::has_friction() const {
  return std::any_of(links.begin(), links.end(), [](const DesignLink& l) { return l.mu != 0; });
}
bool Design::has_loss() const {
  return has_stop() || has_friction() ||
         std::any_of(forces.begin(), forces.end(), [](const DesignForce& f) { return f.damping != 0; });
}

Design random_design(unsigned seed) { return Designer(seed).make(); }

std::string scene_text(const Design& d, const View& view, const std::string& planar) {
  const Writer writer(view);
  json scene = {{"lockstep", 1}, {"gravity", list(Vec3(view.length * writer.direction(d.gravity)))}};
  scene["bodies"] = written(d.bodies, view.order,
                            [&](const DesignBody& b, std::size_t k) { return writer.body(b, static_cast<int>(k)); });
  scene["links"] = written(d.links, view.order, [&](const DesignLink& l, std::size_t k) { return writer.link(l, k); });
  scene["forces"] =
      written(d.forces, view.order, [&](const DesignForce& f, std::size_t k) { return writer.force(f, k); });
  if (!planar.empty()) scene["planar"] = planar;
  scene["run"] = {{"until", 0.4}, {"output", 0.1}};
  return scene.dump(1);
}

Design without_body(const Design& whole, int k) {
  Design d = whole;
  const auto touches = [k](const auto& thing) { return thing.p == k || thing.s == k; };
  std::erase_if(d.links, touches);
  std::erase_if(d.forces, touches);
  d.bodies.erase(d.bodies.begin() + k);
  for (DesignLink& l : d.links) l.p -= l.p > k, l.s -= l.s > k;
  for (DesignForce& f : d.forces) f.p -= f.p > k, f.s -= f.s > k;
  return d;
}

}  // namespace lockstep::differential
