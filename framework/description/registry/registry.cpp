// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/registry.h>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/registry/law_units.h"
#include "framework/description/registry/shelves.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

std::string origin_words(const std::string& origin) {
  if (origin.empty()) return {};
  return origin == "built in" ? " (built in)" : " (plugin " + origin + ")";
}

// The name of what is made; laws and methods have none.
std::string made_name() { return {}; }
std::string made_name(const Attachment& attachment) { return attachment.name; }

ErrorContext of_maker(Thing made, const std::string& owner) {
  std::string label = owner.empty() ? made.label() : owner + " (" + made.type + of_plugin(made.origin) + ")";
  return {.thing = std::move(made), .refuses = true, .label = std::move(label)};
}

// The law of an object with "type"; anything but an object is the value of the law "constant".
template <class L>
LawPtr<L> law_from(const Shelf<LawPtr<L>>& shelf, const Value& v, const Registry& laws, const std::string& owner) {
  if (v.object() == nullptr) {
    const auto* constant = shelf.find("constant");
    if (v.is_null() || v.boolean() != nullptr || constant == nullptr || constant->info.keys.empty())
      refuse(v.where, owner, "expected an object {\"type\": ..., and its keys}, got " + shown(v));
    Value object(Value::Object{{constant->info.keys.front().name, v, v.where}});
    object.where = v.where;
    return shelf.make("constant", Params::unchecked(std::move(object)), &laws, owner);
  }
  const Value* type = v.find("type");
  if (type == nullptr) refuse(v.where, owner, "missing key \"type\"; add one of " + text::join(shelf.names(), " or "));
  const std::string name = read_text(*type, part_of(owner, "type"));
  if (shelf.find(name) == nullptr)
    refuse(type->where, owner, "unknown law \"" + name + "\"" + text::suggestion(name, shelf.names()));
  return shelf.make(name, Params::unchecked(v.without({"type"})), &laws, owner);
}

// The tables among the named numbers of its formulas.
void put_tables(Params& of, const Registry& laws) {
  if (const Value::Object* const named = of.value("parameters").object())
    for (const Value::Member& m : *named)
      if (const std::string key = part_of("parameters", m.key); m.value.object() != nullptr)
        of.put_law("parameters." + m.key, laws.scalar_law(m.value, part_of(of.owner(), key)));
}

}  // namespace

Params with_laws(Params of, const Registry* laws) {
  for (const Key& key : of.keys()) {
    if (key.form == Form::any && key.name == "parameters" && laws != nullptr && of.has(key.name)) put_tables(of, *laws);
    const Value v = holds_law(key.form) ? of.given_or_default(key) : Value();
    if (v.is_null() || (laws == nullptr && !of.has(key.name))) continue;
    if (laws == nullptr) of.refuse(key.name, "it holds a law, and no registry is given to make it; pass one");
    const std::string place = part_of(of.owner(), key.name);
    if (key.form == Form::law) of.put_law(key.name, laws->scalar_law(v, place));
    if (key.form == Form::translation_law) of.put_law(key.name, laws->translation_law(v, place));
    if (key.form == Form::rotation_law) of.put_law(key.name, laws->rotation_law(v, place));
    if (key.form == Form::laws) {
      std::vector<LawPtr<MotionLaw>> list;
      for (const Value& item : *v.list())
        list.push_back(laws->scalar_law(item, place + "[" + std::to_string(list.size()) + "]"));
      of.put_law(key.name, std::make_shared<const std::vector<LawPtr<MotionLaw>>>(std::move(list)));
    }
    if (key.unit != Unit::none && key.unit != Unit::any)  // else it is part of a law, or its user knows
      check_law_units(v, key.form, {key.unit, 0, key.of_time}, *laws, place);
  }
  return of;
}

Params checked_params(const Params& params, const TypeInfo& info, const std::string& owner, const Registry* laws) {
  return with_laws(params.checked(info, owner), laws);
}

template <class Product, class... Args>
void Shelf<Product, Args...>::add(TypeInfo info, Maker make) {
  const std::string what = kind_ + " '" + info.name + "'";
  if (info.name.empty()) throw PluginError("a " + kind_ + " has no name; set the name of its TypeInfo");
  if (!make) throw PluginError(what + " has no maker; pass a function that makes it");
  if (const Entry* taken = find(info.name))
    throw PluginError(what + " is already registered" + origin_words(taken->origin) + "; choose another name");
  try {
    check_type_info(info);
  } catch (const ModelError& error) {
    throw PluginError(what + " cannot be registered: " + error.what());
  }
  std::string name = info.name;
  entries_.emplace(std::move(name), Entry{std::move(info), std::move(make), {}});
}

template <class Product, class... Args>
Product Shelf<Product, Args...>::make(const std::string& name, Args... args, const Params& params, const Registry* laws,
                                      const std::string& owner) const {
  const Entry* entry = find(name);
  if (entry == nullptr)
    refuse(params.where(), owner, "unknown " + kind_ + " \"" + name + "\"" + text::suggestion(name, names()),
           {.thing = {.kind = kind_, .name = made_name(args...), .type = name}});
  const auto context = [&] { return of_maker({kind_, made_name(args...), name, entry->origin}, owner); };
  const Params checked = in_context(context, [&] { return checked_params(params, entry->info, owner, laws); });
  return make_checked(name, std::forward<Args>(args)..., checked);
}

template <class Product, class... Args>
Product Shelf<Product, Args...>::make_checked(const std::string& name, Args... args, const Params& params) const {
  const Entry* entry = find(name);
  const auto context = [&] { return of_maker({kind_, made_name(args...), name, entry->origin}, params.owner()); };
  Product product = in_context(context, [&]() -> Product {
    try {
      return entry->make(args..., params);
    } catch (const ParameterError& error) {  // what it builds on may have keys that this type lacks
      if (key_in({&entry->info.keys}, error.key) != nullptr)
        params.refuse(error.key, error.problem + (error.advice.empty() ? "" : "; " + error.advice));
      throw;
    }
  });
  if (!product) {
    const ErrorContext whose = context();
    throw PluginError(whose.label + ": its maker returned null; return the new object, or throw an error",
                      {.thing = whose.thing});
  }
  if constexpr (requires { labelled(product, LawLabel{}); })
    return labelled(product, {name, entry->origin});
  else if constexpr (requires { product->set_origin(entry->origin); })
    product->set_origin(entry->origin);
  return product;
}

template <class Product, class... Args>
auto Shelf<Product, Args...>::find(const std::string& name) const -> const Entry* {
  const auto found = entries_.find(name);
  return found == entries_.end() ? nullptr : &found->second;
}

template <class Product, class... Args>
std::vector<std::string> Shelf<Product, Args...>::names() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : entries_) names.push_back(name);
  return names;
}

template <class Product, class... Args>
void Shelf<Product, Args...>::set_origin(const std::string& origin) {
  for (auto& [name, entry] : entries_)
    if (entry.origin.empty()) entry.origin = origin;
}

template <class Product, class... Args>
void Shelf<Product, Args...>::merge(const Shelf& other) {
  for (const auto& [name, entry] : other.entries_)
    if (const Entry* taken = find(name))
      throw PluginError(!entry.origin.empty() && entry.origin == taken->origin
                            ? "it is already loaded into this registry; load it once"
                            : kind_ + " '" + name + "'" + origin_words(entry.origin) + " is already registered" +
                                  origin_words(taken->origin) + "; choose another name");
  entries_.insert(other.entries_.begin(), other.entries_.end());
}

template class Shelf<LawPtr<MotionLaw>>;
template class Shelf<LawPtr<TranslationLaw>>;
template class Shelf<LawPtr<RotationLaw>>;
template class Shelf<std::unique_ptr<Lock>, const Attachment&>;
template class Shelf<std::unique_ptr<Force>, const Attachment&>;
template class Shelf<std::unique_ptr<Integrator>>;
template class Shelf<std::unique_ptr<LinearSolver>>;

Registry::Registry() {
  for_each_shelf([this](auto, std::string_view kind, auto on) { (this->*on).kind_ = kind == "link" ? "joint" : kind; });
}

std::string kind_on(std::string_view shelf) {
  std::string found;
  for_each_shelf([&](std::string_view name, const char* kind, auto) { found = name == shelf ? kind : found; });
  return found;
}

const TypeInfo* find_type(const Registry& registry, std::string_view shelf, const std::string& type) {
  const TypeInfo* found = nullptr;
  for_each_shelf([&](std::string_view name, auto, auto on) {
    if (const auto* entry = name == shelf ? (registry.*on).find(type) : nullptr) found = &entry->info;
  });
  return found;
}

std::string_view shelf_of(Form form) {
  if (form == Form::translation_law) return "translation_laws";
  if (form == Form::rotation_law) return "rotation_laws";
  return holds_law(form) ? "laws" : "";
}

LawPtr<MotionLaw> Registry::scalar_law(const Value& v, const std::string& owner) const {
  return law_from(laws, v, *this, owner);
}

LawPtr<TranslationLaw> Registry::translation_law(const Value& v, const std::string& owner) const {
  return law_from(translation_laws, v, *this, owner);
}

LawPtr<RotationLaw> Registry::rotation_law(const Value& v, const std::string& owner) const {
  return law_from(rotation_laws, v, *this, owner);
}

void Registry::merge(const Registry& other) {
  Registry merged = *this;
  for_each_shelf([&](auto, auto, auto shelf) { (merged.*shelf).merge(other.*shelf); });
  *this = std::move(merged);
}

}  // namespace lockstep
