// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/motion_words.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lockstep {

double motion_size(const System& system, const VecX& motion) {
  double size = 0;
  for (int k = 0; k < system.n_slots(); ++k)
    size = std::max({size, motion.segment<3>(6 * k).norm(), system.length() * motion.segment<3>(6 * k + 3).norm()});
  return size;
}

namespace {

constexpr std::size_t kMostNamed = 4;  // bodies by name

// A direction in the world: "z", "-x", "[0.6, 0.8, 0]".
std::string direction_words(const Vec3& direction) {
  const Vec3 unit = direction.normalized();
  for (int k = 0; k < 3; ++k)
    if (std::abs(std::abs(unit[k]) - 1) < kSlight) return std::string(unit[k] < 0 ? "-" : "") + "xyz"[k];
  const auto plain = [](double x) { return std::abs(x) < 5e-4 ? 0.0 : x; };
  return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", plain(unit[0]), plain(unit[1]), plain(unit[2]));
}

// The motion of a slot: "rotates about z", and its size, m; no words if it hardly moves.
struct Part {
  int slot = 0;
  double size = 0;
  std::string words;
};

Part part_of(const System& system, const Inputs& at, const VecX& motion, int slot, double least) {
  const Vec3 move = motion.segment<3>(6 * slot), turn = at.slot(slot).A * motion.segment<3>(6 * slot + 3);
  const double moves = move.norm(), turns = system.length() * turn.norm();
  if (turns > 0 && turns >= kNotable * std::max(moves, least))
    return {slot, turns, "rotates about " + direction_words(turn)};
  if (moves > 0 && moves >= kNotable * least) return {slot, moves, "moves along " + direction_words(move)};
  return {slot, 0, ""};
}

std::string name_of(const System& system, int slot) { return "'" + system.body_of_slot(slot).name + "'"; }

// Those that move notably, the largest first.
std::vector<Part> parts_of(const System& system, const Inputs& at, const VecX& motion) {
  std::vector<Part> parts;
  const double largest = motion_size(system, motion);
  for (int k = 0; k < system.n_slots(); ++k)
    if (Part part = part_of(system, at, motion, k, largest); !part.words.empty()) parts.push_back(std::move(part));
  std::ranges::stable_sort(parts, [](const Part& a, const Part& b) { return a.size > kLarger * b.size; });
  return parts;
}

// The bodies of some parts, with their motion if `words`.
std::string list(const System& system, const std::vector<Part>& parts, bool words) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kMostNamed, parts.size()); ++i)
    text += (i > 0 ? ", " : "") + name_of(system, parts[i].slot) + (words ? " " + parts[i].words : "");
  if (const std::size_t n = parts.size(); n > kMostNamed)
    text += fmt::format(" and {} more bod{}{}", n - kMostNamed, n == kMostNamed + 1 ? "y" : "ies",
                        words ? " with them" : "");
  return text;
}

}  // namespace

std::string motion_words(const System& system, const Inputs& at, const VecX& motion) {
  return list(system, parts_of(system, at, motion), true);
}

std::string led_motion_words(const System& system, const Inputs& at, const VecX& motion, int leader) {
  std::vector<Part> parts = parts_of(system, at, motion);
  const Part first = part_of(system, at, motion, leader, 0);
  if (first.words.empty()) return motion_words(system, at, motion);
  std::erase_if(parts, [&](const Part& p) { return p.slot == leader; });
  const std::string words = list(system, {first}, true);
  if (parts.empty()) return words;
  return words + "; " + list(system, parts, false) + (parts.size() == 1 ? " follows" : " follow");
}

}  // namespace lockstep
