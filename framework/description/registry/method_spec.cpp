// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/registry.h>

#include <algorithm>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

template <class S>
auto make(const S& shelf, const char* kind, const MethodSpec& spec, const Registry& registry,
          const std::string& owner) {
  if (shelf.find(spec.type) == nullptr)
    refuse(spec.where, owner,
           std::string("unknown ") + kind + " \"" + spec.type + "\"" + text::suggestion(spec.type, shelf.names()));
  return shelf.make(spec.type, Params::unchecked(spec.keys), &registry, owner);
}

}  // namespace

MethodSpec read_method_spec(const std::string& text, const std::vector<TypeInfo>& types, const char* kind) {
  const std::vector<std::string> parts = split_at(':', text);
  std::vector<std::string> names, keys;
  for (const TypeInfo& t : types) names.push_back(t.name);
  const auto type = std::ranges::find(types, parts.front(), &TypeInfo::name);
  if (type == types.end())
    throw ModelError(std::string("unknown ") + kind + " \"" + parts.front() + "\"" +
                     text::suggestion(parts.front(), names));
  for (const Key& key : type->keys) keys.push_back(key.name);
  Value::Object members;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equal = parts[i].find('=');
    const std::string key = parts[i].substr(0, equal);
    if (equal == std::string::npos || key_in({&type->keys}, key) == nullptr)
      throw ModelError("\"" + parts[i] + "\" in \"" + text + "\" sets no key of " + type->name +
                       (keys.empty() ? ", which has none" : text::suggestion(key, keys)) + "; write " + type->name +
                       ":key=value, see `lockstep describe " + type->name + "`");
    const std::string word = parts[i].substr(equal + 1);
    const bool quoted = word.size() >= 2 && word.front() == '"' && word.back() == '"';
    members.push_back({key, quoted ? Value(word.substr(1, word.size() - 2)) : read_word(word), {}});
  }
  return {type->name, Value(std::move(members)), {}};
}

std::unique_ptr<Integrator> make_integrator(const MethodSpec& spec, const Registry& registry,
                                            const std::string& owner) {
  return make(registry.integrators, "integrator", spec, registry, owner);
}

std::unique_ptr<LinearSolver> make_solver(const MethodSpec& spec, const Registry& registry, const std::string& owner) {
  return make(registry.solvers, "solver", spec, registry, owner);
}

}  // namespace lockstep
