// SPDX-License-Identifier: BSD-3-Clause
#include "tests/differential/shrink.h"

#include <vector>

namespace lockstep::differential {

namespace {

constexpr int kMostTries = 200;

// All designs that are smaller by one thing.
std::vector<Design> smaller(const Design& d) {
  std::vector<Design> all;
  const auto with = [&](auto&& change) {
    Design next = d;
    change(next);
    all.push_back(std::move(next));
  };
  for (std::size_t k = d.bodies.size(); k-- > 0 && d.bodies.size() > 1;)
    all.push_back(without_body(d, static_cast<int>(k)));
  for (std::size_t k = d.forces.size(); k-- > 0;)
    with([&](Design& n) { n.forces.erase(n.forces.begin() + static_cast<std::ptrdiff_t>(k)); });
  for (std::size_t k = d.links.size(); k-- > 0;) {
    with([&](Design& n) { n.links.erase(n.links.begin() + static_cast<std::ptrdiff_t>(k)); });
    if (d.links[k].drive != 0) with([&](Design& n) { n.links[k].drive = 0; });
    if (d.links[k].mu != 0) with([&](Design& n) { n.links[k].mu = 0; });
    if (d.links[k].stop != 0) with([&](Design& n) { n.links[k].stop = 0; });
  }
  for (std::size_t k = 0; k < d.bodies.size(); ++k)
    if (!d.bodies[k].v.isZero(0) || !d.bodies[k].w.isZero(0))
      with([&](Design& n) { n.bodies[k].v.setZero(), n.bodies[k].w.setZero(); });
  if (!d.gravity.isZero(0)) with([&](Design& n) { n.gravity.setZero(); });
  return all;
}

}  // namespace

Design shrunk(Design design, const std::function<bool(const Design&)>& disagrees) {
  int tries = 0;
  for (bool found = true; found;) {
    found = false;
    for (Design& next : smaller(design))
      if (++tries <= kMostTries && disagrees(next)) {
        design = std::move(next), found = true;
        break;
      }
  }
  return design;
}

}  // namespace lockstep::differential
