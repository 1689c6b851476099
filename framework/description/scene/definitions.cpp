#include "framework/description/scene/definitions.h"

#include <algorithm>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {

using expression::Amount;

namespace {

constexpr std::size_t kMostChained = 200;  // parameters that hang on one another

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
               "the components are of different dimensions; give all of them the same unit");
      whole.v[k] = one->v[0], whole.dimension = one->dimension, whole.measured = one->measured;
    }
    return whole;
  }
  if (v.number() != nullptr) return Amount::number(read_number(v, Unit::any, context));
  if (v.text() == nullptr) return std::nullopt;
  Amount q = Amount::number(read_number(v, Unit::any, context));
  const std::string_view text = text::trimmed(*v.text());
  std::size_t unit = text.find_first_of(" \t");
  if (unit == std::string_view::npos || !dimension_of(text::trimmed(text.substr(unit)))) {  // "12mm"
    for (unit = 0; unit < text.size() && !dimension_of(text::trimmed(text.substr(unit)));) ++unit;
  }
  const Dimension d = dimension_of(text::trimmed(text.substr(unit))).value_or(Dimension{});
  q.dimension = {double(d.m), double(d.kg), double(d.s), double(d.rad)}, q.measured = true;
  return q;
}

Amount as_point(Amount q, const Where& where, const std::string& context) {
  if (!q.is_vector) refuse(where, context, "a point is [x, y, z], and this is " + article_name_of(q));
  const expression::Exponents length{1, 0, 0, 0};
  if (q.measured && !(q.dimension == length))
    refuse(where, context, "a point is made of lengths, and this is " + article_name_of(q));
  q.dimension = length, q.measured = true;
  return q;
}

}  // namespace

Definitions::Definitions(const Value& root) {
  take(root, "parameters", false);
  take(root, "points", true);
}

const Amount* Definitions::find(const std::string& name) {
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
    return expression::evaluate(e, known, [this] { return names(false); });
  });
}

Value Definitions::placed_value(const Amount& q, const Where& where) {
  Value v = expression::value_of(q);
  v.where = where;
  if (Value::List* items = v.list())
    for (Value& each : *items) each.where = where;
  return v;
}

void Definitions::take(const Value& root, const char* key, bool points) {
  const Value* object = root.find(key);
  if (object == nullptr) return;
  if (object->object() == nullptr)
    refuse(object->where, part_of("scene", key),
           std::string("expected an object of ") + (points ? "points" : "numbers") + " by name, got " + shown(*object));
  for (const Value::Member& m : *object->object()) {
    std::string problem;
    if (!expression::is_name(m.key, problem))
      refuse(m.where, part_of("scene", key),
             "\"" + m.key + "\" cannot name a " + (points ? "point" : "parameter") + ": " + problem);
    const auto [known, fresh] = index_.emplace(m.key, entries_.size());
    if (!fresh)
      refuse(m.where, part_of("scene", key),
             "\"" + m.key + "\" is a " + (entries_[known->second].point ? "point" : "parameter") +
                 " already; formulas read all by name, so rename one of the two");
    entries_.push_back({m.key, points, &m.value});
  }
}

const Amount& Definitions::value(Entry& e) {
  if (e.value) return *e.value;
  const std::string context = part_of(part_of("scene", e.point ? "points" : "parameters"), e.name);
  const auto begun = std::find(open_.begin(), open_.end(), &e);
  if (begun != open_.end()) {
    std::string circle;
    for (auto it = begun; it != open_.end(); ++it) circle += (*it)->name + " -> ";
    refuse(e.given->where, context, "it hangs on itself: " + circle + e.name + "; give one of them a number");
  }
  if (open_.size() == kMostChained)
    refuse(e.given->where, context,
           "more than " + std::to_string(kMostChained) + " parameters hang on one another; shorten the chain");
  open_.push_back(&e);
  Amount q = given(*e.given, context, e.point);
  open_.pop_back();
  if (e.point) q = as_point(q, e.given->where, context);
  e.value = q;
  return *e.value;
}

Amount Definitions::given(const Value& v, const std::string& context, bool point) {
  if (is_formula(v)) return evaluate(v, context);
  Value plain = v;
  Value::List* items = plain.list();
  for (std::size_t k = 0; items != nullptr && k < items->size(); ++k) {
    Value& each = (*items)[k];
    const Where where = each.where;
    if (is_formula(each)) each = placed_value(evaluate(each, item(context, k)), where);
    if (point && each.number() != nullptr) each = Value(text::number(read_number(each, Unit::length, context)) + " m");
    each.where = where;
  }
  std::optional<Amount> q = plain_quantity(plain, context);
  if (!q)
    refuse(v.where, context,
           std::string("expected ") + (point ? "[x, y, z]" : "a number, a text such as \"100 mm\"") +
               " or a formula, got " + shown(v));
  return *q;
}

}  // namespace lockstep
