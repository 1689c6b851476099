#include <lockstep/scene.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"
#include "framework/description/scene/old_names.h"
#include "framework/description/scene/place.h"
#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {

constexpr int kMostValues = 1'000'000;

std::vector<std::string> split_at(char mark, const std::string& text) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find(mark, begin)) != std::string::npos; begin = end + 1)
    parts.push_back(std::string(text::trimmed(text.substr(begin, end - begin))));
  parts.push_back(std::string(text::trimmed(text.substr(begin))));
  return parts;
}

// A word of the command line as a JSON value.
Value value_of(const std::string& word) {
  if (word == "true" || word == "false") return Value(word == "true");
  double x = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  return error == std::errc() && end == word.data() + word.size() ? Value(x) : Value(word);
}

// The dimension of a text with a unit; nothing for one without a name here.
std::optional<Unit> unit_of(const std::string& text) {
  for (int u = static_cast<int>(Unit::none) + 1; u < static_cast<int>(Unit::any); ++u)
    if (read_quantity(text, static_cast<Unit>(u)).problem.empty()) return static_cast<Unit>(u);
  return {};
}

/// Reads words into the values that a place may hold.
class Reader {
 public:
  Reader(const ScenePlace& place, std::string path) : key_(place.key), path_(std::move(path)) {
    const Form form = key_.form;
    numeric_ = form == Form::number || form == Form::vector3 || form == Form::axis || form == Form::orientation ||
               form == Form::numbers || form == Form::points || form == Form::law || form == Form::laws ||
               form == Form::translation_law || form == Form::rotation_law;
    if (numeric_) return;
    const Value& now = *place.value;  // the tables do not know: it keeps its kind
    const bool open = form == Form::any && key_.choices.empty();
    const bool quantity = now.text() != nullptr && read_quantity(*now.text(), Unit::any).problem.empty();
    numeric_ = open && (now.number() != nullptr || quantity);
    if (numeric_) key_.unit = Unit::any;
  }

  bool numeric() const { return numeric_; }

  Value read(const std::string& word) {
    if (word.empty()) throw ModelError("\"" + path_ + "\": a value is missing; write NAME=v1,v2,... or NAME=a:b:n");
    const Value v = value_of(word);
    if (numeric_) {
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
    return key_.unit != Unit::any ? si_unit(key_.unit) : given_ ? si_unit(*given_) : "";
  }

 private:
  void note_unit(const std::string& word) {
    const std::optional<Unit> unit = key_.unit == Unit::any ? unit_of(word) : std::nullopt;
    if (!unit) return;
    if (given_ && *given_ != *unit)
      throw ModelError("\"" + path_ + "\": " + article_name_of(*given_) + " and " + article_name_of(*unit) + " (\"" +
                       word + "\") are mixed; give all values of one kind");
    given_ = unit;
  }

  Key key_;
  std::string path_;
  bool numeric_ = false;
  std::optional<Unit> given_;
};

// a:b:n. Both ends are met exactly.
std::vector<Value> read_range(Reader& reader, const std::vector<std::string>& parts, const std::string& path) {
  if (parts.size() != 3)
    throw ModelError("\"" + path + "\": expected a:b:n, n numbers evenly from a to b, as in 1:5:9");
  if (!reader.numeric())
    throw ModelError("\"" + path + "\" is not a number, so nothing lies between two values; list them: NAME=v1,v2");
  const double a = *reader.read(parts[0]).number(), b = *reader.read(parts[1]).number();
  const bool bare_a = value_of(parts[0]).number() != nullptr, bare_b = value_of(parts[1]).number() != nullptr;
  if (bare_a != bare_b && (bare_a ? a : b) != 0)
    throw ModelError("\"" + path + "\": one of " + parts[0] + " and " + parts[1] +
                     " has a unit, the other has none; give both one");
  int n = 0;
  const auto [end, error] = std::from_chars(parts[2].data(), parts[2].data() + parts[2].size(), n);
  if (error != std::errc() || end != parts[2].data() + parts[2].size() || n < 2 || n > kMostValues)
    throw ModelError("\"" + path + "\": the number of values is \"" + parts[2] +
                     "\"; it must be a whole one from 2 to " + std::to_string(kMostValues));
  std::vector<Value> values;
  const double m = n - 1;
  for (int k = 0; k < n; ++k) {
    const double mixed = (a * (m - k) + b * k) / m;  // closer to round numbers than a + k (b - a) / m
    values.emplace_back(std::isfinite(mixed) ? mixed : a * ((m - k) / m) + b * (k / m));
  }
  values.front() = Value(a), values.back() = Value(b);
  return values;
}

void refuse_columns(const std::string& path) {
  for (const char* fixed : {"lockstep", "requires", "run.record", "run.draw"})
    if (path == fixed || path.rfind(std::string(fixed) + ".", 0) == 0)
      throw ModelError("\"" + path + "\" cannot vary: plugins and columns are the same in all runs");
}

}  // namespace

Variable read_variable(const std::string& text, const Scene& scene, const Registry& registry) {
  const std::size_t equals = text.find('=');
  Variable v;
  v.path = std::string(text::trimmed(text.substr(0, equals)));
  if (equals == std::string::npos || v.path.empty())
    throw ModelError("\"" + text + "\": expected NAME=a:b:n or NAME=v1,v2,..., as in bodies.rod.mass=1:5:9");
  refuse_columns(v.path);
  rename_old_keys(v.path);
  Value root = scene.root;
  const ScenePlace place = find_place(root, v.path, registry);
  v.place = place.path, v.near = place.near;
  Reader reader(place, v.path);
  const std::string values = text.substr(equals + 1);
  const std::vector<std::string> range = split_at(':', values);
  if (range.size() > 1)
    v.values = read_range(reader, range, v.path);
  else
    for (const std::string& word : split_at(',', values)) v.values.push_back(reader.read(word));
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
                         (other.path == v.path ? "" : " (the other time as \"" + other.path + "\")") +
                         "; give all its values at once");
    all.push_back(std::move(v));
  }
  return all;
}

Scene vary_scene(const Scene& scene, const std::vector<Variable>& variables, const std::vector<std::size_t>& choice,
                 const Registry& registry) {
  Value root = scene.root;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    Value& value = *find_place(root, variables[k].path, registry).value;
    const Where where = value.where;
    value = variables[k].values[choice[k]];
    value.where = where;
  }
  return scene_from(std::move(root), scene.file);
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
