// SPDX-License-Identifier: BSD-3-Clause
#include "framework/hosts/python/simulation.h"

#include <pybind11/functional.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/assembly.h>
#include "framework/description/scene/reading.h"
#include "framework/mechanism/params/read.h"

namespace lockstep::python {

namespace {

Mechanism mechanism_of(const py::object& source, Types& types, const Settings& set, const Settings& record,
                       ReportText& text, Settings& recorded) {
  Scene scene = scene_of(source, types);
  text.title = scene.title, text.description = scene.description;
  const bool places = scene.run.record.empty();  // are recorded if nothing else is
  Mechanism mechanism;
  const Registry& registry = types.registry();
  computing([&] { mechanism = read_mechanism(std::move(scene), registry, set); });
  types.check(mechanism);
  if (places && !record.empty()) mechanism.run.record.clear();
  for (const auto& [name, channel] : record) mechanism.run.record.push_back({channel, name, {}});
  text.panels = mechanism.run.draw;
  for (const ChannelRequest& r : mechanism.run.record) recorded.emplace_back(r.column(), r.channel);
  for (const auto& [name, channel] : recorded)
    if (name != channel) text.channels.emplace_back(name, channel);
  return mechanism;
}

py::dict pose_of(const Body& body, const State& state) {
  const Pose p = body_pose(body, state);
  const Twist o = body_twist(body, state);
  return py::dict(py::arg("x") = p.x, py::arg("q") = numbers_of(p.q), py::arg("v") = o.v, py::arg("w") = o.w);
}

/// A state as functions of events see it: during their call only.
struct StateView {
  const State* state = nullptr;
  const System* system = nullptr;
  State* changed = nullptr;  // null: it may be read only
  const State& get() const {
    if (state == nullptr)
      throw ModelError("a state is used after the call that it was given to; copy numbers out of it");
    return *state;
  }
  py::dict body(const std::string& name) const {
    const State& at = get();
    return pose_of(system->body(name), at);
  }
  void set_twist(const std::string& name, const py::object& v, const py::object& w) const {
    if (get(), changed == nullptr) throw ModelError("the state of a condition is read only; change it in \"change\"");
    const Body& of = system->body(name);
    Twist twist = body_twist(of, *state);
    if (!v.is_none()) twist.v = vec3_of(v, "v");
    if (!w.is_none()) twist.w = vec3_of(w, "w");
    StateEditor(*changed).set_twist(of, twist);
  }
};

/// What a condition returned. Throws TypeError for a truth value, and for what is no number.
double passing(const py::object& y) {
  py::detail::make_caster<bool> truth;
  py::detail::make_caster<double> number;
  if (truth.load(y, false) || !number.load(y, true))
    throw py::type_error("the condition is " + std::string(py::repr(y)) +
                         "; return a number that passes zero, such as y - 0");
  return py::detail::cast_op<double>(number);
}

// `when`: None, or a function that passes zero. `change`: None, or a function that changes the state.
void add_event(Run& run, std::string name, const py::object& when, std::optional<double> at,
               const std::string& crossing, bool stop, bool once, std::vector<std::string> activate,
               std::vector<std::string> deactivate, const py::object& change, double tolerance) {
  static const std::map<std::string, Event::Crossing> words{
      {"rising", Event::Crossing::rising}, {"falling", Event::Crossing::falling}, {"any", Event::Crossing::any}};
  const auto word = words.find(crossing);
  if (word == words.end()) throw py::value_error("crossing is \"" + crossing + "\"; must be rising, falling or any");
  for (const EventCourse& other : run.simulation().loop().event_courses())
    if (other.name == name) throw ModelError("there is an event \"" + name + "\"; give another name");
  Event e;
  e.name = std::move(name), e.crossing = word->second, e.tolerance = tolerance, e.once = once, e.stop = stop;
  e.activate = std::move(activate), e.deactivate = std::move(deactivate);
  if (at) e.at = *at;
  if (!when.is_none())
    e.value = [f = py::handle(when)](const Sample& s) {
      const auto lock = locked();
      return passing(call_with(f, StateView{&s.state, &s.system()}));
    };
  if (!change.is_none())
    e.change = [f = py::handle(change), &run](State& s) {
      const auto lock = locked();
      call_with(f, StateView{&s, &run.simulation().system(), &s});
    };
  run.functions.append(when), run.functions.append(change);
  run.simulation().add_event(std::move(e));
}

}  // namespace

ReadScene::ReadScene(const py::object& source, Types given) : types(std::move(given)), scene(scene_of(source, types)) {
  computing([&, &registry = types.changed()] { scene = with_values(std::move(scene), registry, {}); });
}

std::pair<std::vector<double>, std::string> ReadScene::quantities(const std::string& name,
                                                                  const std::string& texts) const {
  const Variable v = read_variable(name + "=" + texts, scene, types.registry());
  std::vector<double> numbers;
  for (const Value& value : v.values) numbers.push_back(value.number() != nullptr ? *value.number() : NAN);
  return {std::move(numbers), v.unit};
}

Scene scene_of(const py::object& source, Types& types) {
  if (py::isinstance<ReadScene>(source)) return source.cast<const ReadScene&>().scene;
  if (py::isinstance<py::dict>(source)) return scene_from(value_of(source, types), "scene.json");
  if (!py::isinstance<py::str>(source) && !py::isinstance<py::bytes>(source) && !py::hasattr(source, "__fspath__"))
    throw py::type_error("the scene is " + std::string(py::repr(source)) +
                         "; give a path, a JSON text, a dictionary or a Mechanism");
  const py::object path = py::module_::import("os").attr("fspath")(source);
  const auto text = path.cast<std::string>();
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '{') return scene_from_text(text, "scene.json");
  return read_scene(text);
}

Run::Run(const py::object& source, Types given, const Settings& set, const Settings& record, bool with_report)
    : types(std::move(given)), simulation_([&] {
        Mechanism mechanism = mechanism_of(source, types, set, record, text, recorded);
        std::vector<Solid> solids = mechanism.solids;
        std::vector<Look> looks = mechanism.looks;
        std::optional<Simulation> made;
        computing([&] { made.emplace(std::move(mechanism)); });
        made->recorder().find_extremes();
        if (with_report) report.emplace(made->recorder(), std::move(solids), std::move(looks));
        return std::move(*made);
      }()) {}

void Turns::take() {
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < interval_) return;
  looked_ = now;
  if (PyGILState_Check() != 0) const auto others = lent_lock();
  const auto lock = locked();
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

bool Run::goes_on() {
  if (on_step) {
    const auto lock = locked();
    between_steps_ = true;
    const AtEnd over([this] { between_steps_ = false, now_.reset(); });
    const py::object given = call(py::object(on_step), nullptr);
    if (!given.is_none() && !py::bool_(given)) return false;
  }
  turns_.take();
  return true;
}

void Run::begin() {
  simulation();
  if (begun) return;
  alone([&] {
    simulation().loop().progress = [this](const State&) { return goes_on(); };
    if (report) simulation().add_observer(*report);
  });
  begun = true;
}

void Run::warn_once(std::vector<Finding> findings) {
  std::erase_if(findings,
                [this](const Finding& f) { return !warned_.insert(std::string(f.code()) + " " + f.thing).second; });
  warn(findings);
}

void Run::take_rows_back() {
  if (!rows_) return;
  Table table = rows_.use_count() == 1 ? std::move(*rows_) : *rows_;
  rows_.reset();
  simulation().recorder().exchange(table);
}

Simulation& Run::simulation() {
  if (runner_ != std::thread::id{} && runner_ != std::this_thread::get_id())
    throw ModelError("the simulation is in use in another thread; wait for it, or make one for each thread");
  return simulation_;
}

py::list columns_of(const std::shared_ptr<Table>& rows, std::span<const ColumnRange> ranges) {
  py::list all;
  for (std::size_t k = 0; k < rows->n_columns(); ++k) {
    const Column& c = rows->columns()[k];
    const py::capsule keeps(new std::shared_ptr<Table>(rows),
                            [](void* p) { delete static_cast<std::shared_ptr<Table>*>(p); });
    py::array_t<double> values(static_cast<py::ssize_t>(c.values.size()), c.values.data(), keeps);
    values.attr("flags").attr("writeable") = false;
    py::object range = py::none();
    if (k > 0 && k <= ranges.size()) {
      const ColumnRange& r = ranges[k - 1];
      range = py::make_tuple(r.least, r.t_least, r.most, r.t_most, r.resolved);
    }
    all.append(py::make_tuple(c.name, c.unit, std::move(values), std::move(range)));
  }
  return all;
}

py::list Run::columns() {
  const bool runs = runner_ != std::thread::id{};
  std::shared_ptr<Table> rows = rows_;
  if (!rows && runs) {
    rows = std::make_shared<Table>(simulation().table());
  } else if (!rows) {
    rows = rows_ = std::make_shared<Table>();
    for (const Column& c : simulation().table().columns()) rows->add_column(c.name, c.unit);
    simulation().recorder().exchange(*rows);
  }
  return columns_of(rows, simulation().recorder().ranges());
}

std::pair<double, std::string> Run::value(const std::string& name) {
  if (simulation(), runner_ != std::thread::id{} && !between_steps_)
    throw ModelError("\"" + name +
                     "\" cannot be read inside a step; read it in on_step, or between the calls of the run");
  auto known = channels_.find(name);
  if (known == channels_.end()) {
    const auto own = std::ranges::find(recorded, name, &Settings::value_type::first);
    Channel made = make_channel(simulation_.system(), own == recorded.end() ? name : own->second);
    if (made.memory || made.of_motion)
      throw ModelError("\"" + name + "\" depends on the motion before; read its column of the table");
    known = channels_.emplace(name, std::move(made)).first;
  }
  begin();
  double value = 0;
  alone([&] {
    if (!now_) now_.emplace(simulation_.dynamics(), simulation_.state(), none_);
    value = known->second.value(*now_);
  });
  return {value, known->second.unit};
}

std::string Run::report_page() {
  if (!report) throw ModelError("the run has no report; make it by Simulation(..., report=True)");
  take_rows_back();
  text.findings = simulation().verdict().findings;
  return report->page(text);
}

void bind_simulation(py::module_& m) {
  m.def(
      "seconds", [](const std::string& text) { return read_number(text, Unit::time, "the time"); },
      "A time of a text with a unit, s.");
  py::class_<StateView>(m, "State", "A state of a run, valid during the call of the function of an event.")
      .def_property_readonly(
          "t", [](const StateView& s) { return s.get().t; }, "Time, s.")
      .def("body", &StateView::body, py::arg("name"),
           "Pose and twist of a body: x (m), q (scalar first), v (m/s), w (body axes, rad/s).")
      .def("set_twist", &StateView::set_twist, py::arg("name"), py::arg("v") = py::none(), py::arg("w") = py::none(),
           "In a change: sets the velocity of a body's origin (world, m/s) and its angular velocity (body axes, "
           "rad/s).");

  py::class_<ReadScene>(m, "Scene", "A scene that was read once, for many runs: a source, and types that it names.",
                        collected<ReadScene>())
      .def(py::init([](const py::object& source, const std::optional<Types>& types) {
             const bool is_made = py::hasattr(source, "scene");  // by a builder
             return ReadScene(is_made ? py::object(source.attr("scene")()) : source, types ? *types : Types());
           }),
           py::arg("source"), py::arg("types") = py::none())
      .def_property_readonly(
          "types", [](const ReadScene& s) { return s.types; }, "The types that it names.")
      .def("quantities", &ReadScene::quantities, py::arg("name"), py::arg("texts"),
           "Values for a name of the scene from texts with commas, in SI, and their unit; NaN for words.");
  py::class_<Run>(m, "Run", collected<Run>())
      .def(py::init([](const py::object& source, const Types& types, const Settings& set, const Settings& record,
                       bool report) { return std::make_unique<Run>(source, types, set, record, report); }))
      .def("record",
           [](Run& r, const Settings& channels) {
             std::vector<Request> requests;
             for (const auto& [name, channel] : channels) requests.emplace_back(name, channel);
             r.simulation(), r.take_rows_back();
             r.simulation().record(std::move(requests));
             r.recorded.insert(r.recorded.end(), channels.begin(), channels.end());
           })
      .def("begin", &Run::begin)
      .def("until", [](Run& r, double t) { r.advancing([&] { r.simulation().run_until(t); }), r.judge(); })
      .def("run", [](Run& r) { r.advancing([&] { r.simulation().run(); }), r.judge(); })
      .def("advance", [](Run& r, double h) { r.advancing([&] { r.simulation().advance(h); }), r.judge(); })
      .def("step",
           [](Run& r, double h) {
             StepReport made;
             r.advancing([&] { made = r.simulation().loop().step(h); });
             r.judge();
             return made.h;
           })
      .def("value", &Run::value)
      .def_readonly("begun", &Run::begun)
      .def("columns", &Run::columns)
      .def_property_readonly("title", [](const Run& r) { return r.text.title; })
      .def_property_readonly("t", [](Run& r) { return r.simulation().state().t; })
      .def("body",
           [](Run& r, const std::string& name) {
             return pose_of(r.simulation().system().body(name), r.simulation().state());
           })
      .def("inputs",
           [](Run& r) {
             return listed(r.simulation().system().control_inputs(), [](const ControlInput& i) { return i.name(); });
           })
      .def("input", [](Run& r, const std::string& name) { return r.simulation().input(name).value(); })
      .def("set_input", [](Run& r, const std::string& name,
                           double value) { r.advancing([&] { r.simulation().input(name).set(value); }); })
      .def("activate", [](Run& r, const std::string& name) { r.advancing([&] { r.simulation().activate(name); }); })
      .def("deactivate", [](Run& r, const std::string& name) { r.advancing([&] { r.simulation().deactivate(name); }); })
      .def("add_event", &add_event)
      .def("set_on_step", [](Run& r, const py::object& f) { r.on_step = f.is_none() ? py::object() : f; })
      .def("save", [](Run& r, const std::string& file) { r.advancing([&] { r.simulation().save(file); }); })
      .def("load", [](Run& r, const std::string& file) { r.advancing([&] { r.simulation().load(file); }); })
      .def("findings", [](Run& r) { return objects_of(r.simulation().verdict().findings); })
      .def_property_readonly("steps", [](Run& r) { return r.simulation().loop().report().steps; })
      .def_property_readonly("stopped_by", [](Run& r) { return r.simulation().loop().report().stopped_by; })
      .def("channels",
           [](Run& r) {
             r.simulation().loop();
             return listed(channel_help(r.simulation().system()),
                           [](const ChannelHelp& c) { return py::make_tuple(c.name, c.unit, c.help); });
           })
      .def("report_page", &Run::report_page);
}

}  // namespace lockstep::python
