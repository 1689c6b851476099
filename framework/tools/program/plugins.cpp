// SPDX-License-Identifier: BSD-3-Clause
// The command plugins list: the plugins of the search path, and why one is rejected. Each file is opened by a separate
// process, which code of a damaged file may end.
#include <sys/wait.h>
#include <unistd.h>

#include <spdlog/fmt/fmt.h>

#include <boost/algorithm/string/replace.hpp>
#include <boost/dll/runtime_symbol_info.hpp>
#include <cstring>
#include <filesystem>

#include <lockstep/author/loader.h>
#include <lockstep/author/plugin.h>
#include <lockstep/author/registry.h>
#include "framework/description/registry/survey.h"
#include "framework/foundation/support/child.h"
#include "framework/tools/program/options.h"

namespace lockstep {
namespace {

const char* state_of(const PluginCandidate& c) {
  if (c.state == PluginCandidate::State::loaded) return "loads";
  return c.state == PluginCandidate::State::hidden ? "hidden" : "rejected";
}

// "link cam_follower, law bump"
std::string brought(const PluginCandidate& c) {
  std::string words;
  for (const auto& [kind, name] : c.brings) words += (words.empty() ? "" : ", ") + kind + " " + name;
  return words;
}

struct Survey {
  std::string host;
  std::vector<std::string> folders;
  std::vector<PluginCandidate> plugins;
};

std::vector<std::string> missing_folders(const Survey& survey) {
  std::vector<std::string> missing = survey.folders;
  std::error_code error;
  std::erase_if(missing, [&](const std::string& folder) { return std::filesystem::is_directory(folder, error); });
  return missing;
}

// `why`: text has all of them.
Fields<PluginCandidate> plugin_fields(bool why) {
  using Candidate = PluginCandidate;
  const auto only_why = [why](const char* label) { return why ? label : ""; };
  using Brought = std::pair<std::string, std::string>;
  static const Fields<Brought> kBrought{{"kind", "", "kind", &Brought::first}, {"name", "", "name", &Brought::second}};
  return {{"name", "", "name", &Candidate::name},
          {"state", "", "state", state_of},
          {"brings_words", "", "adds", brought},
          {"path", "", "", &Candidate::path},
          {"file", "", only_why("file"), &Candidate::file},
          {"folder", "", "", &Candidate::folder},
          {"build", "", "", &Candidate::build},
          {"brings", "", [](const Candidate& c) { return std::vector<Brought>(c.brings.begin(), c.brings.end()); },
           kBrought},
          {"size", "", only_why("bytes"), [](const Candidate& c) { return c.stamp.size; }},
          {"checksum", "", only_why("checksum"),
           [](const Candidate& c) { return c.stamp.checksum > 0 ? fmt::format("{:016x}", c.stamp.checksum) : ""; }},
          {"why", "", "", &Candidate::why}};
}
const Fields<PluginCandidate> kPluginFields[] = {plugin_fields(false), plugin_fields(true)};

Fields<Survey> survey_fields(bool why) {
  return {{"host", "", why ? "this host" : "", &Survey::host},
          // LOCKSTEP_PLUGIN_PATH, then the program's own
          {"folders", "", why ? "searched folders" : "", &Survey::folders},
          {"missing_folders", "", why ? "missing folders" : "", missing_folders},
          {"plugins", "plugins", &Survey::plugins, kPluginFields[why]}};
}
const Fields<Survey> kSurveyFields[] = {survey_fields(false), survey_fields(true)};

// Precedes the answer of a process; output of the plugin may precede it.
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
  return fmt::format("SIG{} ({}){}", sigabbrev_np(signal), strsignal(signal),
                     signal == SIGABRT ? ": a constructor of a global object may have thrown" : "");
}

void ask_process(PluginCandidate& c) {
  const auto [status, text] = run_child({boost::dll::program_location().string(), "plugin-answer", c.file});
  const std::size_t at = text.rfind(kAnswer);
  if (status == 0 && at != std::string::npos)
    if (const Json answer = Json::from_msgpack(text.substr(at + kAnswer.size()), false, false); answer.is_object())
      return take_answer(answer, c);
  c.why = "plugin file '" + c.file + "' ended the process that opened it: " + end_words(status) +
          "; the file is damaged, or its code is wrong; build or install it again";
}

Result list_plugins(const Arguments& args) {
  Survey found{abi_words(abi_of_this_build()), plugin_folders(), {}};
  if (args["file"].empty()) {
    found.plugins = survey_plugins(found.folders, ask_process);
  } else {
    PluginCandidate& one = found.plugins.emplace_back();
    one.name = std::filesystem::path(args["file"]).stem(), one.path = one.file = args["file"];
    ask_process(one);
  }
  if (found.plugins.empty() && !args.has("--json"))
    fmt::print("no plugins in {} folders; --why lists them\n", found.folders.size());
  Result result(kSurveyFields[args.has("--why")], found);
  result.brief = text_of(*result.schema, result.data);
  for (const PluginCandidate& c : found.plugins)
    if (!c.why.empty())
      result.brief += fmt::format("  {} {}:\n    {}\n", state_of(c), c.name,
                                  boost::replace_first_copy(c.why, "; ", "\n    hint: "));
  return result;
}

}  // namespace

int answer_for_plugin(const char* file) {
  alarm(kPatience);
  PluginCandidate c;
  c.file = file;
  ask_plugin(c, builtin_registry());
  const std::vector<std::uint8_t> answer = Json::to_msgpack(kPluginFields[false](c));
  fmt::print("{}{}", kAnswer, std::string_view(reinterpret_cast<const char*>(answer.data()), answer.size()));
  return kExitOk;
}

std::string plugin_advice(const std::string& type) {
  for (const PluginCandidate& c : survey_plugins(plugin_folders(), ask_process))
    for (const auto& [kind, name] : c.brings)
      if (name == type) return fmt::format("; plugin {} adds this {}: load it by --plugin {}", c.name, kind, c.name);
  return "";
}

Command plugins_list_command() {
  return {"plugins list",
          {{"file", "FILE", "this file alone; default: all of the searched folders"},
           {"--why", "", "report folders, files, sizes and checksums too"},
           kJson},
          list_plugins,
          "Example:\n  LOCKSTEP_PLUGIN_PATH=~/my/plugins lockstep plugins list --why",
          {&kSurveyFields[false].schema()}};
}

}  // namespace lockstep
