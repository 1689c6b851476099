// SPDX-License-Identifier: BSD-3-Clause
// Types of scenes whose code is Python's: laws, joints and forces.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>

#include <lockstep/author/formula.h>
#include <lockstep/author/loader.h>
#include <lockstep/function_laws.h>
#include "framework/description/scene/system_of.h"
#include "framework/hosts/python/bindings.h"
#include "framework/tools/check/derivatives.h"
#include "framework/tools/simulation/host_types.h"

namespace lockstep::python {

namespace {

std::string shown(const py::handle& o) { return py::repr(o); }

/// A number that a function of Python returned, on jets or doubles. Throws TypeError, naming `what`.
template <class T>
T number_from(const py::handle& o, const char* what) {
  if (PyFloat_CheckExact(o.ptr())) return T(PyFloat_AS_DOUBLE(o.ptr()));
  if constexpr (!std::is_same_v<T, double>)
    if (py::isinstance<T>(o)) return o.cast<const T&>();
  if (PyNumber_Check(o.ptr()) != 0 && !py::hasattr(o, "gradient"))
    return T(py::float_(py::reinterpret_borrow<py::object>(o)).cast<double>());
  throw py::type_error(fmt::format("{} returned {}; give a number", what, shown(o)));
}

/// A function of Python, which Types keep, with the values of its further parameters.
class Function {
 public:
  Function(py::handle f, const Params& parameters) : f_(f) {
    const auto lock = locked();
    if (!parameters.keys().empty()) keys_.emplace(numbers_of(parameters));
  }
  template <class... Args>
  py::object operator()(const Args&... args) const {
    return call(f_, keys_ ? (*keys_)->ptr() : nullptr, args...);
  }

 private:
  py::handle f_;
  std::optional<Held> keys_;
};

// -- laws

/// A function of the time, which it gets as a jet: the object of the last call, unless the function kept it.
struct PythonLaw {
  Function f;
  mutable std::optional<Held> argument{};

  Time operator()(const Time& t) const {
    constexpr const char* kWhat = "the function of a law";
    const auto lock = locked();
    if (argument && (**argument).ref_count() == 1)
      (**argument).cast<Time&>() = t;
    else
      argument.emplace(py::cast(t));
    const py::object y = f(**argument);
    if (PyTuple_Check(y.ptr()) == 0 || PyTuple_GET_SIZE(y.ptr()) != 3) return number_from<Time>(y, kWhat);
    const auto level = [&](int k) { return number_from<double>(py::handle(PyTuple_GET_ITEM(y.ptr(), k)), kWhat); };
    return {level(0), level(1), level(2)};
  }
};

// -- joints

/// What a function of a joint sees of a pair; notes which coordinates it reads.
template <class T>
struct Coordinates {
  LockCoords<T> of;
  std::shared_ptr<unsigned> read{};  // null: nobody asks
  enum : unsigned { kTranslation = unsigned(Reads::translation), kRotation = unsigned(Reads::rotation), kAngle = 4 };
  unsigned known = kTranslation | kRotation | kAngle;  // what the joint computes
  void note(unsigned what) const {
    if (read) *read |= what;
    if ((what & ~known) != 0)
      throw ModelError(
          "a function of a joint reads a coordinate that it did not read in the pose in which the markers "
          "coincide; read all of its coordinates in every pose");
  }
};

template <class T>
void bind_coordinates(py::module_& m, const char* name) {
  using C = Coordinates<T>;
  py::class_<C> c(m, name,
                  "The pose of marker P relative to S: x, y, z (m), e0 ... e3, angle_z (rad) and the time t (s).");
  const auto one = [&](const char* of, T LockCoords<T>::*member, unsigned what) {
    c.def_property_readonly(of, [member, what](const C& y) { return y.note(what), y.of.*member; });
  };
  one("x", &LockCoords<T>::x, C::kTranslation), one("y", &LockCoords<T>::y, C::kTranslation);
  one("z", &LockCoords<T>::z, C::kTranslation), one("e0", &LockCoords<T>::e0, C::kRotation);
  one("e1", &LockCoords<T>::e1, C::kRotation), one("e2", &LockCoords<T>::e2, C::kRotation);
  one("e3", &LockCoords<T>::e3, C::kRotation), one("t", &LockCoords<T>::t, 0);
  c.def_property_readonly("angle_z", [](const C& y) { return y.note(C::kRotation | C::kAngle), y.of.angle_z(); });
}

/// The rows that a function of Python returned: one number, or n of them.
template <class T, int n>
auto rows_from(const py::object& rows) {
  constexpr const char* kWhat = "the function of a joint";
  if constexpr (n == 1) {
    return number_from<T>(rows, kWhat);
  } else {
    if (!py::isinstance<py::sequence>(rows) || py::len(rows) != n)
      throw py::type_error(fmt::format("{} returned {}; give its {} rows", kWhat, shown(rows), n));
    std::array<T, n> all;
    for (int k = 0; k < n; ++k) all[static_cast<std::size_t>(k)] = number_from<T>(rows[py::int_(k)], kWhat);
    return all;
  }
}

/// The rows of a function at coordinates. Not inlined: rows of a function are compiled flat, with all that they call.
template <int n, class T, class... More>
[[gnu::noinline]] auto called(const Function& f, unsigned known, const LockCoords<T>& first, const More&... more) {
  const auto lock = locked();
  return rows_from<T, n>(f(py::cast(Coordinates<T>{first, {}, known}), py::cast(Coordinates<T>{more, {}, known})...));
}

/// phi = a function of Python of the relative coordinates of its pairs.
template <int pairs, int n, Reads reads, bool counts>
struct PythonRows {
  Function f;
  static constexpr PhiSpec spec{.pairs = pairs, .rows = n, .reads = reads, .counts_turns = counts};
  template <class T, class... More>
  auto operator()(const LockCoords<T>& first, const More&... more) const {
    return called<n>(f, unsigned(reads) | (counts ? Coordinates<T>::kAngle : 0U), first, more...);
  }
};

/// How a joint of Python was declared.
struct JointSpec {
  std::string type, mask;
  int rows = 1;
};

/// Which coordinates a function reads: it is called once, in the pose in which the markers coincide. `turns`: whether it
/// may read rotations, if it cannot take that pose.
unsigned probe(const Function& f, bool turns) {
  using C = Coordinates<Time>;
  C y{{}, std::make_shared<unsigned>(0)};
  y.of.e0 = 1.0;
  const auto lock = locked();
  try {
    f(py::cast(y));
  } catch (py::error_already_set& error) {  // a pose that it cannot take
    if (!error.matches(PyExc_Exception)) throw;
    return C::kTranslation | (turns ? C::kRotation : 0U) | *y.read;
  }
  return *y.read;
}

template <int n>
std::unique_ptr<Lock> joint_of(const Attachment& a, const JointSpec& spec, const Function& f) {
  using C = Coordinates<Time>;
  const Mask mask = spec.mask.empty() ? Mask::none : mask_from(spec.mask);
  const auto joint = [&](auto phi) -> std::unique_ptr<Lock> {
    return std::make_unique<HostJoint<PhiLock<decltype(phi)>>>(spec.type, a.name, a.p(), a.s(), mask, std::move(phi));
  };
  const auto turns = [](const Marker& m) { return m.body->freedoms != Freedoms::particle; };
  const unsigned read = probe(f, turns(a.p()) && turns(a.s()));
  if ((read & C::kAngle) != 0) return joint(PythonRows<1, n, Reads::both, true>{f});
  if ((read & C::kRotation) != 0) return joint(PythonRows<1, n, Reads::both, false>{f});
  return joint(PythonRows<1, n, Reads::translation, false>{f});
}

std::unique_ptr<Lock> make_joint(const Attachment& a, const JointSpec& spec, Function f) {
  if (a.pairs.size() == 1)
    return spec.rows == 1   ? joint_of<1>(a, spec, f)
           : spec.rows == 2 ? joint_of<2>(a, spec, f)
                            : joint_of<3>(a, spec, f);
  if (spec.rows != 1)
    throw ModelError(fmt::format("joint '{}' has {} rows; a function of several pairs has one", a.name, spec.rows));
  using Two = PythonRows<2, 1, Reads::both, true>;
  using Three = PythonRows<3, 1, Reads::both, true>;
  if (a.pairs.size() == 2)
    return std::make_unique<HostJoint<PhiCoupling<Two>>>(spec.type, CoupledPairs(a), Two{std::move(f)});
  return std::make_unique<HostJoint<PhiCoupling<Three>>>(spec.type, CoupledPairs(a), Three{std::move(f)});
}

// -- forces

/// A marker in the world, as a function of a force sees it: numbers or jets.
template <class T>
struct MarkerView {
  Vec3T<T> x, v, w;
  Mat3T<T> A;
  explicit MarkerView(const MarkerOn<T>& m) : x(m.x()), v(m.v()), w(m.w()), A(m.A()) {}
};
template <class T>
struct EndsView {
  MarkerView<T> P, S;
  double t;
};

py::object as_array(const Vec3& v) { return py::cast(v); }
py::object as_array(const Mat3& A) { return py::cast(A); }
py::object as_objects(py::object list) {
  const py::module_ numpy = py::module_::import("numpy");
  return numpy.attr("array")(std::move(list), py::arg("dtype") = "object");
}
py::object as_array(const Vec3T<SlotJet>& v) { return as_objects(py::make_tuple(v[0], v[1], v[2])); }
py::object as_array(const Mat3T<SlotJet>& A) {
  py::list rows;
  for (int i = 0; i < 3; ++i) rows.append(py::make_tuple(A(i, 0), A(i, 1), A(i, 2)));
  return as_objects(std::move(rows));
}

template <class T>
void bind_ends(py::module_& m, const char* marker, const char* ends) {
  using M = MarkerView<T>;
  py::class_<M>(m, marker, "A marker in the world.")
      .def_property_readonly(
          "x", [](const M& a) { return as_array(a.x); }, "Origin, world, m.")
      .def_property_readonly(
          "v", [](const M& a) { return as_array(a.v); }, "Velocity of the origin, world, m/s.")
      .def_property_readonly(
          "w", [](const M& a) { return as_array(a.w); }, "Angular velocity, world, rad/s.")
      .def_property_readonly(
          "A", [](const M& a) { return as_array(a.A); }, "Rotation: marker axes to world axes.");
  py::class_<EndsView<T>>(m, ends, "The two markers of a force, and the time.")
      .def_readonly("P", &EndsView<T>::P, "Marker P.")
      .def_readonly("S", &EndsView<T>::S, "Marker S; the origin of the world without one.")
      .def_readonly("t", &EndsView<T>::t, "Time, s.");
}

template <class T>
Vec3T<T> vector_from(const py::handle& o, const char* what) {
  if (py::hasattr(o, "__len__") && py::len(o) == 3) {
    Vec3T<T> v;
    for (int k = 0; k < 3; ++k) v[k] = number_from<T>(py::reinterpret_borrow<py::object>(o)[py::int_(k)], what);
    return v;
  }
  throw py::type_error(fmt::format("{} is {}; give three numbers", what, shown(o)));
}

/// A force by a function of Python of its two markers. It returns the force on P's body at P (world, N), or a
/// dictionary of "force", "torque" (world, N m), "potential" (J) and "dissipation" (W).
class PythonForce final : public FormulaForce<PythonForce> {
 public:
  PythonForce(std::string type, const std::string& name, Marker& p, Marker* s, Function f)
      : FormulaForce(name, p, s), type_(std::move(type)), f_(std::move(f)) {}
  std::string_view type() const override { return type_; }

  template <class T, class Load>
  void act(const Ends<T>& at, Load& load) const {
    const auto lock = locked();
    const py::object made = f_(py::cast(EndsView<T>{MarkerView<T>(at.P), MarkerView<T>(at.S), at.t}));
    if (!py::isinstance<py::dict>(made)) return load.force(vector_from<T>(made, "the force"), at.P.x());
    for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(made)) {
      const std::string name = py::str(key);
      if (name == "force")
        load.force(vector_from<T>(value, "the force"), at.P.x());
      else if (name == "torque")
        load.torque(vector_from<T>(value, "the torque"));
      else if (name == "potential")
        load.stores(number_from<T>(value, "the potential"));
      else if (name == "dissipation")
        load.dissipates(number_from<T>(value, "the dissipation"));
      else
        throw py::key_error("a force returned \"" + name + "\"; known: force, torque, potential, dissipation");
    }
  }

 private:
  std::string type_;
  Function f_;
};

// -- registration

/// The keys of a Type: the further parameters of its function.
Keys keys_of(const py::object& type) {
  Keys keys;
  using Given = std::vector<std::pair<std::string, std::optional<double>>>;  // with their defaults
  for (const auto& [name, fallback] : type.attr("keys").cast<Given>())
    keys.push_back({name, Form::number, Unit::any, fallback ? Default(Value(*fallback)) : Default(kRequired),
                    "a parameter of the function"});
  return keys;
}

}  // namespace

py::dict numbers_of(const Params& p) {
  py::dict given;
  for (const Key& key : p.keys()) given[py::str(key.name)] = p.number(key.name);
  return given;
}

Types::Types() : registry_(std::make_shared<Registry>(builtin_registry())) {}

Registry& Types::changed() {
  if (registry_.use_count() > 1) {
    registry_ = std::make_shared<Registry>(*registry_);
    functions_ = py::list(functions_.attr("copy")());
  }
  return *registry_;
}

void Types::load_plugin(const std::string& name) { lockstep::load_plugin(changed(), name); }

void add_integrator(Registry&, const TypeInfo&, py::handle type);

std::string Types::add(const py::handle& given) {
  if (const auto at = added_.find(given.ptr()); at != added_.end()) return at->second;
  const py::object type = py::module_::import("lockstep.types").attr("type_of")(given);
  const auto kind = type.attr("kind").cast<std::string>();
  Registry& registry = changed();
  const auto is_taken = [&](const std::string& name) {
    return registry.laws.find(name) || registry.links.find(name) || registry.forces.find(name) ||
           registry.integrators.find(name);
  };
  const auto wanted = type.attr("name").cast<std::string>();
  std::string name = wanted;
  for (int k = 2; is_taken(name); ++k) name = fmt::format("{}_{}", wanted, k);
  const TypeInfo info{name, type.attr("help").cast<std::string>(), keys_of(type)};
  const py::handle f = py::object(type.attr("function"));
  if (kind == "law") {
    const auto breaks = type.attr("breaks").cast<std::vector<double>>();
    registry.laws.add(info, [f, breaks](const Params& p) { return laws::law(PythonLaw{Function(f, p)}, breaks); });
  } else if (kind == "joint") {
    const JointSpec spec{name, type.attr("mask").cast<std::string>(), type.attr("rows").cast<int>()};
    registry.links.add(info,
                       [f, spec](const Attachment& a, const Params& p) { return make_joint(a, spec, Function(f, p)); });
  } else if (kind == "force") {
    registry.forces.add(info, [f, name](const Attachment& a, const Params& p) -> std::unique_ptr<Force> {
      return std::make_unique<PythonForce>(name, a.name, p_of(a, p), has_s(a) ? &s_of(a, p) : nullptr, Function(f, p));
    });
  } else {
    add_integrator(registry, info, type);
  }
  functions_.append(type);
  added_.emplace(given.ptr(), name);
  checked_ = std::make_shared<bool>(false);
  return name;
}

void Types::check(Mechanism& m) const {
  if (*checked_ || !has_functions()) return;
  const auto is_own = [&](const Lock& link) {
    return std::ranges::any_of(added_, [&](const auto& type) { return type.second == link.type(); });
  };
  refuse_wrong_derivatives(system_of(m), m.run.until, is_own,
                           {"compute with t itself, not t.value, or return the value and both its rates",
                            "compute with the coordinates themselves, not their .value"});
  *checked_ = true;
}

void bind_types(py::module_& m) {
  bind_coordinates<Time>(m, "CoordinatesAlongTime");
  bind_coordinates<Jet<8>>(m, "Coordinates");
  bind_coordinates<Jet<4>>(m, "CoordinatesOfTranslation");
  bind_coordinates<Jet<14>>(m, "CoordinatesOfTwo");
  bind_coordinates<Jet<22>>(m, "CoordinatesOfThree");
  bind_ends<double>(m, "Marker", "Ends");
  bind_ends<SlotJet>(m, "MarkerOfJets", "EndsOfJets");
  py::class_<Types>(m, "Types", "The types that scenes name: those of the library, of plugins and of Python.",
                    collected<Types>())
      .def(py::init<>())
      .def("load_plugin", &Types::load_plugin, py::arg("name"), "Loads a plugin by its name or path.")
      .def("add", &Types::add, py::arg("type"), "Adds a law, joint, force or integrator of Python; returns its name.")
      .def(
          "names",
          [](const Types& types) {
            const Registry& r = types.registry();
            return py::dict(py::arg("laws") = py::cast(r.laws.names()), py::arg("joints") = py::cast(r.links.names()),
                            py::arg("forces") = py::cast(r.forces.names()),
                            py::arg("integrators") = py::cast(r.integrators.names()),
                            py::arg("solvers") = py::cast(r.solvers.names()));
          },
          "Names of all types, by kind.")
      .def("__copy__", [](const Types& types) { return types; });
}

}  // namespace lockstep::python
