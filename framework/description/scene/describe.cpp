#include "framework/description/scene/describe.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <lockstep/text.h>
#include "framework/description/scene/examples.h"
#include "framework/description/scene/split.h"
#include "framework/description/scene/tables.h"
#include "framework/description/scene/write.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

template <class Shelf>
void append(const Shelf& shelf, const std::string& name, std::vector<Description>& out) {
  for (const auto& [key, entry] : shelf.entries())
    out.push_back({name, entry.info, entry.origin.empty() ? "built in" : entry.origin});
}

std::string singular(const std::string& shelf) {
  std::string word = shelf.substr(0, shelf.size() - (shelf.back() == 's' ? 1 : 0));
  std::replace(word.begin(), word.end(), '_', ' ');
  return shelf == "scene" ? "object of a scene" : word;
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string choice_words(const Key& key) {
  std::vector<std::string> words;
  for (const std::string& choice : key.choices) words.push_back("\"" + choice + "\"");
  return text::join(words, " or ");
}

std::string part_words(const Key& key, const Part& part) {
  const std::string there = ": see `lockstep describe " + part.table + "`";
  switch (part.holds) {
    case Holds::object:
      return "object" + there;
    case Holds::objects:
      return "list of objects" + there;
    case Holds::object_or_list:
      return "object or list of objects" + there;
    case Holds::choice_or_object:
      return choice_words(key) + ", or object" + there;
    case Holds::texts:
      return "list of texts";
    case Holds::texts_or_objects:
      return "list of names or objects" + there;
    case Holds::text_lists:
      return "list of lists of texts";
    case Holds::channels:
      return "list of channel names: see `lockstep check SCENE --channels`";
    case Holds::typed:
      return "name or object: see `lockstep list " + part.table + "`";
    case Holds::vector_or_object:
      return "[x, y, z], 3 rows of 3, or object" + there;
    case Holds::vector_or_word:
      return "[x, y, z] or " + choice_words(key);
    case Holds::quantities:
      return "object of quantities";
    case Holds::named_points:
      return "object of points";
    case Holds::settings:
      return "object of values by path";
  }
  return name_of(key.form);
}

std::string default_words(const Key& key) {
  if (key.required()) return "required";
  if (key.default_value() == nullptr) return "";
  const std::string words = write_json(*key.default_value());
  return "default " + words.substr(0, words.size() - 1);
}

// The short words, which go into the table's column, and where to read on, which comes last in the line.
std::pair<std::string, std::string> split_form(const Key& key, const std::vector<Part>& parts) {
  constexpr std::string_view kSee = ": see ";
  const std::string all = form_words(key, parts);
  const std::size_t at = all.find(kSee);
  if (at == std::string::npos) return {all, {}};
  return {all.substr(0, at), all.substr(at + kSee.size())};
}

}  // namespace

std::vector<std::string> shelf_names() {
  return {"laws", "translation_laws", "rotation_laws", "links", "forces", "integrators", "solvers"};
}

std::vector<Description> shelf_contents(const Registry& registry, const std::string& shelf) {
  std::vector<Description> all;
  if (shelf == "laws") append(registry.laws, shelf, all);
  if (shelf == "laws" || shelf == "translation_laws") append(registry.translation_laws, "translation_laws", all);
  if (shelf == "laws" || shelf == "rotation_laws") append(registry.rotation_laws, "rotation_laws", all);
  if (shelf == "links") append(registry.links, shelf, all);
  if (shelf == "forces") append(registry.forces, shelf, all);
  if (shelf == "integrators") append(registry.integrators, shelf, all);
  if (shelf == "solvers") append(registry.solvers, shelf, all);
  const std::vector<std::string> known = shelf_names();
  if (std::find(known.begin(), known.end(), shelf) == known.end())
    refuse({}, "list", "unknown shelf \"" + shelf + "\"" + text::suggestion(shelf, known));
  return all;
}

namespace {

// With the keys that all of its kind share.
Description with_shared_keys(Description d) {
  for (const SceneTable& table : scene_tables())
    if (table.shelf == d.shelf) {
      d.info.keys = keys_together(table.info.keys, d.info.keys);
      d.parts = table.parts;
    }
  return d;
}

std::vector<Description> all_descriptions(const Registry& registry) {
  std::vector<Description> all;
  for (const char* shelf : {"laws", "links", "forces", "integrators", "solvers"})
    for (Description& d : shelf_contents(registry, shelf)) all.push_back(with_shared_keys(std::move(d)));
  for (const SceneTable& table : scene_tables()) all.push_back({"scene", table.info, "built in", table.parts});
  return all;
}

}  // namespace

std::vector<Description> find_descriptions(const Registry& registry, const std::string& name) {
  std::vector<Description> found = all_descriptions(registry);
  std::erase_if(found, [&](const Description& d) { return d.info.name != name; });
  return found;
}

std::vector<std::string> describable_words(const Registry& registry) {
  std::vector<std::string> names;
  for (const Description& d : all_descriptions(registry)) names.push_back(d.info.name);
  return names;
}

std::string form_words(const Key& key, const std::vector<Part>& parts) {
  if (key.form == Form::choice) return choice_words(key);
  if (key.form == Form::any)
    for (const Part& part : parts)
      if (part.key == key.name) return part_words(key, part);
  if (key.unit == Unit::none) return name_of(key.form);
  const std::string si = si_unit(key.unit);
  const std::string words = key.form == Form::number ? name_of(key.unit) : name_of(key.form);
  return words + (si.empty() ? "" : " in " + si);
}

std::string describe(const Description& d) {
  std::string text = d.info.name + ": " + singular(d.shelf) +
                     (d.origin == "built in" ? "" : ", from plugin " + d.origin) + "\n  " + d.info.help + "\n";
  std::size_t name = 0, form = 0, fallback = 0;
  for (const Key& key : d.info.keys) {
    name = std::max(name, key.name.size());
    form = std::min<std::size_t>(24, std::max(form, split_form(key, d.parts).first.size()));
    fallback = std::min<std::size_t>(20, std::max(fallback, default_words(key).size()));
  }
  const std::string object = example_of(d), example = object.empty() ? "" : "example:\n  " + object + "\n";
  if (d.info.keys.empty()) return text + "  it takes no keys\n" + example;
  text += "keys:\n";
  for (const Key& key : d.info.keys) {
    const auto [words, where] = split_form(key, d.parts);
    std::string line = "  " + padded(key.name, name) + "  " + padded(words, form) + "  " +
                       padded(default_words(key), fallback) + "  " + key.help;
    if (key.help.find(where) == std::string::npos) line += "; see " + where;
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text + example;
}

}  // namespace lockstep
