// SPDX-License-Identifier: BSD-3-Clause
// The verbs list, describe, reference and schema.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include <lockstep/text.h>
#include "framework/description/scene/describe.h"
#include "framework/description/scene/write.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/describe_scene.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/findings.h"

namespace lockstep {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Description& d) {
  Json keys = Json::array();
  for (const Key& key : d.info.keys) {
    Json k = {{"name", key.name}, {"form", form_words(key, d.parts)}, {"required", key.required()}, {"help", key.help}};
    if (const Value* v = key.default_value()) k["default"] = Json::parse(write_json(*v));
    keys.push_back(std::move(k));
  }
  Json j = {{"name", d.info.name},
            {"shelf", d.shelf},
            {"origin", d.origin},
            {"help", d.info.help},
            {"keys", std::move(keys)}};
  if (const std::string example = example_of(d); !example.empty()) j["example"] = Json::parse(example);
  return j;
}

// What a scene gets if it names none.
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

void print_shelf(const std::string& shelf, const std::vector<Description>& all) {
  fmt::print("{}:\n", shelf);
  std::size_t width = 0;
  for (const Description& d : all) width = std::max(width, shown_name(d).size());
  for (const Description& d : all) {
    const std::string origin = d.origin == "built in" ? "" : " [plugin " + d.origin + "]";
    fmt::print("  {:<{}}  {}{}\n", shown_name(d), width, d.info.help, origin);
  }
  if (all.empty()) fmt::print("  nothing\n");
}

Json json_of(const FindingKind& kind) {
  return {{"name", kind.code},
          {"shelf", "findings"},
          {"severity", to_string(kind.severity)},
          {"cause", kind.cause},
          {"cure", kind.cure}};
}

int list_findings(const Arguments& args) {
  Json all = Json::array();
  for (const FindingKind* kind : finding_kinds()) {
    if (!args.has("--json")) fmt::print("  {:<24} {:<8} {}\n", kind->code, to_string(kind->severity), kind->cause);
    all.push_back(json_of(*kind));
  }
  if (args.has("--json")) print_document(Json({{"findings", all}}));
  return kExitOk;
}

}  // namespace

int list_command(const Arguments& args) {
  const Registry registry = make_registry(args.all("--plugin"));
  if (args["shelf"] == "findings") return list_findings(args);
  std::vector<std::string> shelves = {"links", "laws", "forces", "integrators", "solvers"};
  if (args.has("shelf")) shelves = {args["shelf"]};
  Json all = Json::object();
  for (const std::string& name : shelves) {
    const std::vector<Description> contents = shelf_contents(registry, name);
    if (!args.has("--json")) print_shelf(name, contents);
    all[name] = Json::array();
    for (const Description& d : contents) all[name].push_back(json_of(d));
  }
  if (args.has("--json")) print_document(all);
  return kExitOk;
}

namespace {

// Parameters and points of a scene: one of them, or all.
int describe_in_scene(const Arguments& args) {
  Arguments with_scene = args;
  with_scene.set("scene", args["--scene"]);
  const Loaded loaded = read_with_plugins(with_scene);
  std::vector<ParameterFacts> all;
  for (const SceneParameter& p : loaded.scene.parameters)
    if (args["name"].empty()) all.push_back(parameter_facts(loaded.scene, p.name));
  if (!args["name"].empty()) all.push_back(parameter_facts(loaded.scene, args["name"]));
  if (args.has("--json")) {
    Json list = Json::array();
    for (const ParameterFacts& f : all)
      list.push_back({{"name", f.name},
                      {"kind", f.kind},
                      {"value", f.value},
                      {"written", Json::parse(f.written)},
                      {"where", f.where},
                      {"read_by", f.read_by}});
    print_document(list);
    return kExitOk;
  }
  for (const ParameterFacts& f : all) {
    fmt::print("{}: a {} of {}\n  {}, written {}\n", f.name, f.kind, f.where, f.value, f.written);
    fmt::print("  read in this file by: {}\n", f.read_by.empty() ? "nothing" : text::join(f.read_by, ", "));
    fmt::print("  {}\n", ways_to_change(f));
  }
  if (all.empty()) fmt::print("{} has neither parameters nor points\n", loaded.scene.file);
  return kExitOk;
}

}  // namespace

int describe_command(const Arguments& args) {
  if (args.has("--scene")) return describe_in_scene(args);
  if (args["name"].empty()) throw UsageError("describe: give a name, as in `lockstep describe revolute`");
  const Registry registry = make_registry(args.all("--plugin"));
  const std::vector<Description> found = find_descriptions(registry, args["name"]);
  const std::string word = describe_word(registry, args["name"]);
  const FindingKind* finding = find_kind(args["name"]);
  if (found.empty() && word.empty() && finding == nullptr) {
    std::vector<std::string> known = known_words(registry);
    for (const FindingKind* kind : finding_kinds()) known.emplace_back(kind->code);
    throw UsageError("describe: unknown name \"" + args["name"] + "\"" + text::suggestion(args["name"], known));
  }
  if (args.has("--json")) {
    Json all = Json::array();
    for (const Description& d : found) all.push_back(json_of(d));
    if (!word.empty()) all.push_back({{"name", args["name"]}, {"shelf", "words"}, {"help", word}});
    if (finding != nullptr) all.push_back(json_of(*finding));
    print_document(all);
    return kExitOk;
  }
  if (finding != nullptr) fmt::print("{}", text_of(*finding));
  for (const Description& d : found) {
    fmt::print("{}", describe(d));
    if (is_default(d)) fmt::print("a run takes it when nothing else is said\n");
  }
  fmt::print("{}{}", found.empty() || word.empty() ? "" : "\n", word);
  return kExitOk;
}

int reference_command(const Arguments& args) {
  fmt::print("{}", args["page"] == "findings" ? findings_page() : scene_reference(make_registry(args.all("--plugin"))));
  return kExitOk;
}

int schema_command(const Arguments& args) {
  fmt::print("{}", scene_schema(make_registry(args.all("--plugin"))));
  return kExitOk;
}

}  // namespace lockstep
