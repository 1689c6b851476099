// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/linear_inputs.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include <lockstep/author/formula.h>
#include <lockstep/author/registry.h>
#include <lockstep/text.h>
#include "framework/description/scene/tables.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

// Types of laws and forces that hold the inputs.

/// The inputs by number; made with the mechanism.
using InputLaws = std::vector<std::shared_ptr<InputLaw>>;

constexpr const char *kInputLaw = "linear_input",  ///< scalar law: {"number", "law"}
    *kInputTranslation = "linear_input_along",     ///< translation law: {"number", "axis", "law"}
        *kInputForce = "linear_input_force";       ///< force: {"number", "along"}

std::shared_ptr<InputLaw>& made_input(const std::shared_ptr<InputLaws>& all, const Params& params,
                                      LawPtr<MotionLaw> law = {}) {
  std::shared_ptr<InputLaw>& input = all->at(static_cast<std::size_t>(params.integer("number")));
  if (!input) input = std::make_shared<InputLaw>(std::move(law));
  return input;
}

// x = law(t) + u e
class InputAlong final : public TranslationLaw {
 public:
  InputAlong(LawPtr<TranslationLaw> law, int axis, std::shared_ptr<InputLaw> input)
      : law_(std::move(law)), axis_(axis), input_(std::move(input)) {}
  TranslationValue at(double t) const override {
    TranslationValue x = law_->at(t);
    const LawValue u = input_->at(t);
    x.x[axis_] += u.y, x.v[axis_] += u.yd, x.a[axis_] += u.ydd;
    return x;
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { law_->breakpoints(t0, t1, out); }

 private:
  LawPtr<TranslationLaw> law_;
  int axis_;
  std::shared_ptr<InputLaw> input_;
};

// The ends of a force: its own markers, or those of the joint in which it acts; without S the ground.
std::pair<const Marker*, const Marker*> ends_of(const Attachment& attachment, const Params& params) {
  if (attachment.link != nullptr) return attachment.link->pairs().front();
  return {&p_of(attachment, params), has_s(attachment) ? &s_of(attachment, params) : nullptr};
}

//   f = u e_k of S (of the world, without S)
std::unique_ptr<Force> input_force(const Attachment& attachment, const Params& params,
                                   std::shared_ptr<InputLaw> input) {
  const auto ends = ends_of(attachment, params);
  const Marker *const p = ends.first, *const s = ends.second;
  const int axis = static_cast<int>(params.integer("along"));
  if (axis >= 3 && p->body->freedoms == Freedoms::particle)
    throw ModelError("input '" + attachment.name + "' is a torque on '" + p->body->name +
                     "', which is a particle and cannot rotate; name a force along x, y or z");
  std::vector<const Marker*> markers{p};
  if (s != nullptr) markers.push_back(s);
  return function_force(attachment.name, std::move(markers),
                        [=, input = std::move(input)](const Inputs& in, WrenchSum& out) {
                          const double u = input->at(in.t).y;
                          if (u == 0) return;
                          const MarkerFrame P(*p), S = s != nullptr ? MarkerFrame(*s) : MarkerFrame();
                          const auto act = [&](const Ends<double>& at, auto& load) {
                            const Vec3 f = u * at.S.axis(axis % 3);
                            axis >= 3 ? load.torque(f) : load.force(f, at.P.x());
                          };
                          formula::apply(P, S, in, act, out);
                        });
}

/// Adds types that put the input with a number
///   - added to a scalar law, which may be absent;
///   - added to a translation law, along one of its axes 0, 1, 2;
///   - into a force along an axis of S on p's body at P, or a torque about it (axes 3, 4, 5), and the opposite on s's body.
void add_input_types(Registry& registry, const std::shared_ptr<InputLaws>& laws) {
  const Key number{"number", Form::integer, Unit::none, kRequired, "number of the input, from 0"},
      axis{"axis", Form::integer, Unit::none, kRequired, "0 to 2: x, y, z"},
      along{"along", Form::integer, Unit::none, kRequired, "0 to 2: along x, y, z of S; 3 to 5: about them"};
  TypeInfo law{kInputLaw,
               "a law of the scene, and the input of a linearisation",
               {number, {"law", Form::law, Unit::none, kOptional, "the law of the scene", {}, LawQuantity::value}}};
  registry.laws.add(std::move(law), [laws](const Params& params) -> LawPtr<MotionLaw> {
    return made_input(laws, params, params.has("law") ? params.law("law") : nullptr);
  });
  TypeInfo translation{kInputTranslation,
                       "a translation of the scene, and the input of a linearisation along an axis",
                       {number, axis, {"law", Form::translation_law, Unit::length, kRequired, "the law of the scene"}}};
  registry.translation_laws.add(std::move(translation), [laws](const Params& params) -> LawPtr<TranslationLaw> {
    return std::make_shared<InputAlong>(params.translation_law("law"), static_cast<int>(params.integer("axis")),
                                        made_input(laws, params));
  });
  TypeInfo force{kInputForce, "the input of a linearisation between the ends of a force", {number, along}};
  registry.forces.add(std::move(force), [laws](const Attachment& attachment, const Params& params) {
    return input_force(attachment, params, made_input(laws, params));
  });
}

// Inputs by name.

constexpr std::array kAxes = {"x", "y", "z", "rx", "ry", "rz"};

std::string along(const std::string& name, int axis) { return name + "." + kAxes[axis]; }

// The input with a number, added to the law if there is one.
Value input_beside(const Value* law, std::size_t number) {
  Value input = Value::object({{"type", kInputLaw}, {"number", static_cast<int>(number)}});
  if (law != nullptr) input.object()->push_back({"law", *law, law->where}), input.where = law->where;
  return input;
}

// Forces whose law is their magnitude, zero if it is not given.
struct Magnitude {
  const char *type, *key, *unit;
};
constexpr std::array kMagnitudes = {
    Magnitude{"spring_damper", "force", "N"}, Magnitude{"torsion_spring_damper", "torque", "N m"},
    Magnitude{"force_motor", "force", "N"},   Magnitude{"torque_motor", "torque", "N m"},
    Magnitude{"applied_force", "law", "N"},   Magnitude{"applied_torque", "law", "N m"}};

// Opens inputs of one scene, by name.
class Opening {
 public:
  Opening(Scene& scene, const Registry& registry) : scene_(scene), registry_(registry) {
    for (const Value& body : items(scene.root, "bodies"))
      refuse(text_of(body, "name"), "is a body; add an applied_force or a motor on it, and name that");
    for (Value& marker : items(scene.root, "markers")) {
      const std::size_t before = places_.size();
      collect_laws(marker, scene_table("marker").info.keys, "marker");
      refuse(text_of(marker, "name"),
             "is a marker; " + advice(before, "give it a \"translation\" or a \"rotation\", or add a force at it"));
    }
    for (Value& link : items(scene.root, "links")) collect_link(link);
    for (Value& force : items(scene.root, "forces")) collect_force(force);
  }

  /// The unit of the input.
  std::string open(const std::string& name, std::size_t number) {
    for (Place& place : places_) {
      if (place.name != name && place.short_name != name) continue;
      if (!place.refusal.empty()) throw UnknownInput("\"" + name + "\" " + place.refusal);
      if (place.opened) throw UnknownInput("\"" + name + "\" is given twice");
      place.opened = true;
      place.put_in(number);
      return place.unit;
    }
    std::vector<std::string> names;
    for (const Place& place : places_)
      if (place.refusal.empty()) names.push_back(place.short_name);
    throw UnknownInput("\"" + name + "\" is not a drive, a law or a force" +
                       (names.empty() ? "; the scene has none" : text::suggestion(name, names)));
  }
  // Forces that were added, at last: places point into the scene until then.
  void close() {
    for (Value& force : added_) member(scene_.root, "forces")->list()->push_back(std::move(force));
    added_.clear();
  }

 private:
  // A name that can be an input; with a refusal, one that cannot, and the next move.
  struct Place {
    std::string name, short_name, unit, refusal;
    std::function<void(std::size_t number)> put_in;
    bool opened = false;
  };

  void add(const std::string& name, const std::string& short_name, const std::string& unit,
           std::function<void(std::size_t)> put_in) {
    places_.push_back({name, short_name, unit, "", std::move(put_in)});
  }
  void refuse(const std::string& name, const std::string& why) { places_.push_back({name, name, "", why, {}}); }
  bool has(const std::string& name) const {
    return std::ranges::any_of(places_, [&](const Place& p) { return p.name == name || p.short_name == name; });
  }

  // The first input that was collected since then; "" if there is none.
  std::string first_input(std::size_t since) const {
    for (std::size_t k = since; k < places_.size(); ++k)
      if (places_[k].refusal.empty()) return places_[k].name;
    return {};
  }
  std::string advice(std::size_t since, const std::string& otherwise) const {
    const std::string first = first_input(since);
    return first.empty() ? otherwise : "name one of its laws, as \"" + first + "\"";
  }

  void collect_link(Value& link) {
    const std::size_t before = places_.size();
    collect_drives(link);
    collect_laws(link, scene_table("link").info.keys, "joint");
    if (const auto* entry = registry_.links.find(text_of(link, "type"))) collect_laws(link, entry->info.keys, "joint");
    const std::string name = text_of(link, "name");
    if (!has(name))
      refuse(name, "is a joint without a drive; " + advice(before, "give it one, or add a motor or a force"));
  }
  void collect_drives(Value& link) {
    Value* drive = member(link, "drive");
    if (drive == nullptr) return;
    for (Value& one : one_or_all(*drive)) {
      const std::string axis = text_of(one, "axis"), link_name = text_of(link, "name"), name = link_name + "." + axis;
      const bool speed = member(one, "law") == nullptr;
      add(name, one_or_all(*drive).size() > 1 ? name : link_name,
          std::string(axis.starts_with("r") ? "rad" : "m") + (speed ? "/s" : ""), [&one, speed](std::size_t number) {
            const char* const key = speed ? "speed" : "law";
            put(one, key, input_beside(member(one, key), number));
          });
    }
  }

  // Laws of time that are given under these keys: "rope.length", "table.translation.x", "A.turn.z".
  void collect_laws(Value& object, const Keys& keys, const char* kind) {
    const std::string owner = text_of(object, "name");
    for (const Key& k : keys) {
      Value* law = member(object, k.name);
      if (law == nullptr || (k.form != Form::law && k.form != Form::translation_law && k.form != Form::rotation_law))
        continue;
      const std::string name = owner + "." + k.name;
      if (!k.of_time) {
        refuse(name, "depends on the position of the " + std::string(kind) + ", not on time; name a drive or a force");
        continue;
      }
      if (k.form == Form::law) {
        add(name, name, si_unit(k.unit), [law](std::size_t n) { *law = input_beside(law, n); });
        continue;
      }
      const bool turn = k.form == Form::rotation_law;
      for (int axis = 0; axis < 3; ++axis)
        add(along(name, axis), along(name, axis), turn ? "rad" : "m",
            [law, axis, turn](std::size_t n) { turn ? turn_before(*law, axis, n) : move_beside(*law, axis, n); });
      refuse(name, std::string("is a law of a ") + (turn ? "rotation" : "translation") + "; name one axis of it: \"" +
                       name + ".x\", \".y\" or \".z\"");
    }
  }
  static void move_beside(Value& law, int axis, std::size_t number) {
    replace(law,
            Value::object(
                {{"type", kInputTranslation}, {"number", static_cast<int>(number)}, {"axis", axis}, {"law", law}}));
  }
  // q = (rotation by the input about an axis of the frame) (law)
  static void turn_before(Value& law, int axis, std::size_t number) {
    const Value first =
        Value::object({{"type", "axis_rotation"}, {"axis", kAxes[axis]}, {"law", input_beside(nullptr, number)}});
    replace(law, Value::object({{"type", "product"}, {"first", first}, {"second", law}}));
  }

  void collect_force(Value& force) {
    const std::string name = text_of(force, "name"), type = text_of(force, "type");
    const auto* const found = std::ranges::find_if(kMagnitudes, [&](const Magnitude& m) { return type == m.type; });
    if (found != kMagnitudes.end()) return collect_magnitude(force, *found);
    const std::size_t before = places_.size();
    if (const auto* entry = registry_.forces.find(type)) collect_laws(force, entry->info.keys, "force");
    if (first_input(before).empty()) collect_ends(force);
    if (!has(name))
      refuse(name,
             "is a " + type + ", which has no magnitude; name one of its inputs, as \"" + first_input(before) + "\"");
  }
  void collect_magnitude(Value& force, const Magnitude& magnitude) {
    const std::string name = text_of(force, "name"), type = magnitude.type;
    const auto put_in = [&force, k = magnitude.key](std::size_t n) {
      put(force, k, input_beside(member(force, k), n));
    };
    if (!type.starts_with("applied_")) return add(name + "." + magnitude.key, name, magnitude.unit, put_in);
    const char* const constant = type == "applied_torque" ? "torque" : "force";
    for (int axis = 0; axis < 3; ++axis)
      add(along(name, axis), along(name, axis), magnitude.unit, [&force, axis](std::size_t n) {
        if (member(force, "laws") == nullptr) put(force, "laws", Value::list({0, 0, 0}));
        if (Value::List* laws = member(force, "laws")->list(); laws != nullptr && laws->size() == 3) {
          Value& law = (*laws)[axis];
          law = input_beside(&law, n);
        }
      });
    if (force.find("direction") != nullptr)
      add(name + ".law", name, magnitude.unit, put_in);
    else if (const Value* value = force.find(constant); value != nullptr)
      add(name, name, magnitude.unit,
          [&force, put_in, direction = *value](std::size_t n) { put(force, "direction", direction), put_in(n); });
    else
      refuse(name, "has laws of components and no direction; name one of \"" + name + ".x\", \".y\" and \".z\"");
  }

  // A force along, or a torque about an axis of S, added to a force of another kind, between its ends.
  void collect_ends(Value& force) {
    const std::string name = text_of(force, "name");
    const auto add_axis = [&](const std::string& input, int axis) {
      add(input, input, axis >= 3 ? "N m" : "N", [this, &force, name, axis](std::size_t n) {
        added_.push_back(force_beside(force, "input_" + std::to_string(n + 1) + "_" + name, axis, n));
      });
    };
    if (text_of(force, "type") == "function_force") {
      const bool torque = force.find("torque") != nullptr;
      const std::string given = text_of(force, "coordinate"), own = !given.empty() ? given : torque ? "rz" : "z";
      const auto* const found = std::ranges::find(kAxes, own);
      if (found != kAxes.end()) add_axis(name, static_cast<int>(found - kAxes.begin()));
    }
    for (int axis = 0; axis < 6; ++axis) add_axis(along(name, axis), axis);
  }
  static Value force_beside(const Value& force, const std::string& name, int axis, std::size_t number) {
    Value beside =
        Value::object({{"name", name}, {"type", kInputForce}, {"number", static_cast<int>(number)}, {"along", axis}});
    for (const char* key : {"p", "s", "at", "at_p", "at_s", "axis", "orientation", "link", "active"})
      if (const Value* given = force.find(key)) beside.object()->push_back({key, *given, given->where});
    return beside;
  }

  Scene& scene_;
  const Registry& registry_;
  std::vector<Place> places_;
  Value::List added_;
};

}  // namespace

MechanismWithInputs build_with_inputs(Scene scene, Registry registry, const std::vector<std::string>& names) {
  const auto laws = std::make_shared<InputLaws>(names.size());
  add_input_types(registry, laws);
  MechanismWithInputs out;
  Opening opening(scene, registry);
  for (std::size_t k = 0; k < names.size(); ++k) out.inputs.push_back({names[k], opening.open(names[k], k), nullptr});
  opening.close();
  out.mechanism = std::make_unique<Mechanism>(build_mechanism(scene, registry));
  for (std::size_t k = 0; k < names.size(); ++k) out.inputs[k].law = (*laws)[k];
  return out;
}

}  // namespace lockstep
