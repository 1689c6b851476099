// SPDX-License-Identifier: BSD-3-Clause
#include "framework/hosts/python/bindings.h"

namespace lockstep::python {
void add_integrator(Registry&, const TypeInfo&, const Held&) {}
void bind_integrators(py::module_&) {}

}  // namespace lockstep::python
