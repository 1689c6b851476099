// SPDX-License-Identifier: BSD-3-Clause
// Pieces of scenes from Python objects.
#include <spdlog/fmt/fmt.h>

#include "framework/hosts/python/bindings.h"

namespace lockstep::python {
namespace {

bool is_type(const py::handle& o) { return py::isinstance(o, py::module_::import("lockstep.types").attr("Type")); }

Value object_from(const py::dict& members, Types& types, const std::string& place) {
  Value::Object all;
  for (const auto& [key, value] : members) {
    if (!py::isinstance<py::str>(key))
      throw py::type_error(
          fmt::format("{}: the key {} is no text; keys of a scene are texts", place, std::string(py::repr(key))));
    const std::string name = py::str(key);
    const bool names_type = name == "type" && (is_type(value) || PyCallable_Check(value.ptr()) != 0);
    all.push_back({name, names_type ? Value(types.add(value)) : value_of(value, types, place + "." + name), {}});
  }
  return all;
}

}  // namespace

Value value_of(const py::handle& o, Types& types, const std::string& place) {
  if (Py_EnterRecursiveCall(" in a scene") != 0) throw py::error_already_set();
  const AtEnd leave(&Py_LeaveRecursiveCall);
  static const py::handle numpy_bool = py::object(py::module_::import("numpy").attr("bool_")).release();
  const bool is_array = py::isinstance<py::array>(o);
  if (is_array && py::reinterpret_borrow<py::array>(o).ndim() == 0) return value_of(o[py::tuple()], types, place);
  if (o.is_none()) return {};
  if (py::isinstance<py::bool_>(o) || py::isinstance(o, numpy_bool)) return PyObject_IsTrue(o.ptr()) != 0;
  if (py::isinstance<py::str>(o)) return o.cast<std::string>();
  if (py::isinstance<py::dict>(o)) return object_from(py::reinterpret_borrow<py::dict>(o), types, place);
  if (is_type(o)) return Value::object({{"type", types.add(o)}});
  if (PyNumber_Check(o.ptr()) != 0 && !py::hasattr(o, "__len__")) {
    const double x = PyFloat_AsDouble(o.ptr());
    if (PyErr_Occurred() == nullptr) return x;
    PyErr_Clear();
  }
  if (PyCallable_Check(o.ptr()) != 0) return Value::object({{"type", types.add(o)}});  // a function of time
  if ((py::isinstance<py::sequence>(o) && PyObject_CheckBuffer(o.ptr()) == 0) || is_array) {
    Value::List items;
    for (const py::handle item : py::reinterpret_borrow<py::object>(o))
      items.push_back(value_of(item, types, fmt::format("{}[{}]", place, items.size())));
    return items;
  }
  throw py::type_error(
      fmt::format("{}: {} cannot be a part of a scene; give a number, a text, a list, a dictionary or a function",
                  place, std::string(py::repr(py::type::of(o)))));
}

Vec3 vec3_of(const py::handle& o, const char* what) {
  const auto a = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(o);
  if (!a || a.size() != 3) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{} is {}; give three numbers", what, std::string(py::repr(o))));
  }
  return {a.data()[0], a.data()[1], a.data()[2]};
}

}  // namespace lockstep::python
