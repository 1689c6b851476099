#include <lockstep/loader.h>

#include <boost/dll/shared_library.hpp>
#include <cfenv>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>

#include <lockstep/error.h>
#include <lockstep/log.h>
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;
namespace dll = boost::dll;

using Register = void(Registry&);

// Restores the floating-point environment after a library was loaded, since some switch denormal numbers off.
class KeepRounding {
 public:
  KeepRounding() { std::fegetenv(&before_); }
  ~KeepRounding() { std::fesetenv(&before_); }

 private:
  std::fenv_t before_{};
};

// Opened libraries by path. They are never closed, because objects carry their code.
dll::shared_library& opened(const fs::path& file) {
  static std::mutex mutex;
  static auto& libraries = *new std::map<std::string, dll::shared_library>;  // never destroyed
  const std::lock_guard lock(mutex);
  dll::shared_library& library = libraries[file.string()];
  if (library.is_loaded()) return library;
  std::error_code error;
  library.load(file, error, dll::load_mode::rtld_now | dll::load_mode::rtld_local);
  if (error) {
    std::string why = error.message();
    try {  // the throwing form has the system loader's message
      library.load(file, dll::load_mode::rtld_now | dll::load_mode::rtld_local);
    } catch (const std::exception& e) {
      why = e.what();
    }
    throw PluginError("plugin '" + plugin_name(file.string()) + "' (" + file.string() + ") cannot be opened: " + why +
                      "; rebuild the plugin against this lockstep");
  }
  return library;
}

// Adds the entries of `from` with the plugin as their origin, whatever origin they claim.
template <class Shelf>
void put(Shelf& to, const Shelf& from, const std::string& name) {
  for (const auto& [type, entry] : from.entries()) to.add(entry.info, entry.make);
  to.set_origin(name);
}

Registry as_of(const std::string& name, const Registry& from) {
  Registry its;
  put(its.laws, from.laws, name);
  put(its.translation_laws, from.translation_laws, name);
  put(its.rotation_laws, from.rotation_laws, name);
  put(its.links, from.links, name);
  put(its.forces, from.forces, name);
  put(its.integrators, from.integrators, name);
  put(its.solvers, from.solvers, name);
  return its;
}

bool empty(const Registry& r) {
  return r.laws.names().empty() && r.translation_laws.names().empty() && r.rotation_laws.names().empty() &&
         r.links.names().empty() && r.forces.names().empty() && r.integrators.names().empty() &&
         r.solvers.names().empty();
}

}  // namespace

void check_plugin_file(const std::string& file) {
  const std::string difference = abi_difference(read_abi(file), abi_of_this_build());
  if (!difference.empty()) throw PluginError("plugin '" + plugin_name(file) + "': " + difference);
}

std::string load_plugin(Registry& registry, const std::string& name_or_path, const std::vector<std::string>& folders) {
  std::string file = find_plugin(name_or_path, folders);
  const std::string name = plugin_name(file), who = "plugin '" + name + "': ";
  if (name == "built in") throw PluginError(who + "its file has the name of lockstep's own types; rename it");
  check_plugin_file(file);
  const KeepRounding rounding;
  dll::shared_library& library = opened(file);  // its code runs from here on
  if (!library.has(kRegisterSymbol))
    throw PluginError(who + "it exports no \"" + kRegisterSymbol + "\"; add LOCKSTEP_PLUGIN(registry) { ... } to it");
  Registry its;
  try {
    library.get<Register>(kRegisterSymbol)(its);
  } catch (const Error&) {
    std::throw_with_nested(PluginError(who + thrown_words(std::current_exception())));
  } catch (...) {
    std::throw_with_nested(PluginError(who + "registering threw: " + thrown_words(std::current_exception())));
  }
  try {
    if (empty(its)) throw PluginError("it registers nothing; let its LOCKSTEP_PLUGIN add something");
    registry.merge(as_of(name, its));
  } catch (const Error& error) {
    throw PluginError(who + error.what());
  }
  log_info(who + "loaded from " + file);
  return file;
}

}  // namespace lockstep
