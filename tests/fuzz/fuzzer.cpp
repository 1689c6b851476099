// SPDX-License-Identifier: BSD-3-Clause
// One fuzz target as a program of libFuzzer: LOCKSTEP_FUZZ_TARGET is its name.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string_view>

#include "tests/fuzz/mutate.h"
#include "tests/fuzz/targets.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    lockstep::fuzz::LOCKSTEP_FUZZ_TARGET({data, size});
  } catch (const lockstep::fuzz::Broken& broken) {
    std::fprintf(stderr, "broken: %s\n", broken.words.c_str());
    std::abort();
  }
  return 0;
}

// Scenes are changed as JSON three times out of four.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  constexpr std::string_view kName = LOCKSTEP_FUZZ_NAME;
  if ((kName != "scene" && kName != "run") || seed % 4 == 0) return LLVMFuzzerMutate(data, size, most);
  std::mt19937_64 bits(seed);
  const std::string next = lockstep::fuzz::mutated_scene({reinterpret_cast<const char*>(data), size}, bits);
  const std::size_t n = std::min(next.size(), most);
  std::memcpy(data, next.data(), n);
  return n;
}
