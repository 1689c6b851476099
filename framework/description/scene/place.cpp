// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/place.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <optional>
#include <string_view>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/registry/shelves.h"
#include "framework/description/scene/split.h"
#include "framework/description/scene/tables.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

constexpr std::size_t kMostLeaves = 20'000;  // that are searched for a near path

/// A value as the tables describe it: its key and part, and the keys of an object.
struct Kind {
  Key key{};
  Part part{};  // without a key if it has none
  Keys keys{};
  std::vector<Part> parts{};
};

void add_type(Kind& kind, const Value& v, const Registry& registry, std::string_view shelf) {
  const std::string* type = text_under(v, "type");
  const TypeInfo* info = type != nullptr ? find_type(registry, shelf, *type) : nullptr;
  if (info != nullptr) kind.keys = keys_together(kind.keys, info->keys);
}

// The kind of v, which is under the key and part of `kind`; the items of a list keep both.
Kind kind_of(const Value& v, Kind kind, const Registry& registry) {
  if (v.object() == nullptr) return kind;
  const std::string& table = kind.part.table;
  if (kind.part.names_type()) {
    add_type(kind, v, registry, table);
  } else if (!table.empty()) {
    const SceneTable& t = scene_table(table);
    kind.keys = t.info.keys, kind.parts = t.parts;
    add_type(kind, v, registry, t.shelf);
  }
  add_type(kind, v, registry, shelf_of(kind.key.form));
  return kind;
}

// The kind of the value under a key of an object of this kind.
Kind under(const Kind& object, const std::string& name) {
  Kind kind;
  kind.key.form = Form::any, kind.key.unit = Unit::any;
  if (const Key* key = key_in({&object.keys}, name)) kind.key = *key;
  for (const Part& part : object.parts)
    if (part.key == name) kind.part = part;
  return kind;
}

std::string step_to(const Value& item, std::size_t index) {
  const std::string* name = text_under(item, "name");
  return name != nullptr ? *name : std::to_string(index);
}

// Whether its type is unknown.
bool has_unknown_type(const Value& object, const Registry& r) {
  const std::string* type = text_under(object, "type");
  bool known = type == nullptr;
  for_each_shelf([&](auto, auto, auto shelf) { known = known || (r.*shelf).find(*type) != nullptr; });
  return !known;
}

/// Where a path fails.
struct Miss {
  std::size_t step = 0;  // the first that is unknown; the number of steps: the path leads to several values
  std::vector<std::string> candidates{};
  std::string problem{};
};

class Walk {
 public:
  Walk(Value& root, std::vector<std::string> steps, const Registry& registry, bool before_plugins = false)
      : registry_(registry), before_plugins_(before_plugins), root_(root), steps_(std::move(steps)), here_(&root) {
    kind_ = kind_of(root, {.part = {"", "object", "scene"}}, registry_);
  }

  std::optional<Miss> go() {
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const bool found = here_->object() != nullptr ? into_object(i) : here_->list() != nullptr && into_list(i);
      if (!found) return miss(i);
    }
    return several() ? std::optional(miss(steps_.size())) : std::nullopt;
  }
  ScenePlace place() const {
    Key key = kind_.key;
    if (kind_.part.names_type())
      key.choices = kind_.part.table == "solvers" ? registry_.solvers.names() : registry_.integrators.names();
    return {here_, path_, "", false, std::move(key)};
  }

 private:
  bool into_object(std::size_t i) {
    const std::string& name = steps_[i];
    Value::Object& members = *here_->object();
    const Kind kind = under(kind_, name);
    auto member = std::find_if(members.begin(), members.end(), [&](const auto& m) { return m.key == name; });
    if (member == members.end()) {
      const bool last = i + 1 == steps_.size();
      inserted_unknown_ = kind.key.name.empty() && last && before_plugins_ && has_unknown_type(*here_, registry_);
      if (!inserted_unknown_ && (kind.key.name.empty() || (kind.key.required() && !last))) return false;
      Value fresh = by_default(kind, last);
      fresh.where = here_->where;
      members.push_back({name, std::move(fresh), here_->where});
      member = std::prev(members.end());
    }
    here_ = &member->value;
    kind_ = kind_of(*here_, kind, registry_);
    path_ += (path_.empty() ? "" : ".") + name;
    return true;
  }

  bool into_list(std::size_t i) {
    Value::List& items = *here_->list();
    std::size_t index = items.size();
    for (std::size_t k = 0; k < items.size() && index == items.size(); ++k)
      if (items[k].find("name") != nullptr && step_to(items[k], k) == steps_[i]) index = k;
    if (index == items.size()) index = component(items, steps_[i]);
    if (index == items.size()) index = number_in<std::size_t>(steps_[i]).value_or(index);
    if (index >= items.size()) return false;
    here_ = &items[index];
    kind_ = kind_of(*here_, {kind_.key, kind_.part}, registry_);
    path_ += (path_.empty() ? "" : ".") + step_to(*here_, index);
    return true;
  }

  // "x", "y", "z" of three plain values; the number of items for anything else.
  static std::size_t component(const Value::List& items, const std::string& step) {
    const bool plain = items.size() == 3 && items.front().object() == nullptr && items.front().list() == nullptr;
    const std::size_t k = step.size() == 1 ? std::string_view("xyz").find(step) : std::string_view::npos;
    return plain && k != std::string_view::npos ? k : items.size();
  }

  // The value of a key that the scene leaves out: empty at the end of the path, else the default.
  static Value by_default(const Kind& kind, bool last) {
    if (kind.part.holds == "object") return Value(Value::Object{});
    const bool several = kind.key.form == Form::vector3 || kind.key.form == Form::numbers;
    if (const Value* v = kind.key.default_value(); v != nullptr && (several || !last)) return *v;
    return {};
  }

  // Lists and objects, including those that the scene leaves out.
  bool several() const {
    if (here_->list() != nullptr || here_->object() != nullptr) return true;
    if (!here_->is_null() || inserted_unknown_) return false;
    const Form form = kind_.key.form;
    if (form == Form::any) return !kind_.part.names_type() && kind_.key.choices.empty();
    return form >= Form::vector3 && form <= Form::laws && form != Form::law;
  }

  Miss miss(std::size_t i) const {
    Miss m{i, {}, ""};
    const std::string owner = path_.empty() ? "the scene" : "\"" + shown_path(path_) + "\"";
    if (const Value::List* items = here_->list())
      for (std::size_t k = 0; k < items->size(); ++k) m.candidates.push_back(step_to((*items)[k], k));
    if (const Value::Object* members = here_->object()) {
      for (const Value::Member& member : *members)
        m.candidates.push_back(member.key == "links" ? "joints" : member.key);
      for (const Key& key : kind_.keys)
        if (here_->find(key.name) == nullptr && std::ranges::find(m.candidates, key.name) == m.candidates.end())
          m.candidates.push_back(key.name);
    }
    const bool plain = here_->list() == nullptr && here_->object() == nullptr;
    if (i == steps_.size())
      m.problem = plain ? owner + " is not in the scene and has several values; add it first"
                        : owner + " has several values; name one of them";
    else if (here_->text() != nullptr && here_->text()->starts_with('='))
      m.problem = owner + " is given as a whole by the formula \"" + *here_->text() +
                  "\"; vary the parameters of the formula, or set the whole value";
    else if (here_->text() != nullptr && is_point(*here_->text()))
      m.problem = owner + " is point \"" + *here_->text() + "\"; vary that point, or its parameters";
    else if (before_plugins_ && here_->object() != nullptr && has_unknown_type(*here_, registry_))
      m.problem = owner + " has a plugin's type and does not give \"" + steps_[i] + "\"; write \"" + steps_[i] +
                  "\" in its definition";
    else
      m.problem = plain ? owner + " is a single value without parts" : owner + " has no \"" + steps_[i] + "\"";
    return m;
  }

  bool is_point(const std::string& name) const {
    const Value* points = root_.find("points");
    return points != nullptr && points->find(name) != nullptr;
  }

  const Registry& registry_;
  const bool before_plugins_;
  const Value& root_;
  std::vector<std::string> steps_;
  Value* here_;
  Kind kind_;
  std::string path_;
  bool inserted_unknown_ = false;
};

std::string closest_number(const Value& root, const std::string& path) {
  const auto ends_in_index = [](const std::string& p) { return !p.empty() && p.back() >= '0' && p.back() <= '9'; };
  std::vector<std::string> paths;
  for (NumberAt& number : numbers_in(root))
    if (ends_in_index(path) || !ends_in_index(number.path)) paths.push_back(std::move(number.path));
  return text::closest_name(path, paths);
}

// The path with each unknown name replaced by the closest, else the closest path to a number; "" if none.
std::string nearest(const Value& root, const std::string& path, const Registry& registry) {
  std::vector<std::string> steps = split_at('.', path);
  for (std::size_t tries = 0; tries <= steps.size(); ++tries) {
    Value copy = root;
    const std::optional<Miss> miss = Walk(copy, steps, registry).go();
    if (!miss) return boost::join(steps, ".");
    if (miss->step == steps.size()) break;
    const std::string closest = text::closest_name(steps[miss->step], miss->candidates);
    if (closest.empty() || closest == steps[miss->step]) break;
    steps[miss->step] = closest == "joints" ? "links" : closest;
  }
  return closest_number(root, path);
}

}  // namespace

std::string shown_path(const std::string& path) {
  return path == "links" || path.starts_with("links.") ? "joints" + path.substr(5) : path;
}

void for_each_leaf(const Value& v, const LeafVisit& visit, const std::string& path, const std::string& key) {
  const bool in_list = v.list() != nullptr;
  std::size_t i = 0;
  for_each_child(v, [&](const Value& each, const std::string& name) {
    const std::string step = in_list ? step_to(each, i++) : name;
    for_each_leaf(each, visit, path.empty() ? step : path + "." + step, in_list ? key : name);
  });
  if (!in_list && v.object() == nullptr) visit(path, key, v);
}

std::vector<NumberAt> numbers_in(const Value& root) {
  std::vector<NumberAt> numbers;
  for_each_leaf(root, [&](const std::string& path, const std::string&, const Value& v) {
    const bool quantity = v.text() != nullptr && read_quantity(*v.text(), Unit::any).problem.empty();
    if ((v.number() != nullptr || quantity) && numbers.size() < kMostLeaves) numbers.push_back({path, &v});
  });
  return numbers;
}

ScenePlace find_place(Value& root, const std::string& path, const Registry& registry, bool before_plugins) {
  Walk walk(root, split_at('.', path), registry, before_plugins);
  const std::optional<Miss> miss = walk.go();
  ScenePlace place = walk.place();
  const bool vector = place.key.form == Form::vector3 || place.key.form == Form::axis;
  place.whole = miss && vector && static_cast<int>(miss->step) > std::ranges::count(path, '.');
  if (!miss || place.whole) {
    if (place.value->is_null()) place.near = closest_number(root, place.path);
    return place;
  }
  const std::string near = nearest(root, path, registry);
  throw ModelError(
      "\"" + shown_path(path) + "\": " + miss->problem +
      (near.empty() ? text::suggestion("", miss->candidates) : "; did you mean \"" + shown_path(near) + "\"?"));
}

}  // namespace lockstep
