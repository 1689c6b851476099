// What a plugin includes. One line makes a shared library a plugin:
//
//   LOCKSTEP_PLUGIN(registry) { registry.links.add<CamFollower>(); }
#pragma once

#include <Eigen/Geometry>

#include "framework/mechanism/lock/phi_lock.h"
#include "framework/description/registry/abi.h"
#include "framework/description/registry/registry.h"
#include "framework/foundation/support/error.h"
#include "framework/foundation/support/text.h"

/// Exports the record of this build and the function that fills a registry. It may throw an Error; then nothing of the
/// plugin is taken.
#define LOCKSTEP_PLUGIN(registry)                                                                       \
  extern "C" LOCKSTEP_API const lockstep_abi_record lockstep_abi;                                       \
  extern "C" LOCKSTEP_API constexpr lockstep_abi_record lockstep_abi = ::lockstep::abi_of_this_build(); \
  extern "C" LOCKSTEP_API void lockstep_register_plugin(::lockstep::Registry& registry)
