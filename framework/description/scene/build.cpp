// SPDX-License-Identifier: BSD-3-Clause
// build_mechanism(): makes the parts of a scene in order, and what those parts share.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <map>

#include <lockstep/author/integrator.h>
#include <lockstep/author/loader.h>
#include <lockstep/text.h>
#include "framework/description/registry/law_units.h"
#include "framework/description/registry/shelves.h"
#include "framework/description/scene/builder.h"
#include "framework/description/scene/reading.h"
#include "framework/description/scene/tree.h"
#include "framework/dynamics/simulate/along_laws.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/expression/function.h"
#include "framework/mechanism/expression/scope.h"
#include "framework/mechanism/system/rows_at_start.h"

namespace lockstep {
namespace {

constexpr double kMostGravity = 300;  // m/s^2; the Sun's is 274
constexpr double kFarCenter = 30;     // distances of its joints

// Whether the value names one of these things, or what such a thing brings with it ("A.friction", "A.x@B").
bool names_one(const Value& v, const std::set<std::string, std::less<>>& names) {
  bool named = false;
  for_each_child(v, [&](const Value& each, const std::string& key) {
    named = named || (key != "name" && names_one(each, names));
  });
  if (v.text() == nullptr) return named;
  const std::string_view word = *v.text();
  const std::size_t at = word.find('@');
  return names.contains(word.substr(0, word.find_first_of(".@"))) ||
         (at != std::string_view::npos && names.contains(word.substr(at + 1)));
}

}  // namespace

std::string owner_of(const std::string& kind, const std::string& name) {
  return (kind == "link" ? "joint" : kind) + " '" + name + "'";
}

std::string owner_of(const std::string& kind, const Value& object, const std::string& list, std::size_t index) {
  if (const std::string* name = text_under(object, "name")) return owner_of(kind, *name);
  return (list == "links" ? "joints" : list) + "[" + std::to_string(index) + "]";
}

Params params_of(const Value& object, const std::string& table, const std::string& owner, const Registry* laws) {
  const SceneTable& of = scene_table(table);
  return placed(object.where, [&] {
    check_members(object, of.info.name, {&of.info.keys}, owner);
    return with_laws(Params::part({std::shared_ptr<const void>(), &object}, of.keys(), owner), laws);
  });
}

Params params_under(const Params& parent, const std::string& key, const std::string& table) {
  return params_of(parent.value(key), table, part_of(parent.owner(), key), nullptr);
}

const Value::List& items_of(const Params& parent, const std::string& key, const std::string& expected) {
  static const Value::List kNone;
  if (!parent.has(key)) return kNone;
  const Value& v = parent.value(key);
  if (v.list() == nullptr) parent.refuse(key, "expected " + expected + ", got " + shown(v));
  return *v.list();
}

std::vector<std::pair<std::string, SourceLocation>> texts_of(const Params& parent, const std::string& key) {
  std::vector<std::pair<std::string, SourceLocation>> texts;
  for (const Value& item : items_of(parent, key, "a list of texts"))
    texts.emplace_back(read_text(item, part_of(parent.owner(), key)), item.where);
  return texts;
}

double positive(const Params& p, const std::string& key, const std::string& what) {
  const double x = p.number(key);
  if (!(x > 0)) p.refuse(key, "the " + what + " is " + plain_text(p.value(key)) + "; it must be greater than 0");
  return x;
}

const Value* refused_value(const Value& v, const ErrorData& error) {
  const auto is_there = [&](const SourceLocation& where) {
    return where.line > 0 && where.line == error.line && where.column == error.column;
  };
  const auto within = [&](const Value& each) { return is_there(each.where) ? &each : refused_value(each, error); };
  if (const Value::List* items = v.list())
    for (const Value& each : *items)
      if (const Value* found = within(each)) return found;
  if (const Value::Object* members = v.object())
    for (const Value::Member& m : *members)
      if (const Value* found = is_there(m.where) ? &m.value : within(m.value)) return found;
  return nullptr;
}

// `read`: what was being read; null: an error without a place.
void SceneErrors::note(const Value& read, const SceneError* error) {
  if (error != nullptr && is_own(read, *error)) refusals_.add(*error);
  if (const std::string* name = text_under(read, "name"); name != nullptr && !stand_ins_.contains(*name))
    failed_.insert(*name);
}

// Not what follows from the failure of another thing.
bool SceneErrors::is_own(const Value& read, const SceneError& error) const {
  if (misnamed_ && !error.value.empty() && error.advice.find("known: ") != std::string::npos) return false;
  if (const Value* at = refused_value(read, error)) return !names_one(*at, failed_);
  return !names_one(read, failed_) && !names_one(read, stand_ins_);
}

bool Builder::is_taken(const std::string& kind, const std::string& name) const {
  const Names& taken = taken_[kind == "event"];
  const auto found = taken.find(name);
  return found != taken.end() && found->second.first == kind;
}

std::vector<std::string> Builder::names(std::initializer_list<std::string> kinds) const {
  std::vector<std::string> all;
  for (const std::string& kind : kinds) {
    for (const auto& [name, by] : taken_[kind == "event"])
      if (by.first == kind) all.push_back(name);
    if (kind == "body") all.push_back("ground");
  }
  return all;
}

std::string Builder::claim(const Value& name, const std::string& kind) {
  if (!errors_.attempt(Value(), [&] { check_name(*name.text(), name.where, kind); }))
    return errors_.misname(), unnamed();
  taken_[kind == "event"][*name.text()] = {kind, name.where};
  return *name.text();
}

std::string Builder::unnamed() { return "(unnamed " + std::to_string(++n_unnamed_) + ")"; }

void Builder::check_name(const std::string& name, const SourceLocation& where, const std::string& kind) const {
  const std::string owner = owner_of(kind, name);
  if (name.empty()) refuse(where, owner, "the name is empty; give it one");
  for (const char c : name)
    if (std::string_view(".@,[]\"'").find(c) != std::string_view::npos || static_cast<unsigned char>(c) < 0x20)
      refuse(
          where, owner,
          "a name with '" + std::string(1, c) + "' would be ambiguous in channels; use letters, digits, '_' and '-'");
  static const std::vector<std::string> kReserved = {"ground", "energy", "momentum", "angular_momentum", "solver"};
  if (std::find(kReserved.begin(), kReserved.end(), name) != kReserved.end())
    refuse(where, owner, "the name \"" + name + "\" is reserved; choose another");
  const Names& taken = taken_[kind == "event"];
  if (const auto found = taken.find(name); found != taken.end()) {
    const std::string place = found->second.second.text();
    refuse(where, owner,
           "the name is already taken by " + owner_of(found->second.first, name) +
               (place.empty() ? "" : " at " + place) + "; rename one of the two");
  }
}

void Builder::all(const Params& root, const std::string& list, const std::string& kind, Act make, Act failed) {
  errors_.attempt(root.value(list), [&] {
    const Value::List& things = items_of(root, list);
    for (std::size_t i = 0; i < things.size() && !errors_.full(); ++i)
      errors_.attempt(things[i], [&] {
        const std::string owner = owner_of(kind, things[i], list, i);
        try {
          (this->*make)(things[i], owner);
        } catch (const SceneError&) {
          if (failed != nullptr) (this->*failed)(things[i], owner);
          throw;
        }
      });
  });
}

void Builder::set_gravity(const Params& root) {
  const Vec3 g = root.vector3("gravity");
  system_.set_gravity(g);
  if (g.norm() < kMostGravity) return;
  report_finding({.kind = &finding::implausible,
                  .thing = "scene",
                  .message = fmt::format("gravity is {:.4g} m/s^2; that of the Earth is 9.81", g.norm()),
                  .advice = "check the units of the scene: numbers without a unit are in m, kg and s",
                  .value = g.norm(),
                  .limit = kMostGravity,
                  .unit = "m/s^2",
                  .place = root.value("gravity").where.text()});
}

// Of a body whose joints are close together, compared with their distance from its centre of mass.
void Builder::doubt_centers() const {
  std::map<const Body*, std::vector<Vec3>> joints;  // of a body, in its frame
  for (const auto& link : system_.links())
    if (link->jointed() != nullptr)
      for (const Marker* m : {link->pairs().front().first, link->pairs().front().second})
        if (!m->body->fixed) joints[m->body].push_back(m->local.x);
  for (const Body& body : system_.bodies()) {
    const std::vector<Vec3>& points = joints[&body];
    double span = 0, nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& x : points) {
      nearest = std::min(nearest, (x - body.mass.center).norm());
      for (const Vec3& y : points) span = std::max(span, (x - y).norm());
    }
    if (span > kSlight * nearest && nearest > kFarCenter * span)
      report_finding({.kind = &finding::implausible,
                      .thing = owner_of("body", body.name),
                      .message = fmt::format("body '{}': its centre of mass is {:.4g} m from its joints, which are "
                                             "{:.4g} m apart",
                                             body.name, nearest, span),
                      .advice = "check the units: numbers without a unit are in m",
                      .value = nearest,
                      .limit = kFarCenter * span,
                      .unit = "m",
                      .place = taken_[0].at(body.name).second.text()});
  }
}

// The input of a law: that of the name, or a new one.
InputScope::Reader Builder::input(const std::string& name, double value) {
  std::deque<ControlInput>& all = system_.control_inputs();
  const auto at = std::ranges::find(all, name, &ControlInput::name);
  const ControlInput& input = at != all.end() ? *at : system_.add_input(name, value);
  if (input.value() != value)
    throw ModelError(
        fmt::format("input '{}' is {} here and {} in another law; give one value", name, value, input.value()));
  return [&input] { return input.value(); };
}

void Builder::build() {
  const InputScope scope([this](const std::string& name, double value) { return input(name, value); });
  const Params root = params_of(scene_.root, "scene", "scene", &registry_);
  set_gravity(root);
  define_numbers();
  out_.run = scene_.run;
  all(root, "bodies", "body", &Builder::body, &Builder::stand_in);
  all(root, "markers", "marker", &Builder::marker, nullptr);
  all(root, "links", "link", &Builder::link, &Builder::note_sides);
  all(root, "forces", "force", &Builder::force, &Builder::note_sides);
  all(root, "events", "event", &Builder::event, nullptr);
  const Value of_no_thing;  // what "run" records or draws of a thing that failed is no matter here
  errors_.attempt(of_no_thing, [&] { make_integrator(out_.run, registry_); });
  errors_.attempt(of_no_thing, [&] { make_solver(out_.run, registry_); });
  errors_.attempt(of_no_thing, [&] { check_assembled(); });
  errors_.attempt(of_no_thing, [&] { check_requirements(); });
  if (!errors_.empty() && also_) also_(out_, errors_);
  errors_.raise();
  doubt_centers();
  set_merge(root.text("merge"));
  set_up(root);
}

// Parameters, points and tables, for formulas of channels.
void Builder::define_numbers() {
  for (const std::string key : {"parameters", "points", "tables"}) {
    const Value* const object = scene_.root.find(key);
    if (object == nullptr) continue;
    for (NamedNumbers& n : expression::read_constants(*object, part_of("scene", key))) {
      if (key == "tables") {
        const Value& law = *object->find(n.name);
        const std::string place = part_of("scene.tables", n.name);
        if (std::ranges::find(system_.defined(), n.name, &NamedNumbers::name) != system_.defined().end())
          refuse(law.where, place, "a parameter, a point or another table has this name; choose another one");
        n.table = registry_.scalar_law(law, place), n.values.clear();
      }
      system_.define(std::move(n));
    }
  }
}

// Those of numbers alone; those of channels are looked at during runs.
void Builder::check_requirements() const {
  expression::Scope scope;
  scope.add(system_.defined());
  for (const ChannelRequest& r : out_.run.require) {
    const expression::Expression e(r.channel, {}, expression::Naming::channels);
    const std::vector<std::string> names = expression::names_in(e);
    const auto is_number = [&](const std::string& n) {
      return n == "pi" || (scope.find(n) != nullptr && !scope.find(n)->table);
    };
    if (!std::ranges::all_of(names, is_number)) continue;
    placed(r.where, "scene.require", [&] {
      const auto amount = [&](const std::string& n) { return n == "pi" ? nullptr : &scope.find(n)->amount; };
      if (expression::evaluate(e, amount).v[0] != 0) return;
      std::string words;
      for (const std::string& n : names)
        if (n != "pi") words += (words.empty() ? "; " : ", ") + n + " = " + expression::words_of(scope.find(n)->amount);
      throw ModelError("\"" + r.column() + "\" does not hold" + words + "; change them, or the condition",
                       {.thing = {.kind = "requirement", .name = r.column()}});
    });
  }
}

// Initial conditions of joints need assembly.
void Builder::check_assembled() const {
  if (out_.run.assemble) return;
  const std::string link = !out_.start_speeds.empty()           ? out_.start_speeds.front().link
                           : !out_.assembly.coordinates.empty() ? out_.assembly.coordinates.front().link
                                                                : "";
  if (!link.empty())
    refuse(out_.run.where, "run.assemble",
           "it is false, but joint '" + link +
               "' has a \"start\", which needs assembly; remove \"assemble\", or give poses and velocities of bodies");
}

void Builder::set_merge(const std::string& how) {
  if (how != "auto") return;
  std::vector<std::string> named;  // channels, joints and forces
  const auto name = [&](const std::string& column) {
    for (std::string& channel : expression::channels_in(column)) named.push_back(std::move(channel));
  };
  for (const ChannelRequest& r : out_.run.record) name(r.channel);
  for (const EventRequest& e : out_.events) {
    name(e.channel);
    for (const auto* names : {&e.event.activate, &e.event.deactivate})
      named.insert(named.end(), names->begin(), names->end());
  }
  std::vector<const Lock*> keep;
  for (const auto& link : system_.links())
    if (std::ranges::any_of(named, [&](const std::string& text) {
          return text == link->name() || text.starts_with(link->name() + ".");
        }))
      keep.push_back(link.get());
  system_.set_merge(true, std::move(keep));
}

// The tree of joint coordinates of the mechanism as it is set now, for the decision on the plane; null: the run uses
// none, or by itself only in the plane.
std::shared_ptr<const JointTree> Builder::tree() const {
  const Formulation formulation = out_.run.formulation;
  if (formulation != Formulation::joint && formulation != Formulation::automatic) return nullptr;
  const std::unique_ptr<Integrator> method = make_integrator(out_.run, registry_);
  if (!method->info().joint) return nullptr;
  system_.setup();
  const Taken taken = formulation == Formulation::joint ? Taken::all : Taken::trees;
  std::shared_ptr<const JointTree> tree = lay_out_tree(system_, system_.start().modes, taken).tree;
  return takes(*method, method->info(), tree.get()) ? tree : nullptr;
}

// A start speed of a joint out of the plane, of a system that is set up in it; null if there is none.
const VelocityTarget* Builder::start_out_of(Plane plane) const {
  for (const VelocityTarget& start : out_.start_speeds) {
    const Vec3 normal = MarkerFrame(*system_.link(start.link).pairs().front().second).A0.row(plane.n);
    if (start.value != 0 && !axis_stays_in_plane(start.axis, normal)) return &start;
  }
  return nullptr;
}

// The plane of a mechanism that moves in one, unless a formulation works in space, or joints alone keep it in a plane.
// `asked`: the scene asks for it, and the plane is preferred.
void Builder::choose_plane(bool asked) {
  if (!asked && out_.run.formulation == Formulation::quaternion) return;
  const std::shared_ptr<const JointTree> in_space = asked ? nullptr : tree();
  if (in_space && in_space->planar() && !in_space->has_rows()) return;  // coordinates are as few as in a plane
  const Plane found = settle_in_plane(system_, [&](Plane plane) { return start_out_of(plane) == nullptr; });
  // Joint coordinates in space are kept rather than a plane without them.
  if (found && in_space && !tree()) system_.set_planar({});
}

// Errors of the System name a body, joint or force: its place in the file is put before them.
void Builder::set_up(const Params& root) {
  const std::string normal = root.text("planar");
  try {
    if (normal == "auto")
      choose_plane(root.has("planar"));
    else if (normal != "off")
      system_.set_planar(Plane{normal[0] - 'x'});
    system_.setup();
    const VelocityTarget* out = normal.size() == 1 ? start_out_of(system_.plane()) : nullptr;
    if (out != nullptr)
      throw ModelError({.thing = {.kind = "joint", .name = out->link},
                        .problem = "the scene is planar with normal " + normal + ", but it starts with " +
                                   text::brief(out->value) + (is_rotation(out->axis) ? " rad/s" : " m/s") +
                                   " out of the plane; set \"planar\" to \"off\", or start in the plane"});
  } catch (const ModelError& error) {
    const bool known = is_taken(error.thing.kind == "joint" ? "link" : error.thing.kind, error.thing.name);  // no event
    const Value& whole = root.has("planar") ? root.value("planar") : scene_.root;
    refuse(known ? taken_[0].at(error.thing.name).second : whole.where, "", error.what(),
           static_cast<const ErrorData&>(error));
  }
}

Scene in_space(Scene scene) {
  change_root(scene, [](Value& root) {
    if (root.find("planar") == nullptr) root.object()->push_back({"planar", Value("off"), root.where});
  });
  return scene;
}

Mechanism::Mechanism() : methods(std::make_shared<Registry>()) {}

Mechanism build_mechanism(const Scene& scene, const Registry& registry) { return build_mechanism(scene, registry, {}); }

Mechanism build_mechanism(const Scene& scene, const Registry& registry, const AlsoWrong& also) {
  Mechanism mechanism;
  Registry& methods = *mechanism.methods;
  methods.integrators = registry.integrators, methods.solvers = registry.solvers;
  methods.laws = registry.laws, methods.translation_laws = registry.translation_laws;  // a method may have laws as keys
  methods.rotation_laws = registry.rotation_laws;
  with_formulas(scene, [&] { Builder(scene, registry, mechanism, also).build(); });
  return mechanism;
}

void record_places(Mechanism& m) {
  if (!m.run.record.empty()) return;
  for (const Body& body : m.system.bodies())
    if (!body.fixed)
      for (const char* axis : {".x", ".y", ".z"}) m.run.record.push_back({body.name + axis, "", {}});
}

Mechanism read_mechanism(const std::string& file, const Registry& registry,
                         const std::vector<std::pair<std::string, std::string>>& set) {
  return read_mechanism(read_scene(file), registry, set);
}

Scene with_values(Scene scene, Registry& registry, const std::vector<std::string>& set) {
  for (const std::string& plugin : scene.plugins)
    if (things_of(registry, plugin_name(plugin)).empty()) load_plugin(registry, plugin);
  return set.empty() ? scene : set_in_scene(scene, set, registry);
}

Mechanism read_mechanism(Scene scene, const Registry& given,
                         const std::vector<std::pair<std::string, std::string>>& set) {
  Registry registry = given;
  std::vector<std::string> texts;
  for (const auto& [name, value] : set) texts.push_back(name + "=" + value);
  scene = with_values(std::move(scene), registry, texts);
  Mechanism mechanism = build_mechanism(scene, registry);
  record_places(mechanism);
  return mechanism;
}

Mechanism read_mechanism(const std::string& file, const std::vector<std::pair<std::string, std::string>>& set) {
  return read_mechanism(file, builtin_registry(), set);
}

}  // namespace lockstep
