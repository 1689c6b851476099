// The reference of scenes as a page: every object, type, key, form and unit.
#pragma once

#include <string>

#include <lockstep/author/registry.h>
#include <lockstep/detail/export.h>

namespace lockstep {

/// In Markdown; types of plugins that the registry has stand beside the others.
LOCKSTEP_API std::string scene_reference(const Registry&);

}  // namespace lockstep
