// SPDX-License-Identifier: BSD-3-Clause
// Channels of bodies and markers: motion in the world, and seen from another frame.
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <memory>

#include <lockstep/author/params.h>
#include <lockstep/author/relative.h>
#include "framework/tools/record/channel_entry.h"

namespace lockstep::channels {
namespace {

/// The rotation of m relative to n as three sequences of angles.
void add_rotation(Entries& out, const Frame& m, const Frame& n) {
  const auto q = [m, n](const Sample& s) { return conjugate(n.at(s).q()) * m.at(s).q(); };
  for (const std::string name : {"cardan", "euler", "hpb"}) {
    const std::string sequence = angle_sequence(name);
    for (int k = 0; k < 3; ++k)
      add(out, fmt::format("{}_{}", name, k + 1), "rad",
          fmt::format("rotation {} of three about its axes {}", k + 1, sequence),
          [q, sequence, k](const Sample& s) { return to_angles(sequence, q(s)).value[k]; });
    add(out, name + "_gimbal", "", "1 in gimbal lock of that sequence (the third rotation is set to 0), else 0",
        [q, sequence](const Sample& s) { return to_angles(sequence, q(s)).gimbal ? 1.0 : 0.0; });
  }
}

}  // namespace

void of_frame(const Frame& f, Entries& out) {
  for (const NamedCoordinate& c : coordinates_of(CoordinateOwner::frame)) add_coordinate(out, c, f, {});
  add_rotation(out, f, {});
}

void of_body(const Body& body, Entries& out) {
  of_frame({{&body, nullptr}}, out);
  if (body.fixed) return;
  for (const NamedCoordinate& c : coordinates_of(CoordinateOwner::body))
    add_coordinate(out, c, {{&body, nullptr, true}}, {});
}

void of_pair(const Frame& m, const Frame& n, Entries& out) {
  for (const NamedCoordinate& c : coordinates_of(CoordinateOwner::pair)) add_coordinate(out, c, m, n);
  add_rotation(out, m, n);
}

}  // namespace lockstep::channels
