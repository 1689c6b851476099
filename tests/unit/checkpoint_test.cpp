// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/report.h>
#include <lockstep/simulation.h>
#include "framework/tools/simulation/checkpoint.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace checkpoint_file_test {

using namespace lockstep;
using lockstep::testing::message_of, lockstep::testing::says;

namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("lockstep_checkpoint_test_" + std::to_string(::getpid()));
  Folder() { fs::remove_all(path), fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const char* name) const { return (path / name).string(); }
};

std::string bytes_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

void write_bytes(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

SimulationOptions options_with(const std::string& integrator) {
  return {.integrator = integrator, .tolerance = 1e-8, .step = integrator == "rk4" ? 0.01 : 0.0, .output = 0.01};
}

/// A rod on a hinge that turns round and round.
struct Pendulum {
  System system{System::Options{{0, -9.81, 0}}};
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  Revolute& hinge = system.add<Revolute>("hinge", rod, system.ground(), pose_at({0, 0, 0}));
  explicit Pendulum(double speed = 9) { rod.start = {{0, 0.5 * speed, 0}, {0, 0, speed}}; }
};

/// Counts steps, and says so in a checkpoint or not.
struct Counter final : Observer {
  long steps = 0;
  bool reads = true;
  void step(const Sample&) override { ++steps; }
  void save(Snapshot& out) const override { out.put(static_cast<double>(steps)); }
  void load(SnapshotReader& in) override {
    if (reads) steps = in.get_count();
  }
};

/// A method with a history of another library.
struct Secretive final : Integrator {
  IntegratorInfo info() const override { return {"secretive", 1, false, false, 1}; }
  void begin(Dynamics&, const State&) override {}
  StepReport step(Dynamics& dynamics, State& s, double h) override {
    StateRate rate;
    dynamics.rate(s, rate);
    s.v += h * rate.v;
    dynamics.advance(s, h, s.v);
    dynamics.project(s);
    s.t += h;
    StepReport report;
    report.h = h;
    return report;
  }
  bool saves_all() const override { return false; }
};

}  // namespace

TEST_CASE("a simulation continues from a checkpoint to the last bit") {
  const Folder folder;
  for (const char* integrator : {"dopri5", "dop853", "radau5", "rk4"}) {
    INFO(integrator);
    Pendulum one, other;
    Simulation whole(one.system, options_with(integrator));
    const Table& all = whole.record({"rod.angle_z", "energy.balance", "hinge.force_on_p_world_y"});
    Counter counted, counted_on;
    whole.add_observer(counted);
    whole.run_until(0.777);
    whole.save(folder / "run");
    whole.run_until(2);
    CHECK_FALSE(fs::exists(folder / "run.partial"));

    Simulation on(other.system, options_with(integrator));
    const Table& rest = on.record({"rod.angle_z", "energy.balance", "hinge.force_on_p_world_y"});
    on.add_observer(counted_on);
    on.load(folder / "run");
    CHECK(on.state().t == 0.777);
    on.run_until(2);
    CHECK(counted_on.steps == counted.steps);
    CHECK(std::abs(rest.last("rod.angle_z")) > 7);  // turns are counted on
    REQUIRE(rest.n_rows() == all.n_rows());
    for (std::size_t k = 0; k < all.n_columns(); ++k) CHECK(rest.columns()[k].values == all.columns()[k].values);
  }
}

TEST_CASE("a checkpoint that is damaged, cut or of another layout is rejected") {
  const Folder folder;
  Pendulum pendulum;
  Simulation run(pendulum.system, options_with("dopri5"));
  run.run_until(0.1);
  run.save(folder / "run");
  const std::string whole = bytes_of(folder / "run");
  const auto refusal = [&](const std::string& bytes) {
    write_bytes(folder / "other", bytes);
    Pendulum fresh;
    Simulation on(fresh.system, options_with("dopri5"));
    return message_of<FileError>([&] { on.load(folder / "other"); });
  };
  CHECK(refusal(whole) == "no error");
  std::mt19937 draw(7);
  for (int k = 0; k < 300; ++k) {  // any bit of any byte
    std::string bytes = whole;
    bytes[draw() % bytes.size()] ^= static_cast<char>(1u << draw() % 8);
    CHECK(says(refusal(bytes), {"checkpoint '", "other'"}));
  }
  for (const std::size_t n :
       {std::size_t{0}, std::size_t{5}, std::size_t{25}, whole.size() / 2, whole.size() - 8, whole.size() - 1})
    CHECK(refusal(whole.substr(0, n)) != "no error");
  CHECK(says(refusal(whole.substr(0, whole.size() - 3)), {"is truncated or damaged"}));
  CHECK(says(refusal(whole + "x"), {"is truncated or damaged"}));
  CHECK(says(refusal("{\"lockstep\": 1}"), {"is not a checkpoint"}));
  std::string later = whole;
  REQUIRE(later.starts_with("lockstep checkpoint " + std::to_string(kCheckpointLayout) + "\n"));
  later.replace(20, std::to_string(kCheckpointLayout).size(), std::to_string(kCheckpointLayout + 1));
  const std::string numbers = "has layout " + std::to_string(kCheckpointLayout + 1) + " instead of " +
                              std::to_string(kCheckpointLayout) + ":";
  CHECK(says(refusal(later), {numbers.c_str(), "run the scene again from its start"}));
  std::string first = whole;
  first.replace(20, std::to_string(kCheckpointLayout).size(), "1");  // which said nothing of the layout
  CHECK(says(refusal(first), {"has layout 1 instead of "}));
  CHECK(says(refusal("lockstep checkpoint "), {"has no layout number"}));
  CHECK(says(refusal("lockstep checkpoint 2"), {"has no layout number"}));
  CHECK(says(message_of<FileError>([&] { run.load(folder / "nowhere"); }), {"cannot be read"}));
}

TEST_CASE("a checkpoint of another version, simulation or kind is rejected by name") {
  const Folder folder;
  Pendulum pendulum;
  Simulation run(pendulum.system, options_with("dopri5"));
  run.run_until(0.1);
  run.save(folder / "run");

  std::string bytes = bytes_of(folder / "run");
  const double other_digit = '7';  // the version's first letter, as a number after its length
  std::memcpy(bytes.data() + bytes.find('\n') + 1 + 8 + 8, &other_digit, 8);
  const std::uint64_t hash = hash_of(std::string_view(bytes).substr(0, bytes.size() - 8));
  std::memcpy(bytes.data() + bytes.size() - 8, &hash, 8);
  write_bytes(folder / "version", bytes);
  CHECK(says(message_of<FileError>([&] { run.load(folder / "version"); }), {"was written by lockstep 7", "this is "}));

  const auto refusal = [&](System& system, const SimulationOptions& options, bool column = false) {
    Simulation on(system, options);
    if (column) on.record({"rod.x"});
    return message_of<ModelError>([&] { on.load(folder / "run"); });
  };
  Pendulum same;
  CHECK(refusal(same.system, options_with("dopri5")) == "no error");
  CHECK(
      says(refusal(same.system, options_with("dop853")), {"other options", "integrator dopri5", "integrator dop853"}));
  CHECK(says(refusal(same.system, options_with("dopri5"), true), {"1 columns and records 2"}));
  const auto refusal_of = [&](const Shape& shape, const Vec3& gravity, const Vec3& hinge) {
    System other{System::Options{gravity}};
    Body& rod = other.add_body("rod", shape);
    other.add<Revolute>("hinge", rod, other.ground(), pose_at(hinge));
    return refusal(other, options_with("dopri5"));
  };
  const Vec3 down(0, -9.81, 0), here(0, 0, 0);
  const Shape same_rod = shapes::rod(1.0, {0, 0, 0}, {1, 0, 0});
  CHECK(refusal_of(same_rod, down, here) == "no error");
  CHECK(says(refusal_of(shapes::rod(2.0, {0, 0, 0}, {1, 0, 0}), down, here), {"belongs to another run", "body rod"}));
  Shape thicker = same_rod, off_centre = same_rod;
  thicker.mass.J *= 1.01, off_centre.mass.center[0] += 0.01;
  CHECK(says(refusal_of(thicker, down, here), {"belongs to another run", "body rod"}));
  CHECK(says(refusal_of(off_centre, down, here), {"belongs to another run", "body rod"}));
  CHECK(says(refusal_of(same_rod, {0, -1.62, 0}, here), {"belongs to another run", "gravity"}));
  CHECK(says(refusal_of(same_rod, down, {0.1, 0, 0}), {"belongs to another run", "marker hinge.P"}));
  SimulationOptions drifting = options_with("dopri5");
  drifting.dynamics.stabilization.kind = Stabilization::Kind::none;
  CHECK(says(refusal(same.system, drifting), {"belongs to another run", "stabilization"}));

  write_checkpoint(folder / "kind", [] {
    Snapshot s;
    s.put_text("run");
    return s;
  }());
  CHECK(says(message_of<ModelError>([&] { run.load(folder / "kind"); }), {"lockstep resume"}));
}

TEST_CASE("a run continues as it was after a checkpoint that it cannot take") {
  const Folder folder;
  Pendulum saved, pendulum, same;
  Simulation other(saved.system, options_with("dopri5"));
  other.run_until(0.3);
  other.save(folder / "other");
  Simulation run(pendulum.system, options_with("dopri5")), whole(same.system, options_with("dopri5"));
  for (Simulation* each : {&run, &whole}) each->record({"rod.x"}), each->run_until(0.1);
  const std::string refusal = message_of<Error>([&] { run.load(folder / "other"); });
  INFO(refusal);
  CHECK(says(refusal, {"1 columns and records 2"}));
  CHECK(run.table().n_rows() == 11);
  Pendulum turning;
  Simulation counts(turning.system, options_with("dopri5"));
  counts.record({"rod.angle_z"}), counts.run_until(0.1);
  CHECK(says(message_of<ModelError>([&] { counts.load(folder / "other"); }), {"it has \"nothing\"", "rod"}));
  for (Simulation* each : {&run, &whole}) each->run_until(0.2);
  REQUIRE(run.table().n_rows() == whole.table().n_rows());
  CHECK(run.table().last("rod.x") == Approx(whole.table().last("rod.x")).epsilon(1e-7));
}

TEST_CASE("objects that cannot be saved or loaded are reported, and those that read less than was saved") {
  const Folder folder;
  Pendulum pendulum;
  Simulation run(pendulum.system, options_with("dopri5"));
  CHECK(says(message_of<ModelError>([&] { run.save(folder / "early"); }), {"has not started"}));
  Counter counter;
  run.add_observer(counter);
  run.run_until(0.1);
  run.save(folder / "run");
  CHECK(says(message_of<FileError>([&] { run.save(folder / "no/such/folder"); }), {"cannot be written"}));

  Pendulum fresh;
  Simulation without(fresh.system, options_with("dopri5"));
  CHECK(says(message_of<ModelError>([&] { without.load(folder / "run"); }), {"observers"}));
  Simulation forgetful(fresh.system, options_with("dopri5"));
  Counter deaf;
  deaf.reads = false;
  forgetful.add_observer(deaf);
  CHECK(says(message_of<ModelError>([&] { forgetful.load(folder / "run"); }), {"reads less"}));
  Simulation more(fresh.system, options_with("dopri5"));
  Counter same;
  more.add_observer(same);
  more.add_event({.name = "late", .at = 5, .stop = true});
  CHECK(says(message_of<ModelError>([&] { more.load(folder / "run"); }), {"0 events and has 1"}));

  Dynamics dynamics(fresh.system, make_solver(MethodSpec{"schur"}, builtin_registry(), "test"));
  StepLoop loop(dynamics, std::make_unique<Secretive>(), {.step = 0.01});
  loop.run_until(0.05);
  Snapshot out;
  CHECK(says(message_of<ModelError>([&] { loop.save(out); }), {"'secretive'", "cannot be saved"}));

  Simulation shown(fresh.system, options_with("dopri5"));
  Report page(shown.recorder());
  shown.add_observer(page);
  shown.run_until(0.1);
  CHECK(
      says(message_of<ModelError>([&] { shown.save(folder / "shown"); }), {"observer 2", "Report", "cannot be saved"}));
}

TEST_CASE("a snapshot holds any word of 64 bits") {
  Snapshot out;
  const std::uint64_t words[] = {0, 1, 0xffffffffu, 0x100000000u, 0x0123456789abcdefu, ~std::uint64_t{0}};
  for (const std::uint64_t w : words) out.put_bits(w);
  SnapshotReader in(out);
  for (const std::uint64_t w : words) CHECK(in.get_bits() == w);
  CHECK(in.at_end());
  for (const double odd : {-1.0, 4294967296.0, std::nan("")}) {
    Snapshot bad;
    bad.put(0), bad.put(odd);
    CHECK(says(message_of<ModelError>([&] { SnapshotReader(bad).get_bits(); }), {"restore() reads more than save() wrote"}));
  }
}

TEST_CASE("a part of a snapshot is no longer than what is left of it") {
  for (const double size : {3.0, 4.0, -1.0, std::nan("")}) {
    Snapshot bad;
    for (const double x : {size, 1.0, 2.0}) bad.put(x);
    CHECK(says(message_of<ModelError>([&] { SnapshotReader(bad).get_part(); }), {"restore() reads more than save() wrote"}));
  }
}

TEST_CASE("numbers of a checkpoint that fit its hash but no run are always rejected") {
  struct Sprung : Pendulum {
    Sprung() {
      Marker &end = system.add_marker_at("end", rod, pose_at({1, 0, 0})),
             &hook = system.add_marker_at("hook", system.ground(), pose_at({0, 1, 0}));
      system.add<SpringDamper>("spring", end, hook, {.stiffness = 3, .free_length = 0.1});
    }
  };
  struct Watched {
    Sprung pendulum;
    EnergyAudit audit{pendulum.system};
    Simulation run;
    explicit Watched(const std::string& integrator)
        : run(pendulum.system, {.integrator = integrator, .step = integrator == "rattle2" ? 0.01 : 0.0}) {
      run.add_observer(audit);
    }
  };
  for (const char* integrator : {"dop853", "rattle2"}) {
    INFO(integrator);
    Watched good(integrator);
    good.run.run_until(0.1);
    Snapshot saved;
    good.run.loop().save(saved);
    std::mt19937_64 draw(11);
    long cut = 0, refused = 0, ran = 0;
    for (int k = 0; k < 1000; ++k) {
      std::vector<double> numbers = saved.numbers();
      const std::size_t at = draw() % numbers.size();
      const double odd[] = {-1, 0, 1, 3, 1e9, 1e300, std::nan(""), -std::numeric_limits<double>::infinity(), 0.5};
      if (k % 4 == 0)
        numbers.resize(at);
      else
        numbers[at] = odd[draw() % std::size(odd)];
      Snapshot bad;
      bad.assign(std::move(numbers));
      Watched on(integrator);
      const std::string said = message_of<Error>([&] { on.run.loop().load(bad); });
      if (k % 4 == 0) ++cut, refused += said != "no error" ? 1 : 0;
      if (said != "no error") continue;
      for (int step = 0; step < 3; ++step) message_of<Error>([&] { on.run.loop().step(1e-3); });
      on.audit.result();
      ++ran;
    }
    CHECK(refused == cut);  // all that end too early
    CHECK(ran > 0);
  }
}

}  // namespace checkpoint_file_test
