// Checked parameters of a named thing.
#pragma once

#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/error.h>
#include <lockstep/export.h>
#include <lockstep/law.h>
#include <lockstep/math.h>

namespace lockstep {

// Orientation by named angle sequences, both ways.


/// Three turns about the frame's own (moving) axes, one after another: "xyz" (Cardan), "zxz" (Euler), "zxy" (HPB:
/// heading about z, pitch about x, bank about y), or any three letters of x y z without two equal neighbours. Throws
/// ModelError for anything else.
LOCKSTEP_API Quat from_angles(const std::string& sequence, const Vec3& angles);

/// Three angles about axes in sequence.
struct Angles {
  Vec3 value = Vec3::Zero();  ///< rad
  bool gimbal =
      false;  ///< the middle turn makes the outer axes parallel (within 1e-7 rad): the third angle is set to 0
};
LOCKSTEP_API Angles to_angles(const std::string& sequence, const Quat& q);

/// "xyz" for "cardan", "zxz" for "euler", "zxy" for "hpb"; a sequence of letters stands for itself.
LOCKSTEP_API std::string angle_sequence(const std::string& name);


// A piece of a description as data: what a scene file says, or what C++ gives in its place. Every piece knows where it
// stood.


/// Where a value stood: line and column count from 1; line 0 = given in C++.
struct Where {
  std::shared_ptr<const std::string> file;
  int line = 0, column = 0;
  /// "four_bar.json:4:64", or "" for C++.
  LOCKSTEP_API std::string text() const;
};

/// null, true/false, number, text, list or object (its members in the order of the file).
class Value {
 public:
  struct Member;
  using List = std::vector<Value>;
  using Object = std::vector<Member>;

  // Out of line, as all that makes or ends a Value: Member is complete only below.
  LOCKSTEP_API Value();
  LOCKSTEP_API Value(bool b);          // NOLINT: a description reads like data
  LOCKSTEP_API Value(double x);        // NOLINT
  LOCKSTEP_API Value(int x);           // NOLINT
  LOCKSTEP_API Value(const char* s);   // NOLINT
  LOCKSTEP_API Value(std::string s);   // NOLINT
  LOCKSTEP_API Value(List items);      // NOLINT
  LOCKSTEP_API Value(Object members);  // NOLINT
  LOCKSTEP_API Value(const Value&);
  LOCKSTEP_API Value(Value&&) noexcept;
  LOCKSTEP_API Value& operator=(const Value&);
  LOCKSTEP_API Value& operator=(Value&&) noexcept;
  LOCKSTEP_API ~Value();
  LOCKSTEP_API static Value list(std::initializer_list<double> numbers);
  LOCKSTEP_API static Value object(std::initializer_list<std::pair<const char*, Value>> members);

  bool is_null() const { return std::holds_alternative<std::monostate>(data_); }
  const bool* boolean() const { return std::get_if<bool>(&data_); }
  const double* number() const { return std::get_if<double>(&data_); }
  const std::string* text() const { return std::get_if<std::string>(&data_); }
  const List* list() const { return std::get_if<List>(&data_); }
  const Object* object() const { return std::get_if<Object>(&data_); }
  List* list() { return std::get_if<List>(&data_); }
  Object* object() { return std::get_if<Object>(&data_); }

  /// Member of an object by name, nullptr when absent or when this is no object.
  LOCKSTEP_API const Value* find(std::string_view key) const;
  /// This object without the members named; what is no object stays as it is.
  LOCKSTEP_API Value without(std::initializer_list<std::string_view> keys) const;
  /// "a number", "a text", "a list of 3", ... for messages.
  LOCKSTEP_API std::string kind() const;

  Where where;

 private:
  std::variant<std::monostate, bool, double, std::string, List, Object> data_;
};

/// A key of an object with its value.
struct Value::Member {
  std::string key;
  Value value;
  Where where;  ///< of the key
};


// Checked parameters of a named thing. One table of keys per registered type feeds the parser, the JSON schema, `list`,
// `describe` and the errors; there is no second list anywhere.


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

/// One key of a type: its form, unit, default and help.
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


// Site: where a link or force stands, handed to its maker together with its parameters.


class Lock;

/// The name of the thing and the markers it is given, P before S of each pair.
struct LOCKSTEP_API Site {  // shown, because the shelves are templates of it
  std::string name;
  std::vector<std::pair<Marker*, Marker*>> pairs;  ///< one for a lock; forces may have none, or a pair without S
  Lock* link = nullptr;                            ///< the link that carries a force (friction); most have none

  /// Of pair k; throw ModelError when the marker is not given.
  Marker& p(std::size_t k = 0) const { return given(name, k < pairs.size() ? pairs[k].first : nullptr, "p", k); }
  Marker& s(std::size_t k = 0) const { return given(name, k < pairs.size() ? pairs[k].second : nullptr, "s", k); }
  /// Throws ModelError when none is given.
  Lock& carrier() const {
    if (link == nullptr) throw ModelError("'" + name + "': its type acts in a link; name that as \"link\"");
    return *link;
  }

  /// The marker of one side of pair k; throws ModelError, naming `name`, when it is not given.
  template <class M>
  static M& given(const std::string& name, M* marker, const char* side, std::size_t k) {
    if (marker == nullptr)
      throw ModelError("'" + name + "': its type needs a marker or a body for \"" + side + "\"" +
                       (k == 0 ? "" : " of pair " + std::to_string(k + 1)) + "; add it");
    return *marker;
  }
};

}  // namespace lockstep
