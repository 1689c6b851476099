// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/loader.h>

#include <spdlog/fmt/fmt.h>

#include <boost/core/demangle.hpp>
#include <boost/dll/shared_library.hpp>
#include <cerrno>
#include <cfenv>
#include <cstring>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <new>

#include <lockstep/author/plugin.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include "framework/description/registry/shelves.h"
#include "framework/foundation/support/at_end.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;
namespace dll = boost::dll;

using Register = void(Registry&);

std::string words_of(const PluginStamp& s) { return fmt::format("{} bytes with checksum {:016x}", s.size, s.checksum); }

// The words of the system's loader and advice, with the symbol that it lacks as C++.
std::string reason(const std::string& why) {
  static const std::string kLacks = "undefined symbol: ", kSays = "system message: ", kNoFile = ": cannot open shared";
  const std::string rebuild =
      "rebuild the plugin against this lockstep, by lockstep_add_plugin() or with the flags of lockstep.pc";
  const auto word = [&](std::size_t from, std::size_t to) { return why.substr(from, to - from); };
  if (const std::size_t at = why.find(kLacks); at != std::string::npos)
    return "it needs '" +
           boost::core::demangle(word(at + kLacks.size(), why.find_first_of(", )", at + kLacks.size())).c_str()) +
           "', which neither this lockstep nor another library has; if it is your own, add its source or library to "
           "the "
           "plugin, else " +
           rebuild;
  const std::size_t says = why.find(kSays), no_file = why.find(kNoFile);
  if (says != std::string::npos && no_file != std::string::npos)
    return "it needs the library '" + word(says + kSays.size(), no_file) +
           "', which is not found; install it, or add its folder to LD_LIBRARY_PATH or the plugin's rpath";
  return why + "; " + rebuild;
}

// Whether glibc lacked memory. It then misses files that are there, such as this one, which was read before.
bool lacks_memory(const std::string& why, const std::string& file) {
  const std::string no_file = file + ": cannot open shared object file: " + std::strerror(ENOENT);
  return why.find(std::strerror(ENOMEM)) != std::string::npos || why.find(no_file) != std::string::npos ||
         why.find("cannot create shared object descriptor") != std::string::npos;
}

// Opened libraries by path, and what their files were before. They are never closed, because objects carry their code.
dll::shared_library& opened(const fs::path& file, const PluginStamp& stamp) {
  struct Opened {
    dll::shared_library library;
    PluginStamp stamp;
  };
  static std::mutex mutex;
  static auto& libraries = *new std::map<std::string, Opened>;  // never destroyed
  const std::lock_guard lock(mutex);
  auto& [library, before] = libraries[file.string()];
  if (library.is_loaded() && stamp != before)
    throw PluginError("plugin '" + plugin_name(file.string()) + "': " + file.string() + " has " + words_of(stamp) +
                      "; this process loaded it with " + words_of(before) + "; restart the process");
  if (library.is_loaded()) return library;
  before = stamp;
  try {
    library.load(file, dll::load_mode::rtld_now | dll::load_mode::rtld_local);
  } catch (const std::system_error& error) {  // with the system loader's message
    if (lacks_memory(error.what(), file.string())) throw std::bad_alloc();
    throw PluginError("plugin '" + plugin_name(file.string()) + "' (" + file.string() +
                      ") cannot be opened: " + reason(error.what()));
  }
  return library;
}

// The entries of a registry with the plugin as their origin, whatever origin they claim.
Registry as_of(const std::string& name, const Registry& from) {
  Registry its;
  for_each_shelf([&](auto, auto, auto shelf) {
    for (const auto& [type, entry] : (from.*shelf).entries()) (its.*shelf).add(entry.info, entry.make);
    (its.*shelf).set_origin(name);
  });
  return its;
}

}  // namespace

std::string load_plugin(Registry& registry, const std::string& name_or_path, const std::vector<std::string>& folders,
                        const std::optional<PluginStamp>& expected) {
  std::string file = find_plugin(name_or_path, folders);
  const std::string name = plugin_name(file), who = "plugin '" + name + "': ";
  if (name == "built in") throw PluginError(who + "this name stands for lockstep's own types; rename the file");
  const PluginStamp stamp = check_plugin_file(file);
  if (expected && stamp != *expected)
    throw PluginError(who + file + " has " + words_of(stamp) + ", expected " + words_of(*expected) +
                      "; install the file again, or update the expected stamp");
  std::fenv_t rounding{};
  std::fegetenv(&rounding);
  const AtEnd restore([&] { std::fesetenv(&rounding); });  // some libraries switch denormal numbers off
  dll::shared_library& library = opened(file, stamp);  // its code runs from here on
  if (!library.has(kRegisterSymbol))
    throw PluginError(who + "it exports no \"" + kRegisterSymbol + "\"; add LOCKSTEP_PLUGIN(registry) { ... } to it");
  Registry its;
  try {
    library.get<Register>(kRegisterSymbol)(its);
  } catch (const Error&) {
    std::throw_with_nested(PluginError(who + thrown_words(std::current_exception())));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
    const std::string what = "its LOCKSTEP_PLUGIN function threw: " + thrown_words(std::current_exception());
    std::throw_with_nested(PluginError(who + what));
  }
  try {
    its = as_of(name, its);
    if (things_of(its, name).empty()) throw PluginError("it registers no type; add one in its LOCKSTEP_PLUGIN");
    registry.merge(its);
  } catch (const Error& error) {
    throw PluginError(who + error.what());
  }
  log_info(who + "loaded from " + file);
  return file;
}

}  // namespace lockstep
