// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/describe.h"

#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <sstream>

#include "framework/description/scene/json.h"
#include "framework/foundation/support/lines.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

// In a cell of a table a bar would end it.
std::string cell(const std::string& text) { return boost::replace_all_copy(text, "|", "\\|"); }

// The object of a joint has its older name in the tables.
std::string shown_object(const std::string& object) { return object == "link" ? "joint" : object; }

// The help of a key of any form begins with its form: "list of [t, x]: times increasing".
std::string form_cell(const Key& key, const std::vector<Part>& parts) {
  const std::string words = form_words(key, parts);
  return cell(words == "any" ? key.help.substr(0, key.help.find(": ")) : words.substr(0, words.find(": see ")));
}

std::string default_cell(const Key& key) {
  if (key.required()) return "required";
  if (key.default_value() == nullptr) return "";
  return "`" + cell(write_json_line(*key.default_value())) + "`";
}

// Where the objects under a key are described.
std::string seen_cell(const Key& key, const std::vector<Part>& parts) {
  for (const Part& part : parts)
    if (part.key == key.name && !part.table.empty() && !part.names_type())
      return " ([" + shown_object(part.table) + "](#" + shown_object(part.table) + "))";
  return "";
}

void write_keys(std::ostream& out, const std::vector<Key>& keys, const std::vector<Part>& parts) {
  if (keys.empty()) return;
  out << "\n| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const Key& key : keys)
    out << "| `" << key.name << "` | " << form_cell(key, parts) << seen_cell(key, parts) << " | " << default_cell(key)
        << " | " << cell(key.help) << " |\n";
}

void write_type(std::ostream& out, const Description& d) {
  const std::string kind = d.shelf.substr(0, d.shelf.find("_laws"));
  out << "\n### " << shown_object(d.info.name) << (kind != d.shelf ? " " + kind : "")
      << (d.shelf.ends_with("laws") ? " law" : "") << "\n"
      << d.info.help << ".";
  if (d.origin != "built in") out << " From plugin `" << d.origin << "`.";
  out << "\n";
  write_keys(out, d.info.keys, d.parts);
  if (const std::string example = example_of(d); !example.empty()) out << "\nExample: `" << example << "`\n";
}

// A description of words.cpp: the first line, then lines of examples.
void write_form(std::ostream& out, const std::string& name, const std::string& text) {
  out << "\n### " << name << "\n";
  for (const std::string& line : lines_of(std::string_view(text).substr(text.find(": ") + 2))) {
    if (line.ends_with(": a key")) break;
    if (line.starts_with("  "))
      out << "\n    " << line.substr(2) << "\n";
    else
      out << line << "\n";
  }
}

struct Chapter {
  const char *name, *heading, *text;
};
constexpr Chapter kChapters[] = {
    {"links", "Joints and couplings", "Under `joints` of the scene. Each also has the keys of [joint](#joint)."},
    {"forces", "Forces", "Under `forces` of the scene. Each also has the keys of [force](#force)."},
    {"laws", "Laws", "Functions of time, for every key that holds a law. `y` has the unit of that key."},
    {"integrators", "Integrators", "`run.integrator`: the name, or an object with its `type` and keys."},
    {"solvers", "Linear solvers", "`run.solver`: the name, or an object with its `type` and keys."}};

// A line of links for each chapter, to the anchors that GitHub makes of headings.
std::string index_of(const std::string& text) {
  std::string index;
  for (const std::string& line : lines_of(text)) {
    if (!line.starts_with("##")) continue;
    const bool chapter = line[2] == ' ';
    const std::string heading = line.substr(chapter ? 3 : 4);
    const std::string anchor = boost::replace_all_copy(boost::to_lower_copy(heading), " ", "-");
    index += (chapter ? "\n- **[" : " [") + heading + "](#" + anchor + (chapter ? ")**:" : ")");
  }
  return index + "\n";
}

}  // namespace

std::string scene_reference(const Registry& registry) {
  std::ostringstream head, out;
  head << "# Scene reference\nEvery object, type and key of a scene file, for authors of scenes; "
          "[Scenes](scenes.md) explains the format. "
          "A value is in SI units (m, kg, s, rad), unless it is a text with another unit. "
          "`lockstep describe NAME` shows one entry, `lockstep reference` all of them.\n";
  out << "\n## Objects\n";
  for (const Description& d : all_descriptions(registry))
    if (d.shelf == "scene") write_type(out, d);
  for (const Chapter& shelf : kChapters) {
    out << "\n## " << shelf.heading << "\n" << shelf.text << "\n";
    if (std::string(shelf.name) == "links")
      out << "\n![The six coordinates of P relative to S, and those that each joint constrains](lock.svg)\n";
    for (const Description& d : shelf_contents(registry, shelf.name)) write_type(out, d);
  }
  out << "\n## Values\n";
  for (const char* form : {"number", "quantity", "vector3", "axis", "orientation", "law", "translation law",
                           "rotation law", "formula", "channel", "unit"})
    write_form(out, form, describe_word(registry, form));
  out << "\n| quantity | SI unit | example |\n|---|---|---|\n";
  for (const Unit unit : units())
    out << "| " << name_of(unit) << " | " << si_unit(unit) << " | `\"" << example_of(unit) << "\"` |\n";
  return head.str() + index_of(out.str()) + out.str();
}

}  // namespace lockstep
