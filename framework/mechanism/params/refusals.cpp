// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/params/refusals.h"

#include <algorithm>
#include <string_view>

namespace lockstep {

bool Refusals::full() const {
  constexpr std::size_t kMostLines = 20;
  return lines_.size() >= kMostLines;
}

void Refusals::add(const SceneError& error) {
  if (empty() || error.line < first_.line)
    if ((first_ = error.data()).key.empty()) first_.key = key_;
  std::string_view rest = error.what();
  for (bool more = true; more && !full();) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    if (std::ranges::none_of(lines_, [&](const auto& known) { return known.second == line; }))
      lines_.emplace(error.line, line);
    more = end != std::string_view::npos;
    if (more) rest.remove_prefix(end + 1);
  }
}

void Refusals::raise() const {
  if (empty()) return;
  std::string all;
  for (const auto& [number, line] : lines_) all += (all.empty() ? "" : "\n") + line;
  throw SceneError(all + (full() ? "\nmore errors may follow these" : ""), first_);
}

}  // namespace lockstep
