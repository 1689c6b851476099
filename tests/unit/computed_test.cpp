// SPDX-License-Identifier: BSD-3-Clause
// Columns by formulas of channels: against closed forms, and against channels that say the same.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <lockstep/author/registry.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/sweep.h>
#include "framework/tools/record/piece.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace computed_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

// A pendulum, and a crank that is driven at 4 rad/s.
const char* const kScene = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
  "parameters": {"r": "0.2 m", "plain": 3, "w": "4 rad/s"}, "points": {"Q": [1, 2, 2]},
  "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
             {"name": "crank", "rod": {"mass": 2, "from": [3, 0, 0], "to": [3.2, 0, 0]}}],
  "joints": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]},
             {"name": "big end", "type": "revolute", "p": "crank", "s": "ground", "at": [3, 0, 0],
              "drive": {"axis": "rz", "law": {"type": "formula", "y": "=4*t"}}}],
  "run": {"integrator": "dopri5", "tolerance": 1e-10, "until": 2, "output": 0.25, "record": [)";

Table run_with(const std::string& record) {
  Simulation run(build_mechanism(scene_from_text(kScene + record + "]}}", "columns.json"), builtin_registry()));
  run.run();
  return run.table();
}

void agree(const Table& table, const std::string& a, const std::string& b, double margin) {
  for (std::size_t i = 0; i < table.n_rows(); ++i) {
    INFO(a << " and " << b << ", row " << i);
    CHECK(table[a][i] == Approx(table[b][i]).margin(margin));
  }
}

std::string refusal(const std::string& record) {
  return message_of<SceneError>([&] { run_with(record); });
}

}  // namespace

TEST_CASE("a column may be a formula of channels, vectors among them, with its unit", "[unit][record]") {
  const Table t = run_with(R"~("A.force_on_p_world_x", "A.force_on_p_world_y", "A.force_on_p_world_z",
      {"F": "=norm(A.force_on_p_world)"}, {"Fy": "=A.force_on_p_world.y"}, {"dot": "=dot(rod.v, [0, 1, 0])"}, "rod.vy",
      {"power": "=A.rz_d*A.force_on_p_world_x*r"}, {"ratio": "=A.rz_d/'big end.rz_d'"}, {"w": "=A.rz_d/w"},
      {"Qz": "=Q.z"}, {"M": "=cross(rod - Q, A.force_on_p_world).z"}, "=t*plain")~");
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double x = t["A.force_on_p_world_x"][i], y = t["A.force_on_p_world_y"][i];
    CHECK(t["F"][i] == Approx(std::hypot(x, y, t["A.force_on_p_world_z"][i])).epsilon(1e-14));
    CHECK(t["Fy"][i] == y);
    CHECK(t["Qz"][i] == 2);
    CHECK(t["ratio"][i] == Approx(t["w"][i]).epsilon(1e-12));
    CHECK(t["=t*plain"][i] == 3 * t["t"][i]);
  }
  agree(t, "dot", "rod.vy", 1e-15);
  CHECK(t.column("F").unit == "N");
  CHECK(t.column("M").unit == "N m");
  CHECK(t.column("power").unit == "W");
  CHECK(t.column("ratio").unit.empty());
  CHECK(t.column("Qz").unit == "m");
}

TEST_CASE("a column reads the columns above it by their names", "[unit][record]") {
  const Table t = run_with(R"~({"F": "=norm(A.force_on_p_world)"}, {"own speed": "A.rz_d"}, "rod.y",
      {"P": "=-F*r*'own speed'"}, {"left": "=max(F) - F"}, "=2*P", {"fallen": "=-rod.y"}, {"mean": "=mean(P)"})~");
  double most = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    INFO("row " << i);
    most = std::max(most, t["F"][i]);
    CHECK(t["P"][i] == Approx(-0.2 * t["F"][i] * t["own speed"][i]).epsilon(1e-14));
    CHECK(t["=2*P"][i] == Approx(2 * t["P"][i]).epsilon(1e-14));
    CHECK(t["left"][i] >= most - t["F"][i] - 1e-12);
    CHECK(t["fallen"][i] == -t["rod.y"][i]);
  }
  CHECK(t.column("P").unit == "W");
  CHECK(t.column("left").unit == "N");
  // F = m g - m c^2 m g/I at the start, and m g + 2 m c^2 m g/I at the lowest point, which the rod passes
  CHECK(t.last("left") + t.last("F") == Approx(3 * 9.81 - 2 * t["F"][0]).epsilon(1e-10));
  const Table named = run_with(R"~({"pi": "A.rz"}, {"turn": "=2*pi"})~");
  CHECK(named.last("turn") == Approx(2 * std::numbers::pi).epsilon(1e-15));
  check_words(refusal(R"~({"b": "=2*a"}, {"a": "A.rz"})~"), {"run.record", "\"a\""});
  check_words(refusal(R"~({"c": "=c + 1"})~"), {"run.record", "\"c\""});
  check_words(refusal(R"~({"F": "=norm(A.force_on_p_world)"}, "=F + r")~"), {"run.record", "a force and a length"});
}

TEST_CASE("a name of a column and of a parameter is rejected if a formula reads it", "[unit][record]") {
  const std::string both = R"~({"plain": "A.rz"}, {"Q": "rod.x"}, {"Q.z": "rod.y"})~";
  const std::vector<std::string> words{
      "\"plain\" is both a parameter (columns.json:2:41) and a recorded column (columns.json:8:", "rename one of them",
      "'plain'"};
  check_words(refusal(both + R"~(, {"six": "=2*plain"})~"), words);
  check_words(refusal(both + R"~(, "=max(plain)")~"), words);
  check_words(refusal(R"~({"six": "=2*plain"}, )~" + both), words);  // also above the column
  check_words(refusal(both + R"~(, {"five": "=norm(Q - [1, 2, 7])"})~"),
              {"\"Q\" is both a point (columns.json:2:77) and a recorded column"});
  check_words(refusal(both + R"~(, {"two": "=Q.z"})~"), {"\"Q.z\" is both a point"});
  // A condition and an event read the same names.
  const auto with = [&](const std::string& members) {
    return build_mechanism(scene_from_text(kScene + both + "]}, " + members + "}", "columns.json"), builtin_registry());
  };
  const auto refused = [&](const std::string& members) { return message_of<SceneError>([&] { with(members); }); };
  check_words(refused(R"~("require": ["=plain < 9"])~"), words);
  check_words(refused(R"~("require": ["=plain*A.rz_d < 9 rad/s"])~"), words);
  check_words(refused(R"~("events": [{"name": "e", "when": {"channel": "=plain - t"}, "stop": true}])~"), words);
  // In quotes it is the column, as it is where no formula is; a column has no components.
  const Table quoted = run_with(both + R"~(, {"double": "=2*'plain'"}, {"y": "=Q.y"})~");
  CHECK(quoted.last("double") == 2 * quoted.last("plain"));
  CHECK(quoted.last("y") == 2);
  Simulation stopped(
      with(R"~("events": [{"name": "e", "when": {"channel": "plain", "crosses": "-0.5 rad"}, "stop": true}])~"));
  stopped.run();
  CHECK(stopped.table().last("plain") == Approx(-0.5).epsilon(1e-9));
  // The column itself reads the parameter; if it is the parameter, all do.
  const Table same = run_with(R"~({"plain": "=plain"}, {"six": "=2*plain"}, {"w": "=2*w"})~");
  CHECK(same.last("six") == 6);
  CHECK(same.last("w") == 8);
}

TEST_CASE("a peak inside a step is found to round-off, also late and in short steps", "[unit][record]") {
  // cos(x) over 0.9 rad, the peak at different places inside the step and at its ends
  for (const double t0 : {0.0, 1.0, 100.0})
    for (const double h : {1.0, 1e-4, 1e-7})
      for (const double before : {0.0, 0.01, 0.3, 0.45, 0.899, 0.9}) {
        const auto value = [&](double t) { return std::cos(0.9 * (t - t0) / h - before); };
        channels::Piece p{t0, t0 + h};
        for (int k = 0; k < channels::Piece::kNodes; ++k) p.v[static_cast<std::size_t>(k)] = value(p.t(k));
        CAPTURE(t0, h, before);
        // instants have a round-off of 1e-16 t0, of which the part in a step moves cos(x) by half of its square
        const double blur = 0.9 * 1e-16 * (t0 + h) / h;
        CHECK(std::abs(p.most(p.t0, p.t1, 1, value) - 1) <= 1e-15 + blur * blur);
        CHECK(p.most(p.t0, p.t1, -1, value) == Approx(std::cos(std::max(before, 0.9 - before))).margin(1e-14 + blur));
      }
}

TEST_CASE("the rate of a recorded quantity is its derivative", "[unit][record]") {
  const Table t = run_with(R"~("A.rz_d", "A.rz_dd", "rod.ax", {"d": "=rate(A.rz)"}, {"dd": "=rate(A.rz_d)"},
      {"ax": "=rate(rod.vx)"})~");
  agree(t, "d", "A.rz_d", 1e-10);
  agree(t, "dd", "A.rz_dd", 1e-8);
  agree(t, "ax", "rod.ax", 1e-8);
  CHECK(t.column("d").unit == "rad/s");
}

// Rows lie inside steps: what the window has lost at its end must not be missing at theirs.
TEST_CASE("a mean over the last period is that of its window at every output", "[unit][record]") {
  const std::string often = std::string(kScene).replace(std::string(kScene).find("0.25"), 4, "0.003");
  Simulation run(build_mechanism(
      scene_from_text(
          often + R"~({"mean": "=mean(last(t^2, 0.5 s))"}, {"most": "=max(last(t^2 - t*1.5 s, 0.5 s))"}]}})~",
          "last.json"),
      builtin_registry()));
  run.run();
  const Table& table = run.table();
  for (std::size_t i = 0; i < table.n_rows(); ++i) {
    const double t = table["t"][i], from = std::max(t - 0.5, 0.0);
    const auto f = [](double x) { return x * x - 1.5 * x; };
    if (t > 0.01) CHECK(table["mean"][i] == Approx((t * t * t - from * from * from) / 3 / (t - from)).epsilon(1e-10));
    CHECK(table["most"][i] == Approx(std::max(f(t), f(from))).margin(1e-12));
  }
}

TEST_CASE("functions of the motion are those of its closed form", "[unit][record]") {
  const Table t =
      run_with(R"~({"turn": "=integral('big end.rz_d')"}, "big end.rz", {"mean": "=mean(sin('big end.rz'))"},
      {"rms": "=rms(sin('big end.rz'))"}, {"most": "=max(sin('big end.rz'))"}, {"least": "=min(sin('big end.rz'))"},
      {"at": "=at('big end.rz', 0.3 s)"}, {"last": "=mean(last(sin('big end.rz')^2, 0.5*pi/w))"},
      {"swing": "=(max(A.rz) - min(A.rz))/2"}, {"impulse": "=integral(A.force_on_p_world_y - 9.81 N)"}, "rod.vy")~");
  agree(t, "turn", "big end.rz", 1e-12);
  for (std::size_t i = 1; i < t.n_rows(); ++i) {
    const double x = 4 * t["t"][i];
    INFO("t = " << t["t"][i]);
    CHECK(t["mean"][i] == Approx((1 - std::cos(x)) / x).epsilon(1e-7));
    CHECK(t["rms"][i] == Approx(std::sqrt(0.5 - std::sin(2 * x) / (4 * x))).epsilon(1e-7));
    CHECK(t["most"][i] == Approx(x < kPi / 2 ? std::sin(x) : 1).epsilon(1e-6));
    CHECK(t["least"][i] == Approx(x < kPi ? 0 : x < 1.5 * kPi ? std::sin(x) : -1).margin(1e-6));
    CHECK(t["at"][i] == Approx(std::min(x, 1.2)).epsilon(1e-9));
  }
  CHECK(t.last("last") == Approx(0.5 + 0.5 * (std::sin(16 - kPi) - std::sin(16)) / kPi).epsilon(1e-7));
  CHECK(t.last("swing") == Approx(kPi / 2).epsilon(1e-5));
  agree(t, "impulse", "rod.vy", 1e-7);
  CHECK(t.column("turn").unit == "rad");
  CHECK(t.column("impulse").unit == "N s");
}

TEST_CASE("an event may watch a formula of channels", "[unit][record]") {
  const std::string text = kScene + std::string(R"~({"F": "=norm(A.force_on_p_world)"}]}, "events": [
      {"name": "heavy", "when": {"channel": "=norm(A.force_on_p_world)", "crosses": "20 N"}, "stop": true}]})~");
  Simulation run(build_mechanism(scene_from_text(text, "events.json"), builtin_registry()));
  run.run();
  CHECK(run.loop().report().stopped_by == "heavy");
  CHECK(run.table().last("F") == Approx(20).epsilon(1e-8));
}

// A particle that is thrown: x = t, y = 5 t - 5 t^2. `rest`: what follows the columns. `before`: keys of the scene.
Scene thrown(const std::string& record, const std::string& rest, const std::string& before = "") {
  return scene_from_text(R"({"lockstep": 1, "gravity": [0, -10, 0], "bodies": [{"name": "b", "particle": 2,
      "velocity": [1, 5, 0]}], )" +
                             before + R"("run": {"until": 1, "output": 0.1, "record": [)" + record + "]" + rest + "}}",
                         "thrown.json");
}

TEST_CASE("an event may watch a function of the motion, inside steps", "[unit][record]") {
  struct Case {
    std::string channel, crosses;
    double t;  // 1: never
  };
  for (const Case& c : {Case{"=integral(b.vx)", "0.3 m", 0.3}, Case{"d", "0.3 m", 0.3}, Case{"=2*d", "0.6 m", 0.3},
                        Case{"=integral(b.vy)", "0.7 m", 0.5 - std::sqrt(0.11)}, Case{"=mean(b.vy)", "4 m/s", 0.2},
                        Case{"=rms(b.vx)", "0.5 m/s", 1}, Case{"=mean(b.x)", "0.3 m", 0.6},
                        Case{"=max(last(b.y, 0.1 s))", "1.2 m", 0.4}, Case{"=max(rate(b.y))", "5.1 m/s", 1}})
    for (const std::string step : {"", R"(, "step": 0.01)", R"(, "step": 0.01, "integrator": "rk4")"}) {
      INFO(c.channel << step);
      Simulation run(build_mechanism(thrown(R"~({"d": "=integral(b.vx)"})~", step,
                                            R"~("events": [{"name": "e", "stop": true, "when": {"channel": ")~" +
                                                c.channel + R"~(", "crosses": ")~" + c.crosses + R"~("}}], )~"),
                                     builtin_registry()));
      run.run();
      CHECK(run.state().t == Approx(c.t).margin(1e-8));
    }
}

TEST_CASE("a rate may stand inside functions of the motion, also as a column", "[unit][record]") {
  Simulation run(build_mechanism(thrown(R"~({"v": "=rate(b.y)"}, {"most": "=max(v)"}, {"rise": "=integral(v)"},
      {"mean": "=mean(rate(b.vy))"})~",
                                        ""),
                                 builtin_registry()));
  run.run();
  CHECK(run.table().last("most") == Approx(5).epsilon(1e-8));
  CHECK(run.table().last("rise") == Approx(0).margin(1e-8));
  CHECK(run.table().last("mean") == Approx(-10).epsilon(1e-8));
  check_words(refusal(R"~("=max(mean(rod.x))")~"), {"columns.json", "mean(...) is of the motion", "only rate(x)"});
}

TEST_CASE("a formula that is drawn is a column", "[unit][record]") {
  const Scene scene =
      thrown(R"("b.y")", R"(, "draw": [["=2*b.y", "b.y"]], "pictures": [{"x": "b.y", "y": "=b.x - b.y"}])");
  CHECK(scene.run.record.size() == 3);
}

TEST_CASE("functions of the motion and extremes continue from a checkpoint to the last bit", "[unit][record]") {
  const std::string text = kScene + std::string(R"~({"mean": "=mean(A.rz)"}, {"most": "=max(A.rz_d)"},
      {"last": "=rms(last(A.rz, 0.5 s))"}, {"at": "=at(A.rz, 0.7 s)"}]}})~");
  const auto run_of = [&] {
    Simulation run(build_mechanism(scene_from_text(text, "saved.json"), builtin_registry()));
    run.recorder().find_extremes();
    return run;
  };
  Simulation whole = run_of(), first = run_of(), rest = run_of();
  Snapshot saved;
  first.advance(1.1), first.loop().save(saved);
  whole.advance(1.1);
  rest.loop().load(SnapshotReader(saved));
  for (Simulation* run : {&whole, &rest}) run->run();
  REQUIRE(whole.table().n_rows() == rest.table().n_rows());
  for (std::size_t k = 0; k < 5; ++k) CHECK(whole.table().columns()[k].values == rest.table().columns()[k].values);
  for (std::size_t k = 0; k < 4; ++k) {
    const ColumnRange a = whole.recorder().ranges()[k], b = rest.recorder().ranges()[k];
    CHECK((a.least == b.least && a.most == b.most && a.t_most == b.t_most && a.resolved == b.resolved));
  }
}

TEST_CASE("wrong formulas of columns name the place and what is wrong", "[unit][record]") {
  check_words(refusal(R"~("=A.rz + rod.x")~"), {"run.record", "an angle", "a length", "added"});
  check_words(refusal(R"~("=rod.x - 0.2")~"), {"a length", "give the number a unit"});
  check_words(refusal(R"~("=norm(A.rz)")~"), {"norm", "vector"});
  check_words(refusal(R"~("=A.force_on_p_world")~"), {"use a component"});
  check_words(refusal(R"~("=A.forc + 1")~"), {"A.forc", "has no \"forc\""});
  check_words(refusal(R"~("=mean(max(A.rz))")~"), {"of the motion"});
  check_words(refusal(R"~("=last(A.rz, 1 s)")~"), {"argument of min"});
  check_words(refusal(R"~("=at(A.rz, t)")~"), {"constant time"});
  check_words(refusal(R"~("=mean(A.rz")~"), {"expected \")\""});
}

TEST_CASE("a requirement of numbers is checked when a scene is read", "[unit][record]") {
  const auto scene = [](const std::string& require) {
    const std::string text = kScene + std::string(R"~("rod.x"]}, "require": [)~") + require + "]}";
    build_mechanism(scene_from_text(text, "require.json"), builtin_registry());
  };
  CHECK_NOTHROW(scene(R"~("=r > 0 m", {"far": "=norm(Q) < 4 m"}, "=A.rz > 0 rad")~"));
  const auto refused = [&](const std::string& require) { return message_of<SceneError>([&] { scene(require); }); };
  check_words(refused(R"~("=r < 10 cm")~"),
              {"require.json", "scene.require", "=r < 10 cm", "does not hold", "r = 0.2 m"});
  check_words(refused(R"~({"near": "=Q.x > 2 m"})~"), {"\"near\" does not hold", "Q.x = 1 m"});
  check_words(refused(R"~("=r > 2 kg")~"), {"compared"});
  check_words(refused(R"~("r > 2")~"), {"is no formula", "\"=r > 2\""});
}

TEST_CASE("a requirement of channels is checked over the motion, and its worst instant is found", "[unit][record]") {
  const auto broken = [](const std::string& require, double output) {
    const std::string text = kScene + std::string(R"~("rod.x"]}, "require": [)~") + require + "]}";
    Scene scene = scene_from_text(text, "require.json");
    scene.run.output = output;
    return sweep_run(scene, builtin_registry(), recorded_columns(scene, builtin_registry()));
  };
  CHECK_FALSE(broken(R"~("=norm(A.force_on_p_world) < 25 N")~", 0.7).wrong);
  const SweepRun run = broken(R"~({"bearing": "=norm(A.force_on_p_world) < 24 N"}, "=rod.y > -2 m")~", 0.7);
  CHECK(run.wrong);
  CHECK_FALSE(run.failed);
  // 2.5 m g of a slender rod at its lowest point, which it passes after a quarter of its period
  Simulation single(build_mechanism(
      scene_from_text(kScene + std::string(R"~("rod.x"]}, "require": ["=A.rz > -1 rad"]})~"), "require.json"),
      builtin_registry()));
  single.run();
  CHECK_FALSE(single.verdict().right);
  check_words(run.outcome(), {"wrong; requirement \"bearing\"", "does not hold", "by 0.52"});
  const std::string words = run.outcome();  // or after three quarters
  CHECK((words.find("t = 0.483") != std::string::npos || words.find("t = 1.450") != std::string::npos));
}

TEST_CASE("a requirement that round-off alone breaks holds", "[unit][record]") {
  for (const char* e : {"0", "0.5"}) {
    const Scene scene = scene_from_text(
        R"~({"lockstep": 1, "gravity": [0, -10, 0], "bodies": [{"name": "b", "particle": 1, "position": [0, 1, 0]}],
          "joints": [{"name": "floor", "type": "point_on_plane", "p": "b", "s": "ground", "at_p": [0, 1, 0],
                      "at_s": [0, 0, 0], "axis": "y", "unilateral": {"restitution": )~" +
            std::string(e) + R"~(}}], "run": {"until": 1, "output": 0.1, "record": ["b.y"]},
          "require": ["=b.y >= 0 m", "=floor.gap >= 0 m", "=b.y >= 1 mm", "=(1 s)/t > 2"]})~",
        "bouncing.json");
    const SweepRun run = sweep_run(scene, builtin_registry(), recorded_columns(scene, builtin_registry()));
    REQUIRE(run.findings.size() == 2);
    check_words(run.findings[0].text(), {"b.y >= 1 mm"});
    check_words(run.findings[1].text(), {"(1 s)/t > 2"});  // infinite at the start
  }
}

TEST_CASE("a requirement that fails has its first instant", "[unit][record]") {
  const auto finding = [](const std::string& require) {
    Simulation run(
        build_mechanism(thrown(R"({"q": "=b.y"})", "", "\"require\": [" + require + "], "), builtin_registry()));
    run.run();
    const std::vector<Finding> all = run.verdict().findings;
    REQUIRE(all.size() == 1);
    return all[0];
  };
  for (const char* condition : {R"("=b.y < 1.2 m")", R"("=q < 1.2 m")", R"("=b.vx > 0 m/s && q < 1.2 m")"})
    CHECK(finding(condition).t == Approx(0.4).epsilon(1e-9));
  check_words(finding(R"("=q < 1.2 m")").text(), {"first at t = 0.4 s", "worst at t = 0.5 s by 0.05 m"});
  const Finding undefined = finding(R"("=sqrt(1 - b.y/(1 m)) < 3")");  // from y = 1 m on
  CHECK(undefined.t == Approx(0.5 - std::sqrt(0.05)).epsilon(1e-9));
  check_words(undefined.text(), {"is no number, first at t = 0.276393 s"});
  const auto refused = [](const std::string& require) {
    return message_of<SceneError>([&] {
      build_mechanism(thrown(R"({"q": "=b.y"})", "", "\"require\": [" + require + R"(], "parameters": {"r": "2 m"}, )"),
                      builtin_registry());
    });
  };
  check_words(refused(R"("=r")"), {"thrown.json:2:", "\"=r\" is a quantity, no condition", "\"=r < 1\""});
  check_words(refused(R"("=b.y")"), {"thrown.json:2:", "\"=b.y\" is a quantity, no condition"});
  check_words(refused(R"("=0 m < b.y < 1 m")"), {"thrown.json:2:", "one comparison follows another"});
}

namespace {

// y = 5 t - 5 t^2 of a particle that is thrown, with 1 m at 0.27639 s and 0.72361 s, and the apex of 1.25 m at 0.5 s.
SweepRun run_thrown(const std::string& record, double output, const std::string& require = "", Table* rows = nullptr) {
  const std::string text =
      R"~({"lockstep": 1, "gravity": [0, -10, 0], "bodies": [{"name": "b", "particle": 2, "velocity": [1, 5, 0]}],
          "run": {"until": 1, "output": )~" +
      std::to_string(output) + R"~(, "record": [)~" + record + "]}, \"require\": [" + require + "]}";
  const Scene scene = scene_from_text(text, "thrown.json");
  return sweep_run(scene, builtin_registry(), recorded_columns(scene, builtin_registry()), {}, rows);
}

// 10 mm sin(2 pi f t) of a driven particle of 1 kg.
SweepRun driven(const std::string& record, int f) {
  const std::string text =
      R"~({"lockstep": 1, "gravity": [0, 0, 0], "bodies": [{"name": "b", "particle": 1}],
          "joints": [{"name": "A", "type": "lock", "mask": "y z", "p": "b", "s": "ground", "at": [0, 0, 0],
          "drive": {"axis": "x", "law": {"type": "formula", "y": "=0.01*sin(2*pi*)~" +
      std::to_string(f) + R"~(*t)"}}}], "run": {"until": 1, "output": 0.1, "record": [)~" + record + "]}}";
  const Scene scene = scene_from_text(text, "driven.json");
  return sweep_run(scene, builtin_registry(), recorded_columns(scene, builtin_registry()));
}

}  // namespace

TEST_CASE("functions of the motion are cut at kinks, jumps and poles", "[unit][record]") {
  Table rows;
  const SweepRun run = run_thrown(R"~({"most": "=max(min(b.y, 0.5 m))"}, {"least": "=min(max(b.y, 0.5 m))"},
      {"above": "=mean(b.y > 0.8 m ? 1 : 0)"}, {"log": "=max(log(b.y/(1 m)))"}, {"steps": "=integral(floor(b.y/(0.5 m)))"},
      {"bend": "=integral(abs(b.vy))"}, {"lost": "=rms(sign(b.vy))"})~",
                                  0.1, "", &rows);
  CHECK(rows.last("most") == Approx(0.5).epsilon(1e-12));
  CHECK(rows.last("least") == Approx(0.5).epsilon(1e-12));
  for (std::size_t i = 1; i < rows.n_rows(); ++i) CHECK(rows["most"][i] >= rows["most"][i - 1]);
  CHECK(rows.last("above") == Approx(0.6).epsilon(1e-9));  // from 0.2 s to 0.8 s
  CHECK(rows.last("log") == Approx(std::log(1.25)).epsilon(1e-5));
  // y > 0.5 m for sqrt(0.6) s, y > 1 m for sqrt(0.2) s
  CHECK(rows.last("steps") == Approx(std::sqrt(0.6) + std::sqrt(0.2)).epsilon(1e-9));
  CHECK(rows.last("bend") == Approx(2.5).epsilon(1e-9));
  CHECK(rows.last("lost") == Approx(1).epsilon(1e-9));
  CHECK(run.columns[0].resolved);
  run_thrown(R"~({"kink": "=at(abs(t - 0.3 s), 0.3 s)"}, {"flat": "=at(min(t, 0.7 s), 0.7 s)"},
      {"jump": "=at(t < 0.25 s ? 1 : 2, 0.25 s)"}, {"floor": "=at(floor(t/(0.5 s)), 0.5 s)"})~",
             0.1, "", &rows);
  CHECK(rows.last("kink") == Approx(0).margin(1e-9));
  CHECK(rows.last("flat") == Approx(0.7).epsilon(1e-9));
  CHECK(rows.last("jump") == 2);
  CHECK(rows.last("floor") == 1);
  run_thrown(R"~({"pole": "=max(1 m/(b.y - 1 m))"})~", 0.05, "", &rows);
  for (std::size_t i = 0; rows["t"][i] < 0.27; ++i) CHECK(rows["pole"][i] == Approx(-1));
}

TEST_CASE("functions of a prescribed motion are found between few outputs", "[unit][record]") {
  for (const int f : {57, 200, 1000}) {
    INFO(f << " Hz");
    const double a = 0.01 * std::pow(2 * kPi * f, 2);
    const SweepRun run = driven(R"~({"most": "=max(b.x)"}, {"rms": "=rms(b.x)"}, {"F": "A.drive.force_on_p_link_x"},
        {"G": "=F"}, {"rms F": "=rms(F)"}, {"way": "=mean(abs(b.x))"})~",
                                f);
    CHECK(run.columns[0].most == Approx(0.01).epsilon(1e-4));
    CHECK(run.columns[1].last == Approx(0.01 / std::sqrt(2)).epsilon(1e-4));
    CHECK(run.columns[2].most == Approx(a).epsilon(1e-3));
    CHECK(run.columns[3].most == Approx(a).epsilon(1e-3));
    CHECK(run.columns[4].last == Approx(a / std::sqrt(2)).epsilon(1e-4));
    for (const std::size_t k : {0u, 1u, 4u}) CHECK(run.columns[k].resolved);
    if (f > 200) continue;  // 1000 Hz has 200 kinks between two outputs
    CHECK(run.columns[5].last == Approx(0.02 / kPi).epsilon(1e-4));
    CHECK(run.columns[5].resolved);
  }
}

TEST_CASE("extremes of a formula are those at its kinks and jumps, and requirements fail there", "[unit][record]") {
  const double t = 0.5 - std::sqrt(0.25 - 0.14);  // y = 0.7 m
  for (const char* const formula :
       {"=abs(b.y - 0.7 m)", "=norm([b.y - 0.7 m, 0, 0])", "=max(b.y, 0.7 m) - min(b.y, 0.7 m)"}) {
    INFO(formula);
    const SweepRun run =
        run_thrown("\"" + std::string(formula) + "\"", 0.25, "\"" + std::string(formula) + " > 0.01 m\"");
    CHECK(run.columns[0].least == Approx(0).margin(1e-8));
    CHECK(std::min(std::abs(run.columns[0].t_least - t), std::abs(run.columns[0].t_least - (1 - t))) < 1e-6);
    CHECK(run.columns[0].most == Approx(0.7));
    CHECK(run.wrong);
  }
  CHECK(run_thrown("\"b.y\"", 0.25, R"~("=b.y < 0.7 m || b.y > 0.72 m")~").wrong);
  CHECK_FALSE(run_thrown("\"b.y\"", 0.25, R"~("=b.y < 0.7 m || b.y > 0.69 m")~").wrong);
}

TEST_CASE("a column without a finite value at an instant hides no other column", "[unit][record]") {
  const SweepRun run =
      run_thrown(R"~("b.y", {"q": "=b.y/b.vy*(1 m/(1 s))"}, {"log": "=log(b.y/(1 m))"}, {"one": "=b.y/(1 m)"})~", 0.1);
  CHECK(run.columns[0].most == Approx(1.25));
  CHECK(run.columns[0].t_most == Approx(0.5).margin(1e-3));
  CHECK_FALSE(run.columns[1].resolved);
  CHECK_FALSE(run.columns[2].resolved);
  CHECK(run.columns[3].most == Approx(1.25));
}

}  // namespace computed_test
