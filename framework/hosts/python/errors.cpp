// SPDX-License-Identifier: BSD-3-Clause
// Errors become exceptions of lockstep.errors, findings become warnings.
#include <cmath>

#include "framework/hosts/python/bindings.h"

namespace lockstep::python {
namespace {

py::module_ python_errors() { return py::module_::import("lockstep.errors"); }

py::object text_or_none(const std::string& text) { return text.empty() ? py::object(py::none()) : py::str(text); }
py::object number_or_none(double x) { return std::isnan(x) ? py::object(py::none()) : py::float_(x); }
py::object count_or_none(int n) { return n == 0 ? py::object(py::none()) : py::int_(n); }

// The exception of a function of Python inside an error, with its traceback; null: there is none.
py::object cause_of(const Error& error) {
  try {
    std::rethrow_if_nested(error);
  } catch (py::error_already_set& inner) {
    if (inner.trace()) PyException_SetTraceback(inner.value().ptr(), inner.trace().ptr());
    return inner.value();
  } catch (const py::builtin_exception& inner) {  // of this module
    inner.set_error();
    return py::error_already_set().value();
  } catch (const Error& inner) {
    return cause_of(inner);
  } catch (...) {  // one of C++ is in the sentence
  }
  return {};
}

void raise(const Error& e) {
  py::object cause = cause_of(e);
  if (cause && PyErr_GivenExceptionMatches(cause.ptr(), PyExc_Exception) == 0) {  // KeyboardInterrupt, SystemExit
    PyErr_SetObject(py::type::of(cause).ptr(), cause.ptr());
    return;
  }
  const py::object made = python_errors().attr("error_of")(
      to_string(e.kind()), e.what(),
      py::dict(py::arg("thing") = text_or_none(e.thing.name), py::arg("thing_kind") = text_or_none(e.thing.kind),
               py::arg("key") = text_or_none(e.key), py::arg("value") = text_or_none(e.value),
               py::arg("problem") = text_or_none(e.problem), py::arg("advice") = text_or_none(e.advice),
               py::arg("file") = text_or_none(e.file), py::arg("line") = count_or_none(e.line),
               py::arg("column") = count_or_none(e.column), py::arg("t") = number_or_none(e.t)));
  if (cause) PyException_SetCause(made.ptr(), cause.release().ptr());
  PyErr_SetObject(py::type::of(made).ptr(), made.ptr());
}

py::object object_of(const Finding& f) {
  return python_errors().attr("Finding")(std::string(f.code()), to_string(f.severity()), text_or_none(f.thing),
                                         f.message, text_or_none(f.advice), number_or_none(f.value),
                                         number_or_none(f.limit), text_or_none(f.unit), number_or_none(f.t),
                                         text_or_none(f.place), f.text());
}

}  // namespace

py::list objects_of(const std::vector<Finding>& findings) { return listed(findings, object_of); }

void warn(const std::vector<Finding>& findings) {
  if (!findings.empty()) python_errors().attr("warn")(objects_of(findings));
}

void bind_errors(py::module_&) {
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const Error& e) {
      raise(e);
    }
  });
}

}  // namespace lockstep::python
