// SPDX-License-Identifier: BSD-3-Clause
// The header that a plugin includes.
#pragma once

/// @file plugin.h
/// The header that a plugin includes; LOCKSTEP_PLUGIN makes a shared library a plugin.

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include <lockstep/author/formula.h>
#include <lockstep/author/phi_links.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include <lockstep/version.h>

// The build record of a plugin: a plain-C record that is data in the plugin's file. It is read before the plugin is
// opened, and so before any of its code can run.
extern "C" {

/// The build record of a plugin or host: compiler, libraries, settings. All texts end with a zero; the record holds no
/// pointers, so the linker leaves it as it was compiled.
struct lockstep_abi_record {
  char magic[16];                    ///< "lockstep-abi"
  std::uint32_t size;                ///< of this record, bytes
  std::int32_t abi;                  ///< lockstep::kAbiNumber
  char compiler[16];                 ///< "gcc", "clang" or "unknown"
  std::int32_t compiler_version[3];  ///< major, minor, patch level
  char library[16];                  ///< standard library: "libstdc++", "libc++"
  std::int32_t library_version;      ///< its version
  std::int32_t library_abi;          ///< _GLIBCXX_USE_CXX11_ABI; 0 of libc++
  std::int64_t cxx_level;            ///< __cplusplus
  std::int32_t eigen_version[3];     ///< world, major, minor
  std::int32_t alignment;            ///< EIGEN_MAX_ALIGN_BYTES: of memory from the heap
  std::int32_t static_alignment;     ///< EIGEN_MAX_STATIC_ALIGN_BYTES: of members of objects
  std::int32_t index_size;           ///< of Eigen::Index, bytes
  char flags[64];                    ///< settings that change objects or arithmetic: "debug-library fast-math "
};
}

namespace lockstep {

inline constexpr const char* kRegisterSymbol = "lockstep_register_plugin";  ///< symbol of the function that registers
inline constexpr const char* kAbiMagic = "lockstep-abi";                    ///< lockstep_abi_record::magic

namespace abi_detail {
template <std::size_t N>
constexpr void put(char (&to)[N], const char* from) {
  std::size_t i = 0;
  while (i < N && to[i] != 0) ++i;
  for (; i + 1 < N && *from != 0; ++i, ++from) to[i] = *from;
}
}  // namespace abi_detail

/// The record of the program or plugin that compiles this.
constexpr lockstep_abi_record abi_of_this_build() {
  lockstep_abi_record r{};
  abi_detail::put(r.magic, kAbiMagic);
  r.size = sizeof r;
  r.abi = kAbiNumber;
#if defined(__clang__)
  abi_detail::put(r.compiler, "clang");
  r.compiler_version[0] = __clang_major__, r.compiler_version[1] = __clang_minor__,
  r.compiler_version[2] = __clang_patchlevel__;
#elif defined(__GNUC__)
  abi_detail::put(r.compiler, "gcc");
  r.compiler_version[0] = __GNUC__, r.compiler_version[1] = __GNUC_MINOR__, r.compiler_version[2] = __GNUC_PATCHLEVEL__;
#else
  abi_detail::put(r.compiler, "unknown");
#endif
#if defined(_GLIBCXX_RELEASE)
  abi_detail::put(r.library, "libstdc++");
  r.library_version = _GLIBCXX_RELEASE;
  r.library_abi = _GLIBCXX_USE_CXX11_ABI;
#elif defined(_LIBCPP_VERSION)
  abi_detail::put(r.library, "libc++");
  r.library_version = _LIBCPP_VERSION;
#endif
  r.cxx_level = __cplusplus;
  r.eigen_version[0] = EIGEN_WORLD_VERSION, r.eigen_version[1] = EIGEN_MAJOR_VERSION,
  r.eigen_version[2] = EIGEN_MINOR_VERSION;
  r.alignment = EIGEN_MAX_ALIGN_BYTES;
  r.static_alignment = EIGEN_MAX_STATIC_ALIGN_BYTES;
  r.index_size = sizeof(Eigen::Index);
#if defined(_GLIBCXX_DEBUG)
  abi_detail::put(r.flags, "debug-library ");
#endif
#if defined(__FAST_MATH__)
  abi_detail::put(r.flags, "fast-math ");
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
  abi_detail::put(r.flags, "finite-math-only ");
#endif
#if !defined(__cpp_exceptions)
  abi_detail::put(r.flags, "no-exceptions ");
#endif
#if !defined(__cpp_rtti)
  abi_detail::put(r.flags, "no-rtti ");
#endif
#if EIGEN_MALLOC_ALREADY_ALIGNED
  abi_detail::put(r.flags, "malloc-already-aligned ");
#endif
#if defined(EIGEN_DEFAULT_TO_ROW_MAJOR)
  abi_detail::put(r.flags, "row-major ");
#endif
  return r;
}

}  // namespace lockstep

/// Makes a shared library a plugin: exports the record of this build and the function that fills a registry.
///
///     LOCKSTEP_PLUGIN(registry) { registry.links.add<CamFollower>(); }
///
/// The function may throw an Error; then no type of the plugin is registered.
#define LOCKSTEP_PLUGIN(registry)                                                                       \
  extern "C" LOCKSTEP_API const lockstep_abi_record lockstep_abi;                                       \
  extern "C" LOCKSTEP_API constexpr lockstep_abi_record lockstep_abi = ::lockstep::abi_of_this_build(); \
  /* NOLINTNEXTLINE(bugprone-macro-parentheses): the name of a parameter */                             \
  extern "C" LOCKSTEP_API void lockstep_register_plugin(::lockstep::Registry& registry)
