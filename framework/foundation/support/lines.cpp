// SPDX-License-Identifier: BSD-3-Clause
#include "framework/foundation/support/lines.h"

#include <algorithm>

namespace lockstep {

std::vector<std::string> lines_of(std::string_view text, char end) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t n = std::min(text.find(end), text.size());
    lines.emplace_back(text.substr(0, n));
    text.remove_prefix(std::min(n + 1, text.size()));
  }
  return lines;
}

}  // namespace lockstep
