#include "framework/plugin/loader.h"

#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <boost/dll/shared_library.hpp>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <sstream>

#include "framework/plugin/elf.h"
#include "framework/support/error.h"
#include "framework/support/text.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;
namespace dll = boost::dll;

using Register = void(Registry&);

std::string version(const std::int32_t (&v)[3]) {
  return std::to_string(v[0]) + "." + std::to_string(v[1]) + "." + std::to_string(v[2]);
}

template <std::size_t N>
std::string text(const char (&s)[N]) {
  return {s, std::find(s, s + N, '\0')};
}

std::string flags(const lockstep_abi_record& r) {
  std::string all = text(r.flags);
  while (!all.empty() && all.back() == ' ') all.pop_back();
  return all.empty() ? "none" : all;
}

// "cam_follower" from "plugins/libcam_follower.so"
std::string name_of(const fs::path& path) {
  const std::string stem = path.stem().string();
  return stem.rfind("lib", 0) == 0 ? stem.substr(3) : stem;
}

// As written; with the ending of a library; with "lib" before it as well.
std::vector<fs::path> spellings(const fs::path& path) {
  const std::string ending = dll::shared_library::suffix().string();
  std::vector<fs::path> all = {path};
  if (path.extension() != ending) {
    fs::path with = path;
    with += ending;
    all.push_back(with);
    all.push_back(with.parent_path() / ("lib" + with.filename().string()));
  }
  return all;
}

fs::path find_file(const std::string& name, std::vector<std::string> folders) {
  std::error_code error;
  const bool is_path = name.find('/') != std::string::npos;
  if (is_path) {
    folders = {""};
  } else if (folders.empty()) {
    folders = plugin_folders();
  }
  for (const std::string& folder : folders)
    for (const fs::path& file : spellings(folder.empty() ? fs::path(name) : fs::path(folder) / name))
      if (fs::is_regular_file(file, error)) return fs::absolute(file);
  if (is_path) throw PluginError("plugin '" + name + "': there is no such file; check the path, or build it first");
  throw PluginError("plugin '" + name + "' not found; looked in " + (folders.empty() ? "no folder" : join(folders)) +
                    "; give its path, or name its folder in LOCKSTEP_PLUGIN_PATH");
}

// Opened libraries by path: they stay so, because objects carry their code.
dll::shared_library& opened(const fs::path& file) {
  static std::mutex mutex;
  static auto& libraries = *new std::map<std::string, dll::shared_library>;  // never destroyed: nothing is unloaded
  const std::lock_guard lock(mutex);
  dll::shared_library& library = libraries[fs::canonical(file).string()];
  if (library.is_loaded()) return library;
  std::error_code error;
  library.load(file, error, dll::load_mode::rtld_now | dll::load_mode::rtld_local);
  if (error) {
    std::string why = error.message();
    try {  // the throwing form has the loader's own words
      library.load(file, dll::load_mode::rtld_now | dll::load_mode::rtld_local);
    } catch (const std::exception& e) {
      why = e.what();
    }
    throw PluginError("plugin '" + name_of(file) + "' (" + file.string() + ") cannot be opened: " + why +
                      "; rebuild the plugin against this lockstep");
  }
  return library;
}

void set_origin(Registry& registry, const std::string& name) {
  registry.laws.set_origin(name);
  registry.translation_laws.set_origin(name);
  registry.rotation_laws.set_origin(name);
  registry.links.set_origin(name);
  registry.forces.set_origin(name);
  registry.integrators.set_origin(name);
  registry.solvers.set_origin(name);
}

bool empty(const Registry& r) {
  return r.laws.names().empty() && r.translation_laws.names().empty() && r.rotation_laws.names().empty() &&
         r.links.names().empty() && r.forces.names().empty() && r.integrators.names().empty() &&
         r.solvers.names().empty();
}

}  // namespace

std::vector<std::string> plugin_folders() {
  std::vector<std::string> folders;
  const auto add = [&](const fs::path& folder) {
    const std::string name = folder.lexically_normal().string();
    if (!name.empty() && std::find(folders.begin(), folders.end(), name) == folders.end()) folders.push_back(name);
  };
  if (const char* path = std::getenv("LOCKSTEP_PLUGIN_PATH")) {
    std::istringstream parts(path);
    for (std::string folder; std::getline(parts, folder, ':');)
      if (!folder.empty()) add(folder);
  }
  std::error_code error;
  const fs::path program = dll::program_location(error), library = dll::symbol_location_ptr(&read_abi, error);
  if (!program.empty()) add(program.parent_path() / ".." / "plugins");
  if (!library.empty()) add(library.parent_path() / ".." / "plugins");
  if (!library.empty()) add(library.parent_path() / "lockstep" / "plugins");
  return folders;
}

lockstep_abi_record read_abi(const std::string& path) {
  const std::vector<unsigned char> bytes = exported_data(path, kAbiSymbol, sizeof(lockstep_abi_record));
  const std::string who = "plugin '" + name_of(path) + "' (" + path + ")";
  if (bytes.empty())
    throw PluginError(who + " is no plugin of lockstep: it has no symbol \"" + kAbiSymbol +
                      "\"; add a LOCKSTEP_PLUGIN(registry) { ... } to it");
  lockstep_abi_record record{};
  std::memcpy(&record, bytes.data(), bytes.size());
  if (text(record.magic) != kAbiMagic)
    throw PluginError(who + ": the record of its build cannot be read; rebuild the plugin against this lockstep");
  return record;
}

std::string abi_difference(const lockstep_abi_record& plugin, const lockstep_abi_record& host) {
  const auto build = [](const lockstep_abi_record& r) {
    return "ABI " + std::to_string(r.abi) + " with " + text(r.compiler) + " " + version(r.compiler_version);
  };
  const auto sentence = [](const std::string& its, const std::string& ours) {
    return "built for " + its + ", this host is " + ours + "; rebuild the plugin against this lockstep";
  };
  if (plugin.abi != host.abi || plugin.size != host.size || text(plugin.compiler) != text(host.compiler) ||
      plugin.compiler_version[0] != host.compiler_version[0])
    return sentence(build(plugin), build(host));
  const auto differs = [&](const std::string& what, const std::string& its, const std::string& ours) {
    return its == ours ? std::string() : sentence(what + " " + its, what + " " + ours);
  };
  const auto library = [](const lockstep_abi_record& r) {
    return text(r.library) + " " + std::to_string(r.library_version) + (r.library_abi != 0 ? "" : " (old strings)");
  };
  for (const std::string& difference :
       {differs("C++", std::to_string(plugin.cxx_level), std::to_string(host.cxx_level)),
        differs("the standard library", library(plugin), library(host)),
        differs("Eigen", version(plugin.eigen_version), version(host.eigen_version)),
        differs("alignment", std::to_string(plugin.alignment), std::to_string(host.alignment)),
        differs("settings", flags(plugin), flags(host))})
    if (!difference.empty()) return difference;
  return {};
}

std::string load_plugin(Registry& registry, const std::string& name_or_path, const std::vector<std::string>& folders) {
  const fs::path file = find_file(name_or_path, folders);
  const std::string name = name_of(file), who = "plugin '" + name + "': ";
  const std::string difference = abi_difference(read_abi(file.string()), abi_of_this_build());
  if (!difference.empty()) throw PluginError(who + difference);

  dll::shared_library& library = opened(file);  // its code runs from here on
  if (!library.has(kRegisterSymbol))
    throw PluginError(who + "it exports no \"" + kRegisterSymbol + "\"; add LOCKSTEP_PLUGIN(registry) { ... } to it");
  Registry its;
  try {
    library.get<Register>(kRegisterSymbol)(its);
    if (empty(its)) throw PluginError("it registers nothing; let its LOCKSTEP_PLUGIN add something");
    set_origin(its, name);
    registry.merge(its);
  } catch (const std::exception& error) {
    throw PluginError(who + error.what());
  }
  return file.string();
}

}  // namespace lockstep
