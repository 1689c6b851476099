// The verb plugins list: the plugins of the search path, and why one is refused.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <lockstep/loader.h>
#include <lockstep/registry.h>
#include "framework/description/registry/survey.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/document.h"

namespace lockstep {
namespace {

using Json = nlohmann::ordered_json;

const char* state_of(const PluginCandidate& c) {
  if (c.state == PluginCandidate::State::loaded) return "loads";
  return c.state == PluginCandidate::State::hidden ? "hidden" : "refused";
}

// "link cam_follower, law bump"
std::string brought(const PluginCandidate& c) {
  std::string words;
  for (const auto& [kind, name] : c.brings) words += (words.empty() ? "" : ", ") + kind + " " + name;
  return words;
}

Json json_of(const PluginCandidate& c) {
  Json brings = Json::array();
  for (const auto& [kind, name] : c.brings) brings.push_back({{"kind", kind}, {"name", name}});
  return {{"name", c.name}, {"state", state_of(c)}, {"why", c.why},     {"path", c.path},
          {"file", c.file}, {"folder", c.folder},   {"build", c.build}, {"brings", brings}};
}

void print_all(const PluginCandidate& c) {
  fmt::print("{}: {}\n", c.name, state_of(c));
  fmt::print("  file    {}{}\n", c.path, c.file == c.path ? "" : " -> " + c.file);
  if (!c.build.empty()) fmt::print("  build   {}\n", c.build);
  if (!c.brings.empty()) fmt::print("  brings  {}\n", brought(c));
  if (!c.why.empty()) fmt::print("  why     {}\n", c.why);
}

void print_folders(const std::vector<std::string>& folders) {
  fmt::print("searched, in this order (LOCKSTEP_PLUGIN_PATH, then the program's own folders):\n");
  for (const std::string& folder : folders) {
    std::error_code error;
    fmt::print("  {}{}\n", folder, std::filesystem::is_directory(folder, error) ? "" : " (there is no such folder)");
  }
}

}  // namespace

int plugins_list_command(const Arguments& args) {
  const std::vector<std::string> folders = plugin_folders();
  const std::vector<PluginCandidate> all = survey_plugins(builtin_registry(), folders);
  if (args.json) {
    Json found = Json::array();
    for (const PluginCandidate& c : all) found.push_back(json_of(c));
    const Json all_words = {{"host", abi_words(abi_of_this_build())}, {"folders", folders}, {"plugins", found}};
    print_document(all_words);  // a path need not be UTF-8
    return kExitOk;
  }
  if (args.why) {
    fmt::print("this host: {}\n", abi_words(abi_of_this_build()));
    print_folders(folders);
    for (const PluginCandidate& c : all) print_all(c);
    return kExitOk;
  }
  std::size_t width = 0;
  for (const PluginCandidate& c : all) width = std::max(width, c.name.size());
  for (const PluginCandidate& c : all)
    fmt::print("{:<{}}  {:<7}  {}\n", c.name, width, state_of(c),
               c.state == PluginCandidate::State::loaded ? brought(c) : c.why);
  if (all.empty()) fmt::print("no plugin in {} folders; --why names them\n", folders.size());
  return kExitOk;
}

}  // namespace lockstep
