// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include <lockstep/author/jet.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/function.h"
#include "framework/mechanism/expression/quantity.h"
#include "tests/fuzz/answered.h"
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

void formula(Bytes bytes) {
  using namespace lockstep::expression;
  const std::string text = text_of(bytes);
  answered([&] {
    Amount length = Amount::number(0.5), point = Amount::number(1);
    length.dimension.m = 1, length.measured = true;
    point.is_vector = true, point.v[1] = 2;
    const Expression expression(text);
    const Amount amount = evaluate(expression, [&](const std::string& name) -> const Amount* {
      return name == "L" ? &length : name == "A" ? &point : nullptr;
    });
    for (int k = 0; k < (amount.is_vector ? 3 : 1); ++k) must_be_finite(amount.v[k], "the value of a formula");
    words_of(amount), article_name_of(amount);
  });
  answered([&] {
    const FormulaFunction function(text, {"t", "q", "x"}, {{"k", {2}}, {"P", {1, 2, 3}}});
    for (const double t : {0.0, -1.5, 1e-300, 3.0}) {
      // NaN and infinity are its users' to refuse.
      const Jet<4> jets[] = {Jet<4>(t), Jet<4>(0.5), Jet<4>(-2.0)};
      function(std::span<const Jet<4>>(jets));
      const Time times[] = {Time(t), Time(0.5), Time(-2.0)};
      function(std::span<const Time>(times));
    }
    std::vector<double> instants;
    function.breakpoints(0, 0, 1, instants);
    for (const double t : instants)
      if (!(t > 0 && t < 1)) throw Broken{"an instant outside of the interval that was asked for"};
  });
}

}  // namespace lockstep::fuzz
