// SPDX-License-Identifier: BSD-3-Clause
// The module lockstep._core: what of the library Python calls. The package around it is in lockstep/.
#include <lockstep/version.h>
#include "framework/hosts/python/bindings.h"

PYBIND11_MODULE(_core, m) {
  namespace python = lockstep::python;
  m.doc() = "The compiled part of lockstep.";
  m.attr("version") = lockstep::kVersion;
  python::bind_errors(m);
  python::bind_jets(m);
  python::bind_types(m);
  python::bind_integrators(m);
  python::bind_simulation(m);
  python::bind_analyses(m);
}
