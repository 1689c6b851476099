// SPDX-License-Identifier: BSD-3-Clause
#include "framework/hosts/python/bindings.h"

namespace lockstep::python {

void bind_analyses(py::module_&) {}

}  // namespace lockstep::python
