// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/definitions.h"

#include <algorithm>

#include <lockstep/body.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {

using expression::Amount;

namespace {

constexpr std::size_t kMostChained = 200;  // parameters that depend on one another

// A text with a unit, a number, or three of them.
std::optional<Amount> plain_quantity(const Value& v, const std::string& context) {
  if (v.list() != nullptr) {
    const Value::List& items = *v.list();
    if (items.size() != 3) return std::nullopt;
    Amount whole;
    whole.is_vector = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::optional<Amount> one = plain_quantity(items[k], item(context, k));
      if (!one || one->is_vector) return std::nullopt;
      if (k > 0 && (!(one->dimension == whole.dimension) || one->measured != whole.measured))
        refuse(items[k].where, item(context, k),
               "the components have different dimensions; give all of them the same unit");
      whole.v[k] = one->v[0], whole.dimension = one->dimension, whole.measured = one->measured;
    }
    return whole;
  }
  if (v.number() == nullptr && v.text() == nullptr) return std::nullopt;
  Amount q = Amount::number(read_number(v, Unit::any, context));
  q.measured = v.text() != nullptr;
  if (q.measured) q.dimension = expression::exponents_of(dimension_of_text(*v.text()));
  return q;
}

Amount as_point(Amount q, const SourceLocation& where, const std::string& context) {
  if (!q.is_vector) refuse(where, context, "a point is [x, y, z], but this is " + article_name_of(q));
  const expression::Exponents length{1, 0, 0, 0};
  if (q.measured && !(q.dimension == length))
    refuse(where, context, "a point consists of lengths, but this is " + article_name_of(q));
  q.dimension = length, q.measured = true;
  return q;
}

}  // namespace

Definitions::Definitions(const Value& root) {
  take(root, "parameters", false);
  add(root);
}

void Definitions::add(const Value& part) {
  take(part, "points", true);
  take_things(part, "bodies");
  take_things(part, "markers");
}

const Amount* Definitions::find(const std::string& name) {
  if (Entry* of_body = place(name)) return &value(*of_body);
  const auto found = index_.find(name);
  return found == index_.end() ? nullptr : &value(entries_[found->second]);
}

bool Definitions::is_point(const std::string& name) const {
  const auto found = index_.find(name);
  return found != index_.end() && entries_[found->second].point;
}

std::vector<std::string> Definitions::names(bool points_only) const {
  std::vector<std::string> all;
  for (const Entry& e : entries_)
    if (e.point || !points_only) all.push_back(e.name);
  return all;
}

std::vector<SceneParameter> Definitions::all() {
  std::vector<SceneParameter> out;
  for (Entry& e : entries_) out.push_back({e.name, e.point, placed_value(value(e), e.given->where), *e.given});
  return out;
}

Amount Definitions::evaluate(const Value& formula, const std::string& context) {
  return placed(formula.where, context, [&] {
    const expression::Expression e(*formula.text());
    const expression::Names known = [this](const std::string& name) { return find(name); };
    return expression::evaluate(e, known, [this] {
      std::vector<std::string> all = names(false);
      for (const auto& [thing, object] : things_) all.push_back(thing + ".at");
      return all;
    });
  });
}

Value Definitions::resolved(Value v, const std::string& context) {
  if (is_formula(v)) return placed_value(evaluate(v, context), v.where);
  if (Value::List* items = v.list())
    for (std::size_t i = 0; i < items->size(); ++i) (*items)[i] = resolved((*items)[i], item(context, i));
  if (Value::Object* members = v.object())
    for (Value::Member& m : *members) m.value = resolved(m.value, part_of(context, m.key));
  return v;
}

Value Definitions::placed_value(const Amount& q, const SourceLocation& where) {
  return placed_at(where, expression::value_of(q));
}

void Definitions::take(const Value& root, const char* key, bool points) {
  const Value* object = root.find(key);
  if (object == nullptr) return;
  if (object->object() == nullptr)
    refuse(object->where, part_of("scene", key),
           std::string("expected an object of ") + (points ? "points" : "numbers") + " by name, got " + shown(*object));
  for (const Value::Member& m : *object->object()) {
    if (const std::string fault = expression::name_fault(m.key); !fault.empty())
      refuse(m.where, part_of("scene", key),
             "\"" + m.key + "\" cannot name a " + (points ? "point" : "parameter") + ": " + fault);
    const auto [known, fresh] = index_.emplace(m.key, entries_.size());
    if (!fresh)
      refuse(m.where, part_of("scene", key),
             "\"" + m.key + "\" is a " + (entries_[known->second].point ? "point" : "parameter") +
                 " already; rename one of the two");
    entries_.push_back({m.key, points, &m.value});
  }
}

const Amount& Definitions::value(Entry& e) {
  if (e.value) return *e.value;
  if (e.refusal) std::rethrow_exception(e.refusal);
  const std::string context =
      e.place.empty() ? part_of(part_of("scene", e.point ? "points" : "parameters"), e.name) : "\"" + e.name + "\"";
  const auto begun = std::find(open_.begin(), open_.end(), &e);
  if (begun != open_.end()) {
    std::string circle;
    for (auto it = begun; it != open_.end(); ++it) circle += (*it)->name + " -> ";
    refuse(e.given->where, context, "it depends on itself: " + circle + e.name + "; give one of them a number");
  }
  if (open_.size() == kMostChained)
    refuse(e.given->where, context,
           "more than " + std::to_string(kMostChained) + " parameters depend on one another; shorten the chain");
  open_.push_back(&e);
  try {
    const Amount q = e.place.empty() ? given(*e.given, context, e.point) : Amount{place_of(e), true};
    e.value = e.point ? as_point(q, e.given->where, context) : q;
  } catch (...) {  // values that depend on it fail for the same reason
    e.refusal = std::current_exception();
    open_.pop_back();
    throw;
  }
  open_.pop_back();
  return *e.value;
}

// -- places of bodies and markers, as the scene gives them

void Definitions::take_things(const Value& root, const char* list) {
  for (const Value& object : items(root, list))
    if (const std::string* name = text_under(object, "name")) things_.emplace(*name, &object);
}

// Of "rod.to"; nullptr for other names. Entries stay where they are in memory: others may be open.
Definitions::Entry* Definitions::place(const std::string& name) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) return nullptr;
  if (const auto known = places_.find(name); known != places_.end()) return &known->second;
  const auto thing = things_.find(name.substr(0, dot));
  if (thing == things_.end()) return nullptr;
  return &places_.emplace(name, Entry{name, true, thing->second, {}, name.substr(dot + 1)}).first->second;
}

Vec3 Definitions::place_of(const Entry& e) {
  const Value& object = *e.given;
  const Value* carrier = object.find("body");
  if (carrier == nullptr) return place_of_body(e);
  const std::string owner = owner_of("marker", *object.find("name")->text());
  if (e.place != "at") refuse(object.where, owner, "it has no \"." + e.place + "\"; a marker has \".at\"");
  if (object.find("world_at") != nullptr) return vector_under(object, "world_at", owner);
  const Value* at = object.find("at");
  if (at != nullptr && at->text() != nullptr && !is_formula(*at)) return vector_under(object, "at", owner);  // a point
  const Vec3 own = vector_under(object, "at", owner);
  const std::string body = carrier->text() != nullptr ? *carrier->text() : "";
  if (body == "ground" || !things_.contains(body)) return own;
  const Pose home = home_of(body);
  return home.x + rotation(home.q) * own;
}

Vec3 Definitions::place_of_body(const Entry& e) {
  const std::string owner = owner_of("body", *e.given->find("name")->text());
  const Value* rod = e.given->find("rod");
  if (rod != nullptr && rod->object() != nullptr) {
    const auto end = [&](const std::string& key) { return vector_under(*rod, key, part_of(owner, "rod")); };
    return e.place == "at" ? Vec3(0.5 * (end("from") + end("to"))) : end(e.place);
  }
  if (e.place != "at")
    refuse(e.given->where, owner, "it is not a rod and has no \"." + e.place + "\"; its origin is \".at\"");
  return vector_under(*e.given, "position", owner);
}

// A point by name, a formula or numbers; the origin where the key is not given.
Vec3 Definitions::vector_under(const Value& object, const std::string& key, const std::string& owner) {
  const Value* v = object.find(key);
  if (v == nullptr) return Vec3::Zero();
  const std::string context = part_of(owner, key);
  const bool named = v->text() != nullptr && is_point(*v->text());
  return named ? find(*v->text())->v : as_point(given(*v, context, true), v->where, context).v;
}

Pose Definitions::home_of(const std::string& body) {
  const Value& object = *things_.at(body);
  const std::string owner = owner_of("body", body);
  const Value *rod = object.find("rod"), *orientation = object.find("orientation");
  Pose home{find(body + ".at")->v, {}};
  if (orientation != nullptr) {
    const std::string context = part_of(owner, "orientation");
    home.q = read_orientation(resolved(*orientation, context), context);
  } else if (rod != nullptr && rod->object() != nullptr) {
    const Vec3 from = find(body + ".from")->v, to = find(body + ".to")->v;
    home.q = placed(rod->where, owner, [&] { return shapes::slender_rod(1, from, to, 1).home.q; });
    if (const Value* roll = rod->find("roll")) {
      const std::string context = part_of(part_of(owner, "rod"), "roll");
      home.q = home.q * axis_angle(Vec3::UnitX(), read_number(resolved(*roll, context), Unit::angle, context));
    }
  }
  return home;
}

Amount Definitions::given(const Value& v, const std::string& context, bool point) {
  if (is_formula(v)) return evaluate(v, context);
  Value plain = v;
  Value::List* items = plain.list();
  for (std::size_t k = 0; items != nullptr && k < items->size(); ++k) {
    Value& each = (*items)[k];
    if (is_formula(each)) each = placed_value(evaluate(each, item(context, k)), each.where);
    if (point && each.number() != nullptr) replace(each, text::number(read_number(each, Unit::length, context)) + " m");
  }
  std::optional<Amount> q = plain_quantity(plain, context);
  if (!q)
    refuse(v.where, context,
           std::string("expected ") + (point ? "[x, y, z]" : "a number, a text such as \"100 mm\"") +
               " or a formula, got " + shown(v));
  return *q;
}

}  // namespace lockstep
