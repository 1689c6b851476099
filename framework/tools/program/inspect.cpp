// SPDX-License-Identifier: BSD-3-Clause
// The commands list, describe, reference and schema.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>

#include <lockstep/recorder.h>
#include <lockstep/text.h>
#include "framework/description/scene/describe.h"
#include "framework/description/scene/json.h"
#include "framework/foundation/support/lines.h"
#include "framework/tools/program/describe_scene.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/options.h"

namespace lockstep {
namespace {

// The default of a scene.
bool is_default(const Description& d) {
  const RunSettings run;
  return (d.shelf == "integrators" && d.info.name == run.integrator.type) ||
         (d.shelf == "solvers" && d.info.name == run.solver.type);
}

std::string shown_name(const Description& d) {
  if (d.shelf == "translation_laws") return d.info.name + " (translation)";
  if (d.shelf == "rotation_laws") return d.info.name + " (rotation)";
  return d.info.name + (is_default(d) ? " (default)" : "");
}

Json parsed(const std::string& json) { return json.empty() ? Json() : Json::parse(json); }

using KeyOf = std::pair<Key, const Description*>;
const Fields<KeyOf> kKeyFields{
    {"name", "", "key", [](const KeyOf& k) { return std::string(k.first.name); }},
    {"form", "", "form", [](const KeyOf& k) { return form_words(k.first, k.second->parts); }},
    {"required", "", "required", [](const KeyOf& k) { return k.first.required(); }},
    {"help", "", "help", [](const KeyOf& k) { return std::string(k.first.help); }},
    {"default", "", "default",
     [](const KeyOf& k) {
       return parsed(k.first.default_value() != nullptr ? write_json(*k.first.default_value()) : "");
     },
     kUnlessEmpty}};
const Fields<Description> kDescriptionFields{
    {"shown", "", "name", shown_name},
    {"name", "", "", [](const Description& d) { return d.info.name; }},
    {"shelf", "", "", &Description::shelf},
    {"help", "", "what it is", [](const Description& d) { return d.info.help; }},
    {"origin", "", "", &Description::origin},
    {"plugin", "", "of plugin", [](const Description& d) { return d.origin == "built in" ? "" : d.origin; }},
    {"keys", "",
     [](const Description& d) {
       std::vector<KeyOf> all;
       for (const Key& key : d.info.keys) all.emplace_back(key, &d);
       return all;
     },
     kKeyFields},
    {"example", "", "", [](const Description& d) { return parsed(example_of(d)); }, kUnlessEmpty}};

using Kinds = std::vector<const FindingKind*>;
const Fields<const FindingKind*> kKindFields{
    {"name", "", "code", [](const auto& k) { return k->code; }},
    {"shelf", "", "", [](const auto&) { return "findings"; }},
    {"severity", "", "severity", [](const auto& k) { return to_string(k->severity); }},
    {"cause", "", "cause", [](const auto& k) { return k->cause; }},
    {"cure", "", "", [](const auto& k) { return k->cure; }}};

const Fields<Kinds> kKindsFields{{"codes", "findings", std::identity(), kKindFields, kWhole}};

// The shelves of `list`, each empty unless it is asked for.
using Shelves = std::map<std::string, std::vector<Description>>;
constexpr const char* kShelves[] = {"links", "laws", "forces", "integrators", "solvers"};
const Fields<Shelves> kShelfFields = [] {
  Fields<Shelves> all{};
  for (const char* name : kShelves)
    all.add({name, name == std::string_view("links") ? "joints" : name, [name](const Shelves& s) { return s.at(name); },
             kDescriptionFields, kUnlessEmpty, kWhole});
  return all;
}();

Result list_all(const Arguments& args) {
  const Registry registry = make_registry(args.all("--plugin"));
  if (args["kind"] == "findings") {
    const auto all = finding_kinds();
    return {kKindsFields, Kinds(all.begin(), all.end())};
  }
  Shelves shelves;
  for (const std::string name : kShelves)
    if (auto& shelf = shelves[name]; !args.has("kind") || (args["kind"] == "joints" ? "links" : args["kind"]) == name)
      shelf = shelf_contents(registry, name);
  return {kShelfFields, shelves};
}

const Fields<ParameterFacts> kFactsFields{
    {"name", "", "name", &ParameterFacts::name},
    {"kind", "", "kind", &ParameterFacts::kind},
    {"value", "", "value", &ParameterFacts::value},
    {"written", "", "written", [](const ParameterFacts& f) { return Json::parse(f.written); }},
    {"where", "", "place", &ParameterFacts::where},
    {"read_by", "", "read in this file by", &ParameterFacts::read_by},
    {"change", "", "to change it", ways_to_change}};
const Fields<std::vector<ParameterFacts>> kParametersFields{
    {"parameters", "parameters and points", std::identity(), kFactsFields}};

// Parameters and points of a scene: one of them, or all.
Result describe_in_scene(const Arguments& args) {
  Arguments with_scene = args;
  with_scene.set("scene", args["--scene"]);
  const Loaded loaded = read_with_plugins(with_scene);
  std::vector<ParameterFacts> all;
  for (const SceneParameter& p : loaded.scene.parameters)
    if (args["name"].empty()) all.push_back(parameter_facts(loaded.scene, p.name));
  if (!args["name"].empty()) all.push_back(parameter_facts(loaded.scene, args["name"]));
  return {loaded, kParametersFields, all};
}

/// The meaning of a name.
struct Described {
  std::vector<Description> types;
  std::string word;  ///< a word of scenes, "orientation", or an exit code; "" for none
  Kinds findings;
};
const Fields<Described> kDescribedFields{{"types", "type", &Described::types, kDescriptionFields},
                                         {"help", "", "", &Described::word},
                                         {"codes", "finding", &Described::findings, kKindFields}};

std::string exit_code_words(const std::string& code) {
  for (const std::string& line : lines_of(kExitCodes))
    if (const std::string_view words = text::trimmed(line); words.starts_with(code + " "))
      return fmt::format("exit code {}\n", words);
  return "";
}

// The channels of a force, by its example.
std::string channel_lines(const Description& d, const Registry& registry) try {
  const std::string force = d.shelf == "forces" ? example_of(d) : "";
  if (force.empty()) return "";
  const Scene scene = scene_from_text(
      R"({"lockstep": 1, "bodies": [{"name": "arm", "sphere": {"mass": 1, "radius": 0.1}}], "joints": [{"name": "A",
          "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0]}], "forces": [)" +
          force + "]}",
      "example of " + d.info.name);
  std::string lines = "channels:\n";
  for (const ChannelHelp& c : channel_help(build_mechanism(scene, registry).system))
    if (c.name.starts_with("F.")) lines += fmt::format("  {:20}  {:6}  {}\n", c.name, c.unit, c.help);
  return lines;
} catch (const Error&) {  // a plugin may need more than its example has
  return "";
}

Result describe_name(const Arguments& args) {
  if (args.has("--scene")) return describe_in_scene(args);
  if (args["name"].empty()) throw UsageError("describe: a name is missing, as in `lockstep describe revolute`");
  const Registry registry = make_registry(args.all("--plugin"));
  const std::string name = args["name"] == "joint" ? "link" : args["name"];
  Described found{find_descriptions(registry, name), describe_word(registry, name), {}};
  std::ranges::copy_if(finding_kinds(), std::back_inserter(found.findings),
                       [&](const FindingKind* kind) { return kind->code == args["name"]; });
  found.word += exit_code_words(args["name"]);
  if (found.types.empty() && found.word.empty() && found.findings.empty()) {
    if (const std::string advice = plugin_advice(args["name"]); !advice.empty())
      throw UsageError("describe: unknown name \"" + args["name"] + "\"" + advice);
    std::vector<std::string> known = known_words(registry);
    for (const FindingKind* kind : finding_kinds()) known.emplace_back(kind->code);
    throw UsageError("describe: unknown name \"" + args["name"] + "\"" + text::suggestion(args["name"], known));
  }
  Result result(kDescribedFields, found);
  if (args.has("--json")) return result;
  result.printed = true;
  for (const FindingKind* kind : found.findings) fmt::print("{}", text_of(*kind));
  for (const Description& d : found.types) {
    fmt::print("{}{}", describe(d), channel_lines(d, registry));
    if (is_default(d)) fmt::print("the default of a run\n");
  }
  fmt::print("{}{}", found.types.empty() || found.word.empty() ? "" : "\n", found.word);
  return result;
}

Result print_reference(const Arguments& args) {
  fmt::print("{}", args["page"] == "findings" ? findings_page() : scene_reference(make_registry(args.all("--plugin"))));
  return kExitOk;
}

Result print_schema(const Arguments& args) {
  if (args.has("--results"))
    print_document(results_of_all());
  else
    fmt::print("{}", scene_schema(make_registry(args.all("--plugin"))));
  return kExitOk;
}

}  // namespace

Command list_command() {
  return {"list",
          {Option{"kind", "KIND", "only one of them"}.among("joints,links,laws,forces,integrators,solvers,findings"),
           kPlugin, kJson},
          list_all,
          "Example:\n  lockstep list joints",
          {&kShelfFields.schema(), &kKindsFields.schema()}};
}
Command describe_command() {
  return {
      "describe",
      {{"name", "NAME",
        "a name of `lockstep list`; an object of scenes: body, marker, joint, force, event, run, ...; a key; or "
        "orientation, axis, law, formula, unit, channel, ...; a code of `lockstep list findings`; an exit code; with "
        "--scene a parameter or point"},
       {"--scene", "FILE.json", "describe a parameter or point of this scene, or all of them: value, place, uses"},
       kPlugin,
       kJson},
      describe_name,
      "Example:\n  lockstep describe revolute\n  lockstep describe crank --scene samples/scenes/four_bar.json",
      {&kDescribedFields.schema(), &kParametersFields.schema()}};
}
Command schema_command() {
  return {"schema",
          {{"--results", "", "the schemas of the results of all commands"}, kPlugin},
          print_schema,
          "Example:\n  lockstep schema > scene.schema.json"};
}
Command reference_command() {
  return {"reference",
          {Option{"page", "PAGE", "default: scenes"}.among("scenes,findings"), kPlugin},
          print_reference,
          "Example:\n  lockstep reference > reference.md"};
}

}  // namespace lockstep
