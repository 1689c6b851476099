// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/lane_passes.h"

#include <string>

#include <lockstep/error.h>

namespace lockstep::lanes {

Passes passes(Instructions set) {
#if defined(__x86_64__)
  const bool has_fma = __builtin_cpu_supports("fma"), has_avx512 = __builtin_cpu_supports("avx512f");
#else
  const bool has_fma = false, has_avx512 = false;
#endif
  if (set == Instructions::best)
    set = has_avx512 ? Instructions::avx512 : has_fma ? Instructions::fma : Instructions::plain;
  if ((set == Instructions::avx512 && !has_avx512) || (set == Instructions::fma && !has_fma))
    throw ModelError(std::string("batch: this processor has no ") + (set == Instructions::fma ? "FMA" : "AVX-512") +
                     " instructions; use Instructions::best");
  if (set == Instructions::avx512) return avx512::all_passes();
  return set == Instructions::fma ? fma::all_passes() : plain::all_passes();
}

}  // namespace lockstep::lanes
