// SPDX-License-Identifier: BSD-3-Clause
// Registries, and the types that callbacks make.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/check.h>
#include <lockstep/author/formula.h>
#include <lockstep/author/loader.h>
#include "framework/description/scene/describe.h"
#include "framework/description/scene/json.h"
#include "framework/description/scene/tree.h"
#include "framework/hosts/c/state.h"
#include "framework/hosts/c/user_code.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/simulation/host_types.h"

namespace lockstep::c {

thread_local std::string* message_in_progress = nullptr;

namespace {

/// A type of which scenes make objects.
struct Type {
  TypeInfo info;
  User user;

  /// `words`: "amplitude omega=2"; `shelf`: "laws".
  Type(const char* name, const char* words, const char* what, const char* shelf, User its)
      : info{needed_text(name, "type"), std::string(what) + " of the host", {}}, user(std::move(its)) {
    check_word(info.name, "type \"" + info.name + '"');
    std::string spaced = text_or(words, "keys");
    std::ranges::replace(spaced, ',', ' ');
    std::istringstream in(spaced);
    for (std::string word; in >> word;) info.keys.push_back(key_of(word, shelf));
  }
  /// The callback with the values that an object of the type has.
  template <class F>
  Code<F> code(F callback, const Params& params) const {
    std::vector<double> values;
    for (const Key& key : info.keys) values.push_back(params.number(key.name));
    return {callback, user, std::move(values)};
  }

 private:
  static void check_word(const std::string& word, const std::string& what) {
    const auto fits = [](unsigned char c) { return c == '_' || c >= 0x80 || std::isalnum(c) != 0; };
    if (word.empty() || ('0' <= word[0] && word[0] <= '9') || !std::ranges::all_of(word, fits))
      refuse(LOCKSTEP_USAGE, what + " is no word; use letters, digits and _, and begin with a letter");
  }
  Key key_of(const std::string& word, const char* shelf) const {
    const std::string name = word.substr(0, word.find('=')), what = "type \"" + info.name + "\", key \"" + name + '"';
    check_word(name, what);
    bool taken = name == "type" || key_in({&info.keys}, name) != nullptr;
    for (const SceneTable& table : scene_tables())  // the keys that scenes give all types of this shelf
      taken = taken || (table.shelf == shelf && key_in({&table.info.keys}, name) != nullptr);
    if (taken) refuse(LOCKSTEP_USAGE, what + " is taken, by another key or by scenes; choose another name");
    Key key{name, Form::number, Unit::any, kRequired, "a number of the host's type"};
    if (name == word) return key;
    const std::string given = word.substr(name.size() + 1);
    const std::optional<double> x = number_in<double>(given);
    if (!x || !std::isfinite(*x))
      refuse(LOCKSTEP_USAGE, what + ": its default \"" + given + "\" is no finite number; give one in SI units");
    key.fallback = *x;
    return key;
  }
};

// (y, yd, ydd) = law(t)
class Law final : public MotionLaw {
 public:
  Law(Code<lockstep_law> law, Code<lockstep_next_break> next) : law_(std::move(law)), next_(std::move(next)) {}
  LawValue at(double t) const override {
    std::array<double, 3> y{};
    law_(t, y.data());
    return {y[0], y[1], y[2]};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    const std::size_t most = out.size() + kMostJumps;
    for (double t = t0; next_.callback != nullptr;) {
      double next = std::numeric_limits<double>::infinity();
      next_(t, &next);
      if (!(next > t))
        throw UserCodeError(fmt::format("next_break gives {} s after {} s; give a later time, or none", next, t));
      if (next >= t1) return;
      if (out.size() == most)
        throw UserCodeError(
            fmt::format("next_break gives more than {} jumps from {} s to {} s; give fewer", kMostJumps, t0, t));
      out.push_back(t = next);
    }
  }

 private:
  static constexpr std::size_t kMostJumps = 10'000'000;  // between two steps or in a run; 80 MB
  Code<lockstep_law> law_;
  Code<lockstep_next_break> next_;
};

// f at P and m on the body of P, -f at P and -m on that of S
class HostForce final : public MarkerForce {
  static std::array<double, 13> numbers(const MarkerOn<double>& m) {
    const Vec3 x = m.x(), v = m.v(), w = m.w();
    const Quat q = m.q();
    return {x[0], x[1], x[2], q.w, q.x, q.y, q.z, v[0], v[1], v[2], w[0], w[1], w[2]};
  }
  auto act() const {
    return [this](const Ends<double>& at, auto& load) {
      const auto p = numbers(at.P), s = numbers(at.S);
      std::array<double, 9> of{};
      force_(at.t, p.data(), s.data(), of.data());
      load.force({of[0], of[1], of[2]}, at.P.x()), load.torque({of[3], of[4], of[5]});
      load.stores(of[6]), load.dissipates(of[7]), load.supplies(of[8]);
    };
  }
  ForceAccount account(const Inputs& in) const { return formula::account(P_, S_, in, act()); }

  std::string type_;
  Code<lockstep_force> force_;

 public:
  HostForce(std::string type, std::string name, Marker& p, Marker* s, Code<lockstep_force> force)
      : MarkerForce(std::move(name), p, s), type_(std::move(type)), force_(std::move(force)) {}
  std::string_view type() const override { return type_; }
  void apply(const Inputs& in, WrenchSum& out) const override { formula::apply(P_, S_, in, act(), out); }
  double potential(const Inputs& in) const override { return account(in).potential; }
  double dissipation(const Inputs& in) const override { return account(in).dissipation; }
  double supply(const Inputs& in) const override { return account(in).supply; }
};

std::unique_ptr<Integrator> integrator_of(const std::string& type, int order, Code<lockstep_integrator> step) {
  return std::make_unique<HostIntegrator>(type, order, [=](Dynamics& dynamics, State& end, double h) {
    in_context([&, t = end.t] { return ErrorContext{.thing = {.kind = "integrator", .name = type}, .t = t}; },
               [&] { step(Lent(end, dynamics, StateObject::May::evaluate).handle(), h); });
  });
}

// Adds a type to a shelf, with the maker that `maker` gives of it; the user data is freed in any case.
template <class Shelf, class Callback, class Maker>
int add_type(lockstep_registry* registry, Shelf Registry::*on, const char* shelf, const char* name, const char* keys,
             const char* what, void* user, lockstep_free_user free_user, Callback callback, Maker maker) noexcept {
  return with_user(user, free_user, [&](const User& owner) {
    return call<RegistryObject>(registry, [&](RegistryObject& r) {
      if (callback == nullptr) refuse_null(what);
      const auto its = std::make_shared<const Type>(name, keys, what, shelf, owner);
      (r.registry.*on).add(its->info, maker(its));
    });
  });
}

// Types by shelf, with the fields of `lockstep list --json`.
Value types_of_registry(const Registry& registry) {
  Value all = Value::object({});
  for (const char* shelf : {"links", "laws", "forces", "integrators", "solvers"}) {
    Value::List types;
    for (const Description& d : shelf_contents(registry, shelf)) {
      Value::List keys;
      for (const Key& key : d.info.keys) {
        keys.push_back(Value::object({{"name", key.name},
                                      {"form", form_words(key, d.parts)},
                                      {"required", key.required()},
                                      {"help", key.help}}));
        if (key.default_value() != nullptr) put(keys.back(), "default", *key.default_value());
      }
      types.push_back(Value::object({{"name", d.info.name},
                                     {"shelf", d.shelf},
                                     {"help", d.info.help},
                                     {"origin", d.origin},
                                     {"keys", std::move(keys)}}));
      if (const std::string its = example_of(d); !its.empty()) put(types.back(), "example", read_json(its, "example"));
    }
    put(all, shelf, std::move(types));
  }
  return all;
}

CheckReport check(const Registry& registry, const std::string& kind, const std::string& type, const Params& keys) {
  if (kind == "law") return check_law(*registry.laws.make(type, keys, &registry, "law '" + type + "'"), {}, type);
  if (kind == "joint") return check_lock(registry, type, keys);
  if (kind == "force") return check_force(registry, type, keys);
  if (kind == "integrator") return check_integrator(registry, type, keys);
  refuse(LOCKSTEP_USAGE, "kind is \"" + kind + "\"; must be law, joint, force or integrator");
}

}  // namespace
}  // namespace lockstep::c

using namespace lockstep;
using namespace lockstep::c;

extern "C" {

int lockstep_fail(const char* message) {
  try {
    put(message_in_progress, utf8(message != nullptr ? message : ""));
  } catch (...) {  // no memory for it: the code alone
  }
  return LOCKSTEP_USER_CODE;
}

int lockstep_new_registry(lockstep_registry** made) {
  return make<RegistryObject>(made, [](RegistryObject& r) { r.registry = builtin_registry(); });
}

int lockstep_load_plugin(lockstep_registry* registry, const char* name) {
  return call<RegistryObject>(registry, [&](RegistryObject& r) { load_plugin(r.registry, needed_text(name, "name")); });
}

int lockstep_types(lockstep_registry* registry, const char** json) {
  return call<RegistryObject>(
      registry, [&](RegistryObject& r) { needed(json, "json") = r.keep(write_json(types_of_registry(r.registry))); });
}

int lockstep_add_law(lockstep_registry* registry, const char* type, const char* keys, lockstep_law law,
                     lockstep_next_break next_break, void* user, lockstep_free_user free_user) {
  return add_type(registry, &Registry::laws, "laws", type, keys, "law", user, free_user, law, [&](const auto& its) {
    return [=](const Params& p) -> LawPtr<MotionLaw> {
      return std::make_shared<Law>(its->code(law, p), its->code(next_break, p));
    };
  });
}

int lockstep_add_joint(lockstep_registry* registry, const char* type, const char* keys, int rows, const char* mask,
                       lockstep_joint joint, void* user, lockstep_free_user free_user) {
  return add_type(registry, &Registry::links, "links", type, keys, "joint", user, free_user, joint,
                  [&](const auto& its) {
                    within(rows, 1, 3, "rows");
                    return [=, held = mask_from(text_or(mask, "mask"))](const Attachment& a, const Params& p) {
                      return numeric_joint(its->info.name, a, held, rows, its->code(joint, p));
                    };
                  });
}

int lockstep_add_force(lockstep_registry* registry, const char* type, const char* keys, lockstep_force force,
                       void* user, lockstep_free_user free_user) {
  return add_type(registry, &Registry::forces, "forces", type, keys, "force", user, free_user, force,
                  [&](const auto& its) {
                    return [=](const Attachment& a, const Params& p) -> std::unique_ptr<Force> {
                      return std::make_unique<HostForce>(its->info.name, a.name, p_of(a, p),
                                                         has_s(a) ? &s_of(a, p) : nullptr, its->code(force, p));
                    };
                  });
}

int lockstep_add_integrator(lockstep_registry* registry, const char* type, const char* keys, int order,
                            lockstep_integrator step, void* user, lockstep_free_user free_user) {
  return add_type(registry, &Registry::integrators, "integrators", type, keys, "step", user, free_user, step,
                  [&](const auto& its) {
                    within(order, 1, std::numeric_limits<double>::digits, "order");  // h/2 leaves less than round-off
                    return [=](const Params& p) { return integrator_of(its->info.name, order, its->code(step, p)); };
                  });
}

int lockstep_check_type(lockstep_registry* registry, const char* kind, const char* type, const char* keys,
                        int* findings, const char** report) {
  return call<RegistryObject>(registry, [&](RegistryObject& r) {
    const Value given = read_json(text_or(keys, "keys", "{}"), "keys");
    const CheckReport found =
        check(r.registry, needed_text(kind, "kind"), needed_text(type, "type"), Params::unchecked(given));
    put(findings, found.findings().size()), put(report, r.keep(found.text()));
  });
}
}
