// SPDX-License-Identifier: BSD-3-Clause
// Jets in Python: numbers with exact derivatives, on which functions of Python are evaluated as those of C++ are.
#include <pybind11/operators.h>
#include <spdlog/fmt/fmt.h>

#include <lockstep/author/formula.h>
#include <lockstep/author/jet.h>
#include "framework/hosts/python/bindings.h"

namespace lockstep::python {
namespace {

// Operators with a jet and with a number on either side, and the functions that numpy calls of objects: numpy.sin(jet) is
// jet.sin().
template <class J>
void bind_jet(py::module_& m, const char* name) {
  py::class_<J> jet(m, name, "A number with its exact derivatives.");
  jet.def(py::init<double>(), py::arg("value"))
      .def_readonly("value", &J::v)
      .def_property_readonly("gradient", [](const J& a) { return VecX(a.g); })
      .def("__float__",
           [](const J& a) -> double {
             throw py::type_error(
                 fmt::format("a jet of value {} became a plain number, which has no derivatives; call the functions of "
                             "lockstep or numpy, not those of math",
                             a.v));
           })
      .def("__repr__", [](const J& a) { return fmt::format("Jet({})", a.v); })
      .def(py::self + py::self)
      .def(py::self - py::self)
      .def(py::self * py::self)
      .def(py::self / py::self)
      .def(py::self + double())
      .def(double() + py::self)
      .def(py::self - double())
      .def(double() - py::self)
      .def(py::self * double())
      .def(double() * py::self)
      .def(py::self / double())
      .def(double() / py::self)
      .def(
          "__pow__",
          [](const J& a, double p) {
            return p == 0 ? J(1) : p == 1 ? a : p == 2 ? a * a : p == 0.5 ? sqrt(a) : pow(a, p);
          },
          py::is_operator())
      .def(
          "__pow__", [](const J& a, const J& b) { return exp(b * log(a)); }, py::is_operator())
      .def(
          "__rpow__", [](const J& a, double b) { return exp(std::log(b) * a); }, py::is_operator())
      .def("__neg__", [](const J& a) { return -a; })
      .def("__pos__", [](const J& a) { return a; })
      .def("__abs__", [](const J& a) { return abs(a); });
  if constexpr (!std::same_as<J, SlotJet>)
    jet.def_property_readonly("rate", [](const J& a) { return a.d; }).def_property_readonly("second", [](const J& a) {
      return a.h;
    });
  const auto compare = [&](const char* op, auto with) {
    jet.def(
        op, [with](const J& a, const J& b) { return with(a.v, b.v); }, py::is_operator());
    jet.def(
        op, [with](const J& a, double b) { return with(a.v, b); }, py::is_operator());
  };
  compare("__lt__", std::less<>());
  compare("__le__", std::less_equal<>());
  compare("__gt__", std::greater<>());
  compare("__ge__", std::greater_equal<>());
  compare("__eq__", std::equal_to<>());
  compare("__ne__", std::not_equal_to<>());
  const auto function = [&](const char* of, J (*f)(const J&)) { jet.def(of, f); };
  function("sqrt", [](const J& a) { return sqrt(a); });
  function("sin", [](const J& a) { return sin(a); });
  function("cos", [](const J& a) { return cos(a); });
  function("tan", [](const J& a) { return tan(a); });
  function("exp", [](const J& a) { return exp(a); });
  function("log", [](const J& a) { return log(a); });
  function("sinh", [](const J& a) { return sinh(a); });
  function("cosh", [](const J& a) { return cosh(a); });
  function("tanh", [](const J& a) { return tanh(a); });
  function("arctan", [](const J& a) { return atan(a); });
  function("arcsin", [](const J& a) { return asin(a); });
  function("arccos", [](const J& a) { return acos(a); });
  function("conjugate", [](const J& a) { return a; });  // numpy.vdot
  jet.def("arctan2", [](const J& y, const J& x) { return atan2(y, x); });
  jet.def("arctan2", [](const J& y, double x) { return atan2(y, J(x)); });
}

}  // namespace

void bind_jets(py::module_& m) {
  bind_jet<Time>(m, "TimeJet");
  m.attr("TimeJet").attr("__doc__") = "A number with its first and second derivative by time: the argument of a law.";
  bind_jet<Jet<8>>(m, "Jet");
  bind_jet<Jet<4>>(m, "JetOfTranslation");
  bind_jet<Jet<14>>(m, "JetOfTwo");
  bind_jet<Jet<22>>(m, "JetOfThree");
  bind_jet<SlotJet>(m, "SlotJet");
}

}  // namespace lockstep::python
