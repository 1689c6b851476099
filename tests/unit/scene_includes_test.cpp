// SPDX-License-Identifier: BSD-3-Clause
// What an included scene may hold: each key of a scene is taken, applied within the part, or left out; all are checked.
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/scene.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/reading.h"
#include "framework/description/scene/tables.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/run_scene.h"
#include "tests/support/scene_folder.h"

namespace scene_includes_test {

using namespace lockstep;
using lockstep::testing::builtin;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

struct Folder : lockstep::testing::SceneFolder {
  Folder() : SceneFolder("includes") {}
  std::string whole(const std::string& members) const {
    return write("whole.json", "{\"lockstep\": 1, " + members + "}");
  }
};

std::string refusal(const std::string& file) {
  set_logger(nullptr);
  const std::string words = message_of<Error>([&] { build_mechanism(read_scene(file), builtin()); });
  spdlog::drop("lockstep");
  return words;
}

/// The scene, and what is logged while it is read.
struct Read {
  Scene scene;
  std::string said;
};
Read read(const std::string& file) {
  builtin();  // which may speak of the plugins that it loads
  std::ostringstream words;
  auto own = std::make_shared<spdlog::logger>("host", std::make_shared<spdlog::sinks::ostream_sink_mt>(words));
  own->set_pattern("%l: %v");
  set_logger(own);
  Scene scene = read_scene(file);
  spdlog::drop("lockstep");
  return {std::move(scene), words.str()};
}

/// What an include does with a key of the included scene.
enum class Does {
  takes,       ///< puts its things before those of the whole
  applies,     ///< within the included scene: nothing of it is left
  leaves,      ///< as documented: texts, and what says how a scene runs that stands alone
  leaves_said  ///< and says so, where the whole gives none
};
struct Row {
  std::string key;
  Does does;
  std::string good, bad;  ///< a value, and one that the file is refused for
};
const std::vector<Row> kRows = {
    {"lockstep", Does::leaves, "1", "2"},
    {"$schema", Does::leaves, R"("schema.json")", "3"},
    {"title", Does::leaves, R"("a part")", "[1]"},
    {"description", Does::leaves, R"("more of it")", "4"},
    {"parameters", Does::applies, R"({"L": "2 m"})", R"({"L": true})"},
    {"points", Does::takes, R"({"P": ["=L", 0, 0]})", R"({"P": 3})"},
    {"tables", Does::applies, R"({"g": {"type": "ramp", "slope": 2}})", R"({"g": "=1 +"})"},
    {"require", Does::leaves_said, R"(["=L > 1 m"])", R"(["L > 1 m"])"},
    {"requires", Does::takes, R"(["drag"])", R"(["../drag.so"])"},
    {"gravity", Does::leaves_said, R"([0, "-1.62 m/s^2", 0])", "[0, 1]"},
    {"planar", Does::leaves_said, R"("z")", R"("w")"},
    {"merge", Does::leaves_said, R"("auto")", R"("maybe")"},
    {"include", Does::applies, R"([{"scene": "small.json", "prefix": "s_"}])", R"([{"scen": "small.json"}])"},
    {"repeat", Does::applies, R"([{"times": 2, "bodies": [{"name": "r{i}", "particle": 1}]}])",
     R"([{"times": 2, "boddies": []}])"},
    {"set", Does::applies, R"({"bodies.r1.particle": 5})", R"({"bodies.nobody.particle": 5})"},
    {"bodies", Does::takes, R"([{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": "P"}}])",
     R"([{"name": "b", "particel": 1}])"},
    {"markers", Does::takes, R"([{"name": "m", "body": "arm", "at": [0, 0, 0]}])",
     R"([{"name": "m", "body": "nobody"}])"},
    {"links", Does::takes, R"([{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0]}])",
     R"([{"name": "A", "type": "revolut", "p": "ground", "s": "ground"}])"},
    {"forces", Does::takes,
     R"([{"name": "F", "type": "applied_force", "p": "arm", "at": [0, 0, 0], "force": [0, 1, 0]}])",
     R"([{"name": "F", "type": "applied_forse"}])"},
    {"events", Does::takes, R"([{"name": "e", "at": 1, "stop": true}])", R"([{"name": "e", "att": 1}])"},
    {"run", Does::leaves, R"({"until": 7})", R"({"untill": 7})"}};

// A scene of these members; `but`: a key with another value, or one more.
std::string text_of(const std::string& but = {}, const std::string& value = {}) {
  std::string text;
  bool found = false;
  for (const Row& row : kRows) {
    text += (text.empty() ? "{\"" : ",\n \"") + row.key + "\": " + (row.key == but ? value : row.good);
    found = found || row.key == but;
  }
  return text + (found || but.empty() ? "" : ",\n \"" + but + "\": " + value) + "}";
}

}  // namespace

TEST_CASE("each key of an included scene is used, applied or left out as in the table", "[unit][scene]") {
  for (const Key& key : scene_table("scene").info.keys) {
    if (key.name == "joints") continue;  // another name of "links"
    INFO("the table of this test has no row for \"" << key.name << "\": say what an include does with it");
    CHECK(std::ranges::count_if(kRows, [&](const Row& row) { return row.key == key.name; }) == 1);
  }
  const Folder folder;
  folder.write("small.json", R"({"lockstep": 1, "bodies": [{"name": "ball", "particle": 3}]})");
  folder.write("part.json", text_of());
  const Read whole = read(folder.whole(R"("include": [{"scene": "part.json", "prefix": "my_"}])"));
  for (const Row& row : kRows) {
    CAPTURE(row.key, whole.said);
    const Value* there = whole.scene.root.find(row.key);
    CHECK((there != nullptr) == (row.does == Does::takes || row.key == "lockstep"));
    const bool said = whole.said.find("part.json") != std::string::npos &&
                      whole.said.find("scene, " + row.key + ": ") != std::string::npos;
    CHECK(said == (row.does == Does::leaves_said));
  }
  CHECK(*whole.scene.root.find("lockstep")->number() == 1);
  CHECK(whole.scene.plugins == std::vector<std::string>{"drag"});
  CHECK(whole.scene.title.empty());
  CHECK(whole.scene.run.until < 0);  // none is given
  const Mechanism m = build_mechanism(whole.scene, builtin());
  CHECK(m.system.gravity().isZero(0));
  CHECK((m.system.body("my_arm").home.x - Vec3(1, 0, 0)).norm() < 1e-15);  // the middle of 2 m
  CHECK(m.system.body("my_s_ball").mass.mass == 3);
  CHECK(m.system.body("my_r0").mass.mass == 1);
  CHECK(m.system.body("my_r1").mass.mass == 5);
  CHECK(m.system.marker("my_m").body == &m.system.body("my_arm"));
  CHECK(m.system.link("my_A").name() == "my_A");
  REQUIRE(m.system.forces().size() == 1);
  CHECK(m.system.forces().front()->name() == "my_F");
  REQUIRE(m.events.size() == 1);
  CHECK(m.events.front().event.name == "my_e");
}

TEST_CASE("an included scene is rejected for the same reason as alone", "[unit][scene]") {
  const Folder folder;
  folder.write("small.json", R"({"lockstep": 1, "bodies": [{"name": "ball", "particle": 3}]})");
  const auto check = [&](const std::string& text, const std::string& key) {
    const std::string alone = refusal(folder.write("part.json", text));
    CAPTURE(key, alone);
    CHECK(alone.find("part.json:") != std::string::npos);
    CHECK(refusal(folder.whole(R"("include": [{"scene": "part.json"}], "planar": "off")")) == alone);
  };
  for (const Row& row : kRows) check(text_of(row.key, row.bad), row.key);
  for (const char* slip :
       {"linkz", "forcez", "eventz", "markerz", "bodiez", "pointz", "gravityy", "runn", "password"}) {
    check(text_of(slip, "[]"), slip);
    check(text_of(slip, R"("=1+")"), slip);
  }
  check(R"({"bodies": [{"name": "b", "particle": 1}]})", "no \"lockstep\"");
  check(R"({"lockstep": 1, "bodiez": []})", "no formula, no point");
  check(R"({"lockstep": 1, "run": {"tolerance": -1}})", "run.tolerance");
  check(R"({"lockstep": 1, "parameters": {"g": "1 kg"}, "gravity": [0, "=g", 0]})", "a formula");

  folder.write("part.json", "{\"lockstep\": 1,\n \"linkz\": []}");
  folder.write("between.json", R"({"lockstep": 1, "include": [{"scene": "part.json"}]})");
  for (const char* file : {"part.json", "between.json"})
    check_words(refusal(folder.whole(R"("include": [{"scene": ")" + std::string(file) + R"("}])")),
                {"part.json:2:2: scene: unknown key \"linkz\"", "did you mean \"links\""});
}

// A block at rest in a guide falls at 10 m/s^2 onto a stop 0.2 m below it: it is there at 0.2 s. Let go of at 0.5 s, it falls
// on: 0.2 m + 5 0.5^2 at 1 s; the stop's gap is -0.45 m then at 0.8 s.
TEST_CASE("an event of an included scene has stops of its joints, alone and with a prefix", "[unit][scene]") {
  const Folder folder;
  folder.write("part.json", R"({"lockstep": 1, "gravity": [0, 0, -10],
    "bodies": [{"name": "block", "box": {"mass": 1, "size": [0.1, 0.1, 0.1]}}],
    "links": [{"name": "A", "type": "prismatic", "p": "block", "s": "ground", "at": [0, 0, 0],
               "stops": [{"axis": "z", "low": "-0.2 m"}]}],
    "events": [{"name": "let go", "at": 0.5, "deactivate": ["A.stop_z_low"]},
               {"name": "near", "when": {"channel": "A.stop_z_low.gap", "crosses": "0.1 m", "direction": "falling"},
                "activate": ["A.stop_z_low"]},
               {"name": "through", "when": {"channel": "A.stop_z_low.gap", "crosses": "-0.45 m"}, "stop": true}]})");
  for (const std::string prefix : {"", "my_"}) {
    CAPTURE(prefix);
    const std::string file =
        folder.whole(R"("gravity": [0, 0, -10], "include": [{"scene": "part.json", "prefix": ")" + prefix + R"("}],
                        "run": {"until": 2, "tolerance": 1e-10})");
    const Mechanism m = build_mechanism(read(file).scene, builtin());
    REQUIRE(m.events.size() == 3);
    CHECK(m.events[0].event.deactivate == std::vector<std::string>{prefix + "A.stop_z_low"});
    CHECK(m.events[1].event.activate == std::vector<std::string>{prefix + "A.stop_z_low"});
    const SceneRun run = run_scene(file);
    CHECK(run.report.stopped_by == prefix + "through");
    CHECK(run.table.last("t") == Approx(0.8).epsilon(1e-8));
  }
}

TEST_CASE("gravity of an included scene is reported if the whole gives none", "[unit][scene]") {
  const Folder folder;
  folder.write("part.json",
               "{\"lockstep\": 1,\n \"gravity\": [0, -9.81, 0], \"bodies\": [{\"name\": \"b\", \"particle\": 1}]}");
  folder.write("between.json",
               R"({"lockstep": 1, "include": [{"scene": "part.json", "prefix": "c_"}], "gravity": [0, 0, 0]})");
  const std::string twice =
      R"("include": [{"scene": "part.json", "prefix": "a_"}, {"scene": "part.json", "prefix": "b_"}])";
  const Read none = read(folder.whole(twice));
  check_words(none.said, {"part.json:2:13: scene, gravity: [0, -9.81, 0] m/s^2", "has no effect", "\"gravity\""});
  CHECK(std::ranges::count(none.said, '\n') == 1);
  CHECK(read(folder.whole(twice + R"(, "gravity": [0, 0, 0])")).said.empty());
  CHECK_FALSE(read(folder.whole(R"("include": [{"scene": "between.json"}])")).said.empty());
  CHECK(read(folder.whole(R"("include": [{"scene": "between.json"}], "gravity": [0, 0, 1])")).said.empty());
}

TEST_CASE("a rule is asked of each scene that is included before anything of it is looked for", "[unit][scene]") {
  const Folder folder;
  folder.write("part.json", R"({"lockstep": 1, "include": [{"scene": "/nowhere/at/all.json"}]})");
  const std::string file = folder.whole(R"("include": [{"scene": "part.json"}])");
  std::vector<std::string> asked;
  const IncludeRule rule = [&](const Value& named, const std::string& path) {
    asked.push_back(*named.text());
    if (path.starts_with("/nowhere")) throw FileError(named.where.text() + ": not " + path);
  };
  check_words(message_of<FileError>([&] { scene_from(read_json_file(file), file, rule); }),
              {"part.json:1:39: not /nowhere/at/all.json"});
  CHECK(asked == std::vector<std::string>{"part.json", "/nowhere/at/all.json"});
}

}  // namespace scene_includes_test
