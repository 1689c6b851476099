#include "framework/plugin/loader.h"

#include <boost/dll/shared_library.hpp>
#include <cfenv>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>

#include "framework/plugin/seal.h"
#include "framework/support/error.h"
#include "framework/support/thrown.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;
namespace dll = boost::dll;

using Register = void(Registry&);

// What a library's start leaves behind in the processor: some switch small numbers off for the whole process.
class KeepRounding {
 public:
  KeepRounding() { std::fegetenv(&before_); }
  ~KeepRounding() { std::fesetenv(&before_); }

 private:
  std::fenv_t before_;
};

// Opened libraries by path: they stay so, because objects carry their code.
dll::shared_library& opened(const fs::path& file) {
  static std::mutex mutex;
  static auto& libraries = *new std::map<std::string, dll::shared_library>;  // never destroyed: nothing is unloaded
  const std::lock_guard lock(mutex);
  dll::shared_library& library = libraries[file.string()];
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
    throw PluginError("plugin '" + plugin_name(file.string()) + "' (" + file.string() + ") cannot be opened: " + why +
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

void check_plugin_file(const std::string& file) {
  const SharedFile library(file);
  const lockstep_abi_record record = record_of(library);
  const std::string difference = abi_difference(record, abi_of_this_build());
  if (!difference.empty()) throw PluginError("plugin '" + plugin_name(file) + "': " + difference);
  check_seal(library, record);
}

std::string load_plugin(Registry& registry, const std::string& name_or_path, const std::vector<std::string>& folders) {
  const std::string file = find_plugin(name_or_path, folders);
  const std::string name = plugin_name(file), who = "plugin '" + name + "': ";
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
    set_origin(its, name);
    registry.merge(its);
  } catch (const Error& error) {
    throw PluginError(who + error.what());
  }
  return file;
}

}  // namespace lockstep
