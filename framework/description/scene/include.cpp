// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/reading.h"
#include "framework/foundation/support/finding_kinds.h"

#include <algorithm>
#include <deque>
#include <filesystem>
#include <set>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/definitions.h"
#include "framework/description/scene/json.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/params/csv_reader.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

/// Puts a prefix before the names of an included scene wherever its objects name one another.
class Renaming {
 public:
  Renaming(Value& scene, std::string prefix) : prefix_(std::move(prefix)) {
    for (const auto& [list, kind] : kThings)
      for (const Value& object : items(scene, list))
        if (const std::string* name = text_under(object, "name")) names_.insert(*name);
  }

  void apply(Value& scene) const {
    if (prefix_.empty()) return;
    for (const auto& [list, kind] : kThings)
      for (Value& object : items(scene, list)) {
        for (const char* key : {"name", "body", "p", "s", "link"}) text(member(object, key));
        for (Value& pair : items(object, "pairs")) text(&pair), text(member(pair, "p")), text(member(pair, "s"));
        for (const char* key : {"activate", "deactivate"})
          for (Value& link : items(object, key)) text(&link);
        if (Value* when = member(object, "when")) channel(member(*when, "channel"));
      }
    for (Value::Member& point : members(scene, "points")) point.key = prefix_ + point.key;
  }

 private:
  // "A", and "A.stop_z_low" or "A.friction", which are parts of a joint.
  void text(Value* v) const {
    if (v == nullptr || v->text() == nullptr) return;
    const std::string old = *v->text();
    if (names_.contains(old) || names_.contains(old.substr(0, old.find('.')))) replace(*v, prefix_ + old);
  }
  // "A.x", "a.x@b": names are at its beginning and after "@".
  void channel(Value* v) const {
    if (v == nullptr || v->text() == nullptr) return;
    const std::string old = *v->text();
    std::string now;
    for (std::size_t i = 0; i < old.size();) {
      const std::size_t end = std::min(old.find_first_of(".@", i), old.size());
      const std::string word = old.substr(i, end - i);
      const bool first = i == 0 || old[i - 1] == '@';
      now += (first && names_.contains(word) ? prefix_ : "") + word + (end < old.size() ? old.substr(end, 1) : "");
      i = end + 1;
    }
    replace(*v, std::move(now));
  }

  std::set<std::string> names_;
  std::string prefix_;
};

using Formulas = std::vector<std::pair<SourceLocation, std::string>>;

// Gives the included scene's parameters the values that are asked for.
void set_parameters(Value& scene, const Params& p, Definitions& outer, Formulas& formulas) {
  if (!p.has("parameters")) return;
  const Value& given = p.value("parameters");
  const std::string owner = part_of(p.owner(), "parameters");
  if (given.object() == nullptr) p.refuse("parameters", "expected an object of numbers by name, got " + shown(given));
  Value* own = member(scene, "parameters");
  for (const Value::Member& m : *given.object()) {
    Value* to = own != nullptr ? member(*own, m.key) : nullptr;
    if (to == nullptr) {
      std::vector<std::string> known;
      for (const Value::Member& k : members(scene, "parameters")) known.push_back(k.key);
      refuse(m.where, owner, "the scene has no parameter \"" + m.key + "\"" + text::suggestion(m.key, known));
    }
    if (is_formula(m.value)) formulas.emplace_back(m.value.where, *m.value.text());
    *to = outer.resolved(m.value, part_of(owner, m.key));
  }
}

// The include's place with the values of formulas and points.
Value settled(const Value& include, const std::string& owner, Definitions& outer, Formulas& formulas) {
  Value v = include;
  if (v.object() == nullptr) return v;
  for (Value::Member& m : *v.object()) {
    if (m.key != "at" && m.key != "orientation") continue;
    const bool named = m.key == "at" && m.value.text() != nullptr && outer.is_point(*m.value.text());
    if (is_formula(m.value)) formulas.emplace_back(m.value.where, *m.value.text());
    m.value = named ? Definitions::placed_value(*outer.find(*m.value.text()), m.value.where)
                    : outer.resolved(m.value, part_of(owner, m.key));
  }
  return v;
}

// The rule judges the path alone; the file is looked for only after that.
std::string path_of(const Params& p, const SceneReading& reading) {
  namespace fs = std::filesystem;
  const fs::path path = path_of_file(p.value("scene"));
  if (reading.rule) reading.rule(p.value("scene"), path.string());
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error))
    p.refuse("scene", "\"" + p.text("scene") + "\" is not a regular file; name a scene file");
  for (const std::string& file : reading.files)
    if (fs::equivalent(path, file, error)) p.refuse("scene", "\"" + p.text("scene") + "\" includes itself; remove it");
  if (reading.files.size() > kMostDepth)
    p.refuse("scene", "scenes include one another more than " + std::to_string(kMostDepth) + " deep; flatten them");
  return path.lexically_normal().string();
}

// Keys of an included scene that affect the whole motion, unless they hold the default.
void note_left_out(const Value& root, SceneReading& reading) {
  const auto note = [&](const char* key, const Value& value, const std::string& words) {
    reading.left_out.push_back({value.where, key, words});
  };
  if (const Value* g = root.find("gravity"))
    if (const Vec3 v = read_vector3(*g, Unit::acceleration, "scene, gravity"); !v.isZero(0))
      note("gravity", *g, "[" + text::brief(v[0]) + ", " + text::brief(v[1]) + ", " + text::brief(v[2]) + "] m/s^2");
  for (const auto& [key, same] : {std::pair{"planar", "auto"}, {"merge", "off"}})
    if (const Value* word = root.find(key); word != nullptr && word->text() != nullptr && *word->text() != same)
      note(key, *word, "\"" + *word->text() + "\"");
  if (const Value* conditions = root.find("require")) note("require", *conditions, shown(*conditions));
}

Value read_included(const Params& p, Definitions& outer, SceneReading& reading, Formulas& formulas) {
  Scene inner;
  inner.file = path_of(p, reading);
  inner.root = read_json_file(inner.file);
  if (inner.root.object() == nullptr) p.refuse("scene", "\"" + inner.file + "\" is not an object");
  check_format(inner.root);
  rename_joints(inner.root);
  set_parameters(inner.root, p, outer, formulas);
  reading.files.push_back(inner.file);
  resolve_formulas(inner, reading);
  reading.files.pop_back();
  read_root(inner);
  note_left_out(inner.root, reading);
  formulas.insert(formulas.end(), inner.formulas.begin(), inner.formulas.end());
  if (p.has("at") || p.has("orientation"))
    with_formulas(inner, [&] { move_scene(inner.root, {p.vector3("at"), p.orientation("orientation")}); });
  Renaming(inner.root, p.text("prefix")).apply(inner.root);
  return std::move(inner.root);
}

constexpr const char* kBrought[] = {"requires", "points", "bodies", "markers", "links", "forces", "events"};

}  // namespace

void expand_includes(Value& root, SceneReading& reading, Formulas& formulas) {
  const Value source = root;
  const Value& includes = *source.find("include");
  if (includes.list() == nullptr)
    refuse(includes.where, "scene.include", "expected a list of objects, got " + shown(includes));
  Definitions definitions(source);
  std::deque<Value> parts;  // stay where they are: `definitions` looks into them
  for (std::size_t i = 0; i < includes.list()->size(); ++i) {
    const Value& include = (*includes.list())[i];
    const std::string owner = item("include", i);
    const Value object = settled(include, owner, definitions, formulas);
    parts.push_back(read_included(params_of(object, "include", owner, nullptr), definitions, reading, formulas));
    definitions.add(parts.back());  // formulas of later parts can read its points
  }
  parts.push_back(root.without({"include"}));  // what is brought comes before the scene's own
  root = parts.back();
  for (const char* key : kBrought) {
    Value brought(Value::Object{});
    for (Value& part : parts)
      if (Value* v = member(part, key)) append(brought, key, std::move(*v), part_of("scene", key));
    if (Value* all = member(brought, key)) made_under(root, key, {}) = std::move(*all);
  }
}

void tell_left_out(const Value& root, const SceneReading& reading) {
  std::set<std::string> told;  // a scene may be included several times
  for (const LeftOutKey& out : reading.left_out)
    if (root.find(out.key) == nullptr && told.insert(out.where.text()).second)
      report_finding({.kind = &finding::not_included,
                      .message = "scene, " + out.key + ": " + out.value +
                                 " of an included scene has no effect; the including scene gives none",
                      .advice = "add \"" + out.key + "\" to the including scene",
                      .place = out.where.text()});
}

}  // namespace lockstep
