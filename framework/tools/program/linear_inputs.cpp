#include "framework/tools/program/linear_inputs.h"

#include <array>

#include <lockstep/text.h>
#include "framework/tools/program/commands.h"

namespace lockstep {
namespace {

constexpr const char* kInputType = "linear_input";

using Laws = std::vector<std::shared_ptr<InputLaw>>;

// A type of law that holds the law of the scene and the input with a number.
void add_input_type(Registry& registry, const std::shared_ptr<Laws>& laws) {
  TypeInfo info{kInputType,
                "a law of the scene, and the input of a linearisation",
                {{"number", Form::integer, Unit::none, kRequired, "number of the input, from 0"},
                 {"law", Form::law, Unit::none, kOptional, "the law of the scene", {}, LawQuantity::value}}};
  registry.laws.add(std::move(info), [laws](const Params& params) -> LawPtr<MotionLaw> {
    std::shared_ptr<InputLaw>& law = laws->at(static_cast<std::size_t>(params.integer("number")));
    if (!law) law = std::make_shared<InputLaw>(params.has("law") ? params.law("law") : nullptr);
    return law;
  });
}

Value* member_of(Value& object, std::string_view key) {
  if (Value::Object* members = object.object())
    for (Value::Member& m : *members)
      if (m.key == key) return &m.value;
  return nullptr;
}

std::string text_of(const Value& object, std::string_view key) {
  const Value* v = object.find(key);
  return v != nullptr && v->text() != nullptr ? *v->text() : std::string();
}

// Puts the law under `key`, or nothing, into an input.
void wrap(Value& object, const char* key, std::size_t number) {
  Value input = Value::object({{"type", kInputType}, {"number", static_cast<int>(number)}});
  if (Value* law = member_of(object, key)) {
    input.object()->push_back({"law", *law, law->where});
    input.where = law->where;
    *law = std::move(input);
  } else {
    object.object()->push_back({key, std::move(input), object.where});
  }
}

// What has a magnitude, and the key of its law.
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
  explicit Opening(Scene& scene) : scene_(scene) {
    collect("links", [this](Value& link) { collect_drives(link); });
    collect("forces", [this](Value& force) { collect_force(force); });
  }

  /// The unit of the input.
  std::string open(const std::string& name, std::size_t number) {
    for (Place& place : places_) {
      if (place.name != name && place.short_name != name) continue;
      if (!place.refusal.empty()) throw UsageError("--inputs: \"" + name + "\" " + place.refusal);
      if (place.opened) throw UsageError("--inputs: \"" + name + "\" is given twice");
      place.opened = true;
      if (place.direction_of != nullptr) {
        Value direction = *place.object->find(place.direction_of);
        place.object->object()->push_back({"direction", std::move(direction), place.object->where});
      }
      wrap(*place.object, place.key, number);
      return place.unit;
    }
    std::vector<std::string> names;
    for (const Place& place : places_)
      if (place.refusal.empty()) names.push_back(place.short_name);
    throw UsageError("--inputs: \"" + name + "\" is neither a driven link nor a force with a magnitude" +
                     (names.empty() ? "; the scene has none" : text::suggestion(name, names)));
  }

 private:
  struct Place {
    std::string name, short_name, unit, refusal;
    Value* object = nullptr;
    const char *key = "", *direction_of = nullptr;
    bool opened = false;
  };

  template <class Take>
  void collect(const char* list, Take&& take) {
    Value* all = member_of(scene_.root, list);
    if (all == nullptr || all->list() == nullptr) return;
    for (Value& item : *all->list()) take(item);
  }
  void collect_drives(Value& link) {
    Value* drive = member_of(link, "drive");
    if (drive == nullptr) return;
    const bool several = drive->list() != nullptr && drive->list()->size() > 1;
    const auto add = [&](Value& one) {
      const std::string axis = text_of(one, "axis"), name = text_of(link, "name");
      Place place;
      place.name = name + "." + axis, place.short_name = several ? place.name : name;
      place.unit = axis.starts_with("r") ? "rad" : "m";
      place.object = &one, place.key = "law";
      if (member_of(one, "law") == nullptr) place.key = "speed", place.unit += "/s";
      places_.push_back(std::move(place));
    };
    if (Value::List* drives = drive->list())
      for (Value& one : *drives) add(one);
    else
      add(*drive);
  }
  void collect_force(Value& force) {
    Place place;
    place.name = place.short_name = text_of(force, "name");
    place.object = &force;
    const std::string type = text_of(force, "type");
    const auto* const found = std::ranges::find_if(kMagnitudes, [&](const Magnitude& m) { return type == m.type; });
    if (found == kMagnitudes.end()) {
      place.refusal = "is a " + type + ", which has no magnitude to add to; add an applied_force or a motor beside it";
    } else {
      place.key = found->key, place.unit = found->unit;
      const char* const constant = type == "applied_torque" ? "torque" : "force";
      if (type.starts_with("applied_") && force.find("direction") == nullptr) {
        if (force.find(constant) == nullptr)
          place.refusal = "has laws of components and no direction; give it \"direction\" and a \"law\"";
        else
          place.direction_of = constant;
      }
    }
    places_.push_back(std::move(place));
  }

  Scene& scene_;
  std::vector<Place> places_;
};

}  // namespace

MechanismWithInputs build_with_inputs(Scene scene, Registry registry, const std::vector<std::string>& names) {
  const auto laws = std::make_shared<Laws>(names.size());
  add_input_type(registry, laws);
  MechanismWithInputs out;
  Opening opening(scene);
  for (std::size_t k = 0; k < names.size(); ++k) out.inputs.push_back({names[k], opening.open(names[k], k), nullptr});
  out.mechanism = std::make_unique<Mechanism>(build_mechanism(scene, registry));
  for (std::size_t k = 0; k < names.size(); ++k) out.inputs[k].law = (*laws)[k];
  return out;
}

}  // namespace lockstep
