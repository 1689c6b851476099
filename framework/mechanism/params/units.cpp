// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/params/units.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <lockstep/text.h>
#include "framework/mechanism/params/read.h"

namespace lockstep {
namespace {

struct UnitWords {
  Unit unit;
  const char *name, *article, *si, *example;
  Dimension dimension;
};

constexpr std::array<UnitWords, 19> kWords{{
    {Unit::none, "number", "a", "", "", {0, 0, 0, 0}},
    {Unit::length, "length", "a", "m", "12 mm", {1, 0, 0, 0}},
    {Unit::angle, "angle", "an", "rad", "30 deg", {0, 0, 0, 1}},
    {Unit::time, "time", "a", "s", "5 ms", {0, 0, 1, 0}},
    {Unit::mass, "mass", "a", "kg", "250 g", {0, 1, 0, 0}},
    {Unit::speed, "speed", "a", "m/s", "20 mm/s", {1, 0, -1, 0}},
    {Unit::angular_speed, "angular speed", "an", "rad/s", "1200 rpm", {0, 0, -1, 1}},
    {Unit::acceleration, "acceleration", "an", "m/s^2", "9.81 m/s^2", {1, 0, -2, 0}},
    {Unit::angular_acceleration, "angular acceleration", "an", "rad/s^2", "90 deg/s^2", {0, 0, -2, 1}},
    {Unit::force, "force", "a", "N", "2 kN", {1, 1, -2, 0}},
    {Unit::torque, "torque", "a", "N m", "50 N mm", {2, 1, -2, 0}},
    {Unit::inertia, "moment of inertia", "a", "kg m^2", "40 kg mm^2", {2, 1, 0, 0}},
    {Unit::density, "density", "a", "kg/m^3", "7.85 g/cm^3", {-3, 1, 0, 0}},
    {Unit::stiffness, "stiffness", "a", "N/m", "4.5 N/mm", {0, 1, -2, 0}},
    {Unit::torsion_stiffness, "torsional stiffness", "a", "N m/rad", "3 N m/deg", {2, 1, -2, -1}},
    {Unit::damping, "damping coefficient", "a", "N s/m", "2 N s/mm", {0, 1, -1, 0}},
    {Unit::torsion_damping, "torsional damping coefficient", "a", "N m s/rad", "1 N m s/deg", {2, 1, -1, -1}},
    {Unit::frequency, "frequency", "a", "Hz", "50 Hz", {0, 0, -1, 0}},
    {Unit::any, "quantity", "a", "", "12 mm", {}},
}};

const UnitWords& words_of(Unit unit) {
  for (const UnitWords& w : kWords)
    if (w.unit == unit) return w;
  return kWords.back();
}

// SI value = x * up / down * 10^ten; powers of ten are separate, so that "12 mm" is the double nearest to 0.012.
struct UnitFactor {
  double up = 1, down = 1;
  int ten = 0;
  Dimension dimension;
};

struct Symbol {
  std::string_view name;
  bool prefixes;
  UnitFactor factor;
};

constexpr double kTurn = kTwoPi;
constexpr std::array<Symbol, 31> kSymbols{{
    {"m", true, {1, 1, 0, {1, 0, 0, 0}}},
    {"g", true, {1, 1, -3, {0, 1, 0, 0}}},
    {"s", true, {1, 1, 0, {0, 0, 1, 0}}},
    {"N", true, {1, 1, 0, {1, 1, -2, 0}}},
    {"Nm", true, {1, 1, 0, {2, 1, -2, 0}}},
    {"J", true, {1, 1, 0, {2, 1, -2, 0}}},
    {"W", true, {1, 1, 0, {2, 1, -3, 0}}},
    {"Hz", true, {1, 1, 0, {0, 0, -1, 0}}},
    {"rad", true, {1, 1, 0, {0, 0, 0, 1}}},
    {"deg", false, {kPi, 180, 0, {0, 0, 0, 1}}},
    {"\u00b0", false, {kPi, 180, 0, {0, 0, 0, 1}}},
    {"rev", false, {kTurn, 1, 0, {0, 0, 0, 1}}},
    {"turn", false, {kTurn, 1, 0, {0, 0, 0, 1}}},
    {"rpm", false, {kTurn, 60, 0, {0, 0, -1, 1}}},
    {"min", false, {60, 1, 0, {0, 0, 1, 0}}},
    {"h", false, {3600, 1, 0, {0, 0, 1, 0}}},
    {"t", false, {1, 1, 3, {0, 1, 0, 0}}},
    {"in", false, {254, 1, -4, {1, 0, 0, 0}}},
    {"ft", false, {3048, 1, -4, {1, 0, 0, 0}}},
    {"inch", false, {254, 1, -4, {1, 0, 0, 0}}},
    {"sec", false, {1, 1, 0, {0, 0, 1, 0}}},
    {"degree", false, {kPi, 180, 0, {0, 0, 0, 1}}},
    {"Nmm", false, {1, 1, -3, {2, 1, -2, 0}}},
    {"degrees", false, {kPi, 180, 0, {0, 0, 0, 1}}},
    {"kgm2", false, {1, 1, 0, {2, 1, 0, 0}}},
    {"Pa", true, {1, 1, 0, {-1, 1, -2, 0}}},
    {"bar", true, {1, 1, 5, {-1, 1, -2, 0}}},
    {"l", true, {1, 1, -3, {3, 0, 0, 0}}},
    {"kgf", false, {980665, 1, -5, {1, 1, -2, 0}}},
    {"hp", false, {745.69987158227022, 1, 0, {2, 1, -3, 0}}},
    {"psi", false, {44482216152605, 64516, -5, {-1, 1, -2, 0}}},
}};

constexpr std::string_view kPrefixes = "numcdhkMG", kMicro[] = {"\u00b5", "\u03bc"};
constexpr std::array kTens{-9, -6, -3, -2, -1, 2, 3, 6, 9};

std::optional<UnitFactor> symbol(std::string_view name) {
  for (const Symbol& s : kSymbols)
    if (s.name == name) return s.factor;
  if (name == "1") return UnitFactor{};  // "1/s"
  for (const std::string_view micro : kMicro)
    if (name.starts_with(micro)) return symbol("u" + std::string(name.substr(micro.size())));
  const std::size_t prefix = name.empty() ? std::string::npos : kPrefixes.find(name.front());
  for (const Symbol& s : kSymbols) {
    if (prefix == std::string::npos || !s.prefixes || s.name != name.substr(1)) continue;
    UnitFactor f = s.factor;
    f.ten += kTens[prefix];
    return f;
  }
  return {};
}

void multiply(UnitFactor& a, const UnitFactor& b, int power) {
  for (int i = 0; i < std::abs(power); ++i) (power > 0 ? a.up : a.down) *= b.up, (power > 0 ? a.down : a.up) *= b.down;
  a.ten += power * b.ten;
  a.dimension.m += power * b.dimension.m, a.dimension.kg += power * b.dimension.kg;
  a.dimension.s += power * b.dimension.s, a.dimension.rad += power * b.dimension.rad;
}

// The power after a symbol ("^3", "\u00b2"), removed from its end; 1 when there is none, 0 when it cannot be read.
int take_power(std::string_view& name) {
  for (const auto& [mark, power] : {std::pair{std::string_view("\u00b2"), 2}, {std::string_view("\u00b3"), 3}})
    if (name.ends_with(mark)) return name.remove_suffix(mark.size()), power;
  const std::size_t hat = name.find('^');
  if (hat == std::string_view::npos) return 1;
  const int power = number_in<int>(name.substr(hat + 1)).value_or(0);
  if (std::abs(power) > 6) return 0;
  name = name.substr(0, hat);
  return power;
}

// What is meant by a unit that is none: "s^2" by "s2".
std::string unit_meant(const std::string& unit) {
  std::vector<std::string> names = {"mm", "kg", "ms", "kN", "kg*m^2"};
  for (const Symbol& s : kSymbols) names.emplace_back(s.name);
  const std::string base = unit.substr(0, unit.size() - 1), power = unit.substr(base.size());
  const bool is_power = (power == "2" || power == "3") && base != "1" && symbol(base);
  const std::string near = is_power ? base + "^" + power : text::closest_name(unit, names);
  return near.empty() ? "; see lockstep describe unit" : "; did you mean \"" + near + "\"?";
}

// Reads a whole unit; on failure `problem` is the reason.
UnitFactor unit_factor(std::string_view unit, std::string& problem) {
  UnitFactor total;
  bool divide = false, divided = false;
  while (!unit.empty()) {
    const std::size_t end = std::min(unit.find_first_of(" \t*/"), unit.size());
    std::string_view name = unit.substr(0, end);
    const std::string written(name);
    const int power = take_power(name);
    const std::optional<UnitFactor> factor = name == "1" && divided ? std::nullopt : symbol(name);
    if (!factor || power == 0) {
      problem = written.empty() ? "a symbol is missing in the unit; a formula begins with \"=\""
                                : "unknown unit \"" + written + "\"" + unit_meant(written);
      return total;
    }
    if (divided && !divide) {
      problem = "a product after a division is ambiguous; write the divisors last, as in \"N m s/rad\"";
      return total;
    }
    multiply(total, *factor, divide ? -power : power);
    unit = text::trimmed(unit.substr(end));
    divide = !unit.empty() && unit.front() == '/';
    divided = divided || divide;
    if (!unit.empty() && (unit.front() == '/' || unit.front() == '*')) {
      unit = text::trimmed(unit.substr(1));
      if (unit.empty()) problem = "the unit ends with \"*\" or \"/\"";
    }
  }
  return total;
}

double power_of_ten(int n) {
  double p = 1;
  for (int i = 0; i < n; ++i) p *= 10;  // exact to 10^22
  return p;
}

double to_si(double x, const UnitFactor& f) {
  const double y = x * f.up / f.down;
  return f.ten >= 0 ? y * power_of_ten(f.ten) : y / power_of_ten(-f.ten);
}

// A dimension per second to a power has no example, since there may be no name for it: "a force per second".
std::string wanted(const UnitWords& w, int per_second) {
  const std::string name = std::string(w.article) + " " + w.name, in = std::string(" is expected (a number in ") + w.si;
  const std::string power = per_second == 1 ? "" : "^" + std::to_string(per_second);
  return per_second > 0 ? name + " per second" + power + in + "/s" + power + ")"
                        : name + in + ", or a text such as \"" + w.example + "\")";
}

// A number and the unit behind it.
struct Split {
  double x = 0;
  std::errc error{};
  std::string_view unit;
};

Split split(std::string_view text) {
  const std::string_view trimmed = text::trimmed(text);
  Split s;
  const auto [end, error] = std::from_chars(trimmed.data(), trimmed.data() + trimmed.size(), s.x);
  s.error = error, s.unit = text::trimmed(trimmed.substr(static_cast<std::size_t>(end - trimmed.data())));
  return s;
}

// Whether it is a number with the unit "1".
bool is_pure(std::string_view text) {
  const Split s = split(text);
  return s.error == std::errc() && s.unit == "1";
}

}  // namespace

std::vector<Unit> units() {
  std::vector<Unit> all;
  for (const UnitWords& w : kWords)
    if (w.unit != Unit::none && w.unit != Unit::any) all.push_back(w.unit);
  return all;
}
std::string name_of(Unit unit) { return words_of(unit).name; }
std::string article_name_of(Unit unit) { return std::string(words_of(unit).article) + " " + words_of(unit).name; }
std::string si_unit(Unit unit) { return words_of(unit).si; }
std::string misfit(const std::string& text, std::string_view symbol) {
  const std::string quoted = "\"" + text + "\"";
  std::string problem, unknown;
  const UnitFactor given = unit_factor(split(text).unit, problem), wanted = unit_factor(symbol, unknown);
  if (!problem.empty()) return quoted + ": " + problem;
  if (symbol.empty()) return quoted + " has a unit; here a number without one is expected";
  if (!unknown.empty() || wanted.dimension == given.dimension) return {};
  return quoted + " is of another dimension; here a number in " + std::string(symbol) + " is expected";
}
std::string example_of(Unit unit) { return words_of(unit).example; }

Measured read_quantity(std::string_view text, Unit unit, int per_second) {
  const UnitWords& words = words_of(unit);
  Dimension dimension = words.dimension;
  dimension.s -= per_second;
  if (per_second == 1 && unit == Unit::length) return read_quantity(text, Unit::speed);
  if (per_second == 2 && unit == Unit::length) return read_quantity(text, Unit::acceleration);
  if (per_second == 1 && unit == Unit::angle) return read_quantity(text, Unit::angular_speed);
  if (per_second == 2 && unit == Unit::angle) return read_quantity(text, Unit::angular_acceleration);
  const std::string quoted = "\"" + std::string(text.substr(0, 60)) + "\"";
  if (unit == Unit::none && !is_pure(text))
    return {0, "expected a number without a unit, got a text (" + quoted + "); write the number without quotes"};

  const auto [x, error, rest] = split(text);
  if (error == std::errc::result_out_of_range) return {0, quoted + " is beyond the range of numbers (1e-308 to 1e308)"};
  if (error != std::errc())
    return {0, "expected " + article_name_of(unit) + ", got a text (" + quoted +
                   ") that does not begin with a number; write it as \"" + words.example + "\""};
  if (!std::isfinite(x)) return {0, quoted + " is not a finite number; write a finite one"};
  if (rest.empty())
    return {0,
            quoted + " has no unit; write the number without quotes, or with a unit as in \"" + words.example + "\""};
  if (rest.front() == ',') return {0, quoted + " has a comma in its number; the decimal separator is a point"};

  Measured result;
  UnitFactor factor = unit_factor(rest, result.problem);
  if (!result.problem.empty()) return {0, quoted + ": " + result.problem};
  if (unit != Unit::any && !(factor.dimension == dimension)) {
    std::string given = article_name_of(factor.dimension);
    if (rest.find('J') != std::string_view::npos && given == article_name_of(Unit::torque)) given = "an energy";
    const int turns = dimension.rad - std::exchange(factor.dimension.rad, dimension.rad);
    const std::string hint = factor.dimension == dimension && std::abs(turns) == 1
                                 ? std::string("; only the radian differs: ") + (turns > 0 ? "multiply" : "divide") +
                                       " by 1 rad in a formula"
                                 : "";
    return {0, quoted + " is " + given + "; here " + wanted(words, per_second) + hint};
  }
  result.value = to_si(x, factor);
  if (!std::isfinite(result.value)) return {0, quoted + " is beyond the range of numbers (1e308)"};
  return result;
}

Measured in_si(double x, std::string_view unit) {
  Measured result;
  result.value = to_si(x, unit_factor(unit, result.problem));
  if (result.problem.empty() && !std::isfinite(result.value))
    result.problem = text::number(x) + " " + std::string(unit) + " is beyond the range of numbers (1e308)";
  return result;
}

std::optional<Dimension> dimension_of(std::string_view unit) {
  std::string problem;
  const UnitFactor factor = unit_factor(unit, problem);
  return unit.empty() || !problem.empty() ? std::nullopt : std::optional(factor.dimension);
}

Dimension dimension_of(Unit unit) { return words_of(unit).dimension; }
Dimension dimension_of_text(std::string_view text) { return dimension_of(split(text).unit).value_or(Dimension{}); }

std::string article_name_of(const Dimension& d) {
  if (d == Dimension{}) return "a pure number";
  for (const UnitWords& w : kWords)
    if (w.unit != Unit::any && w.dimension == d) return article_name_of(w.unit);
  return "a quantity in " + si_unit(d);
}

std::string si_unit(const Dimension& d) {
  if (d == Dimension{}) return "1";
  for (const UnitWords& w : kWords)
    if (w.unit != Unit::any && w.dimension == d) return w.si;
  for (const auto& [name, of] :
       {std::pair{"W", Dimension{2, 1, -3, 0}}, {"Pa", {-1, 1, -2, 0}}, {"N s", {1, 1, -1, 0}}})
    if (of == d) return name;
  std::string product, divisors;
  for (const auto& [name, power] : {std::pair{"kg", d.kg}, {"m", d.m}, {"s", d.s}, {"rad", d.rad}}) {
    if (power == 0) continue;
    std::string& side = power > 0 ? product : divisors;
    if (power < 0 || !product.empty()) side += power < 0 ? '/' : ' ';
    side += name;
    if (std::abs(power) > 1) side.append("^").append(std::to_string(std::abs(power)));
  }
  return (product.empty() ? "1" : product) + divisors;
}

}  // namespace lockstep
