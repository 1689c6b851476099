// SPDX-License-Identifier: BSD-3-Clause
// A plugin with tables that few have: versions of its own, both hash tables, packed relocations (tests/CMakeLists.txt
// says so to the linker), a variable of each thread, and functions that run when it is opened and closed.
#include <string>

#include <lockstep/author/plugin.h>

namespace {

thread_local std::string last_name = "none";
std::string all_names;

struct Still final : lockstep::MotionLaw {
  static lockstep::TypeInfo info() { return {"tables_law", "always 1", {}}; }
  static lockstep::LawPtr<lockstep::MotionLaw> make(const lockstep::Params&) {
    all_names += last_name = "tables_law";
    return std::make_shared<Still>();
  }
  lockstep::LawValue at(double) const override { return {1, 0, 0}; }
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.laws.add<Still>(); }
