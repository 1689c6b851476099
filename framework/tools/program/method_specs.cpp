// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/method_specs.h"

#include <algorithm>

#include <lockstep/error.h>
#include "framework/description/scene/json.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

std::string one_word(const Value& v) {
  if (v.text() != nullptr) return *v.text();
  std::string text = write_json(v);
  std::erase_if(text, [](char c) { return c == '\n' || c == ' '; });
  return text;
}

double number_of(const std::string& option, const std::string& text, Unit unit, const char* example) {
  if (const std::optional<double> x = number_in<double>(text)) return *x;
  const Measured measured = read_quantity(text, unit);
  if (!measured.problem.empty() || unit == Unit::none)
    throw UsageError(option + ": \"" + text + "\" is not a " + name_of(unit) +
                     (text.starts_with("=") ? " (formulas are for scenes only)" : "") + "; write it as in " + option +
                     " " +
                     (example != nullptr   ? example
                      : unit == Unit::none ? "1e-6"
                                           : "0.001"));
  return measured.value;
}

}  // namespace

MethodSpec read_spec(const std::string& option, const std::string& text, const std::vector<TypeInfo>& types) {
  return as_usage(option, [&] {
    return read_method_spec(text, types, option.find("solver") == option.npos ? "integrator" : "solver");
  });
}

std::string to_word(const MethodSpec& spec) {
  std::string text = spec.type;
  if (spec.keys.object() != nullptr)
    for (const Value::Member& m : *spec.keys.object()) text += ":" + m.key + "=" + one_word(m.value);
  return text;
}

Value to_value(const MethodSpec& spec) {
  if (spec.keys.object() == nullptr || spec.keys.object()->empty()) return Value(spec.type);
  Value::Object members{{"type", Value(spec.type), {}}};
  for (const Value::Member& m : *spec.keys.object()) members.push_back(m);
  return Value(std::move(members));
}

std::vector<MethodSpec> all_specs(const MethodSpec& own, const std::vector<TypeInfo>& types) {
  std::vector<MethodSpec> all{own};
  const auto add = [&](MethodSpec spec) {
    const auto same = [&](const MethodSpec& other) { return to_word(other) == to_word(spec); };
    if (std::none_of(all.begin(), all.end(), same)) all.push_back(std::move(spec));
  };
  for (const TypeInfo& type : types) {
    add({type.name, Value(Value::Object{}), {}});
    for (const Key& key : type.keys) {
      if (key.form != Form::choice) continue;
      const std::string usual = key.default_value() != nullptr ? plain_text(*key.default_value()) : "";
      for (const std::string& choice : key.choices)
        if (choice != usual) add({type.name, Value(Value::Object{{key.name, choice, {}}}), {}});
    }
  }
  return all;
}

MethodSpec with_known_keys(const TypeInfo& type, const Value& keys) {
  Value::Object members;
  if (keys.object() != nullptr)
    for (const Value::Member& m : *keys.object())
      if (std::any_of(type.keys.begin(), type.keys.end(), [&](const Key& k) { return k.name == m.key; }))
        members.push_back(m);
  return {type.name, Value(std::move(members)), {}};
}

IntegratorInfo integrator_info(RunSettings run, const Registry& registry) {
  run.step = 1;
  return make_integrator(run, registry)->info();
}

double positive_number(const std::string& option, const std::string& text, Unit unit, const char* example) {
  const double x = number_of(option, text, unit, example);
  if (!(x > 0) || x > 1e300)
    throw UsageError(option + ": the value is " + text + "; it must be greater than 0 and finite");
  return x;
}

double instant(const std::string& option, const std::string& text) {
  const double t = number_of(option, text, Unit::time, "0.5s");
  if (!(t >= 0) || t > 1e300)
    throw UsageError(option + ": the value is " + text + "; it must be 0 or greater, and finite");
  return t;
}

int whole_number(const std::string& option, const std::string& text, int most, const std::string& refusal) {
  const int n = number_in<int>(text).value_or(0);
  if (n < 1 || n > most)
    throw UsageError(option + ": \"" + text + "\" " +
                     (refusal.empty() ? "is not a whole number from 1 to " + std::to_string(most) : refusal));
  return n;
}

int jobs_of(const Arguments& args, int usual) {
  constexpr int kMost = 1024;
  return args.has("--jobs") ? whole_number("--jobs", args["--jobs"], kMost) : usual;
}

}  // namespace lockstep
