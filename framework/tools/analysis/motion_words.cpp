#include "framework/tools/analysis/motion_words.h"

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

std::string direction_words(const Vec3& direction) {
  constexpr double kAlong = 1e-6;
  const Vec3 unit = direction.normalized();
  for (int k = 0; k < 3; ++k)
    if (std::abs(std::abs(unit[k]) - 1) < kAlong) return std::string(unit[k] < 0 ? "-" : "") + "xyz"[k];
  const auto plain = [](double x) { return std::abs(x) < 5e-4 ? 0.0 : x; };
  return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", plain(unit[0]), plain(unit[1]), plain(unit[2]));
}

std::string motion_words(const System& system, const Inputs& at, const VecX& motion) {
  constexpr double kNotable = 0.1;  // of the largest
  constexpr std::size_t kMost = 4;
  struct Part {
    double size;
    std::string words;
  };
  std::vector<Part> parts;
  const double largest = motion_size(system, motion);
  for (int k = 0; k < system.n_slots(); ++k) {
    const Vec3 move = motion.segment<3>(6 * k), turn = at.slot(k).A * motion.segment<3>(6 * k + 3);
    const double moves = move.norm(), turns = system.length() * turn.norm();
    const std::string& name = system.body_of_slot(k).name;
    if (turns >= kNotable * std::max(moves, largest))
      parts.push_back({turns, fmt::format("'{}' turns about {}", name, direction_words(turn))});
    else if (moves >= kNotable * largest)
      parts.push_back({moves, fmt::format("'{}' moves along {}", name, direction_words(move))});
  }
  std::ranges::stable_sort(parts, [](const Part& a, const Part& b) { return a.size > 1.000001 * b.size; });
  std::string words;
  for (std::size_t i = 0; i < std::min(kMost, parts.size()); ++i) words += (i > 0 ? ", " : "") + parts[i].words;
  if (const std::size_t n = parts.size(); n > kMost)
    words += fmt::format(" and {} more bod{} with them", n - kMost, n == kMost + 1 ? "y" : "ies");
  return words;
}

}  // namespace lockstep
