// SPDX-License-Identifier: BSD-3-Clause
// The registry: joints, laws, forces, integrators and solvers by name.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/force.h>
#include <lockstep/author/integrator.h>
#include <lockstep/author/lock.h>
#include <lockstep/author/params.h>
#include <lockstep/author/solver.h>

namespace lockstep {

// Registry: shelves of named makers. It is a value that is passed to its users and filled at run time. Two registries
// in one process are independent.

class Registry;

/// Checks parameters against a type's table of keys, and makes the laws among them by the registry `laws`. Throws
/// SceneError, which begins with `owner`: errors of Params, a law that cannot be made, a law if `laws` is null.
LOCKSTEP_API Params checked_params(const Params&, const TypeInfo&, const std::string& owner, const Registry* laws);

/// Makers of one kind of thing by name. A maker takes Args, then checked parameters, and returns a Product.
template <class Product, class... Args>
class LOCKSTEP_API Shelf {
 public:
  using Maker = std::function<Product(Args..., const Params&)>;  ///< it may throw, and must not return null
  /// One type of a shelf: description, maker and origin.
  struct Entry {
    TypeInfo info;       ///< name, help and keys
    Maker make;          ///< called with checked parameters
    std::string origin;  ///< "built in", or the plugin's name; "": added by the host
  };

  /// Adds a class by its TypeInfo, T::info(), and its maker, T::make().
  template <class T>
  void add() {
    add(T::info(), &T::make);
  }
  /// Adds a type. Throws PluginError for an empty or a taken name, a null maker, or a table of keys that is not sound.
  void add(TypeInfo info, Maker make);
  /// Makes an object of this type, which `owner` names in messages; `laws` makes the laws among its parameters. Throws
  /// SceneError for an unknown name (with the closest) and for invalid parameters, PluginError if the maker returns
  /// null, and the errors of the maker, with the type's name.
  Product make(const std::string& name, Args... args, const Params&, const Registry* laws,
               const std::string& owner) const;
  /// The same, from parameters that are already checked against the entry's table. The type must exist.
  Product make_checked(const std::string& name, Args... args, const Params& checked) const;
  const Entry* find(const std::string& name) const;                         ///< null if there is no such type
  const std::map<std::string, Entry>& entries() const { return entries_; }  ///< all types by name
  std::vector<std::string> names() const;                                   ///< of all types, sorted
  void set_origin(const std::string& origin);                               ///< of all entries that have none yet
  /// Adds all entries of another shelf, or none. Throws PluginError for a name that is taken.
  void merge(const Shelf& other);

 private:
  std::string kind_;  // "law", "joint", ... for messages
  std::map<std::string, Entry> entries_;
  friend class Registry;
};

/// Joints, laws, forces, integrators and solvers by name.
class LOCKSTEP_API Registry {
 public:
  Registry();                                               ///< empty; see builtin_registry()
  Shelf<LawPtr<MotionLaw>> laws;                            ///< scalar laws
  Shelf<LawPtr<TranslationLaw>> translation_laws;           ///< laws of a translation
  Shelf<LawPtr<RotationLaw>> rotation_laws;                 ///< laws of a rotation
  Shelf<std::unique_ptr<Lock>, const Attachment&> links;    ///< joints and couplings
  Shelf<std::unique_ptr<Force>, const Attachment&> forces;  ///< applied forces
  Shelf<std::unique_ptr<Integrator>> integrators;           ///< time-stepping methods
  Shelf<std::unique_ptr<LinearSolver>> solvers;             ///< linear solvers

  /// Makes the scalar law that a Value describes: {"type": ..., its keys}. A bare number, a text with a unit or a list
  /// is the law "constant", with the value as its first key. Throws SceneError, which begins with `owner`.
  LawPtr<MotionLaw> scalar_law(const Value&, const std::string& owner = "law") const;
  /// The same for a translation, m.
  LawPtr<TranslationLaw> translation_law(const Value&, const std::string& owner = "translation law") const;
  /// The same for a rotation.
  LawPtr<RotationLaw> rotation_law(const Value&, const std::string& owner = "rotation law") const;

  /// Adds all entries of another registry, or none. Throws PluginError with the first name that is taken.
  void merge(const Registry& other);
};

extern template class Shelf<LawPtr<MotionLaw>>;
extern template class Shelf<LawPtr<TranslationLaw>>;
extern template class Shelf<LawPtr<RotationLaw>>;
extern template class Shelf<std::unique_ptr<Lock>, const Attachment&>;
extern template class Shelf<std::unique_ptr<Force>, const Attachment&>;
extern template class Shelf<std::unique_ptr<Integrator>>;
extern template class Shelf<std::unique_ptr<LinearSolver>>;

// The registry of everything that comes with lockstep.

/// A new registry with all laws, joints, forces, integrators and solvers of the library; their origin is "built in". A
/// library built with LOCKSTEP_BUILTINS=OFF loads laws and integrators from the plugins "motionlaws" and "integrators"
/// in plugin_folders(), and throws PluginError if it cannot.
LOCKSTEP_API Registry builtin_registry();

/// Descriptions of all types of a shelf, by name.
template <class S>
std::vector<TypeInfo> types_of(const S& shelf) {
  std::vector<TypeInfo> all;
  for (const auto& [name, entry] : shelf.entries()) all.push_back(entry.info);
  return all;
}

/// Reads a method from one word: "dopri5", or "dop853:stages=auto:fixed=true". Values are numbers, true, false, or
/// texts with or without quotes. `types`: those to choose from, by types_of(). Throws ModelError for an unknown name or
/// key, with the closest one.
LOCKSTEP_API MethodSpec read_method_spec(const std::string& text, const std::vector<TypeInfo>& types,
                                         const char* kind = "method");

/// Makes an integrator. Throws SceneError for an unknown name or invalid keys, with the place in the file; its message
/// begins with `owner`.
LOCKSTEP_API std::unique_ptr<Integrator> make_integrator(const MethodSpec&, const Registry&, const std::string& owner);
/// Makes a linear solver. Throws as make_integrator().
LOCKSTEP_API std::unique_ptr<LinearSolver> make_solver(const MethodSpec&, const Registry&, const std::string& owner);

}  // namespace lockstep
