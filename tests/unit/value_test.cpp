// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/params.h>

#include "tests/support/catch.h"

namespace value_test {

using namespace lockstep;

TEST_CASE("a value reports its kind", "[unit][model]") {
  CHECK(Value().kind() == "null");
  CHECK(Value(true).kind() == "true");
  CHECK(Value(false).kind() == "false");
  CHECK(Value(3).kind() == "a number");
  CHECK(Value("a").kind() == "a text");
  CHECK(Value::list({1, 2, 3}).kind() == "a list of 3");
  CHECK(Value(Value::List{}).kind() == "an empty list");
  CHECK(Value::object({}).kind() == "an object");
}

TEST_CASE("a value hands out what it holds and nothing else", "[unit][model]") {
  const Value x(2.5), s("text"), l = Value::list({1, 2}), b(true);
  CHECK(*x.number() == 2.5);
  CHECK(x.text() == nullptr);
  CHECK(x.find("a") == nullptr);
  CHECK(*s.text() == "text");
  CHECK(s.number() == nullptr);
  CHECK(*l.list()->at(1).number() == 2);
  CHECK(l.object() == nullptr);
  CHECK(*b.boolean());
  CHECK(Value().is_null());
  CHECK_FALSE(x.is_null());
}

TEST_CASE("an object finds its members in their order", "[unit][model]") {
  const Value v = Value::object({{"b", 1}, {"a", "two"}});
  CHECK(*v.find("b")->number() == 1);
  CHECK(*v.find("a")->text() == "two");
  CHECK(v.find("c") == nullptr);
  CHECK(v.object()->front().key == "b");
}

TEST_CASE("members can be left out", "[unit][model]") {
  Value v = Value::object({{"type", "ramp"}, {"slope", 1}, {"start", 0}});
  v.where = {std::make_shared<const std::string>("a.json"), 3, 4};
  const Value rest = v.without({"type", "start", "absent"});
  REQUIRE(rest.object()->size() == 1);
  CHECK(rest.find("slope") != nullptr);
  CHECK(rest.where.text() == "a.json:3:4");
  CHECK(Value(3).without({"type"}).number() != nullptr);
}

TEST_CASE("a place is written as file, line and column", "[unit][model]") {
  CHECK(SourceLocation{std::make_shared<const std::string>("four_bar.json"), 4, 64}.text() == "four_bar.json:4:64");
  CHECK(SourceLocation{}.text().empty());
}

}  // namespace value_test
