// SPDX-License-Identifier: BSD-3-Clause
// Threads that share work.
#pragma once

#include <cstddef>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace lockstep {

/// Starts threads that call work(k), k = 0 to n - 1; fewer where the system has no more of them. Throws std::bad_alloc where
/// it has none.
template <class Work>
void start_threads(std::vector<std::jthread>& threads, std::size_t n, const Work& work) {
  try {
    for (std::size_t k = 0; k < n; ++k) threads.emplace_back([work, k] { work(k); });
  } catch (const std::system_error&) {
    if (threads.empty()) throw std::bad_alloc();
  }
}

}  // namespace lockstep
