#include "framework/description/scene/include.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <span>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/builder.h"
#include "framework/description/scene/definitions.h"
#include "framework/description/scene/old_names.h"
#include "framework/description/scene/read.h"
#include "framework/description/scene/resolve.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

constexpr std::size_t kMostFiles = 16;  // within one another
const char* const kLists[] = {"bodies", "markers", "links", "forces", "events"};

Value* member(Value& object, const std::string& key) {
  if (Value::Object* members = object.object())
    for (Value::Member& m : *members)
      if (m.key == key) return &m.value;
  return nullptr;
}

/// Puts a prefix before the names of an included scene wherever its objects name one another.
class Renaming {
 public:
  Renaming(Value& scene, std::string prefix) : prefix_(std::move(prefix)) {
    for (const char* list : kLists)
      for (Value& object : items(scene, list))
        if (const Value* name = member(object, "name"); name != nullptr && name->text() != nullptr)
          names_.insert(*name->text());
  }

  void apply(Value& scene) const {
    if (prefix_.empty()) return;
    for (const char* list : kLists)
      for (Value& object : items(scene, list)) {
        for (const char* key : {"name", "body", "p", "s", "link"}) text(member(object, key));
        if (Value* pairs = member(object, "pairs"); pairs != nullptr && pairs->list() != nullptr)
          for (Value& pair : *pairs->list()) text(&pair), text(member(pair, "p")), text(member(pair, "s"));
        for (const char* key : {"activate", "deactivate"})
          if (Value* links = member(object, key); links != nullptr && links->list() != nullptr)
            for (Value& link : *links->list()) text(&link);
        if (Value* when = member(object, "when")) channel(member(*when, "channel"));
      }
    if (Value* points = member(scene, "points"); points != nullptr && points->object() != nullptr)
      for (Value::Member& point : *points->object()) point.key = prefix_ + point.key;
  }

 private:
  // The objects of a list; none where there is no such list.
  static std::span<Value> items(Value& scene, const char* list) {
    Value* all = member(scene, list);
    return all != nullptr && all->list() != nullptr ? std::span<Value>(*all->list()) : std::span<Value>();
  }

  void put(Value& v, std::string text) const {
    const Where where = v.where;
    v = Value(std::move(text));
    v.where = where;
  }
  // "A", and "A.stop_z_low" or "A.friction", which a link brings with it.
  void text(Value* v) const {
    if (v == nullptr || v->text() == nullptr) return;
    const std::string old = *v->text();
    if (names_.contains(old) || names_.contains(old.substr(0, old.find('.')))) put(*v, prefix_ + old);
  }
  // "A.x", "a.x@b": names stand at its beginning and after "@".
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
    put(*v, std::move(now));
  }

  std::set<std::string> names_;
  std::string prefix_;
};

// Gives the included scene's parameters the values that are asked for.
void set_parameters(Value& scene, const Params& p, Definitions& outer) {
  if (!p.has("parameters")) return;
  const Value& given = p.value("parameters");
  const std::string owner = part_of(p.owner(), "parameters");
  if (given.object() == nullptr) p.refuse("parameters", "expected an object of numbers by name, got " + shown(given));
  Value* own = member(scene, "parameters");
  for (const Value::Member& m : *given.object()) {
    Value* to = own != nullptr ? member(*own, m.key) : nullptr;
    if (to == nullptr) {
      std::vector<std::string> known;
      if (own != nullptr && own->object() != nullptr)
        for (const Value::Member& k : *own->object()) known.push_back(k.key);
      refuse(m.where, owner, "the scene has no parameter \"" + m.key + "\"" + text::suggestion(m.key, known));
    }
    *to = is_formula(m.value) ? Definitions::placed_value(outer.evaluate(m.value, part_of(owner, m.key)), m.value.where)
                              : m.value;
  }
}

std::string path_of(const Params& p, const std::vector<std::string>& files) {
  namespace fs = std::filesystem;
  fs::path path = p.text("scene");
  const auto& from = p.value("scene").where.file;
  if (path.is_relative() && from) path = fs::path(*from).parent_path() / path;
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error))
    p.refuse("scene", "\"" + p.text("scene") + "\" is no file that holds a scene");
  for (const std::string& file : files)
    if (fs::equivalent(path, file, error)) p.refuse("scene", "\"" + p.text("scene") + "\" includes itself");
  if (files.size() > kMostFiles)
    p.refuse("scene", "scenes are included deeper than " + std::to_string(kMostFiles) + " within one another");
  return path.lexically_normal().string();
}

Value read_included(const Params& p, Definitions& outer, const std::vector<std::string>& files) {
  Scene inner;
  inner.file = path_of(p, files);
  inner.root = read_json_file(inner.file);
  if (inner.root.object() == nullptr) p.refuse("scene", "\"" + inner.file + "\" holds no object");
  rename_old_keys(inner.root);
  set_parameters(inner.root, p, outer);
  std::vector<std::string> within = files;
  within.push_back(inner.file);
  resolve_formulas(inner, within);
  Renaming(inner.root, p.text("prefix")).apply(inner.root);
  return std::move(inner.root);
}

// Those of the included scene before the scene's own; plugins behind.
void merge(Value& root, Value& inner, const char* key) {
  Value* from = member(inner, key);
  if (from == nullptr) return;
  Value* to = member(root, key);
  if (to == nullptr) {
    root.object()->push_back({key, std::move(*from), from->where});
    return;
  }
  if (from->list() != nullptr && to->list() != nullptr)
    to->list()->insert(to->list()->begin(), std::make_move_iterator(from->list()->begin()),
                       std::make_move_iterator(from->list()->end()));
  if (from->object() != nullptr && to->object() != nullptr)
    to->object()->insert(to->object()->begin(), std::make_move_iterator(from->object()->begin()),
                         std::make_move_iterator(from->object()->end()));
}

}  // namespace

void expand_includes(Value& root, const std::vector<std::string>& files) {
  const Value source = root;
  Definitions definitions(source);
  root = root.without({"include"});
  const Value& includes = *source.find("include");
  if (includes.list() == nullptr)
    refuse(includes.where, "scene.include", "expected a list of objects, got " + shown(includes));
  for (std::size_t i = includes.list()->size(); i-- > 0;) {  // each comes before what is there
    const Params p = params_of((*includes.list())[i], "include", item("include", i), nullptr);
    Value inner = read_included(p, definitions, files);
    for (const char* key : {"requires", "points", "bodies", "markers", "links", "forces", "events"})
      merge(root, inner, key);
  }
}

}  // namespace lockstep
