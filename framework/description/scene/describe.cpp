// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/describe.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include <lockstep/text.h>
#include "framework/description/registry/shelves.h"
#include "framework/description/scene/json.h"
#include "framework/description/scene/split.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

std::string choice_words(const Key& key) {
  std::vector<std::string> words;
  for (const std::string& choice : key.choices) words.push_back("\"" + choice + "\"");
  return text::join(words, " or ");
}

std::string part_words(const Key& key, const Part& part) {
  std::string words = part.holds;
  if (!key.choices.empty()) words.replace(words.find("choice"), 6, choice_words(key));
  return part.table.empty()
             ? words
             : words + ": see `lockstep " + (part.names_type() ? "list " : "describe ") + part.table + "`";
}

std::string default_words(const Key& key) {
  if (key.required()) return "required";
  if (key.default_value() == nullptr) return "";
  return "default " + write_json_line(*key.default_value());
}

// The short words, for the column of the table, and the reference to more, for the end of the line.
std::pair<std::string, std::string> split_form(const Key& key, const std::vector<Part>& parts) {
  constexpr std::string_view kSee = ": see ";
  const std::string all = form_words(key, parts);
  const std::size_t at = all.find(kSee);
  if (at == std::string::npos) return {all, {}};
  return {all.substr(0, at), all.substr(at + kSee.size())};
}

// Of the keys that all forces share, those that this type takes, with those that it needs marked. A plugin's may take all.
Keys shared_keys(const Description& d, Keys keys) {
  if (d.shelf != "forces" || d.origin != "built in" || d.info.name == "function_force") return keys;
  const bool in_joint = d.info.name == "joint_friction", needs_s = !d.info.name.starts_with("applied");
  std::erase_if(keys, [&](const Key& key) {
    return in_joint ? key_in({&scene_table("pair").info.keys}, key.name) != nullptr : key.name == "link";
  });
  for (Key& key : keys)
    if (key.name == "link" || key.name == "p" || (key.name == "s" && needs_s)) key.fallback = kRequired;
  return keys;
}

}  // namespace

std::vector<std::string> shelf_names() {
  std::vector<std::string> names;
  for_each_shelf([&](const char* name, auto, auto) { names.emplace_back(name); });
  return names;
}

std::vector<Description> shelf_contents(const Registry& registry, const std::string& shelf) {
  if (kind_on(shelf).empty())
    refuse({}, "list", "unknown shelf \"" + shelf + "\"" + text::suggestion(shelf, shelf_names()));
  std::vector<Description> all;
  for_each_shelf([&](std::string_view name, auto, auto on) {
    if (name != shelf && !(shelf == "laws" && name.ends_with("_laws"))) return;
    for (const auto& [type, entry] : (registry.*on).entries())
      all.push_back({std::string(name), entry.info, entry.origin.empty() ? "built in" : entry.origin});
  });
  return all;
}

std::vector<Description> all_descriptions(const Registry& registry) {
  std::vector<Description> all;
  for (const SceneTable& table : scene_tables()) all.push_back({"scene", table.info, "built in", table.parts});
  for (const char* shelf : {"links", "laws", "forces", "integrators", "solvers"})
    for (Description& d : shelf_contents(registry, shelf)) all.push_back(std::move(d));
  return all;
}

std::vector<Description> find_descriptions(const Registry& registry, const std::string& name) {
  std::vector<Description> found = all_descriptions(registry);
  std::erase_if(found, [&](const Description& d) { return d.info.name != name; });
  std::stable_partition(found.begin(), found.end(), [](const Description& d) { return d.shelf != "scene"; });
  for (Description& d : found)
    for (const SceneTable& table : scene_tables()) {
      if (table.shelf != d.shelf) continue;
      const auto own = static_cast<std::ptrdiff_t>(d.info.keys.size());
      Keys& keys = d.info.keys = keys_together(shared_keys(d, table.info.keys), d.info.keys);
      std::rotate(keys.begin() + 2, keys.end() - own, keys.end());  // behind name and type
      d.parts = table.parts;
    }
  return found;
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
  const std::string kind = d.shelf == "scene" ? "object of a scene" : d.shelf == "links" ? "joint" : kind_on(d.shelf);
  std::string text = fmt::format("{}: {}{}\n  {}\n", d.info.name, kind,
                                 d.origin == "built in" ? "" : ", from plugin " + d.origin, d.info.help);
  std::size_t name = 0, form = 0, fallback = 0;
  for (const Key& key : d.info.keys) {
    name = std::max(name, key.name.size());
    form = std::min<std::size_t>(42, std::max(form, split_form(key, d.parts).first.size()));
    fallback = std::min<std::size_t>(20, std::max(fallback, default_words(key).size()));
  }
  const std::string object = example_of(d), example = object.empty() ? "" : "example:\n  " + object + "\n";
  if (d.info.keys.empty()) return text + "  it has no keys\n" + example;
  text += "keys:\n";
  for (const Key& key : d.info.keys) {
    const auto [words, where] = split_form(key, d.parts);
    std::string line =
        fmt::format("  {:{}}  {:{}}  {:{}}  {}", key.name, name, words, form, default_words(key), fallback, key.help);
    if (key.help.find(where) == std::string::npos) line += "; see " + where;
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text + example;
}

}  // namespace lockstep
