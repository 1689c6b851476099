#include "framework/description/scene/resolve.h"

#include <algorithm>
#include <map>
#include <optional>

#include <lockstep/error.h>
#include <lockstep/registry.h>
#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/mechanism/expression/quantity.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

using expression::Amount;

constexpr int kMostChained = 200;  // parameters that hang on one another

bool is_formula(const Value& v) { return v.text() != nullptr && v.text()->starts_with('='); }

bool holds_formula(const Value& v) {
  if (is_formula(v)) return true;
  if (const Value::List* items = v.list()) return std::any_of(items->begin(), items->end(), holds_formula);
  const Value::Object* members = v.object();
  return members != nullptr &&
         std::any_of(members->begin(), members->end(), [](const auto& m) { return holds_formula(m.value); });
}

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

/// The parameters and points of a scene, each computed when it is first read.
class Definitions {
 public:
  void read(const Value& root) {
    take(root, "parameters", false);
    take(root, "points", true);
  }
  bool empty() const { return entries_.empty(); }

  const Amount* find(const std::string& name) {
    const auto found = index_.find(name);
    return found == index_.end() ? nullptr : &value(entries_[found->second]);
  }
  bool is_point(const std::string& name) const {
    const auto found = index_.find(name);
    return found != index_.end() && entries_[found->second].point;
  }
  std::vector<std::string> names(bool points_only) const {
    std::vector<std::string> all;
    for (const Entry& e : entries_)
      if (e.point || !points_only) all.push_back(e.name);
    return all;
  }
  std::vector<SceneParameter> all() {
    std::vector<SceneParameter> out;
    for (Entry& e : entries_) out.push_back({e.name, e.point, placed_value(value(e), e.given->where), *e.given});
    return out;
  }

  /// The value of a formula.
  Amount evaluate(const Value& formula, const std::string& context) {
    return placed(formula.where, context, [&] {
      const expression::Expression e(*formula.text());
      return expression::evaluate(
          e, [this](const std::string& name) { return find(name); }, names(false));
    });
  }

  static Value placed_value(const Amount& q, const Where& where) {
    Value v = expression::value_of(q);
    v.where = where;
    if (Value::List* items = v.list())
      for (Value& each : *items) each.where = where;
    return v;
  }

 private:
  struct Entry {
    std::string name;
    bool point;
    const Value* given;
    std::optional<Amount> value{};
  };

  void take(const Value& root, const char* key, bool points) {
    const Value* object = root.find(key);
    if (object == nullptr) return;
    if (object->object() == nullptr)
      refuse(
          object->where, part_of("scene", key),
          std::string("expected an object of ") + (points ? "points" : "numbers") + " by name, got " + shown(*object));
    for (const Value::Member& m : *object->object()) {
      std::string problem;
      if (!expression::is_name(m.key, problem))
        refuse(m.where, part_of("scene", key),
               "\"" + m.key + "\" cannot name a " + (points ? "point" : "parameter") + ": " + problem);
      if (!index_.emplace(m.key, entries_.size()).second)
        refuse(m.where, part_of("scene", key),
               "\"" + m.key + "\" is a parameter already; formulas read both by name, so rename one of the two");
      entries_.push_back({m.key, points, &m.value});
    }
  }

  const Amount& value(Entry& e) {
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
    if (e.point) q = as_point(q, e, context);
    e.value = q;
    return *e.value;
  }

  Amount given(const Value& v, const std::string& context, bool point) {
    if (is_formula(v)) return evaluate(v, context);
    Value plain = v;
    Value::List* items = plain.list();
    for (std::size_t k = 0; items != nullptr && k < items->size(); ++k) {
      Value& each = (*items)[k];
      const Where where = each.where;
      if (is_formula(each)) each = placed_value(evaluate(each, item(context, k)), where);
      if (point && each.number() != nullptr)
        each = Value(text::number(read_number(each, Unit::length, context)) + " m");
      each.where = where;
    }
    std::optional<Amount> q = plain_quantity(plain, context);
    if (!q)
      refuse(v.where, context,
             std::string("expected ") + (point ? "[x, y, z]" : "a number, a text such as \"100 mm\"") +
                 " or a formula, got " + shown(v));
    return *q;
  }

  static Amount as_point(Amount q, const Entry& e, const std::string& context) {
    if (!q.is_vector) refuse(e.given->where, context, "a point is [x, y, z], and this is " + article_name_of(q));
    const expression::Exponents length{1, 0, 0, 0};
    if (q.measured && !(q.dimension == length))
      refuse(e.given->where, context, "a point is made of lengths, and this is " + article_name_of(q));
    q.dimension = length, q.measured = true;
    return q;
  }

  std::vector<Entry> entries_;
  std::map<std::string, std::size_t> index_;
  std::vector<const Entry*> open_;
};

/// What the tables say of the texts of a type: keys that hold texts, not numbers, and whether it is given the parameters.
struct Texts {
  std::vector<std::string> keys{};
  bool takes_parameters = false;
};

void add_texts(const TypeInfo& info, Texts& texts) {
  const bool takes =
      std::any_of(info.keys.begin(), info.keys.end(), [](const Key& k) { return k.name == "parameters"; });
  texts.takes_parameters = texts.takes_parameters || takes;
  for (const Key& key : info.keys)
    if (key.form == Form::text || key.form == Form::choice || (takes && key.form == Form::any))
      texts.keys.push_back(key.name);
}

Texts texts_of_type(const std::string& type) {
  static const Registry kBuiltIn = builtin_registry();
  Texts texts;
  const auto look = [&](const auto& shelf) {
    if (const auto* entry = shelf.find(type)) add_texts(entry->info, texts);
  };
  look(kBuiltIn.laws), look(kBuiltIn.translation_laws), look(kBuiltIn.rotation_laws);
  look(kBuiltIn.links), look(kBuiltIn.forces);
  return texts;
}

class Resolver {
 public:
  explicit Resolver(Scene& scene) : scene_(scene) {}

  void resolve() {
    definitions_.read(scene_.written);
    Value::Object& root = *scene_.root.object();
    scene_.parameters = definitions_.all();
    for (Value::Member& m : root) {
      static const std::vector<std::string> kTexts = {"$schema", "title", "description", "requires"};
      if (std::find(kTexts.begin(), kTexts.end(), m.key) != kTexts.end()) continue;
      if (m.key == "parameters" || m.key == "points")
        settle(m);
      else
        list(m);
    }
  }

 private:
  // "parameters" and "points" as they are computed.
  void settle(Value::Member& m) {
    for (Value::Member& each : *m.value.object())
      for (const SceneParameter& p : scene_.parameters)
        if (p.name == each.key) note(each.value), each.value = p.value;
  }

  void list(Value::Member& m) {
    static const std::map<std::string, std::string> kKinds = {
        {"bodies", "body"}, {"markers", "marker"}, {"links", "link"}, {"forces", "force"}, {"events", "event"}};
    const auto kind = kKinds.find(m.key);
    if (kind == kKinds.end() || m.value.list() == nullptr)
      return walk(m.value, m.key == "run" ? "run" : part_of("scene", m.key));
    for (std::size_t i = 0; i < m.value.list()->size(); ++i) {
      Value& object = (*m.value.list())[i];
      const std::string owner = owner_of(kind->second, object, m.key, i);
      if (object.object() != nullptr) named_points(kind->second, object, owner);
      walk(object, owner);
    }
  }

  // -- names of points
  void named_points(const std::string& kind, Value& object, const std::string& owner) {
    if (kind == "body") {
      for (Value::Member& m : *object.object()) {
        if (m.key == "position") point(m.value, part_of(owner, m.key));
        if (m.key == "rod" && m.value.object() != nullptr)
          for (Value::Member& end : *m.value.object())
            if (end.key == "from" || end.key == "to") point(end.value, part_of(part_of(owner, "rod"), end.key));
      }
    } else if (kind == "marker") {
      for (Value::Member& m : *object.object())
        if (m.key == "world_at" || m.key == "at")
          if (point(m.value, part_of(owner, m.key))) m.key = "world_at";
    } else if (kind == "link" || kind == "force") {
      places(object, owner);
      for (Value::Member& m : *object.object())
        if (m.key == "pairs" && m.value.list() != nullptr)
          for (std::size_t i = 0; i < m.value.list()->size(); ++i)
            places((*m.value.list())[i], item(part_of(owner, "pairs"), i));
    }
  }
  void places(Value& object, const std::string& owner) {
    if (object.object() == nullptr) return;
    for (Value::Member& m : *object.object())
      if (m.key == "at" || m.key == "at_p" || m.key == "at_s") point(m.value, part_of(owner, m.key));
  }
  // The numbers of the point that is named; false where none is named.
  bool point(Value& v, const std::string& context) {
    if (v.text() == nullptr || is_formula(v)) return false;
    const std::string name = *v.text();
    if (!definitions_.is_point(name)) {
      const std::vector<std::string> points = definitions_.names(true);
      if (points.empty()) return false;  // the reader of the key says what it expects
      refuse(v.where, context, "unknown point \"" + name + "\"" + text::suggestion(name, points));
    }
    v = Definitions::placed_value(*definitions_.find(name), v.where);
    return true;
  }

  // -- formulas
  void note(const Value& v) {
    if (is_formula(v)) scene_.formulas.emplace_back(v.where, *v.text());
  }

  void walk(Value& v, const std::string& context) {
    if (is_formula(v)) {
      note(v);
      v = Definitions::placed_value(definitions_.evaluate(v, context), v.where);
    } else if (Value::List* items = v.list()) {
      for (std::size_t i = 0; i < items->size(); ++i)
        if (needs_walk((*items)[i])) walk((*items)[i], item(context, i));
    } else if (v.object() != nullptr) {
      object(v, context);
    }
  }
  // Numbers do not; a context is a text to be made.
  static bool needs_walk(const Value& v) { return v.text() != nullptr || v.list() != nullptr || v.object() != nullptr; }

  void object(Value& v, const std::string& context) {
    const Value* type = v.find("type");
    const Texts texts = type != nullptr && type->text() != nullptr ? texts_of_type(*type->text()) : Texts{};
    const auto is_text = [&](const std::string& key) {
      return key == "name" || key == "type" || key == "record" || key == "draw" ||
             std::find(texts.keys.begin(), texts.keys.end(), key) != texts.keys.end();
    };
    for (Value::Member& m : *v.object())
      if (needs_walk(m.value) && (m.key == "parameters" || !is_text(m.key))) walk(m.value, part_of(context, m.key));
    if (texts.takes_parameters) give_parameters(v);
  }

  // The scene's parameters, but for those that the object names itself.
  void give_parameters(Value& v) {
    if (scene_.parameters.empty()) return;
    auto own =
        std::find_if(v.object()->begin(), v.object()->end(), [](const auto& m) { return m.key == "parameters"; });
    if (own == v.object()->end()) {
      v.object()->push_back({"parameters", Value(Value::Object{}), v.where});
      v.object()->back().value.where = v.where;
      own = std::prev(v.object()->end());
    }
    if (own->value.object() == nullptr) return;  // refused by its reader
    for (const SceneParameter& p : scene_.parameters)
      if (own->value.find(p.name) == nullptr) own->value.object()->push_back({p.name, p.value, p.value.where});
  }

  Scene& scene_;
  Definitions definitions_;
};

}  // namespace

void resolve_formulas(Scene& scene) {
  const Value& root = scene.root;
  if (root.find("parameters") == nullptr && root.find("points") == nullptr && !holds_formula(root)) return;
  scene.written = root;
  Resolver(scene).resolve();
}

}  // namespace lockstep
