// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/detail/export.h>

namespace lockstep::built_with {

template <>
void eigen_max_align_bytes<EIGEN_MAX_ALIGN_BYTES>() {}
template <>
void eigen_max_static_align_bytes<EIGEN_MAX_STATIC_ALIGN_BYTES>() {}
template <>
void eigen_malloc_already_aligned<EIGEN_MALLOC_ALREADY_ALIGNED>() {}
template <>
void eigen_version<EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION>() {}
template <>
void glibcxx_debug<LOCKSTEP_CHECKED_CONTAINERS>() {}

}  // namespace lockstep::built_with
