// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/json.h"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <locale>
#include <random>

#include <lockstep/error.h>
#include "tests/support/messages.h"

namespace read_test {

using namespace lockstep;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

const std::string kScene = R"({
  "bodies": [
    {"name": "crank", "mass": 1.5, "inertia": [0.1, 0.2, 0.25], "at": ["12 mm", 0, -1e-3]},
    {"name": "Bär \u00e4\n\"x\"", "fixed": true, "start": null}
  ],
  "links": [{"name": "A", "type": "revolute", "drive": {"law": {"type": "ramp", "slope": 2}}}],
  "run": {"until": 10, "tolerance": 1e-8}
})";

std::string problem_of(const std::string& text) {
  return message_of<SceneError>([&] { read_json(text, "a.json"); });
}

std::string place(const Value& v) { return v.where.text(); }

bool same(const Value& a, const Value& b) {
  if (a.kind() != b.kind()) return false;
  if (a.number()) return *a.number() == *b.number();
  if (a.text()) return *a.text() == *b.text();
  if (a.list()) return std::equal(a.list()->begin(), a.list()->end(), b.list()->begin(), b.list()->end(), same);
  if (a.object())
    return std::equal(a.object()->begin(), a.object()->end(), b.object()->begin(), b.object()->end(),
                      [](const auto& x, const auto& y) { return x.key == y.key && same(x.value, y.value); });
  return true;
}

std::string nested(std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); }

// A file that goes away with the test.
struct TemporaryFile {
  explicit TemporaryFile(const std::string& content)
      : path((std::filesystem::temp_directory_path() /
              ("lockstep_read_test_" + std::to_string(std::random_device{}()) + ".json"))
                 .string()) {
    std::ofstream(path, std::ios::binary) << content;
  }
  ~TemporaryFile() { std::remove(path.c_str()); }
  std::string path;
};

}  // namespace

TEST_CASE("comments are read over, and places count them", "[unit][scene]") {
  const Value v = read_json(
      "// a \"scene\"\n{\"a\": /* , : } */ 1, // one\n /* two\n lines */ \"b\": [2, /**/ 3.5 //\n]} // end", "a.json");
  CHECK(*v.find("a")->number() == 1);
  CHECK(v.find("a")->where.text() == "a.json:2:19");
  CHECK(v.object()->at(1).where.text() == "a.json:4:11");
  CHECK(v.find("b")->list()->at(1).where.text() == "a.json:4:25");
  CHECK(*read_json("{\"a\": \"// no comment\"}", "a.json").find("a")->text() == "// no comment");
}

TEST_CASE("a scene is read with all its values", "[unit][scene]") {
  const Value scene = read_json(kScene, "a.json");
  const Value& crank = scene.find("bodies")->list()->at(0);
  CHECK(*crank.find("name")->text() == "crank");
  CHECK(*crank.find("mass")->number() == 1.5);
  CHECK(*crank.find("inertia")->list()->at(2).number() == 0.25);
  CHECK(*crank.find("at")->list()->at(2).number() == -1e-3);
  const Value& other = scene.find("bodies")->list()->at(1);
  CHECK(*other.find("name")->text() == "Bär ä\n\"x\"");
  CHECK(*other.find("fixed")->boolean());
  CHECK(other.find("start")->is_null());
}

TEST_CASE("every key and every value knows its place", "[unit][scene]") {
  const Value scene = read_json(kScene, "a.json");
  CHECK(place(scene) == "a.json:1:1");
  CHECK(scene.object()->at(0).where.text() == "a.json:2:3");
  CHECK(place(*scene.find("bodies")) == "a.json:2:13");
  const Value& crank = scene.find("bodies")->list()->at(0);
  CHECK(place(crank) == "a.json:3:5");
  CHECK(crank.object()->at(1).where.text() == "a.json:3:23");
  CHECK(place(*crank.find("mass")) == "a.json:3:31");
  CHECK(place(crank.find("at")->list()->at(2)) == "a.json:3:84");
  const Value& other = scene.find("bodies")->list()->at(1);
  CHECK(place(*other.find("name")) == "a.json:4:14");
  CHECK(place(*other.find("fixed")) == "a.json:4:44");  // columns count characters, not bytes
  CHECK(place(*other.find("start")) == "a.json:4:59");
  CHECK(place(*scene.find("run")->find("tolerance")) == "a.json:7:37");
}

TEST_CASE("places stay right behind a byte order mark and with the line ends of others", "[unit][scene]") {
  const Value v = read_json("\xEF\xBB\xBF{\r\n\t\"a\" :\r\n  7 }", "a.json");
  CHECK(v.object()->at(0).where.text() == "a.json:2:2");
  CHECK(place(*v.find("a")) == "a.json:3:3");
  CHECK(*v.find("a")->number() == 7);
}

TEST_CASE("a repeated key is rejected with both places", "[unit][scene]") {
  check_words(problem_of("{\"a\": 1,\n \"b\": {\"a\": 1},\n \"a\": 2}"),
              {"a.json:3:2: ", "key \"a\" is given twice", "first at a.json:1:2", "remove one"});
  CHECK(problem_of(R"([{"a": 1}, {"a": 2}])") == "no error");
}

TEST_CASE("depth is limited", "[unit][scene]") {
  CHECK(problem_of(nested(64)) == "no error");
  check_words(problem_of(nested(65)), {"a.json:1:65: ", "deeper than 64"});
  check_words(problem_of(std::string(2000000, '[')), {"deeper than 64"});
}

TEST_CASE("size is limited", "[unit][scene]") {
  check_words(problem_of("[" + std::string(kMostBytes, ' ') + "]"),
              {"a.json: ", "67108866 bytes", "limit is 67108864"});
}

TEST_CASE("broken text is rejected with its place in plain words", "[unit][scene]") {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"", {"a.json:1:1: ", "empty"}},
      {" \n ", {"a.json:2:2: ", "empty"}},
      {"{\"a\": NaN}", {"a.json:1:7: ", "NaN", "finite number"}},
      {"{\"a\": -Infinity}", {"a.json:1:7: ", "infinity"}},
      {"[nan]", {"a.json:1:2: ", "NaN"}},
      {"[1, 1e999]", {"a.json:1:5: ", "1e999", "1e308"}},
      {"[-1e400]", {"-1e400", "range"}},
      {"{\"a\": 1,}", {"a.json:1:9: ", "there is a comma before the closing }"}},
      {"[1,\n2,\n]", {"a.json:3:1: ", "there is a comma before the closing ]"}},
      {"[1 2]", {"a.json:1:4: ", "comma is missing"}},
      {"{\"a\": 1\n \"b\": 2}", {"a.json:2:2: ", "comma is missing"}},
      {"{\"a\" 1}", {"a.json:1:6: ", "colon is missing"}},
      {"{a: 1}", {"a.json:1:2: "}},
      {"{1: 2}", {"a.json:1:2: ", "key in double quotes"}},
      {"{\"a\": 0,6}", {"a.json:1:9: ", "write 0.6 for 0,6"}},
      {"{'a': 1}", {"a.json:1:2: ", "double quotes"}},
      {"# words\n{}", {"a.json:1:1: ", "write \"// ...\""}},
      {"{} # words", {"a.json:1:4: ", "write \"// ...\""}},
      {"{} /* words", {"a.json:1:4: "}},
      {"{\"a\": 1 /* , */ \"b\": 2}", {"a.json:1:17: ", "a comma is missing"}},
      {"{} / {}", {"a.json:1:4: "}},
      {"{\"a\": [1, 2", {"a.json:1:12: ", "ends inside the list", "a.json:1:7", "] is missing"}},
      {"{\"a\": 1", {"ends inside the object", "a.json:1:1", "} is missing"}},
      {"{} {}", {"a.json:1:4: ", "after the end"}},
      {"[\"abc", {"a.json:1:2: ", "missing closing quote"}},
      {"[\"a\tb\"]", {"a.json:1:2: ", "control character"}},
      {"[\"\\q\"]", {"a.json:1:2: ", "backslash"}},
      {"[\"\xff\"]", {"a.json:1:2: ", "UTF-8"}},
      {"[.5]", {"a.json:1:2: ", "0.5 for .5"}},
      {"[+5]", {"a.json:1:2: ", "plus sign"}},
      {"[1.]", {"a.json:1:2: ", "digit"}},
      {"[tru]", {"a.json:1:2: "}}};
  for (const auto& [text, parts] : cases) {
    INFO("text: " << text);
    const std::string problem = problem_of(text);
    for (const std::string& part : parts) check_words(problem, {part});
  }
}

TEST_CASE("an error carries file, line and column", "[unit][scene]") {
  try {
    read_json("[1,\n 2 3]", "b.json");
    FAIL("no error");
  } catch (const SceneError& error) {
    CHECK(error.file == "b.json");
    CHECK(error.line == 2);
    CHECK(error.column == 4);
  }
}

TEST_CASE("numbers are read to the last bit", "[unit][scene]") {
  const Value v = read_json("[0.1, -0, 1e-310, 12345678901234567890, 1e-400, 0.30000000000000004]", "a.json");
  const auto x = [&](std::size_t i) { return *v.list()->at(i).number(); };
  CHECK(x(0) == 0.1);
  CHECK(std::signbit(x(1)));
  CHECK(x(2) == 1e-310);
  CHECK(x(3) == 12345678901234567890.0);
  CHECK(x(4) == 0);
  CHECK(x(5) == 0.1 + 0.2);
}

TEST_CASE("broken scenes never crash", "[unit][scene]") {
  std::mt19937 random(7);
  const std::string bytes = "{}[]\",:0123456789eE+-.\\ \n\tntfu/\x01\xff\xc3";
  int good = 0, bad = 0;
  for (int k = 0; k < 400; ++k) {
    std::string text = kScene;
    for (std::size_t n = 1 + random() % 3; n > 0; --n) {
      const std::size_t at = random() % text.size();
      const std::size_t what = random() % 4;
      if (what == 0) text[at] = bytes[random() % bytes.size()];
      if (what == 1) text.erase(at, 1 + random() % 5);
      if (what == 2) text.insert(at, 1, bytes[random() % bytes.size()]);
      if (what == 3) text.resize(at + 1);
    }
    try {
      read_json(text, "a.json");
      ++good;
    } catch (const SceneError& error) {
      ++bad;
      INFO(text << "\n" << error.what());
      CHECK(error.line >= 1);
      CHECK(error.column >= 1);
      CHECK(error.line <= 1 + std::count(text.begin(), text.end(), '\n'));
    }
  }
  CHECK(good > 0);
  CHECK(bad > 100);
}

TEST_CASE("written values read back the same", "[unit][scene]") {
  const Value scene = read_json(kScene, "a.json");
  const std::string text = write_json(scene);
  CHECK(same(read_json(text, "b.json"), scene));
  CHECK(write_json(read_json(text, "b.json")) == text);
  CHECK(text.ends_with("}\n"));
  CHECK(text.find("\"inertia\": [0.1, 0.2, 0.25]") != std::string::npos);
}

TEST_CASE("every double survives writing and reading", "[unit][scene]") {
  std::mt19937_64 random(11);
  Value::List numbers;
  while (numbers.size() < 500) {
    const std::uint64_t bits = random();
    double x;
    static_assert(sizeof x == sizeof bits);
    std::memcpy(&x, &bits, sizeof x);
    if (std::isfinite(x)) numbers.emplace_back(x);
  }
  const Value v(std::move(numbers));
  CHECK(same(read_json(write_json(v), "a.json"), v));
}

TEST_CASE("written texts are escaped, empty things stay", "[unit][scene]") {
  const Value v = Value::object({{"a\"\\\n\t\x01", Value::object({})}, {"b", Value(Value::List{})}, {"c", Value()}});
  const std::string text = write_json(v);
  CHECK(text == "{\n  \"a\\\"\\\\\\n\\t\\u0001\": {},\n  \"b\": [],\n  \"c\": null\n}\n");
  CHECK(same(read_json(text, "a.json"), v));
}

TEST_CASE("values that JSON cannot hold are not written", "[unit][scene]") {
  const std::string problem = message_of<SceneError>([] { write_json(Value::list({1, std::nan("")})); });
  check_words(problem, {"nan", "finite"});
  check_words(message_of<SceneError>([] { write_json(Value::object({{"a", INFINITY}})); }), {"inf"});
}

TEST_CASE("no locale changes what is read or written", "[unit][scene]") {
  // Thousands apart by points and a decimal comma, for streams and (where the system has one) for C.
  struct Comma final : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  std::string c_before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"})
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  const Value v = read_json("{\"big\": 1234567.5,\n \"small\": 0.25}", "a.json");
  const std::string text = write_json(v);
  std::string lines(1234, '\n');
  const std::string problem = problem_of(lines.append(1, 'x'));
  std::setlocale(LC_ALL, c_before.c_str());
  std::locale::global(before);
  CHECK(*v.find("big")->number() == 1234567.5);
  CHECK(*v.find("small")->number() == 0.25);
  CHECK(text == "{\n  \"big\": 1234567.5,\n  \"small\": 0.25\n}\n");
  check_words(problem, {"a.json:1235:1: "});
}

TEST_CASE("a file is read under its name", "[unit][scene]") {
  const TemporaryFile good("{\"a\": 1}"), bad("{\"a\": }");
  CHECK(*read_json_file(good.path).find("a")->number() == 1);
  check_words(message_of<SceneError>([&] { read_json_file(bad.path); }), {bad.path + ":1:7: "});
}

TEST_CASE("a file that cannot be read is rejected by name", "[unit][scene]") {
  check_words(message_of<FileError>([] { read_json_file("no/such/scene.json"); }),
              {"no/such/scene.json", "No such file", "check the path"});
  check_words(message_of<FileError>([] { read_json_file("."); }), {"'.'", "folder"});
}

}  // namespace read_test
