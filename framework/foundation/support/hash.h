// SPDX-License-Identifier: BSD-3-Clause
// The checksum of files: FNV-1a, 64 bits.
#pragma once

#include <cstdint>
#include <string_view>

namespace lockstep {

/// FNV-1a byte by byte; `hash`: of what came before.
constexpr std::uint64_t hash_of(std::string_view bytes, std::uint64_t hash = 0xcbf29ce484222325u) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

}  // namespace lockstep
