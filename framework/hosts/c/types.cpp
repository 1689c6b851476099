// SPDX-License-Identifier: BSD-3-Clause
// Registries, and the types that callbacks make.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/check.h>
#include <lockstep/author/loader.h>
#include <lockstep/author/relative.h>
#include <lockstep/author/stepping.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/tables.h"
#include "framework/description/scene/write.h"
#include "framework/hosts/c/json.h"
#include "framework/hosts/c/numeric_phi.h"
#include "framework/hosts/c/registry.h"
#include "framework/hosts/c/state.h"
#include "framework/hosts/c/user_code.h"
#include "framework/mechanism/params/read.h"

namespace lockstep::c {

thread_local std::string* message_in_progress = nullptr;

namespace {

/// A type of which scenes make objects.
struct Type {
  TypeInfo info;
  User user;

  /// `words`: "amplitude omega=2"; `shelf`: "laws", of which scenes give some keys by themselves.
  Type(const char* name, const char* words, const char* what, const char* shelf, User its)
      : info{needed_text(name, "type"), std::string(what) + " of the host", {}}, user(std::move(its)) {
    check_word(info.name, "type \"" + info.name + '"');
    std::string_view rest = text_or(words, "keys");
    constexpr std::string_view kBlanks = " \t\n,";
    while ((rest = rest.substr(std::min(rest.size(), rest.find_first_not_of(kBlanks)))) != "") {
      const std::string word(rest.substr(0, rest.find_first_of(kBlanks))), key = word.substr(0, word.find('='));
      const std::string its_name = "type \"" + info.name + "\", key \"" + key + '"';
      check_word(key, its_name);
      if (key_in({&info.keys}, key) != nullptr) refuse(LOCKSTEP_USAGE, its_name + " is given twice; remove one");
      if (is_of_scenes(key, shelf)) refuse(LOCKSTEP_USAGE, its_name + " has a meaning in scenes; choose another name");
      info.keys.push_back({key, Form::number, Unit::any, kRequired, "a number of the host's type"});
      if (key != word) info.keys.back().fallback = default_of(word.substr(key.size() + 1), its_name);
      rest.remove_prefix(word.size());
    }
  }
  /// The callback with the values that an object of the type has.
  template <class F>
  Code<F> code(F* callback, const Params& params) const {
    std::vector<double> values;
    for (const Key& key : info.keys) values.push_back(params.number(key.name));
    return {callback, user, std::move(values)};
  }

 private:
  static void check_word(const std::string& word, const std::string& what) {
    const auto letter = [](unsigned char c) { return ('a' <= (c | 32) && (c | 32) <= 'z') || c == '_' || c >= 0x80; };
    const auto fits = [&](unsigned char c) { return letter(c) || ('0' <= c && c <= '9'); };
    if (word.empty() || !letter(static_cast<unsigned char>(word[0])) || !std::ranges::all_of(word, fits))
      refuse(LOCKSTEP_USAGE, what + " is no word; use letters, digits and _, and begin with a letter");
  }
  static bool is_of_scenes(const std::string& key, const char* shelf) {
    return key == "type" || std::ranges::any_of(scene_tables(), [&](const SceneTable& table) {
             return table.shelf == shelf && key_in({table.keys().get()}, key) != nullptr;
           });
  }
  static Value default_of(const std::string& word, const std::string& key) {
    double x = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(x))
      refuse(LOCKSTEP_USAGE, key + ": its default \"" + word + "\" is no finite number");
    return x;
  }
};

// (y, yd, ydd) = law(t)
class Law final : public MotionLaw {
 public:
  Law(Code<std::remove_pointer_t<lockstep_law>> law, Code<std::remove_pointer_t<lockstep_next_break>> next)
      : law_(std::move(law)), next_(std::move(next)) {}
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
        throw UserCodeError(fmt::format("next_break gives more than {} jumps from {} s to {} s; give fewer", kMostJumps, t0, t));
      out.push_back(t = next);
    }
  }

 private:
  static constexpr std::size_t kMostJumps = 10'000'000;  // between two steps or in a run; 80 MB
  Code<std::remove_pointer_t<lockstep_law>> law_;
  Code<std::remove_pointer_t<lockstep_next_break>> next_;
};

// f at P and m on the body of P, -f at P and -m on that of S
class HostForce final : public MarkerForce {
 public:
  HostForce(std::string type, std::string name, Marker& p, Marker* s, Code<std::remove_pointer_t<lockstep_force>> force)
      : MarkerForce(std::move(name), p, s), type_(std::move(type)), force_(std::move(force)) {}
  std::string_view type() const override { return type_; }
  void apply(const Inputs& in, WrenchSum& out) const override {
    const Result r = at(in);
    const Vec3 f(r.out[0], r.out[1], r.out[2]), m(r.out[3], r.out[4], r.out[5]);
    out.force(P_.slot, f, r.x), out.torque(P_.slot, m);
    out.force(S_.slot, -f, r.x), out.torque(S_.slot, -m);
  }
  double potential(const Inputs& in) const override { return at(in).out[6]; }
  double dissipation(const Inputs& in) const override { return at(in).out[7]; }
  // Potential and dissipation are those along the motion of the markers: laws that move them on their bodies do the rest.
  double supply(const Inputs& in) const override {
    const Result r = at(in);
    return r.out[8] + power(P_, r, in) - power(S_, r, in);
  }

 private:
  using Ends = std::array<double, 13>;
  struct Result {
    Vec3 x;  // of P
    std::array<double, 9> out{};
  };
  static Ends numbers(const MarkerFrame& marker, const MarkerInWorld& m, const Inputs& in) {
    const Quat q = in.slot(marker.slot).e * marker.at(in.t).q;
    return {m.x[0], m.x[1], m.x[2], q.w, q.x, q.y, q.z, m.v[0], m.v[1], m.v[2], m.w[0], m.w[1], m.w[2]};
  }
  Result at(const Inputs& in) const {
    const MarkerInWorld P = in_world(P_, in);
    const Ends p = numbers(P_, P, in), s = numbers(S_, in_world(S_, in), in);
    Result r{.x = P.x};
    force_(in.t, p.data(), s.data(), r.out.data());
    return r;
  }

  // Power of (f, m) at x on the body of a marker, less that on the marker.
  static double power(const MarkerFrame& marker, const Result& r, const Inputs& in) {
    const MarkerInWorld at = in_world(marker, in);
    const Motion& body = in.slot(marker.slot);
    const Vec3 w = body.A * body.w, v = body.v + cross(w, Vec3(r.x - body.x));
    const Vec3 dv = v - at.v - cross(at.w, Vec3(r.x - at.x)), dw = w - at.w;
    return r.out[0] * dv[0] + r.out[1] * dv[1] + r.out[2] * dv[2] + r.out[3] * dw[0] + r.out[4] * dw[1] +
           r.out[5] * dw[2];
  }

  std::string type_;
  Code<std::remove_pointer_t<lockstep_force>> force_;
};

class HostIntegrator final : public Integrator {
 public:
  HostIntegrator(std::string type, int order, Code<std::remove_pointer_t<lockstep_integrator>> step)
      : type_(std::move(type)), order_(order), step_(std::move(step)) {}
  IntegratorInfo info() const override { return {type_, order_, false, false, order_}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    State end = state;
    step_(Lent(end, dynamics, StateObject::May::evaluate).handle(), h);
    end.t = state.t + h;
    const ProjectReport landed = project_end_or_throw(dynamics, end, type_.c_str(), state.t, h);
    state = std::move(end);
    return {.h = h, .violation = landed.before, .violation_after = landed.after};
  }

 private:
  std::string type_;
  int order_;
  Code<std::remove_pointer_t<lockstep_integrator>> step_;
};

// Calls `add` with the registry and the type; the user data is freed in any case.
template <class Add>
int add_type(lockstep_registry* registry, const char* name, const char* keys, const char* what, const char* shelf,
             void* user, lockstep_free_user free_user, const void* callback, Add add) noexcept {
  return with_user(user, free_user, [&](const User& owner) {
    return call<RegistryObject>(registry, [&](RegistryObject& r) {
      if (callback == nullptr) refuse_null(what);
      add(r.registry, std::make_shared<const Type>(name, keys, what, shelf, owner));
    });
  });
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
    if (message_in_progress != nullptr) *message_in_progress = utf8(message != nullptr ? message : "");
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
  return add_type(registry, type, keys, "law", "laws", user, free_user, reinterpret_cast<const void*>(law),
                  [&](Registry& r, const std::shared_ptr<const Type>& its) {
                    r.laws.add(its->info, [=](const Params& p) -> LawPtr<MotionLaw> {
                      return std::make_shared<Law>(its->code(law, p), its->code(next_break, p));
                    });
                  });
}

int lockstep_add_joint(lockstep_registry* registry, const char* type, const char* keys, int rows, const char* mask,
                       lockstep_joint joint, void* user, lockstep_free_user free_user) {
  return add_type(registry, type, keys, "joint", "links", user, free_user, reinterpret_cast<const void*>(joint),
                  [&](Registry& r, const std::shared_ptr<const Type>& its) {
                    within(rows, 1, 3, "rows");
                    const Mask held = mask_from(text_or(mask, "mask"));
                    r.links.add(its->info, [=](const Attachment& a, const Params& p) {
                      PhiNumbers phi = [code = its->code(joint, p)](const double* y, double* f, double* g, double* h) {
                        code(y, f, g, h);
                      };
                      return numeric_joint(its->info.name, a, held, rows, std::move(phi));
                    });
                  });
}

int lockstep_add_force(lockstep_registry* registry, const char* type, const char* keys, lockstep_force force,
                       void* user, lockstep_free_user free_user) {
  return add_type(registry, type, keys, "force", "forces", user, free_user, reinterpret_cast<const void*>(force),
                  [&](Registry& r, const std::shared_ptr<const Type>& its) {
                    r.forces.add(its->info, [=](const Attachment& a, const Params& p) -> std::unique_ptr<Force> {
                      return std::make_unique<HostForce>(its->info.name, a.name, p_of(a, p),
                                                         has_s(a) ? &s_of(a, p) : nullptr, its->code(force, p));
                    });
                  });
}

int lockstep_add_integrator(lockstep_registry* registry, const char* type, const char* keys, int order,
                            lockstep_integrator step, void* user, lockstep_free_user free_user) {
  return add_type(registry, type, keys, "step", "integrators", user, free_user, reinterpret_cast<const void*>(step),
                  [&](Registry& r, const std::shared_ptr<const Type>& its) {
                    within(order, 1, std::numeric_limits<double>::digits, "order");  // h/2 leaves less than round-off
                    r.integrators.add(its->info, [=](const Params& p) -> std::unique_ptr<Integrator> {
                      return std::make_unique<HostIntegrator>(its->info.name, order, its->code(step, p));
                    });
                  });
}

int lockstep_check_type(lockstep_registry* registry, const char* kind, const char* type, const char* keys,
                        int* findings, const char** report) {
  return call<RegistryObject>(registry, [&](RegistryObject& r) {
    const Value given = read_json(text_or(keys, "keys", "{}"), "keys");
    const CheckReport found =
        check(r.registry, needed_text(kind, "kind"), needed_text(type, "type"), Params::unchecked(given));
    if (findings != nullptr) *findings = static_cast<int>(found.findings().size());
    if (report != nullptr) *report = r.keep(found.text());
  });
}
}
