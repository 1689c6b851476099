// SPDX-License-Identifier: BSD-3-Clause
// A registry as a handle.
#pragma once

#include <lockstep/author/registry.h>
#include "framework/hosts/c/handle.h"

namespace lockstep::c {

struct RegistryObject final : Object {
  Registry registry;
};

}  // namespace lockstep::c
