// SPDX-License-Identifier: BSD-3-Clause
// Checked parameters of a named thing.
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/body.h>
#include <lockstep/error.h>
#include <lockstep/math.h>

namespace lockstep {

class Coordinate;

// Orientation from named angle sequences, and back.

/// Unit quaternion of three rotations by `angles`, rad, about the frame's own (moving) axes, one after another: "xyz"
/// (Cardan), "zxz" (Euler), "zxy" (HPB: heading about z, pitch about x, bank about y), or any three letters of x y z
/// without two equal neighbours, or a name that angle_sequence() knows. Throws ModelError for any other sequence.
LOCKSTEP_API Quat from_angles(const std::string& sequence, const Vec3& angles);

/// Three angles about the axes of a sequence, and whether they are unique.
struct Angles {
  Vec3 value = Vec3::Zero();  ///< the three angles, rad
  /// The middle rotation makes the outer axes parallel (within 1e-7 rad): the third angle is set to 0.
  bool gimbal = false;
};
/// The angles of an orientation q, of any length but zero: the inverse of from_angles(). The outer angles are in (-pi,
/// pi], the middle one in [-pi/2, pi/2], or in [0, pi] when first and last axis are the same. Throws ModelError as it
/// does.
LOCKSTEP_API Angles to_angles(const std::string& sequence, const Quat& q);

/// "xyz" for "cardan", "zxz" for "euler", "zxy" for "hpb"; any other text is returned as it is.
LOCKSTEP_API std::string angle_sequence(const std::string& name);

// A piece of a description as data: from a scene file, or from C++ in its place. Every piece has its place in the
// file.

/// The place at which a value was written.
struct SourceLocation {
  std::shared_ptr<const std::string> file;  ///< path of the file; null: given in C++, or as a text without a file
  int line = 0,                             ///< from 1; 0: given in C++
      column = 0;                           ///< from 1; 0: given in C++
  /// "four_bar.json:4:64", the file alone without a line, or "" for C++.
  LOCKSTEP_API std::string text() const;
};

/// A piece of a description: null, true/false, number, text, list or object (its members in the order of the file).
class Value {
 public:
  /// A key of an object with its value.
  struct Member;
  using List = std::vector<Value>;     ///< items of a list
  using Object = std::vector<Member>;  ///< members of an object, in order

  // Defined out of line, like all that makes or destroys a Value: Member is complete only below.
  /// Null.
  LOCKSTEP_API Value();
  /// True or false.
  LOCKSTEP_API Value(bool b);  // NOLINT: a description reads like data
  /// A number.
  LOCKSTEP_API Value(double x);  // NOLINT
  /// A whole number, kept as a double.
  LOCKSTEP_API Value(int x);  // NOLINT
  /// A text.
  LOCKSTEP_API Value(const char* s);  // NOLINT
  /// A text.
  LOCKSTEP_API Value(std::string s);  // NOLINT
  /// A list.
  LOCKSTEP_API Value(List items);  // NOLINT
  /// An object.
  LOCKSTEP_API Value(Object members);  // NOLINT
  /// Copies the whole piece.
  LOCKSTEP_API Value(const Value&);
  /// Moves the whole piece.
  LOCKSTEP_API Value(Value&&) noexcept;
  /// Copies the whole piece.
  LOCKSTEP_API Value& operator=(const Value&);
  /// Moves the whole piece.
  LOCKSTEP_API Value& operator=(Value&&) noexcept;
  LOCKSTEP_API ~Value();
  /// A list of numbers.
  LOCKSTEP_API static Value list(std::initializer_list<double> numbers);
  /// An object with these members, in this order.
  LOCKSTEP_API static Value object(std::initializer_list<std::pair<const char*, Value>> members);

  bool is_null() const { return std::holds_alternative<std::monostate>(data_); }  ///< whether this is null
  /// The value if this is true or false, else nullptr.
  const bool* boolean() const { return std::get_if<bool>(&data_); }
  const double* number() const { return std::get_if<double>(&data_); }          ///< the number, else nullptr
  const std::string* text() const { return std::get_if<std::string>(&data_); }  ///< the text, else nullptr
  const List* list() const { return std::get_if<List>(&data_); }                ///< the items of a list, else nullptr
  const Object* object() const { return std::get_if<Object>(&data_); }  ///< the members of an object, else nullptr
  List* list() { return std::get_if<List>(&data_); }                    ///< the items of a list, else nullptr
  Object* object() { return std::get_if<Object>(&data_); }              ///< the members of an object, else nullptr

  /// The member of an object with that key; nullptr when there is none, or when this is not an object.
  LOCKSTEP_API const Value* find(std::string_view key) const;
  /// A copy of this object without the members of these keys; anything else is copied as it is.
  LOCKSTEP_API Value without(std::initializer_list<std::string_view> keys) const;
  /// "a number", "a text", "a list of 3", ...; for messages.
  LOCKSTEP_API std::string kind() const;

  SourceLocation where;  ///< its place

 private:
  std::variant<std::monostate, bool, double, std::string, List, Object> data_;
};

/// A key of an object with its value.
struct Value::Member {
  std::string key;       ///< name of the key, without quotes
  Value value;           ///< its value
  SourceLocation where;  ///< place of the key
};

// MethodSpec: an integrator or a solver by name, with the keys of its type.

/// An integrator or solver by name, with the keys of its type.
struct MethodSpec {
  std::string type;        ///< name in the registry
  Value keys{};            ///< an object, or null for the defaults
  SourceLocation where{};  ///< its place in a file
};

// Checked parameters of a named thing. One table of keys per registered type serves the parser, the JSON schema,
// `list`, `describe` and the errors; there is no second list.

/// What a key holds.
enum class Form {
  number,           ///< a number, or a text with a unit
  integer,          ///< a whole number
  boolean,          ///< true or false
  text,             ///< a text
  choice,           ///< one of the texts in Key::choices
  vector3,          ///< [x, y, z]
  axis,             ///< a direction, not zero: "x", "-y" or [x, y, z]; read as a unit vector
  orientation,      ///< [w, x, y, z], {"axis", "angle"}, {"angles", "sequence"}, {"matrix"}, or two of {"x", "y", "z"}
  numbers,          ///< a list of numbers
  points,           ///< a list of lists of numbers
  law,              ///< a scalar law: {"type": ..., keys of that law}, or a number for a constant
  translation_law,  ///< a law of a translation: {"type": ..., its keys}, or [x, y, z] for a constant
  rotation_law,     ///< a law of a rotation: {"type": ..., its keys}, or a quaternion for a constant
  laws,             ///< a list of scalar laws
  any               ///< anything; the maker reads the Value itself
};

/// The dimension of a number. A text with a unit ("12 mm", "30 deg", "1200 rpm") is converted to SI.
enum class Unit {
  none,                  ///< a pure number
  length,                ///< m
  angle,                 ///< rad
  time,                  ///< s
  mass,                  ///< kg
  speed,                 ///< m/s
  angular_speed,         ///< rad/s
  acceleration,          ///< m/s^2
  angular_acceleration,  ///< rad/s^2
  force,                 ///< N
  torque,                ///< N m
  inertia,               ///< kg m^2
  density,               ///< kg/m^3
  stiffness,             ///< N/m
  torsion_stiffness,     ///< N m/rad
  damping,               ///< N s/m
  torsion_damping,       ///< N m s/rad
  frequency,             ///< Hz
  any  ///< the unit of what uses it (the amplitude of a law); every unit is accepted and converted to SI
};

/// Relation of a key of a law to its value y: its units follow from the use of the law.
enum class LawQuantity {
  other,         ///< of any dimension: not checked
  value,         ///< of the dimension of y; a law under such a key has that of y too
  rate,          ///< of y per second
  acceleration,  ///< of y per second squared
  coefficients   ///< a list c_0, c_1, ...: of y per second^k
};

/// What holds when a key without a default is not given.
enum class Unset {
  required,  ///< an error
  optional   ///< nothing; the maker asks has()
};
inline constexpr Unset kRequired = Unset::required,  ///< the key must be given
    kOptional = Unset::optional;                     ///< the key may be left out
/// The value of a key that is not given: a Value, kRequired or kOptional.
using Default = std::variant<Unset, Value>;

/// One key of a type: its form, unit, default and help.
struct Key {
  std::string name;                         ///< as written in scenes
  Form form = Form::number;                 ///< what it holds
  Unit unit = Unit::none;                   ///< dimension of its numbers
  Default fallback{};                       ///< 0.5, "words", Value::List{0, 0, 1}, kRequired or kOptional
  std::string help;                         ///< one line; names the frame if there is one
  std::vector<std::string> choices{};       ///< the texts that are accepted, for Form::choice
  LawQuantity of_law = LawQuantity::other;  ///< in the table of a law, of keys without a unit
  bool of_time = true;                      ///< of a key that holds a law: whether its argument is the time, s

  /// Whether it must be given.
  bool required() const { return default_value() == nullptr && std::get<Unset>(fallback) == kRequired; }
  /// Its default; nullptr when there is none.
  const Value* default_value() const { return std::get_if<Value>(&fallback); }
};
using Keys = std::vector<Key>;  ///< a table of keys

/// Name, help and keys of a registered type.
struct TypeInfo {
  std::string name,  ///< as in scenes and registries
      help;          ///< one line of text
  Keys keys;         ///< the keys of its parameters
};

/// The laws of a list, shared: a copy takes no memory.
using LawList = std::shared_ptr<const std::vector<LawPtr<MotionLaw>>>;
/// A law that was made from the value of a key, or the laws of a list. No copy throws: if one did, std::variant of
/// libstdc++ 12 would destroy a value that it has not made.
using MadeLaw = std::variant<LawPtr<MotionLaw>, LawPtr<TranslationLaw>, LawPtr<RotationLaw>, LawList>;

/// The members of one object, checked against a table of keys. Checking throws SceneError with place, owner, key, value
/// and advice: an unknown key (with the closest known one), a key given twice, a missing key, a wrong form, a unit of
/// another dimension, NaN or infinity. Values are read by getters, which return the default of a key that is not given
/// and throw SceneError for a key that is not in the table, or that is not given and has no default.
class LOCKSTEP_API Params {
 public:
  /// Parameters given in C++, Params{{"height", 0.02}, {"width", 0.3}}, not checked yet: checked() does that.
  Params(std::initializer_list<std::pair<const char*, Value>> members = {});
  /// An object from a scene, not checked yet.
  static Params unchecked(Value object);
  /// The members of `object` (null: none) checked against the keys of `info`. `owner` names the thing in messages:
  /// "joint 'A'", "joint 'A', drive.law". Laws are not made: checked_params() of registry.h does that.
  Params(Value object, const TypeInfo& info, std::string owner);

  /// These parameters checked against the keys of `info`; laws are not made. Throws SceneError.
  Params checked(const TypeInfo& info, std::string owner) const;
  /// Members of an object that was checked already, null: none, and the table of their keys. Checks nothing again.
  static Params part(std::shared_ptr<const Value> object, std::shared_ptr<const Keys> keys, std::string owner);
  /// Sets the law that was made from the value of a key.
  void put_law(const std::string& key, MadeLaw law);

  bool has(std::string_view key) const;       ///< whether it is given; a default does not count
  double number(std::string_view key) const;  ///< in SI units
  int integer(std::string_view key) const;    ///< a whole number
  bool boolean(std::string_view key) const;   ///< true or false
  /// Of Form::text and Form::choice. Of a key named "file": a path, relative to the folder of its file.
  std::string text(std::string_view key) const;
  Vec3 vector3(std::string_view key) const;      ///< of Form::vector3, in SI units, and of Form::axis, length 1
  Quat orientation(std::string_view key) const;  ///< unit quaternion
  std::vector<double> numbers(std::string_view key) const;              ///< in SI units
  std::vector<std::vector<double>> points(std::string_view key) const;  ///< one list per point, in SI units
  /// The law made from the value; throws SceneError when none was made.
  LawPtr<MotionLaw> law(std::string_view key) const;
  LawPtr<TranslationLaw> translation_law(std::string_view key) const;  ///< likewise
  LawPtr<RotationLaw> rotation_law(std::string_view key) const;        ///< likewise
  std::vector<LawPtr<MotionLaw>> laws(std::string_view key) const;     ///< likewise, of Form::laws
  const Value& value(std::string_view key) const;                      ///< as written; null when it is not given
  const Keys& keys() const { return *keys_; }  ///< the table that they were checked against; empty before
  /// The value as written, else the default; null when there is neither.
  Value given_or_default(const Key&) const;

  const std::string& owner() const { return owner_; }             ///< the name of the thing in messages
  const SourceLocation& where() const { return object_->where; }  ///< place of the object
  /// Throws SceneError with the place of `key` ("": of the object), owner, key and `problem` (value, limit, advice).
  [[noreturn]] void refuse(std::string_view key, const std::string& problem) const;

 private:
  const Key& key_of(std::string_view key) const;
  const Value& needed(const Key&) const;             // given or default; an error if missing
  std::string place_of(std::string_view key) const;  // "joint 'A', law.slope"
  template <class L>
  L made(std::string_view key) const;
  std::shared_ptr<const Value> object_;
  std::shared_ptr<const Keys> keys_;
  std::string owner_;
  std::map<std::string, MadeLaw> laws_;
};

/// The place of a part in its owner, for messages: part_of("joint 'A'", "law") is "joint 'A', law"; part_of("joint 'A',
/// law", "slope") is "joint 'A', law.slope".
LOCKSTEP_API std::string part_of(const std::string& owner, std::string_view part);

/// Whether a key of this form holds a law or a list of laws.
LOCKSTEP_API bool holds_law(Form);

/// "number", "choice", "translation law", ...; for `describe` and the schema.
LOCKSTEP_API std::string name_of(Form);

/// Throws ModelError for a faulty table: no name, a key without a name or listed twice, text that is not one plain line
/// of UTF-8, a default that is not of the key's form, a choice without choices.
LOCKSTEP_API void check_type_info(const TypeInfo&);

// Attachment: the markers and the joint on which a joint or force acts; its maker gets it together with the parameters.

class Lock;

/// The name of a new joint or force and the markers it is given, P before S in each pair.
struct LOCKSTEP_API Attachment {  // exported, because the registries are templates of it
  std::string name;               ///< name of the joint or force
  /// One for a lock; forces may have none, or a pair without S (nullptr).
  std::vector<std::pair<Marker*, Marker*>> pairs;
  Lock* link = nullptr;  ///< the joint that a force acts in (friction); most forces have none
  /// The coordinate or rate of this name, "crank.rz", for formulas. Throws ModelError if there is none. Empty without a
  /// scene.
  std::function<std::shared_ptr<Coordinate>(const std::string&)> coordinate{};

  /// Marker P of pair k; throws ModelError when it is not given.
  Marker& p(std::size_t k = 0) const { return given(name, k < pairs.size() ? pairs[k].first : nullptr, "p", k); }
  /// Marker S of pair k; throws ModelError when it is not given.
  Marker& s(std::size_t k = 0) const { return given(name, k < pairs.size() ? pairs[k].second : nullptr, "s", k); }
  /// The joint that the force acts in; throws ModelError when none is given.
  Lock& carrier() const {
    if (link == nullptr) throw ModelError("'" + name + "': its type acts in a joint; name that as \"link\"");
    return *link;
  }

  /// The marker of one side of pair k; throws ModelError with `name` when it is nullptr.
  template <class M>
  static M& given(const std::string& name, M* marker, const char* side, std::size_t k) {
    if (marker == nullptr)
      throw ModelError("'" + name + "': its type needs a marker or a body for \"" + side + "\"" +
                       (k == 0 ? "" : " of pair " + std::to_string(k + 1)) + "; add it");
    return *marker;
  }
};

}  // namespace lockstep
