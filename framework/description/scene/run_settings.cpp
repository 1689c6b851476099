// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/reading.h"

#include <algorithm>
#include <functional>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/mechanism/expression/expression.h"
#include "framework/mechanism/params/refusals.h"

namespace lockstep {
namespace {

// "rk4" or {"type": "rk4", keys}.
MethodSpec read_typed(const Params& run, const std::string& key, const MethodSpec& fallback) {
  const Value& v = run.value(key);
  if (v.is_null() && !run.has(key)) return fallback;
  if (v.text() != nullptr) return {*v.text(), Value(Value::Object{}), v.where};
  const Value* type = v.find("type");
  if (type == nullptr || type->text() == nullptr)
    run.refuse(key, "expected a name, or {\"type\": name, and its keys}, got " + shown(v));
  return {*type->text(), v.without({"type"}), type->where};
}

void read_stabilization(const Params& run, Stabilization& s, Refusals& wrong) {
  const Value& v = run.value("stabilization");
  if (!run.has("stabilization")) return;
  const Keys& keys = scene_table("stabilization").info.keys;
  if (v.object() == nullptr) {
    s.kind = stabilization_from(read_choice(v, keys.front().choices, "run.stabilization"));
    return;
  }
  const Params p = params_under(run, "stabilization", "stabilization");
  s.kind = stabilization_from(p.text("kind"));
  s.alpha = p.number("alpha"), s.beta = p.number("beta");
  for (const char* rate : {"alpha", "beta"})
    wrong.attempt([&] {
      if (p.number(rate) < 0) p.refuse(rate, "the rate is " + text::brief(p.number(rate)) + " 1/s; it must be >= 0");
    });
  wrong.attempt([&] { s.tolerance = positive(p, "tolerance", "tolerance"); });
}

std::vector<double> read_times(const Params& run) {
  if (!run.has("times")) return {};
  if (run.has("output"))
    run.refuse("times", "\"output\" and \"times\" both define the recorded times; remove one of the two");
  const std::vector<double> times = run.numbers("times");
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] < 0)
      run.refuse("times", "time " + text::number(times[i]) + " s is before the start at 0 s; remove it");
    if (i > 0 && times[i] <= times[i - 1])
      run.refuse("times", "times must rise, but " + text::number(times[i]) + " s follows " +
                              text::number(times[i - 1]) + " s; sort them");
  }
  return times;
}

void add_request(std::vector<ChannelRequest>& all, ChannelRequest request, const std::string& owner) {
  const std::string column = request.column();
  if (column.empty() || request.channel.empty())
    refuse(request.where, owner, "the name of a channel is empty; give it one");
  if (std::any_of(column.begin(), column.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
    refuse(request.where, owner, "the name of a column contains a line end or another control character; remove it");
  if (std::ranges::find(all, column, &ChannelRequest::column) != all.end())
    refuse(request.where, owner, "column \"" + column + "\" is requested twice; rename one of them");
  all.push_back(std::move(request));
}

// Texts, and objects of texts by name. `what`: "channel's name".
std::vector<ChannelRequest> read_requests(const Value::List& items, const std::string& owner, const std::string& what) {
  std::vector<ChannelRequest> all;
  Refusals wrong;
  for (const Value& item : items) {
    if (item.object() != nullptr)
      for (const Value::Member& m : *item.object())
        wrong.attempt([&] {
          add_request(all, {read_text(m.value, owner + "." + m.key), m.key, m.value.where}, owner);
        });
    else
      wrong.attempt([&] {
        if (item.text() == nullptr)
          refuse(item.where, owner,
                 "expected a " + what + " or {\"own name\": \"" + what.substr(0, what.find('\'')) + "\"}, got " +
                     shown(item));
        add_request(all, {*item.text(), "", item.where}, owner);
      });
  }
  wrong.raise();
  return all;
}

// A name of a column, or "t". A formula that is not recorded becomes a column.
std::string column_named(const Value& v, const std::string& owner, std::vector<ChannelRequest>& record) {
  std::vector<std::string> known{"t"};
  for (const ChannelRequest& r : record) known.push_back(r.column());
  const std::string name = read_text(v, owner);
  if (std::ranges::find(known, name) != known.end()) return name;
  if (!name.starts_with('='))
    refuse(v.where, owner, "\"" + name + "\" is not recorded" + text::suggestion(name, known));
  record.push_back({name, "", v.where});
  return name;
}

// A panel: names of columns.
std::vector<std::string> read_panel(const Value& panel, std::vector<ChannelRequest>& record, Refusals& wrong) {
  if (panel.list() == nullptr)
    refuse(panel.where, "run.draw", "expected a panel as a list of recorded names, got " + shown(panel));
  if (panel.list()->empty())
    refuse(panel.where, "run.draw", "this panel is empty; name a recorded channel, or remove it");
  std::vector<std::string> names;
  for (const Value& item : *panel.list())
    wrong.attempt([&] { names.push_back(column_named(item, "run.draw", record)); });
  return names;
}

// The settings with known names and valid forms; errors of the others are kept.
Value sound_settings(const Value& v, Refusals& wrong) {
  Refusals here;
  here.attempt([&] { params_of(v, "run", "run", nullptr); });
  if (here.empty()) return v;
  wrong.attempt([&] { here.raise(); });
  Value::Object sound;
  for (const Value::Member& m : v.object() != nullptr ? *v.object() : Value::Object{}) {
    Refusals alone;
    alone.attempt([&] { check_members(Value::Object{m}, "run", {&scene_table("run").info.keys}, "run"); });
    const bool again = std::ranges::any_of(sound, [&](const Value::Member& other) { return other.key == m.key; });
    if (alone.empty() && !again) sound.push_back(m);
  }
  Value rest(std::move(sound));
  rest.where = v.where;
  return rest;
}

void read_methods(const Params& p, RunSettings& run, Refusals& wrong) {
  wrong.attempt([&] { run.integrator = read_typed(p, "integrator", run.integrator); });
  wrong.attempt([&] { run.solver = read_typed(p, "solver", run.solver); });
  wrong.attempt([&] { read_stabilization(p, run.stabilization, wrong); });
  run.formulation = formulation_from(p.text("formulation"));
  if (p.has("solver") && !p.has("formulation")) run.formulation = Formulation::omega;  // joint coordinates need none
  if (run.formulation == Formulation::quaternion && !p.has("solver")) run.solver.type = "sparse";
  run.assemble = p.boolean("assemble");
  run.nearly_redundant = nearly_redundant_from(p.text("nearly_redundant"));
}

void read_clock(const Params& p, RunSettings& run, Refusals& wrong) {
  const auto take = [&](const char* key, const char* what, double& to) {
    if (p.has(key)) wrong.attempt([&] { to = positive(p, key, what); });
  };
  take("step", "step", run.step);
  wrong.attempt([&] {
    if (!p.has("until")) return;
    const double until = p.number("until");
    if (!(until >= 0)) p.refuse("until", "the end of the run is " + text::number(until) + " s; it must be >= 0");
    run.until = until;
  });
  take("output", "interval", run.output);
  run.at_jumps = p.boolean("at_jumps");
  wrong.attempt([&] { run.times = read_times(p); });
  wrong.attempt([&] {
    if (p.has("max_steps") && (run.max_steps = p.integer("max_steps")) < 1)
      p.refuse("max_steps", "the limit must be at least 1 step");
  });
}

void read_limits(const Params& p, RunSettings& run, Refusals& wrong) {
  wrong.attempt([&] {
    placed(p.value("tolerance").where, "run.tolerance", [&] { run.tolerance = tolerance_of(p.number("tolerance")); });
  });
  wrong.attempt([&] { run.limits.energy = positive(p, "energy_limit", "limit"); });
  wrong.attempt([&] {
    if (p.has("violation_limit")) run.limits.violation = positive(p, "violation_limit", "limit");
  });
}

// Of the object "run", which may be null. `record`: what it records.
RunOutputs read_outputs(const Value& run, std::vector<ChannelRequest>& record) {
  RunOutputs out;
  const Params p = params_of(run, "run", "run", nullptr);
  out.units = p.text("headers") == "units";
  const Value::List& pictures = items_of(p, "pictures");
  Refusals wrong;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    wrong.attempt([&] {
      const Params picture = params_of(pictures[i], "picture", item("run.pictures", i), nullptr);
      PictureRequest& to = out.pictures.emplace_back();
      wrong.attempt([&] { to.x = column_named(picture.value("x"), part_of(picture.owner(), "x"), record); });
      wrong.attempt([&] { to.y = column_named(picture.value("y"), part_of(picture.owner(), "y"), record); });
    });
  wrong.raise();
  return out;
}

}  // namespace

RunOutputs outputs_of(const Scene& scene) {
  const Value* run = scene.root.find("run");
  std::vector<ChannelRequest> record = scene.run.record;
  return run != nullptr ? read_outputs(*run, record) : RunOutputs{};
}

RunSettings read_run(const Value& v) {
  RunSettings run;
  run.where = v.where;
  Refusals wrong;
  const Value sound = sound_settings(v, wrong);
  const Params p = params_of(sound, "run", "run", nullptr);
  read_methods(p, run, wrong);
  read_clock(p, run, wrong);
  read_limits(p, run, wrong);
  bool recorded = false;
  wrong.attempt([&] {
    run.record = read_requests(items_of(p, "record", "a list of channels"), "run.record", "channel's name");
    recorded = (v.find("record") == nullptr) == (sound.find("record") == nullptr);
  });
  if (recorded) {  // else errors of these may follow from that of "record"
    wrong.attempt([&] {
      for (const Value& panel : items_of(p, "draw", "a list of panels, each a list of recorded names"))
        wrong.attempt([&] { run.draw.push_back(read_panel(panel, run.record, wrong)); });
    });
    wrong.attempt([&] { read_outputs(sound, run.record); });
  }
  wrong.raise();
  return run;
}

namespace {

// The parameter or point that a formula reads by a name, or by that of a component; null if there is none.
const SceneParameter* parameter_named(const std::string& name, const Scene& scene) {
  for (const SceneParameter& p : scene.parameters) {
    const std::size_t component = p.value.list() != nullptr && name.starts_with(p.name + ".") ? 2 : 0;  // ".x"
    if (name.size() == p.name.size() + component && name.starts_with(p.name)) return &p;
  }
  return nullptr;
}

std::string is_both(const ChannelRequest& r, const SceneParameter& p) {
  const auto at = [](const SourceLocation& where) { return where.line > 0 ? " (" + where.text() + ")" : ""; };
  return "\"" + r.column() + "\" is both a " + (p.is_point ? "point" : "parameter") + at(p.written.where) +
         " and a recorded column" + at(r.where) + "; rename one of them, or read the column as '" + r.column() + "'";
}

}  // namespace

std::string without_columns(std::string column, const Scene& scene, std::size_t n) {
  static const std::vector<std::string> kTime{"t"};
  const std::vector<ChannelRequest>& record = scene.run.record;
  const auto named = [&](const std::string& name) {
    return std::size_t(std::ranges::find(record, name, &ChannelRequest::column) - record.begin());
  };
  if (!column.starts_with('=')) return named(column) < record.size() ? record[named(column)].channel : column;
  const expression::Expression e(column, kTime, expression::Naming::channels);
  std::vector<expression::Node> names = e.nodes();
  std::erase_if(names, [](const expression::Node& node) { return node.operation != expression::Operation::name; });
  std::ranges::sort(names, std::greater(), &expression::Node::at);
  for (const expression::Node& node : names) {
    const std::string name = expression::without_quotes(node.name);
    const std::size_t k = named(name);
    if (k == record.size() || name == "pi") continue;
    const std::string& channel = record[k].channel;
    const SceneParameter* const own = node.name == name ? parameter_named(name, scene) : nullptr;
    if (own != nullptr && k != n && channel != "=" + name) e.refuse(node, is_both(record[k], *own));
    if (own == nullptr && k < n && channel != name)
      column.replace(node.at, node.name.size(),
                     channel.starts_with('=') ? "(" + channel.substr(1) + ")" : "'" + channel + "'");
  }
  return column;
}

std::vector<ChannelRequest> read_require(const Params& scene) {
  return read_requests(items_of(scene, "require", "a list of conditions"), "scene.require", "condition");
}

namespace {

void check_condition(const ChannelRequest& r) {
  const std::string text = "\"" + r.column() + "\"";
  if (!r.channel.starts_with('=')) throw ModelError(text + " is no formula; write \"=" + r.channel + "\"");
  const expression::Expression e(r.channel, std::vector<std::string>{"t"}, expression::Naming::channels);
  int node = e.root();
  while (e.node(node).operation == expression::Operation::choose) node = e.node(node).children[1];
  if (!expression::is_condition(e.node(node).operation))
    throw ModelError(text + " is a quantity, no condition; compare it, as in \"" + r.column() + " < 1\"");
}

}  // namespace

void read_columns(Scene& scene) {
  Refusals wrong;
  std::size_t n = 0;  // columns that may be read
  const auto read = [&](ChannelRequest& r) {
    const std::string column = r.column(), channel = without_columns(r.channel, scene, n);
    if (channel != r.channel) r.channel = channel, r.name = column;
  };
  for (ChannelRequest& r : scene.run.record) {
    if (r.channel.starts_with('=')) wrong.attempt([&] { placed(r.where, "run.record", [&] { read(r); }); });
    ++n;
  }
  for (ChannelRequest& r : scene.run.require)
    wrong.attempt([&] { placed(r.where, "scene.require", [&] { read(r), check_condition(r); }); });
  wrong.raise();
}

Stabilization::Kind stabilization_from(const std::string& word) {
  if (word == "baumgarte") return Stabilization::Kind::baumgarte;
  return word == "none" ? Stabilization::Kind::none : Stabilization::Kind::project;
}

NearlyRedundant nearly_redundant_from(std::string_view word) {
  if (word == "auto") return NearlyRedundant::automatic;
  if (word == "report") return NearlyRedundant::reported;
  if (word == "free") return NearlyRedundant::free;
  if (word == "held") return NearlyRedundant::held;
  throw ModelError("nearly_redundant is '" + std::string(word) + "'; it must be auto, report, free or held");
}

std::unique_ptr<Integrator> make_integrator(const RunSettings& run, const Registry& registry) {
  auto method =
      placed(run.integrator.where, [&] { return make_integrator(run.integrator, registry, "run.integrator"); });
  if (!method->info().adaptive && run.step <= 0)
    refuse(run.integrator.where.line > 0 ? run.integrator.where : run.where, "run.integrator",
           "\"" + run.integrator.type +
               "\" has fixed steps and no step is given; add \"step\" to \"run\", as in \"step\": 0.001");
  method->set_tolerance(run.tolerance);
  return method;
}

std::unique_ptr<LinearSolver> make_solver(const RunSettings& run, const Registry& registry) {
  return placed(run.solver.where, [&] { return make_solver(run.solver, registry, "run.solver"); });
}

}  // namespace lockstep
