// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/system/coordinate_names.h"

#include <optional>
#include <string_view>

#include <lockstep/author/lock.h>
#include <lockstep/error.h>

namespace lockstep {
namespace {

enum Owner : unsigned { joint = 1, frame = 2, pair = 4 };

// The name of a quantity is `begin`, the axis and `end`.
struct Rule {
  std::string_view begin, end;
  Coordinate::Kind kind;
  bool rate;
  unsigned owners;
};
using Kind = Coordinate::Kind;
constexpr Rule kRules[] = {{"", "", Kind::position, false, joint | frame | pair},
                           {"v", "", Kind::position, true, joint | frame | pair},
                           {"", "_d", Kind::position, true, joint},
                           {"r", "", Kind::turn, false, joint},
                           {"r", "_d", Kind::turn, true, joint},
                           {"angle_", "", Kind::turn, false, joint},
                           {"angle_", "_d", Kind::turn, true, joint},
                           {"omega_", "", Kind::omega, false, joint | pair},
                           {"omega_world_", "", Kind::omega, false, frame}};

std::optional<Coordinate::Of> quantity(std::string_view name, Owner owner) {
  if (owner == pair && name == "distance") return Coordinate::Of{Kind::distance};
  if (owner == pair && name == "distance_d") return Coordinate::Of{Kind::distance, 0, true};
  for (const Rule& r : kRules) {
    const bool fits = (r.owners & owner) != 0 && name.size() == r.begin.size() + 1 + r.end.size();
    if (!fits || !name.starts_with(r.begin) || !name.ends_with(r.end)) continue;
    const std::size_t axis = std::string_view("xyz").find(name[r.begin.size()]);
    if (axis != std::string_view::npos) return Coordinate::Of{r.kind, static_cast<int>(axis), r.rate};
  }
  return std::nullopt;
}

std::optional<BodyOrMarker> frame_named(const System& system, std::string_view name) {
  for (const Body& b : system.bodies())
    if (b.name == name) return BodyOrMarker{&b, nullptr};
  for (const Marker& m : system.markers())
    if (m.name == name) return BodyOrMarker{m.body, &m};
  return std::nullopt;
}

std::shared_ptr<Coordinate> made(const std::optional<Coordinate::Of>& of, const BodyOrMarker& m,
                                 const BodyOrMarker& n) {
  return of ? std::make_shared<Coordinate>(*of, m, n) : nullptr;
}

}  // namespace

std::shared_ptr<Coordinate> coordinate_named(const System& system, const std::string& name) {
  const std::size_t at = name.find('@');
  const std::string_view left = std::string_view(name).substr(0, at);
  for (std::size_t dot = left.rfind('.'); dot != std::string::npos && dot > 0; dot = left.rfind('.', dot - 1)) {
    const std::string_view owner = left.substr(0, dot), word = left.substr(dot + 1);
    std::shared_ptr<Coordinate> found;
    const std::optional<BodyOrMarker> m = frame_named(system, owner);
    if (at != std::string::npos) {
      const std::optional<BodyOrMarker> n = frame_named(system, std::string_view(name).substr(at + 1));
      if (m && n) found = made(quantity(word, pair), *m, *n);
    } else if (m) {
      found = made(quantity(word, frame), *m, {});
    }
    for (const auto& link : system.links())
      if (at == std::string::npos && link->name() == owner && !link->pairs().empty()) {
        const auto [p, s] = link->pairs().front();
        found = made(quantity(word, joint), {p->body, p}, {s->body, s});
      }
    if (found) return found;
  }
  throw ModelError("\"" + name +
                   "\" is no parameter, table or coordinate; a formula of a force can read coordinates and rates of "
                   "joints (crank.rz, crank.rz_d), and motions of bodies and markers (P.x, P.vx, P.distance@Q)");
}

}  // namespace lockstep
