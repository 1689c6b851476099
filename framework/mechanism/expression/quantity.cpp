// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/quantity.h"

#include <cmath>

#include <lockstep/text.h>

namespace lockstep::expression {

Exponents settled(Exponents e) {
  if (e.m != 0 && e.rad > 0) e.rad = 0;
  return e;
}

std::optional<Dimension> whole(const Exponents& e) {
  const auto fits = [](double p) { return p == std::round(p) && std::abs(p) <= 6; };
  if (!fits(e.m) || !fits(e.kg) || !fits(e.s) || !fits(e.rad)) return std::nullopt;
  return Dimension{int(e.m), int(e.kg), int(e.s), int(e.rad)};
}

std::string unit_of(const Amount& q) {
  const Dimension d = whole(settled(q.dimension)).value_or(Dimension{});
  return d == Dimension{} ? "" : si_unit(d);
}

Value value_of(const Amount& q) {
  const std::string unit = si_unit(whole(q.dimension).value_or(Dimension{}));
  const auto one = [&](double x) { return q.measured ? Value(text::number(x) + " " + unit) : Value(x); };
  if (!q.is_vector) return one(q.v[0]);
  return Value(Value::List{one(q.v[0]), one(q.v[1]), one(q.v[2])});
}

std::string words_of(const Amount& q) {
  const std::optional<Dimension> d = whole(settled(q.dimension));
  const std::string unit = d && *d != Dimension{} ? " " + si_unit(*d) : "";
  if (!q.is_vector) return text::brief(q.v[0]) + unit;
  return "[" + text::brief(q.v[0]) + ", " + text::brief(q.v[1]) + ", " + text::brief(q.v[2]) + "]" + unit;
}

std::string article_name_of(const Amount& q) {
  const std::optional<Dimension> d = whole(settled(q.dimension));
  const std::string one = d ? lockstep::article_name_of(*d) : "a quantity of fractional dimension";
  return q.is_vector ? "a vector (" + one + ")" : one;
}

}  // namespace lockstep::expression
