// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/params.h>

#include <algorithm>
#include <array>
#include <boost/locale/utf.hpp>
#include <cmath>

#include <lockstep/text.h>
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/csv_reader.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/refusals.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

// Reports that a quaternion, read as q, is not of length one within rounding: three digits of each of its numbers leave
// |length - 1| <= 5e-4 (|w| + |x| + |y| + |z|) <= 1e-3.
void warn_of_length(const Value& v, const Quat& q, const std::string& context) {
  constexpr double kRounded = 1e-3;
  if (v.list() == nullptr || v.list()->size() != 4) return;
  double length = 0;
  for (const double x : read_numbers(v, Unit::none, context)) length = std::hypot(length, x);
  if (std::abs(length - 1) <= kRounded) return;
  const std::string shown_length = text::number(std::round(1e4 * length) / 1e4);
  Finding f{&finding::quaternion_length,
            "",
            context + ": the quaternion has length " + shown_length,
            "it is normalised to [" + text::brief(q.w) + ", " + text::brief(q.x) + ", " + text::brief(q.y) + ", " +
                text::brief(q.z) + "] (scalar first)",
            length,
            1};
  f.place = v.where.text();
  report_finding(f);
}

// {"type": ..., ...} or a constant: the rest is read when the law is made.
void check_law_form(const Value& v, Form form, const std::string& context) {
  const bool vector = form == Form::translation_law || form == Form::rotation_law;
  if (vector && v.list() != nullptr) return;  // a constant vector or quaternion
  const bool constant = (v.number() != nullptr && !vector) ||
                        (v.text() != nullptr && !vector && read_quantity(*v.text(), Unit::any).problem.empty());
  if (constant) {
    read_number(v, Unit::any, context);  // rejects NaN and infinity
  } else if (v.object() == nullptr) {
    refuse(v.where, context,
           std::string("expected a law ({\"type\": ..., and its keys}, or a ") +
               (vector ? "list of numbers" : "number") + " for a constant one), got " + shown(v));
  } else if (v.find("type") == nullptr) {
    refuse(v.where, context, "the law has no \"type\"; add one, such as {\"type\": \"constant\", ...}");
  }
}

// Throws what the getter of this form would throw.
void check_value(const Value& v, const Key& key, const std::string& context) {
  const Form form = key.form;
  if (form == Form::number) read_number(v, key.unit, context);
  if (form == Form::integer) read_integer(v, context);
  if (form == Form::boolean) read_boolean(v, context);
  if (form == Form::text) read_text(v, context);
  if (form == Form::choice) read_choice(v, key.choices, context);
  if (form == Form::vector3) read_vector3(v, key.unit, context);
  if (form == Form::axis) read_axis(v, context);
  if (form == Form::orientation) read_orientation(v, context);
  if (form == Form::numbers) read_numbers(v, key.unit, context);
  if (form == Form::points) read_points(v, key.unit, context);
  if (!holds_law(form)) return;
  if (form != Form::laws) return check_law_form(v, form, context);
  const Value::List* items = v.list();
  if (items == nullptr) refuse(v.where, context, "expected a list of laws, got " + shown(v));
  for (std::size_t i = 0; i < items->size(); ++i) check_law_form((*items)[i], Form::law, item(context, i));
}

// " (a length in m: height of the bump)"
std::string description(const Key& key) {
  std::string words =
      key.form == Form::number && key.unit != Unit::none ? article_name_of(key.unit) : name_of(key.form);
  if (!si_unit(key.unit).empty()) words += " in " + si_unit(key.unit);
  return " (" + words + (key.help.empty() ? "" : ": " + key.help) + ")";
}

[[noreturn]] void refuse_missing(const SourceLocation& where, const Key& key, const std::string& owner) {
  lockstep::refuse(where, owner, "missing key \"" + key.name + "\"" + description(key) + "; add it");
}

// One line of UTF-8 without control characters: it goes to terminals and into JSON as it is.
bool is_plain(const std::string& text) {
  for (auto at = text.begin(); at != text.end();) {
    const auto c = boost::locale::utf::utf_traits<char>::decode(at, text.end());
    if (c < 0x20 || (c >= 0x7f && c < 0xa0) || !boost::locale::utf::is_valid_codepoint(c)) return false;
  }
  return true;
}

void check_plain(const std::string& text, const std::string& what) {
  if (!is_plain(text))
    throw ModelError(what + " is not a plain line of text: it has control characters, or is not UTF-8; rewrite it");
}

void check_known(const Value::Object& members, KeyTables tables, const std::string& owner) {
  Refusals wrong;
  for (auto member = members.begin(); member != members.end() && !wrong.full(); ++member) {
    const auto same = [&](const auto& other) { return other.key == member->key; };
    wrong.about(member->key).attempt([&] {
      if (std::find_if(members.begin(), member, same) != member)
        refuse(member->where, owner, "key \"" + member->key + "\" is given twice; remove one of the two");
      if (key_in(tables, member->key) != nullptr) return;
      std::vector<std::string> names;
      for (const bool required : {true, false})
        for (const Keys* keys : tables)
          for (const Key& key : *keys)
            if (key.required() == required) names.push_back(key.name);
      refuse(member->where, owner,
             "unknown key \"" + member->key + "\"" +
                 (names.empty() ? "; it takes no keys" : text::suggestion(member->key, names)));
    });
  }
  wrong.raise();
}

}  // namespace

const Key* key_in(KeyTables tables, std::string_view name) {
  for (const Keys* keys : tables)
    for (const Key& key : *keys)
      if (key.name == name) return &key;
  return nullptr;
}

void check_members(const Value& object, const std::string& type, KeyTables tables, const std::string& owner) {
  const Value::Object none, *members = object.is_null() ? &none : object.object();
  if (members == nullptr)
    refuse(object.where, owner,
           "expected an object with keys of '" + type + "', got " + shown(object) + "; see lockstep describe " + type);
  Refusals wrong;
  wrong.attempt([&] { check_known(*members, tables, owner); });
  const bool unknown = !wrong.empty();  // it may be meant for a key that is missing
  for (const Keys* keys : tables)
    for (const Key& key : *keys) {
      if (key_in(tables, key.name) != &key) continue;
      const Value* given = object.find(key.name);
      wrong.about(key.name).attempt([&] {
        if (given != nullptr) check_value(*given, key, part_of(owner, key.name));
        if (given == nullptr && !unknown && key.required()) refuse_missing(object.where, key, owner);
      });
    }
  wrong.raise();
}

Quat read_orientation_told(const Value& v, const std::string& context) {
  const Quat q = read_orientation(v, context);
  warn_of_length(v, q, context);
  return q;
}

bool holds_law(Form form) {
  return form == Form::law || form == Form::translation_law || form == Form::rotation_law || form == Form::laws;
}

std::string part_of(const std::string& owner, std::string_view part) {
  if (owner.empty() || part.empty()) return owner + std::string(part);
  // An owner that ends in a quoted name is a thing, any other is itself a part.
  return owner + (owner.back() == '\'' ? ", " : ".") + std::string(part);
}

std::string name_of(Form form) {
  constexpr std::array<const char*, 15> kNames{
      "number", "integer", "boolean",         "text",         "choice", "vector3", "axis", "orientation", "numbers",
      "points", "law",     "translation law", "rotation law", "laws",   "any"};
  return kNames.at(static_cast<std::size_t>(form));
}

void check_type_info(const TypeInfo& info) {
  if (info.name.empty()) throw ModelError("a type without a name: give its TypeInfo one");
  check_plain(info.name, "its name");
  check_plain(info.help, "its help");
  for (std::size_t i = 0; i < info.keys.size(); ++i) {
    const Key& key = info.keys[i];
    const std::string place = "type '" + info.name + "', key '" + key.name + "': ";
    if (key.name.empty())
      throw ModelError("type '" + info.name + "': key number " + std::to_string(i) + " has no name");
    check_plain(key.name, "the name of its key number " + std::to_string(i));
    check_plain(key.help, "the help of its key '" + key.name + "'");
    for (const std::string& choice : key.choices) check_plain(choice, "a choice of its key '" + key.name + "'");
    for (std::size_t j = 0; j < i; ++j)
      if (info.keys[j].name == key.name) throw ModelError(place + "it is listed twice in the table; remove one");
    if (key.form == Form::choice && key.choices.empty())
      throw ModelError(place + "a choice without choices; list them");
    if (key.default_value() == nullptr) continue;
    try {
      check_value(*key.default_value(), key, key.name);
    } catch (const SceneError& error) {
      throw ModelError(place + "its default, " + shown(*key.default_value()) + ", cannot be read: " + error.what());
    }
  }
}

Params::Params(std::initializer_list<std::pair<const char*, Value>> members)
    : object_(std::make_shared<const Value>(Value::object(members))), keys_(std::make_shared<const Keys>()) {}

void Params::put_law(const std::string& key, MadeLaw law) { laws_[key] = std::move(law); }

Params Params::unchecked(Value object) {
  return part(std::make_shared<const Value>(std::move(object)), std::make_shared<const Keys>(), {});
}

Params Params::part(std::shared_ptr<const Value> object, std::shared_ptr<const Keys> keys, std::string owner) {
  Params part;
  part.object_ = std::move(object), part.keys_ = std::move(keys), part.owner_ = std::move(owner);
  return part;
}

Params::Params(Value object, const TypeInfo& info, std::string owner)
    : Params(part(std::make_shared<const Value>(std::move(object)), std::make_shared<const Keys>(info.keys),
                  std::move(owner))) {
  check_members(*object_, info.name, {keys_.get()}, owner_);
}

Params Params::checked(const TypeInfo& info, std::string owner) const {
  return Params(*object_, info, std::move(owner));
}

const Key& Params::key_of(std::string_view name) const {
  if (const Key* key = key_in({keys_.get()}, name)) return *key;
  lockstep::refuse(object_->where, owner_,
                   "its maker asks for key \"" + std::string(name) + "\", which " +
                       (keys().empty() ? "has not been checked yet; call checked() first"
                                       : "its table does not list; add it to the type's keys"));
}

Value Params::given_or_default(const Key& key) const {
  if (const Value* given = object_->find(key.name)) return *given;
  Value v = key.default_value() != nullptr ? *key.default_value() : Value();
  v.where = object_->where;
  return v;
}

const Value& Params::needed(const Key& key) const {
  if (const Value* given = object_->find(key.name)) return *given;
  if (const Value* v = key.default_value()) return *v;
  refuse_missing(object_->where, key, owner_);
}

std::string Params::place_of(std::string_view key) const { return part_of(owner_, key); }

template <class L>
L Params::made(std::string_view name) const {
  const auto found = laws_.find(std::string(name));
  if (found == laws_.end()) {
    (void)needed(key_of(name));
    refuse(name, "it holds a law, but nothing here can make laws; pass a registry");
  }
  const L* law = std::get_if<L>(&found->second);
  if (law == nullptr)
    refuse(name, "its maker asks for another kind of law than its table lists; correct one of the two");
  return *law;
}

bool Params::has(std::string_view key) const { return object_->find(key) != nullptr; }

double Params::number(std::string_view name) const {
  const Key& key = key_of(name);
  return read_number(needed(key), key.unit, place_of(name));
}

int Params::integer(std::string_view name) const { return read_integer(needed(key_of(name)), place_of(name)); }

bool Params::boolean(std::string_view name) const { return read_boolean(needed(key_of(name)), place_of(name)); }

std::string Params::text(std::string_view name) const {
  std::string words = read_text(needed(key_of(name)), place_of(name));
  return name == "file" && has(name) ? path_of_file(value(name)) : words;
}

Vec3 Params::vector3(std::string_view name) const {
  const Key& key = key_of(name);
  const Value& v = needed(key);
  return key.form == Form::axis ? read_axis(v, place_of(name)) : read_vector3(v, key.unit, place_of(name));
}

Quat Params::orientation(std::string_view name) const {
  return read_orientation_told(needed(key_of(name)), place_of(name));
}

std::vector<double> Params::numbers(std::string_view name) const {
  const Key& key = key_of(name);
  return read_numbers(needed(key), key.unit, place_of(name));
}

std::vector<std::vector<double>> Params::points(std::string_view name) const {
  const Key& key = key_of(name);
  return read_points(needed(key), key.unit, place_of(name));
}

LawPtr<MotionLaw> Params::law(std::string_view key) const { return made<LawPtr<MotionLaw>>(key); }

LawPtr<TranslationLaw> Params::translation_law(std::string_view key) const { return made<LawPtr<TranslationLaw>>(key); }

LawPtr<RotationLaw> Params::rotation_law(std::string_view key) const { return made<LawPtr<RotationLaw>>(key); }

std::vector<LawPtr<MotionLaw>> Params::laws(std::string_view key) const { return *made<LawList>(key); }

const Value& Params::value(std::string_view key) const {
  static const Value kAbsent;
  const Value* given = object_->find(key);
  return given != nullptr ? *given : kAbsent;
}

void Params::refuse(std::string_view key, const std::string& problem) const {
  const Value* given = object_->find(key);
  lockstep::refuse(given != nullptr ? given->where : object_->where, place_of(key), problem, {.key = std::string(key)});
}

}  // namespace lockstep
