// Pack<N>: N doubles that the compiler keeps in vector registers, whatever the machine offers.
//
// A row block of up to 8 rows is a pack a column, so that one instruction serves all rows of a link.
#pragma once

#include <cstddef>

namespace lockstep {

template <int N>
struct PackOf;
template <>
struct PackOf<2> {
  typedef double type __attribute__((vector_size(16), may_alias));
};
template <>
struct PackOf<4> {
  typedef double type __attribute__((vector_size(32), may_alias));
};
template <>
struct PackOf<8> {
  typedef double type __attribute__((vector_size(64), may_alias));
};
template <int N>
using Pack = typename PackOf<N>::type;

/// Numbers of a pack that holds m of them: 2, 4 or 8.
constexpr int pack_size(int m) { return m <= 2 ? 2 : m <= 4 ? 4 : 8; }
/// The next offset at or after `at` where a pack of n numbers may stand.
constexpr std::size_t aligned_to(std::size_t at, int n) {
  const auto k = static_cast<std::size_t>(n);
  return (at + k - 1) / k * k;
}
inline constexpr std::size_t kPackAlignment = 64;  ///< bytes, of every array that packs are read from

}  // namespace lockstep
