// SPDX-License-Identifier: BSD-3-Clause
// The verb plugins list: the plugins of the search path, and why one is refused. Each file is asked by a process of its
// own, which code of a damaged file may end.
#include <sys/wait.h>
#include <unistd.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "framework/description/registry/survey.h"
#include "framework/foundation/support/child.h"
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
  return {{"name", c.name},       {"state", state_of(c)},
          {"why", c.why},         {"path", c.path},
          {"file", c.file},       {"folder", c.folder},
          {"build", c.build},     {"brings", brings},
          {"size", c.stamp.size}, {"checksum", fmt::format("{:016x}", c.stamp.checksum)}};
}

// Stands before the answer of a process; what a plugin prints may stand before it.
constexpr std::string_view kAnswer = "\nlockstep plugin: ";
constexpr unsigned kPatience = 10;  // s, for one file

void take_answer(const Json& answer, PluginCandidate& c) {
  c.why = answer["why"];
  for (const Json& thing : answer["brings"]) c.brings.emplace_back(thing["kind"], thing["name"]);
  c.state = answer["state"] == "loads" ? PluginCandidate::State::loaded : PluginCandidate::State::refused;
}

// How a process ended that opened a file: "SIGSEGV (Segmentation fault)".
std::string end_words(int status) {
  if (!WIFSIGNALED(status)) return fmt::format("exit code {} without an answer", WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  if (signal == SIGALRM) return fmt::format("no answer within {} s", kPatience);
  return fmt::format("SIG{} ({})", sigabbrev_np(signal), strsignal(signal));
}

void ask_process(PluginCandidate& c) {
  const auto [status, text] = run_child({boost::dll::program_location().string(), "plugin-answer", c.file});
  const std::size_t at = text.rfind(kAnswer);
  if (status == 0 && at != std::string::npos)
    if (const Json answer = Json::from_msgpack(text.substr(at + kAnswer.size()), false, false); answer.is_object())
      return take_answer(answer, c);
  c.why = "plugin file '" + c.file + "' ended the process that opened it: " + end_words(status) +
          "; the file is damaged, or its code is wrong; build or install it anew";
}

void print_all(const PluginCandidate& c) {
  fmt::print("{}: {}\n", c.name, state_of(c));
  fmt::print("  file    {}{}\n", c.path, c.file == c.path ? "" : " -> " + c.file);
  if (!c.build.empty()) fmt::print("  build   {}\n", c.build);
  if (c.stamp.size > 0) fmt::print("  bytes   {}, checksum {:016x}\n", c.stamp.size, c.stamp.checksum);
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

int plugin_answer_command(const char* file) {
  alarm(kPatience);
  PluginCandidate c;
  c.file = file;
  ask_plugin(c, builtin_registry());
  const std::vector<std::uint8_t> answer = Json::to_msgpack(json_of(c));
  fmt::print("{}{}", kAnswer, std::string_view(reinterpret_cast<const char*>(answer.data()), answer.size()));
  return kExitOk;
}

int plugins_list_command(const Arguments& args) {
  const std::vector<std::string> folders = plugin_folders();
  const std::vector<PluginCandidate> all = survey_plugins(folders, ask_process);
  if (args.has("--json")) {
    Json found = Json::array();
    for (const PluginCandidate& c : all) found.push_back(json_of(c));
    const Json all_words = {{"host", abi_words(abi_of_this_build())}, {"folders", folders}, {"plugins", found}};
    print_document(all_words);  // a path need not be UTF-8
    return kExitOk;
  }
  if (args.has("--why")) {
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
