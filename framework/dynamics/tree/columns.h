// Column and Columns: vectors of three numbers in packs of four, and matrices of three such columns.
#pragma once

#include <cstddef>

#include <lockstep/jet.h>

namespace lockstep {

/// The fourth number is zero. Where a struct holds columns they come first, and it says alignas(kColumn): the compiler
/// takes 16 bytes where it does not count on AVX, and 32 where it does.
using Column = Pack<4>;
inline constexpr std::size_t kColumn = 32;  ///< bytes

struct alignas(kColumn) Columns {
  Column c[3];
};

}  // namespace lockstep
