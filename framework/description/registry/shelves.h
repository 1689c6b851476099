// SPDX-License-Identifier: BSD-3-Clause
// The shelves of a registry, one after another.
#pragma once

#include <string>
#include <string_view>

#include <lockstep/author/registry.h>

namespace lockstep {

/// Calls use(name, kind, shelf) for each shelf: "translation_laws", "translation law", a pointer to the member.
template <class Use>
void for_each_shelf(Use&& use) {
  use("links", "link", &Registry::links);
  use("laws", "law", &Registry::laws);
  use("translation_laws", "translation law", &Registry::translation_laws);
  use("rotation_laws", "rotation law", &Registry::rotation_laws);
  use("forces", "force", &Registry::forces);
  use("integrators", "integrator", &Registry::integrators);
  use("solvers", "solver", &Registry::solvers);
}

/// "law" of "laws": the kind of the types on the shelf of this name; "" if there is no such shelf.
LOCKSTEP_API std::string kind_on(std::string_view shelf);

/// A type of the shelf of this name; null: there is no such type, or no such shelf.
LOCKSTEP_API const TypeInfo* find_type(const Registry&, std::string_view shelf, const std::string& type);

/// Kind and name of the types of this origin: {"joint", "cam_follower"}.
LOCKSTEP_API std::vector<std::pair<std::string, std::string>> things_of(const Registry&, const std::string& origin);

/// The shelf of the laws that a key of this form holds; "" if it holds none.
LOCKSTEP_API std::string_view shelf_of(Form);

}  // namespace lockstep
