// The registry: links, laws, forces, integrators and solvers by name.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/force.h>
#include <lockstep/integrator.h>
#include <lockstep/lock.h>
#include <lockstep/params.h>
#include <lockstep/solver.h>

namespace lockstep {

// Registry: shelves of named makers. A plain value that is passed in and filled at run time; two registries in one
// process know nothing of each other.


class Registry;

/// The parameters held against a table, and the laws among them made by the registry, before the thing itself is.
/// Throws SceneError: whatever Params refuses, a law that cannot be made, a law where there is no registry.
LOCKSTEP_API Params checked_params(const Params&, const TypeInfo&, const std::string& owner, const Registry* laws);

/// A shelf: makers of one kind of thing by name. `Make` is the maker's signature after the common (name) lookup.
/// A class is put on a shelf by `add<T>()`: T::info() is its TypeInfo, T::make(...) its maker.
template <class Product, class... Args>
class LOCKSTEP_API Shelf {
 public:
  using Maker = std::function<Product(Args..., const Params&)>;
  /// One type of a shelf: description, maker and origin.
  struct Entry {
    TypeInfo info;
    Maker make;
    std::string origin;  ///< "built in", or the plugin's name
  };

  template <class T>
  void add() {
    add(T::info(), &T::make);
  }
  /// Throws PluginError for an empty or a taken name, a null maker, or a table of keys that is not sound.
  void add(TypeInfo info, Maker make);
  /// Throws SceneError: unknown name (with the closest), or whatever Params refuses. `laws` makes nested laws.
  Product make(const std::string& name, Args... args, const Params&, const Registry* laws,
               const std::string& owner) const;
  /// From parameters that were checked against the entry's table already.
  Product make_checked(const std::string& name, Args... args, const Params& checked) const;
  const Entry* find(const std::string& name) const;
  const std::map<std::string, Entry>& entries() const { return entries_; }
  std::vector<std::string> names() const;
  void set_origin(const std::string& origin);  ///< of all entries that have none yet
  void merge(const Shelf& other);              ///< throws PluginError before it changes anything

 private:
  std::string kind_;  // "law", "link", ... for messages
  std::map<std::string, Entry> entries_;
  friend class Registry;
};

/// Links, laws, forces, integrators and solvers by name.
class LOCKSTEP_API Registry {
 public:
  Registry();
  Shelf<LawPtr<MotionLaw>> laws;
  Shelf<LawPtr<TranslationLaw>> translation_laws;
  Shelf<LawPtr<RotationLaw>> rotation_laws;
  Shelf<std::unique_ptr<Lock>, const Site&> links;
  Shelf<std::unique_ptr<Force>, const Site&> forces;
  Shelf<std::unique_ptr<Integrator>> integrators;
  Shelf<std::unique_ptr<LinearSolver>> solvers;

  /// The law that a Value describes: {"type": ..., keys}. A bare number, a text with a unit or a list stands for the
  /// law "constant", whose first key it becomes.
  LawPtr<MotionLaw> scalar_law(const Value&, const std::string& owner = "law") const;
  LawPtr<TranslationLaw> translation_law(const Value&, const std::string& owner = "translation law") const;
  LawPtr<RotationLaw> rotation_law(const Value&, const std::string& owner = "rotation law") const;

  /// All of `other`'s entries, or none: throws PluginError naming the first name that is taken.
  void merge(const Registry& other);
};

extern template class Shelf<LawPtr<MotionLaw>>;
extern template class Shelf<LawPtr<TranslationLaw>>;
extern template class Shelf<LawPtr<RotationLaw>>;
extern template class Shelf<std::unique_ptr<Lock>, const Site&>;
extern template class Shelf<std::unique_ptr<Force>, const Site&>;
extern template class Shelf<std::unique_ptr<Integrator>>;
extern template class Shelf<std::unique_ptr<LinearSolver>>;


// The registry of everything that comes with lockstep.


/// A fresh registry with all laws, links, forces, integrators and solvers of the library; their origin is "built in".
/// A library that was built with LOCKSTEP_BUILTINS=OFF loads laws and integrators as plugins of these names, from
/// plugin_folders(); their origin is then "motionlaws" or "integrators". Throws PluginError when it cannot.
LOCKSTEP_API Registry builtin_registry();


// MethodSpec: an integrator or a solver by name, with the keys of its type.


/// An integrator or solver by name, with the keys of its type.
struct MethodSpec {
  std::string type;  ///< name in the registry
  Value keys{};      ///< an object, or null for the defaults
  Where where{};     ///< where a file says so
};

/// Descriptions of all entries of a shelf.
template <class S>
std::vector<TypeInfo> types_of(const S& shelf) {
  std::vector<TypeInfo> all;
  for (const auto& [name, entry] : shelf.entries()) all.push_back(entry.info);
  return all;
}

/// From one word: "dopri5", or "dop853:stages=auto:fixed=true". Values are numbers, true, false, or texts, with or
/// without quotes. Throws ModelError for an unknown name or key, with the closest one.
LOCKSTEP_API MethodSpec read_method_spec(const std::string& text, const std::vector<TypeInfo>& types);

/// Made from their descriptions. `owner` begins every message. Throw SceneError with the place.
LOCKSTEP_API std::unique_ptr<Integrator> make_integrator(const MethodSpec&, const Registry&, const std::string& owner);
LOCKSTEP_API std::unique_ptr<LinearSolver> make_solver(const MethodSpec&, const Registry&, const std::string& owner);

}  // namespace lockstep
