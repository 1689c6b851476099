// SPDX-License-Identifier: BSD-3-Clause
// What the files of the Python module share: one function for each of them, and conversions.
#pragma once

#include <cxxabi.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/finding.h>
#include <lockstep/math.h>
#include <lockstep/scene.h>
#include "framework/foundation/support/at_end.h"

namespace lockstep::python {

namespace py = pybind11;

void bind_errors(py::module_&);
void bind_jets(py::module_&);
void bind_types(py::module_&);
void bind_integrators(py::module_&);
void bind_simulation(py::module_&);
void bind_analyses(py::module_&);

/// Calls `act`, which uses Python. The interpreter exits threads that use it after its end, by unwinding, for which no run
/// is made: such a thread waits here for the end of the process.
template <class Act>
decltype(auto) outlasting(Act&& act) {
  try {
    return act();
  } catch (abi::__forced_unwind&) {
    for (;;) pause();
  }
}

/// Holds the interpreter's lock, in any thread, until what it returns is destroyed.
inline py::gil_scoped_acquire locked() {
  return outlasting([] { return py::gil_scoped_acquire(); });
}
/// Lends the lock, which this thread holds, to others until what it returns is destroyed, unless `keeps`.
inline auto lent_lock(bool keeps = false) {
  return AtEnd([state = keeps ? nullptr : PyEval_SaveThread()] {
    if (state != nullptr) outlasting([state] { PyEval_RestoreThread(state); });
  });
}

/// Looks for an interrupt (Ctrl-C) while something computes, and lends the lock to others, as often as the interpreter does.
class Turns {
 public:
  /// Throws KeyboardInterrupt.
  void take();

 private:
  std::chrono::steady_clock::time_point looked_{};
  std::chrono::duration<double> interval_{py::module_::import("sys").attr("getswitchinterval")().cast<double>()};
};

/// Calls a function of Python with these objects, and with keys if they are given.
template <class... Args>
py::object call(const py::handle& f, PyObject* keys, const Args&... args) {
  PyObject* const given[] = {args.ptr()..., nullptr};
  PyObject* const made = outlasting([&] { return PyObject_VectorcallDict(f.ptr(), given, sizeof...(args), keys); });
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(made);
}

/// Calls a function with a view and more; the view is empty after the call.
template <class View, class... More>
py::object call_with(const py::handle& f, View view, const More&... more) {
  const py::object seen = py::cast(view);
  const AtEnd end([&] { seen.cast<View&>() = {}; });
  return call(f, nullptr, seen, more...);
}

/// Shows the garbage collector what a T refers to: its references().
template <class T>
py::custom_type_setup collected() {
  return py::custom_type_setup([](PyHeapTypeObject* heap) {
    PyTypeObject& type = heap->ht_type;
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_dealloc = [](PyObject* self) { PyObject_GC_UnTrack(self), py::detail::pybind11_object_dealloc(self); };
    type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
      Py_VISIT(Py_TYPE(self));
      const auto held = reinterpret_cast<py::detail::instance*>(self)->get_value_and_holder();
      if (!held.holder_constructed()) return 0;
      for (const py::handle& each : held.template value_ptr<T>()->references()) Py_VISIT(each.ptr());
      return 0;
    };
  });
}

/// A Python object that C++ keeps: it may be released in any thread. The garbage collector does not see it.
class Held {
 public:
  explicit Held(py::object object)
      : object_(new py::object(std::move(object)), [](py::object* o) {
          if (Py_IsInitialized() == 0) return;  // the interpreter has ended, and the object with it
          const auto lock = locked();
          delete o;
        }) {}
  const py::object& operator*() const { return *object_; }
  const py::object* operator->() const { return object_.get(); }

 private:
  std::shared_ptr<py::object> object_;
};

/// The types that scenes name: those of the library, of plugins, and of Python functions, which it keeps. Copies share
/// the registry until one of them adds a type.
class Types {
 public:
  Types();
  const Registry& registry() const { return *registry_; }
  Registry& changed();
  void load_plugin(const std::string& name);
  /// Adds a Type of Python once, and returns its name.
  std::string add(const py::handle& type);
  bool has_functions() const { return !added_.empty(); }  ///< whether runs call Python
  /// Throws ModelError if derivatives of functions in the mechanism differ from differences of their values. Only the
  /// first mechanism of these types is checked.
  void check(Mechanism&) const;
  std::array<py::handle, 1> references() const { return {functions_}; }

 private:
  std::shared_ptr<Registry> registry_;
  std::shared_ptr<bool> checked_ = std::make_shared<bool>(false);
  std::map<PyObject*, std::string> added_;  // names of Types, and of functions that are laws
  py::list functions_;                      // those in registry_; each copy has a reference of its own
};

/// A piece of a scene from numbers, texts, lists, dictionaries and arrays. Functions and Types in it become types of
/// `types`. Throws TypeError for anything else, with its place.
Value value_of(const py::handle&, Types& types, const std::string& place = "scene");
/// The values of checked parameters by name, all numbers.
py::dict numbers_of(const Params&);

/// A list of what `object_of` makes of each.
template <class All, class ObjectOf>
py::list listed(const All& all, ObjectOf object_of) {
  py::list list;
  for (const auto& each : all) list.append(object_of(each));
  return list;
}

/// Findings as Python objects.
py::list objects_of(const std::vector<Finding>&);
/// Python warnings of findings above notes.
void warn(const std::vector<Finding>&);

/// Calls `act`, without the interpreter's lock unless `holds`, and returns its findings.
template <class Act>
std::vector<Finding> found_by(Act&& act, bool holds = false) {
  FindingScope scope;
  const auto others = lent_lock(holds);
  act();
  return std::move(scope.found);
}
/// The same; the findings become warnings of Python.
template <class Act>
void computing(Act&& act) {
  warn(found_by(std::forward<Act>(act)));
}

/// A quaternion as four numbers, the scalar first.
inline Eigen::Vector4d numbers_of(const Quat& q) { return {q.w, q.x, q.y, q.z}; }
/// Three numbers of a sequence or an array. Throws TypeError, naming `what`.
Vec3 vec3_of(const py::handle&, const char* what);

}  // namespace lockstep::python
