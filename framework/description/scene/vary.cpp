// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/scene.h>

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <optional>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/place.h"
#include "framework/description/scene/reading.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

constexpr int kMostValues = 1'000'000;

// The dimension of a text with a unit; nothing for a dimension without a name.
std::optional<Unit> unit_of(const std::string& text) {
  for (const Unit unit : units())
    if (read_quantity(text, unit).problem.empty()) return unit;
  return {};
}

// The SI unit of a parameter's value; "" for a pure number.
std::string symbol_of(const Value& v) {
  if (v.text() == nullptr) return {};
  const std::string unit = v.text()->substr(std::min(v.text()->find(' ') + 1, v.text()->size()));
  return unit == "1" ? "" : unit;
}

// A number as a text with this unit, if there is one.
Value with_unit(const Value& v, const std::string& unit) {
  return unit.empty() || v.number() == nullptr ? v : Value(text::number(*v.number()) + " " + unit);
}

const Value& written_root(const Scene& scene) { return scene.written.is_null() ? scene.root : scene.written; }

// The path of a parameter or point, or of a component of one, that is asked for by its name alone.
std::string full_path(const std::string& path, const Scene& scene) {
  const std::string head = path.substr(0, path.find('.'));
  if (written_root(scene).find(head) == nullptr)
    for (const SceneParameter& p : scene.parameters)
      if (p.name == head) return (p.is_point ? "points." : "parameters.") + path;
  return path;
}

// The value of a parameter at this place, or of its component; nullptr if there is none.
const Value* parameter_at(const std::string& place, const Scene& scene) {
  for (const SceneParameter& p : scene.parameters) {
    if (p.is_point || !place.starts_with("parameters." + p.name)) continue;
    const std::string rest = place.substr(std::string("parameters.").size() + p.name.size());
    if (rest.empty()) return &p.value;
    const bool component = rest.size() == 2 && rest[0] == '.' && rest[1] >= '0' && rest[1] <= '2';
    if (component && p.value.list() != nullptr) return &(*p.value.list())[rest[1] - '0'];
  }
  return nullptr;
}

// Things that included and repeated parts bring are not in the scene as written: their values are set in its "set".
const std::string kSet = "set.";

// A place as in Variable::place; one in "set" is created if necessary.
Value& value_at(Value& root, const std::string& place, const Registry& registry) {
  if (!place.starts_with(kSet)) return *find_place(root, place, registry).value;
  Value& set = made_under(root, "set", Value::Object{});
  if (set.object() == nullptr) throw ModelError("\"set\" of the scene is not an object of values by path");
  return made_under(set, place.substr(kSet.size()), {});
}

// find_place(), but an unknown name may be that of a parameter, or of a thing of an included or repeated part, whose
// place is in "set", with its present value.
ScenePlace place_of(Value& root, const std::string& path, const Scene& scene, const Registry& registry) {
  const Value before = root;
  const std::string full = full_path(path, scene);
  try {
    return find_place(root, full, registry);
  } catch (const ModelError& error) {
    root = before;  // without the empty keys on the way to nowhere
    const bool is_name = path.find('.') == std::string::npos;
    const bool has_parts = root.find("include") != nullptr || root.find("repeat") != nullptr;
    if (!is_name && has_parts && scene.root.find(full.substr(0, full.find('.'))) != nullptr) {
      Value expanded = scene.root;
      ScenePlace place = find_place(expanded, full, registry);  // else the nearest path of the scene with its parts
      const Value now = *place.value;
      place.path = kSet + place.path, place.value = &value_at(root, place.path, registry);
      *place.value = now;
      return place;
    }
    std::vector<std::string> names;
    for (const SceneParameter& p : scene.parameters) names.push_back(p.name);
    std::string near = is_name ? text::closest_name(path, names) : "";
    if (near == path)
      throw ModelError("\"" + path + "\" is a vector; name a component (" + path +
                       ".x), or set all by a formula: " + "--set " + path + "=\"=[1, 2, 3]\"");
    try {
      Value trial = before;
      if (is_name && near.empty()) find_place(trial, "run." + path, registry), near = "run." + path;
    } catch (const ModelError&) {  // no key of "run"
    }
    const bool has_hint = std::string_view(error.what()).find("did you mean") != std::string_view::npos;
    if (is_name && near.empty() && !names.empty() && !has_hint && scene.root.find(path) == nullptr) {
      names.emplace_back("or a path such as bodies.NAME.mass");
      throw ModelError("\"" + path + "\" is not a parameter of the scene" + text::suggestion("", names));
    }
    if (near.empty()) throw;
    throw ModelError("\"" + path + "\" is not a parameter of the scene; did you mean \"" + near + "\"?");
  }
}

/// Reads words into the values that a place may hold.
class Reader {
 public:
  /// `now`: the value at the place. `parameter`: that of a parameter, or null.
  Reader(const ScenePlace& place, const Value& now, const Value* parameter, std::string path)
      : key_(place.key), path_(std::move(path)) {
    if (parameter != nullptr) {
      numeric_ = true, key_.unit = Unit::any, symbol_ = symbol_of(*parameter);
      return;
    }
    const Form form = key_.form;
    numeric_ = form == Form::number || (form >= Form::vector3 && form <= Form::laws);
    if (numeric_) return;  // else, if the tables do not define it, it keeps its kind
    const bool open = form == Form::any && key_.choices.empty();
    const bool quantity = now.text() != nullptr && read_quantity(*now.text(), Unit::any).problem.empty();
    numeric_ = open && (now.number() != nullptr || quantity);
    if (numeric_) key_.unit = Unit::any;
  }

  bool numeric() const { return numeric_; }

  Value read(const std::string& word) {
    if (word.empty()) throw ModelError("\"" + path_ + "\": a value is missing; write NAME=v1,v2,... or NAME=a:b:n");
    const Value v = read_word(word);
    if (numeric_) {
      if (symbol_ && v.text() != nullptr)
        if (const std::string problem = misfit(word, *symbol_); !problem.empty())
          throw ModelError("\"" + path_ + "\": " + problem);
      if (v.text() != nullptr) note_unit(word);
      return Value(read_number(v, key_.unit, path_));
    }
    if (key_.form == Form::integer) return Value(read_integer(v, path_));
    if (key_.form == Form::boolean) return Value(read_boolean(v, path_));
    if (!key_.choices.empty()) return Value(read_choice(v, key_.choices, path_));
    return key_.form == Form::text ? Value(word) : v;
  }

  // SI symbol of the numbers: the key's, else that of the units given.
  std::string unit() const {
    if (!numeric_) return {};
    if (symbol_) return *symbol_;
    return key_.unit != Unit::any ? si_unit(key_.unit) : given_ ? si_unit(*given_) : "";
  }

 private:
  void note_unit(const std::string& word) {
    const std::optional<Unit> unit = key_.unit == Unit::any ? unit_of(word) : std::nullopt;
    if (!unit) return;
    if (given_ && *given_ != *unit)
      throw ModelError("\"" + path_ + "\": " + article_name_of(*given_) + " and " + article_name_of(*unit) + " (\"" +
                       word + "\") are mixed; give all values the same dimension");
    given_ = unit;
  }

  Key key_;
  std::string path_;
  bool numeric_ = false;
  std::optional<Unit> given_;
  std::optional<std::string> symbol_;  // of a parameter; "": without a unit
};

// a:b:n, or a:b:n:log, without the last digits of rounding. Both ends are met exactly.
std::vector<Value> read_range(Reader& reader, const std::vector<std::string>& parts, const std::string& path) {
  const bool log = parts.size() == 4 && parts[3] == "log";
  if (parts.size() != 3 && !log)
    throw ModelError("\"" + path +
                     "\": expected a:b:n, n evenly spaced numbers from a to b, as in 1:5:9, or a:b:n:log");
  if (!reader.numeric())
    throw ModelError("\"" + path + "\" is not a number and has no range; list the values: NAME=v1,v2");
  const double a = *reader.read(parts[0]).number(), b = *reader.read(parts[1]).number();
  const bool bare_a = read_word(parts[0]).number() != nullptr, bare_b = read_word(parts[1]).number() != nullptr;
  if (bare_a != bare_b && (bare_a ? a : b) != 0)
    throw ModelError("\"" + path + "\": one of " + parts[0] + " and " + parts[1] +
                     " has a unit, the other has none; give both a unit");
  const int n = number_in<int>(parts[2]).value_or(0);
  if (n < 2 || n > kMostValues)
    throw ModelError("\"" + path + "\": the number of values is \"" + parts[2] +
                     "\"; it must be an integer from 2 to " + std::to_string(kMostValues));
  if (log && !(a > 0 && b > 0))
    throw ModelError("\"" + path + "\": write a:b:n:log with a and b above 0, as in run.step=1e-4:1e-1:20:log");
  std::vector<Value> values;
  const double m = n - 1;
  for (int k = 0; k < n; ++k) {
    double x = log ? std::exp(((m - k) * std::log(a) + k * std::log(b)) / m) : (a * (m - k) + b * k) / m;
    if (!std::isfinite(x)) x = a * ((m - k) / m) + b * (k / m);
    values.emplace_back(*number_in<double>(fmt::format("{:.{}g}", x, log ? 6 : 15)));
  }
  values.front() = Value(a), values.back() = Value(b);
  return values;
}

// The whole of a vector parameter or point that is asked for by its name alone; nullptr for anything else.
Value* vector_named(Value& root, const std::string& name, const Scene& scene) {
  if (root.find(name) != nullptr) return nullptr;
  for (const SceneParameter& p : scene.parameters)
    if (p.name == name)
      for (Value::Member& m : members(root, p.is_point ? "points" : "parameters"))
        if (m.key == name && m.value.list() != nullptr) return &m.value;
  return nullptr;
}

// Sets the value that "NAME=VALUE" names.
void set_value(Value& root, const std::string& text, const Scene& scene, const Registry& registry) {
  const std::size_t equals = text.find('=');
  std::string path(text::trimmed(text.substr(0, equals)));
  std::string word =
      equals == std::string::npos ? "" : std::string(text::trimmed(std::string_view(text).substr(equals + 1)));
  if (path.empty() || word.empty())
    throw ModelError("\"" + text + "\": expected NAME=VALUE, as in crank=\"120 mm\" or bodies.rod.mass=2");
  rename_joints(path);
  if (word.starts_with('[')) word = "=" + word;
  if (word.starts_with('='))
    if (Value* vector = vector_named(root, path, scene)) return replace(*vector, word);
  const ScenePlace place = place_of(root, path, scene, registry);
  if (place.path.starts_with("requires")) throw ModelError("\"" + path + "\" cannot be set; give plugins by --plugin");
  const Value* parameter = parameter_at(place.path, scene);
  Value v = place.key.form == Form::text ? Value(word) : read_word(word);
  if (parameter != nullptr && !word.starts_with('='))
    v = with_unit(Reader(place, *place.value, parameter, path).read(word), symbol_of(*parameter));
  replace(*place.value, std::move(v));
}

// The scene with other values; meshes that were read stay.
Scene with_values(const Scene& scene, Value root) {
  Scene other = scene_from(std::move(root), scene.file, {}, true);
  other.meshes = scene.meshes;
  return other;
}

}  // namespace

Variable read_variable(const std::string& text, const Scene& scene, const Registry& registry) {
  const std::size_t equals = text.find('=');
  Variable v;
  v.path = std::string(text::trimmed(text.substr(0, equals)));
  if (equals == std::string::npos || v.path.empty())
    throw ModelError("\"" + text + "\": expected NAME=a:b:n or NAME=v1,v2,..., as in bodies.rod.mass=1:5:9");
  for (const char* fixed : {"lockstep", "requires", "run.record", "run.draw"})
    if (v.path == fixed || v.path.starts_with(std::string(fixed) + "."))
      throw ModelError("\"" + v.path + "\" cannot vary; plugins and columns are the same in all runs");
  const bool says_joints = v.path.starts_with("joints.");
  rename_joints(v.path);
  Value root = written_root(scene);
  ScenePlace place = place_of(root, v.path, scene, registry);
  v.place = place.path, v.near = shown_path(place.near);
  if (says_joints) v.path = shown_path(v.path);
  if (place.whole)
    throw ModelError("\"" + v.path + "\" has several values; " +
                     (place.value->list() != nullptr ? "" : "write it in the scene as [x, y, z], and ") +
                     "vary one of them, such as " + v.path + ".x");
  if (v.place.starts_with("points.") || v.place.starts_with(kSet + "points."))
    place.key.form = Form::number, place.key.unit = Unit::length;
  const Value* parameter = parameter_at(v.place, scene);
  if (parameter != nullptr) v.given_unit = symbol_of(*parameter);
  Reader reader(place, *place.value, parameter, v.path);
  const std::string values = text.substr(equals + 1);
  const std::vector<std::string> range = words_at(':', values);
  if (range.size() > 1)
    v.values = read_range(reader, range, v.path);
  else
    for (const std::string& word : words_at(',', values)) v.values.push_back(reader.read(word));
  v.unit = reader.unit();
  return v;
}

std::vector<Variable> read_variables(const std::vector<std::string>& texts, const Scene& scene,
                                     const Registry& registry) {
  std::vector<Variable> all;
  for (const std::string& text : texts) {
    Variable v = read_variable(text, scene, registry);
    for (const Variable& other : all)
      if (other.place == v.place)
        throw ModelError("\"" + v.path + "\" varies twice" +
                         (other.path == v.path ? "" : " (also as \"" + other.path + "\")") +
                         "; give all its values together");
    all.push_back(std::move(v));
  }
  return all;
}

Scene vary_scene(const Scene& scene, const std::vector<Variable>& variables, const std::vector<std::size_t>& choice,
                 const Registry& registry) {
  Value root = written_root(scene);
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const Variable& v = variables[k];
    replace(value_at(root, v.place, registry), with_unit(v.values[choice[k]], v.given_unit));
  }
  return with_values(scene, std::move(root));
}

Scene set_in_scene(const Scene& scene, const std::vector<std::string>& texts, const Registry& registry) {
  Value root = written_root(scene);
  for (const std::string& text : texts) set_value(root, text, scene, registry);
  return with_values(scene, std::move(root));
}

std::vector<std::string> left_behind(const Variable& v, const Scene& scene, const Registry& registry) {
  Value root = written_root(scene);
  const auto is_length = [&](const std::string& path) {
    return find_place(root, path, registry).key.unit == Unit::length;
  };
  const auto in_metres = [](const Value& value) -> std::optional<double> {
    if (value.number() != nullptr) return *value.number();
    const Measured read = read_quantity(value.text() != nullptr ? *value.text() : "", Unit::length);
    return read.problem.empty() ? std::optional(read.value) : std::nullopt;
  };
  std::vector<std::string> same;
  if (v.place.starts_with(kSet) || !is_length(v.place)) return same;
  const std::optional<double> own = in_metres(*find_place(root, v.place, registry).value);
  if (!own || *own == 0) return same;
  for (const NumberAt& number : numbers_in(root)) {
    if (number.path == v.place || number.path.starts_with("run.")) continue;
    const std::optional<double> other = in_metres(*number.value);
    if (other && std::abs(*other - *own) <= 1e-12 * std::abs(*own) && is_length(number.path))
      same.push_back(shown_path(number.path));
  }
  return same;
}

std::string setting_text(const std::vector<Variable>& variables, const std::vector<std::size_t>& choice) {
  std::string text;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const Variable& v = variables[k];
    text += (k == 0 ? "" : ", ") + v.path + " = " + plain_text(v.values[choice[k]]);
    if (!v.unit.empty()) text += " " + v.unit;
  }
  return text;
}

std::string plain_text(const Value& v) {
  if (const double* x = v.number()) return text::number(*x);
  if (const bool* b = v.boolean()) return *b ? "true" : "false";
  return v.text() != nullptr ? *v.text() : "";
}

}  // namespace lockstep
