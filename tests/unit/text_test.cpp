// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/text.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "framework/foundation/support/lines.h"
#include "tests/support/catch.h"

namespace text_test {

using namespace lockstep;

namespace {
const std::vector<std::string> kNames{"revolute", "prismatic", "spherical", "fixed"};
}

TEST_CASE("the closest name is found for upper and lower case", "[unit][support]") {
  CHECK(text::closest_name("revolut", kNames) == "revolute");
  CHECK(text::closest_name("Prismatc", kNames) == "prismatic");
  CHECK(text::closest_name("sphercial", kNames) == "spherical");
  CHECK(text::closest_name("fxed", kNames) == "fixed");
  CHECK(text::closest_name("fxied", kNames) == "fixed");  // two letters exchanged are one slip
}

TEST_CASE("a name that is far from all gets no guess", "[unit][support]") {
  CHECK(text::closest_name("gear", kNames).empty());
  CHECK(text::closest_name("", kNames).empty());
  CHECK(text::closest_name("fixed", {}).empty());
  const std::vector<std::string> others{"p", "turning"};
  CHECK(text::closest_name("6", others).empty());        // a single letter
  CHECK(text::closest_name("warning", others).empty());  // two letters off, and another first one
  CHECK(text::closest_name("P", others) == "p");
}

TEST_CASE("a suggestion is a guess, or the names there are", "[unit][support]") {
  CHECK(text::suggestion("fixd", kNames) == "; did you mean \"fixed\"?");
  CHECK(text::suggestion("gear", kNames) == "; known: revolute, prismatic, spherical, fixed");
  CHECK(text::suggestion("gear", {}).empty());
  CHECK(text::suggestion("fixed", kNames) == "; known: revolute, prismatic, spherical, fixed");  // not the word itself
  const std::vector<std::string> many(20, "abcdefgh");
  CHECK(text::suggestion("zzz", many).ends_with("abcdefgh, ..."));
}

TEST_CASE("words are joined as in a sentence", "[unit][support]") {
  const std::vector<std::string> words{"a", "b", "c"};
  CHECK(text::join(words) == "a, b and c");
  CHECK(text::join(words, " or ") == "a, b or c");
  CHECK(text::join(std::span(words).first(1)) == "a");
  CHECK(text::join({}).empty());
}

TEST_CASE("a text has a line for each of its ends, and one for what follows the last", "[unit][support]") {
  const std::vector<std::string> lines{"a", "", "b"};
  CHECK(lines_of("a\n\nb") == lines);
  CHECK(lines_of("a\n\nb\n") == lines);
  CHECK(lines_of("a::b", ':') == lines);
  CHECK(lines_of("").empty());
  CHECK(lines_of("\n") == std::vector<std::string>{""});
}

TEST_CASE("numbers read back as the same double", "[unit][support]") {
  CHECK(text::number(0.1) == "0.1");
  CHECK(text::number(-1500) == "-1500");
  for (const double x : {1.0 / 3, std::nextafter(0.1, 1), 1e-300, 5e-324, std::numeric_limits<double>::max()}) {
    const std::string text = text::number(x);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    CHECK(back == x);
  }
  CHECK(text::brief(1.0 / 3) == "0.333");
  CHECK(text::brief(123456) == "1.23e+05");
}

}  // namespace text_test
