// Checked parameters of a named thing. One table of keys per registered type feeds the parser, the JSON schema, `list`,
// `describe` and the errors; there is no second list anywhere.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "framework/foundation/math/quaternion.h"
#include "framework/mechanism/model/motion_law.h"
#include "framework/mechanism/params/value.h"

namespace lockstep {

/// What a key holds.
enum class Form {
  number,
  integer,
  boolean,
  text,
  choice,       // choice: one of Key::choices
  vector3,      // [x, y, z]
  axis,         // a direction: "x", "-y" or [x, y, z], not zero; handed out with length 1
  orientation,  // quaternion [w, x, y, z], {"axis":, "angle":}, {"angles": [a, b, c], "sequence": "xyz"}, or {"matrix":
                // ...}
  numbers,      // list of numbers
  points,       // list of lists of numbers
  law,
  translation_law,
  rotation_law,
  laws,  // {"type": ..., keys of that law}, a bare number = constant; laws: a list of scalar ones
  any    // the maker reads the Value itself
};

/// The dimension of a number; strings with a unit are converted to SI ("12 mm", "30 deg", "1200 rpm").
enum class Unit {
  none,
  length,
  angle,
  time,
  mass,
  speed,
  angular_speed,
  acceleration,
  angular_acceleration,
  force,
  torque,
  inertia,
  density,
  stiffness,
  torsion_stiffness,
  damping,
  torsion_damping,
  frequency,
  any
};  // any: what its user takes it for (the amplitude of a law); every unit is taken, and turned into SI

/// What holds where a key is not given: a value, or one of these.
enum class Unset { required, optional };  // optional: may be left out, asked by has()
inline constexpr Unset kRequired = Unset::required, kOptional = Unset::optional;
using Default = std::variant<Unset, Value>;

struct Key {
  std::string name;
  Form form = Form::number;
  Unit unit = Unit::none;
  Default fallback{};                  ///< 0.5, "words", Value::List{0, 0, 1}, kRequired, kOptional
  std::string help;                    ///< one line, says the frame where there is one
  std::vector<std::string> choices{};  ///< of Form::choice

  bool required() const { return default_value() == nullptr && std::get<Unset>(fallback) == kRequired; }
  const Value* default_value() const { return std::get_if<Value>(&fallback); }
};
using Keys = std::vector<Key>;

/// Name, one line of help and the keys of a registered type.
struct TypeInfo {
  std::string name, help;
  Keys keys;
};

/// A law that was made from the value of a key, or the laws of a list.
using MadeLaw =
    std::variant<LawPtr<MotionLaw>, LawPtr<TranslationLaw>, LawPtr<RotationLaw>, std::vector<LawPtr<MotionLaw>>>;

/// The members of one object, checked against a table of keys. Throws SceneError with place, owner, key, value, next
/// move: unknown key (with the closest known one), missing key, wrong form, unit of another dimension, NaN or infinity.
class LOCKSTEP_API Params {
 public:
  /// Parameters given in C++: Params{{"height", 0.02}, {"width", 0.3}}; checked when a maker asks for them through
  /// `checked`.
  Params(std::initializer_list<std::pair<const char*, Value>> members = {});
  /// An object as a scene holds it, not checked yet either.
  static Params unchecked(Value object);
  /// `owner` names the thing in messages: "link 'A'", "link 'A', drive.law".
  /// The laws among them are made by a registry: checked_params() (description/registry/registry.h).
  Params(Value object, const TypeInfo& info, std::string owner);

  /// These parameters held against a table.
  Params checked(const TypeInfo& info, std::string owner) const;
  /// Of checked parameters those that `keys` list, with the laws that were made for them; nothing is checked again.
  Params only(Keys keys) const;
  /// Puts the law that was made from the value of a key.
  void put_law(const std::string& key, MadeLaw law) { laws_[key] = std::move(law); }

  bool has(std::string_view key) const;  ///< given, not merely defaulted
  double number(std::string_view key) const;
  int integer(std::string_view key) const;
  bool boolean(std::string_view key) const;
  std::string text(std::string_view key) const;  ///< Form::text and Form::choice
  Vec3 vector3(std::string_view key) const;      ///< Form::vector3 and Form::axis
  Quat orientation(std::string_view key) const;
  std::vector<double> numbers(std::string_view key) const;
  std::vector<std::vector<double>> points(std::string_view key) const;
  LawPtr<MotionLaw> law(std::string_view key) const;
  LawPtr<TranslationLaw> translation_law(std::string_view key) const;
  LawPtr<RotationLaw> rotation_law(std::string_view key) const;
  std::vector<LawPtr<MotionLaw>> laws(std::string_view key) const;
  const Value& value(std::string_view key) const;  ///< as written; null when absent
  const Keys& keys() const { return keys_; }
  /// As written, else the default; null when there is neither.
  Value given_or_default(const Key&) const;

  const std::string& owner() const { return owner_; }
  const Where& where() const { return object_.where; }  ///< of the object
  /// Throws SceneError: place of `key`, owner, key, `problem` (value, limit, next move).
  [[noreturn]] void refuse(std::string_view key, const std::string& problem) const;

 private:
  const Key& key_of(std::string_view key) const;
  Value needed(const Key&) const;                    // given_or_default, but missing is refused
  std::string place_of(std::string_view key) const;  // "link 'A', law.slope"
  template <class L>
  L made(std::string_view key) const;
  void check_known() const;
  void check_form(const Key&) const;
  Value object_;
  Keys keys_;
  std::string owner_;
  std::map<std::string, MadeLaw> laws_;
};

/// The place of a part in its owner, for messages: part_of("link 'A'", "law") is "link 'A', law"; part_of("link 'A',
/// law", "slope") is "link 'A', law.slope".
LOCKSTEP_API std::string part_of(const std::string& owner, std::string_view part);

/// Whether a key of this form holds a law, or a list of laws.
LOCKSTEP_API bool holds_law(Form);

/// "number", "choice", "translation law", ... for `describe` and the schema.
LOCKSTEP_API std::string name_of(Form);

/// Throws ModelError when a table is not sound: a key without a name or twice, a default that is not of the key's
/// form, a choice without choices.
LOCKSTEP_API void check(const TypeInfo&);

}  // namespace lockstep
