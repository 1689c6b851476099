// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/analysis.h>

#include <cassert>

#include <lockstep/error.h>
#include "framework/mechanism/params/read.h"

namespace lockstep {

Shard read_shard(const std::string& text) {
  const std::size_t bar = text.find('/');
  Shard shard{0, 0};
  if (bar != std::string::npos)
    shard = {number_in<long>(text.substr(0, bar)).value_or(0), number_in<long>(text.substr(bar + 1)).value_or(0)};
  if (shard.index < 1 || shard.count < 1)
    throw ModelError("\"" + text + "\" is not a share; write i/n with whole numbers from 1, as in 2/8");
  if (shard.index > shard.count)
    throw ModelError("\"" + text + "\": there is no share " + std::to_string(shard.index) + " of " +
                     std::to_string(shard.count) + "; the last is " + std::to_string(shard.count) + "/" +
                     std::to_string(shard.count));
  return shard;
}

Grid::Grid(std::vector<std::size_t> sizes) : sizes_(std::move(sizes)) {
  for (const std::size_t size : sizes_) {
    if (size == 0) throw ModelError("a list of the grid has no values; give at least one");
    if (size > static_cast<std::size_t>(kMostRuns / n_runs_))
      throw ModelError("the grid has more than " + std::to_string(kMostRuns) + " runs; use fewer values");
    n_runs_ *= static_cast<long>(size);
  }
}

std::vector<std::size_t> Grid::at(long run) const {
  assert(run >= 1 && run <= n_runs_);
  std::vector<std::size_t> choice(sizes_.size());
  auto rest = static_cast<std::size_t>(run - 1);
  for (std::size_t k = sizes_.size(); k-- > 0; rest /= sizes_[k]) choice[k] = rest % sizes_[k];
  return choice;
}

long Grid::n_runs(Shard shard) const { return shard.index > n_runs_ ? 0 : 1 + (n_runs_ - shard.index) / shard.count; }

}  // namespace lockstep
