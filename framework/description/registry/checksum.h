// CRC-64 (polynomial of ECMA-182): tells every damage of up to 64 neighbouring bits, and all others but one in 2^64.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lockstep {

class Checksum {
 public:
  void add(const char* bytes, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k)
      value_ = value_ << 8 ^ kTable[(value_ >> 56 ^ static_cast<unsigned char>(bytes[k])) & 255];
  }
  std::uint64_t value() const { return ~value_; }

 private:
  static constexpr std::array<std::uint64_t, 256> kTable = [] {
    std::array<std::uint64_t, 256> table{};
    for (std::uint64_t byte = 0; byte < 256; ++byte) {
      std::uint64_t x = byte << 56;
      for (int bit = 0; bit < 8; ++bit) x = x >> 63 != 0 ? x << 1 ^ 0x42F0E1EBA9EA3693u : x << 1;
      table[byte] = x;
    }
    return table;
  }();
  std::uint64_t value_ = ~std::uint64_t{0};
};

}  // namespace lockstep
