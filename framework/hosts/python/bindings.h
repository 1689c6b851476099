// SPDX-License-Identifier: BSD-3-Clause
// What the files of the Python module share: one function for each of them, and conversions.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/finding.h>
#include <lockstep/math.h>

namespace lockstep::python {

namespace py = pybind11;

void bind_errors(py::module_&);
void bind_jets(py::module_&);
void bind_types(py::module_&);
void bind_integrators(py::module_&);
void bind_simulation(py::module_&);
void bind_analyses(py::module_&);

/// A Python object that C++ keeps: it may be released in any thread.
class Held {
 public:
  explicit Held(py::object object)
      : object_(new py::object(std::move(object)), [](py::object* o) {
          if (Py_IsInitialized() == 0) return;  // the interpreter has ended, and the object with it
          const py::gil_scoped_acquire lock;
          delete o;
        }) {}
  const py::object& operator*() const { return *object_; }
  const py::object* operator->() const { return object_.get(); }

 private:
  std::shared_ptr<py::object> object_;
};

/// The types that scenes name: those of the library, of plugins, and of Python functions. Copies share the registry until
/// one of them adds a type.
class Types {
 public:
  Types();
  const Registry& registry() const { return *registry_; }
  Registry& changed();
  void load_plugin(const std::string& name);
  /// Adds a Type of Python once, and returns its name.
  std::string add(const py::handle& type);
  bool has_functions() const { return !added_.empty(); }  ///< whether runs call Python

 private:
  std::shared_ptr<Registry> registry_;
  std::map<PyObject*, std::pair<std::string, Held>> added_;
};

/// A piece of a scene from numbers, texts, lists, dictionaries and arrays. Functions and Types in it become types of
/// `types`. Throws TypeError for anything else, with its place.
Value value_of(const py::handle&, Types& types, const std::string& place = "scene");
/// The values of checked parameters by name, all numbers.
py::dict numbers_of(const Params&);

/// Findings as Python objects.
py::list objects_of(const std::vector<Finding>&);
/// Python warnings of findings above notes.
void warn(const std::vector<Finding>&);

/// Calls `act`, without the interpreter's lock unless `holds`, and returns its findings.
template <class Act>
std::vector<Finding> found_by(Act&& act, bool holds = false) {
  FindingScope scope;
  std::exception_ptr error;
  {
    std::optional<py::gil_scoped_release> unlocked;
    if (!holds) unlocked.emplace();
    try {
      act();
    } catch (...) {
      error = std::current_exception();
    }
  }
  if (error) std::rethrow_exception(error);
  return std::move(scope.found);
}
/// The same; the findings become warnings of Python.
template <class Act>
void computing(Act&& act) {
  warn(found_by(std::forward<Act>(act)));
}

/// A vector as an array of three numbers.
inline py::array_t<double> array_of(const Vec3& v) { return py::array_t<double>(3, v.data()); }
/// A vector of numbers as an array of its own.
inline py::array_t<double> array_of(const VecX& v) { return py::array_t<double>(v.size(), v.data()); }
/// A matrix as an array of rows.
template <class M>
py::array_t<double> matrix_of(const M& m) {
  py::array_t<double> a({m.rows(), m.cols()});
  auto at = a.template mutable_unchecked<2>();
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) at(i, j) = m(i, j);
  return a;
}
/// Three numbers of a sequence or an array. Throws TypeError, naming `what`.
Vec3 vec3_of(const py::handle&, const char* what);

}  // namespace lockstep::python
