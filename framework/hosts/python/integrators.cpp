// SPDX-License-Identifier: BSD-3-Clause
// Integrators of Python: a step of given length, from rates of the mechanism at states.
#include <pybind11/operators.h>
#include <spdlog/fmt/fmt.h>

#include <lockstep/dynamics.h>
#include "framework/dynamics/simulate/user_code.h"
#include "framework/hosts/python/bindings.h"
#include "framework/tools/simulation/host_types.h"

namespace lockstep::python {

namespace {

/// Throws ValueError unless rates have the sizes of a state, or of other rates.
template <class T>
void check_sizes(const T& of, const StateRate& k) {
  if (k.q.size() != of.q.size() || k.v.size() != of.v.size() || k.s.size() != of.s.size())
    throw py::value_error(
        fmt::format("rates of another mechanism: {}, {} and {} numbers of q, v and s; here are {}, {} and {}",
                    k.q.size(), k.v.size(), k.s.size(), of.q.size(), of.v.size(), of.s.size()));
}

StateRate sum(const StateRate& a, const StateRate& b) {
  check_sizes(a, b);
  return {a.q + b.q, a.v + b.v, a.s + b.s};
}
StateRate times(const StateRate& a, double k) { return {k * a.q, k * a.v, k * a.s}; }

/// The mechanism as a step sees it: during the step only.
struct SystemView {
  Dynamics* dynamics = nullptr;
  StateRate rates(const State& at) const {
    if (dynamics == nullptr) throw ModelError("the system of an integrator is used after its step");
    StateRate k = sized_like(at);
    const auto others = lent_lock();
    dynamics->rate(at, k);
    return k;
  }
};

/// A method of fixed steps, an object of a class of Python.
class PythonIntegrator final : public HostIntegrator {
 public:
  PythonIntegrator(const std::string& name, int order, const Held& method)
      : HostIntegrator(name, order,
                       [=](Dynamics& dynamics, State& y, double h) {
                         user_code("integrator", name, y.t, [&] { y = ended(name, method, dynamics, y, h); });
                       }),
        method_(method) {}
  void begin(Dynamics&, const State& y) override {
    user_code("integrator", info().name, y.t, [&] {
      const auto lock = locked();
      if (py::hasattr(*method_, "begin")) call(method_->attr("begin"), nullptr);
    });
  }
  bool saves_all() const override { return false; }

 private:
  static State ended(const std::string& name, const Held& method, Dynamics& dynamics, const State& y, double h) {
    const auto lock = locked();
    const py::object made = call_with(method->attr("step"), SystemView{&dynamics}, py::cast(y), py::float_(h));
    if (!py::isinstance<State>(made))
      throw py::type_error(fmt::format("step() of integrator '{}' returned {}; return the new state", name,
                                       std::string(py::repr(made))));
    State end = made.cast<State>();
    if (end.q.size() != y.q.size() || end.v.size() != y.v.size() || end.s.size() != y.s.size())
      throw ModelError(fmt::format("integrator '{}' returned a state of other sizes", name));
    return end;
  }

  Held method_;
};

template <VecX State::*part>
void set_part(State& y, const py::array_t<double, py::array::c_style | py::array::forcecast>& values) {
  if (values.size() != (y.*part).size())
    throw py::value_error(fmt::format("{} numbers are given; the state has {}", values.size(), (y.*part).size()));
  std::copy_n(values.data(), values.size(), (y.*part).data());
}

}  // namespace

void add_integrator(Registry& registry, const TypeInfo& info, py::handle type) {
  const int order = type.attr("order").cast<int>();
  registry.integrators.add(info, [name = info.name, order, type](const Params& p) -> std::unique_ptr<Integrator> {
    const auto lock = locked();
    return std::make_unique<PythonIntegrator>(name, order, Held(type.attr("function")(**numbers_of(p))));
  });
}

void bind_integrators(py::module_& m) {
  py::class_<StateRate>(m, "Rates", "Time derivatives of a state; they add, and are multiplied by numbers.")
      .def("__add__", &sum, py::is_operator())
      .def(
          "__sub__", [](const StateRate& a, const StateRate& b) { return sum(a, times(b, -1)); }, py::is_operator())
      .def("__mul__", &times, py::is_operator())
      .def("__rmul__", &times, py::is_operator())
      .def(
          "__truediv__", [](const StateRate& a, double k) { return times(a, 1 / k); }, py::is_operator())
      .def("__neg__", [](const StateRate& a) { return times(a, -1); })
      .def_property_readonly(
          "q", [](const StateRate& k) { return k.q; }, "7 per rigid group: m/s, 1/s.")
      .def_property_readonly(
          "v", [](const StateRate& k) { return k.v; }, "6 per rigid group: m/s^2, rad/s^2.")
      .def_property_readonly(
          "s", [](const StateRate& k) { return k.s; }, "Of the integrated states.");
  py::class_<State>(m, "MechanismState", "Positions and velocities of a mechanism, for integrators.")
      .def_readonly("t", &State::t, "Time, s.")
      .def_property(
          "q", [](const State& y) { return y.q; }, &set_part<&State::q>,
          "7 per rigid group: centre of mass (world, m), quaternion (scalar first).")
      .def_property(
          "v", [](const State& y) { return y.v; }, &set_part<&State::v>,
          "6 per rigid group: velocity (world, m/s), angular velocity (own axes, rad/s).")
      .def_property(
          "s", [](const State& y) { return y.s; }, &set_part<&State::s>, "Integrated states.")
      .def("__copy__", [](const State& y) { return y; })
      .def(
          "moved",
          [](const State& y, double h, const StateRate& k) {
            check_sizes(y, k);
            State end = y;
            end.t += h, end.q += h * k.q, end.v += h * k.v, end.s += h * k.s;
            return end;
          },
          py::arg("h"), py::arg("rates"), "The state after h, s, at constant rates.");
  py::class_<SystemView>(m, "System", "The mechanism in a step of an integrator.")
      .def("rates", &SystemView::rates, py::arg("state"), "Solves the equations of motion at a state.");
}

}  // namespace lockstep::python
