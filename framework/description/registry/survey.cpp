// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/survey.h"

#include <filesystem>
#include <map>

#include <lockstep/author/plugin.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include "framework/description/registry/plugin_file.h"
#include "framework/description/registry/shelves.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {

std::vector<std::pair<std::string, std::string>> things_of(const Registry& registry, const std::string& origin) {
  std::vector<std::pair<std::string, std::string>> things;
  for_each_shelf([&](auto, const char* kind, auto shelf) {
    for (const auto& [name, entry] : (registry.*shelf).entries())
      if (entry.origin == origin) things.emplace_back(std::string_view(kind) == "link" ? "joint" : kind, name);
  });
  return things;
}

namespace {

// Size, checksum and build of the file, as far as they can be read; none of its code runs.
void read_head(PluginCandidate& c) {
  try {
    c.stamp = stamp_of(c.file);
    c.build = abi_words(read_abi(c.file));
  } catch (const Error&) {  // ask_plugin() finds it, too
  }
}

}  // namespace

void ask_plugin(PluginCandidate& c, const Registry& base) {
  try {
    const std::string name = plugin_name(c.file);
    Registry registry = is_part_of_library(name) ? Registry() : base;
    load_plugin(registry, c.file, {}, check_plugin_file(c.file));
    c.brings = things_of(registry, name);
    c.state = PluginCandidate::State::loaded;
  } catch (const std::exception& error) {
    const bool names_it = dynamic_cast<const Error*>(&error) != nullptr;  // a damaged file may ask for any memory
    c.why = (names_it ? "" : "plugin file '" + c.file + "': opening it threw: ") + what_of(error);
    log_info("plugin '" + c.name + "' not loaded: " + c.why);
  }
}

std::vector<PluginCandidate> survey_plugins(const std::vector<std::string>& folders,
                                            const std::function<void(PluginCandidate&)>& ask) {
  std::vector<PluginCandidate> all = files_in(folders);
  std::map<std::string, std::string> first;  // of each name: the file that is used
  for (PluginCandidate& c : all) {
    std::error_code error;
    if (const std::uintmax_t size = std::filesystem::file_size(c.file, error); !error) c.stamp.size = size;
    const auto [taken, is_first] = first.emplace(c.name, c.path);
    if (!is_first) {
      c.state = PluginCandidate::State::hidden;
      c.why = taken->second + " comes first and is used";
    } else if (c.why.empty()) {
      read_head(c);
      ask(c);
    }
  }
  return all;
}

}  // namespace lockstep
