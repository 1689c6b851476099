// SPDX-License-Identifier: BSD-3-Clause
// The verbs kinematics and inverse: a fully driven scene from instant to instant, without integration.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include <lockstep/author/lock.h>
#include <lockstep/kinematics.h>
#include <lockstep/log.h>
#include <lockstep/text.h>
#include "framework/mechanism/params/read.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDefaultPoses = 100;  // where the scene names no interval of outputs

// Words of quantities that depend on masses.
constexpr const char* kOfMasses[] = {"force", "torque",   "lambda", "energy", "power",
                                     "work",  "momentum", "center", "mass",   "loss"};

// Keys of bodies that give a mass, or need none.
constexpr const char* kGiveMass[] = {"mass", "rod", "box", "cylinder", "sphere", "compound", "particle", "fixed"};

/// Gives bodies without mass 1 kg and 1 kg m^2 about all axes: a motion by laws does not depend on them. Their names.
std::vector<std::string> fill_masses(Scene& scene) {
  std::vector<std::string> names;
  const auto fill = [&](Value& root) {
    names.clear();
    for (auto& [key, value, where] : *root.object()) {
      if (key != "bodies" || value.list() == nullptr) continue;
      for (Value& body : *value.list()) {
        if (body.object() == nullptr) continue;
        const bool has = std::ranges::any_of(kGiveMass, [&](const char* kind) { return body.find(kind) != nullptr; });
        if (has) continue;
        body.object()->push_back({"mass", Value(1.0), body.where});
        body.object()->push_back({"inertia", Value(Value::List{1.0, 1.0, 1.0}), body.where});
        const Value* name = body.find("name");
        names.push_back(name != nullptr && name->text() != nullptr ? *name->text() : "?");
      }
    }
  };
  if (scene.root.object() != nullptr) change_root(scene, fill);
  return names;
}

/// What a channel gives of its thing: "force_on_p_world_x" of "A.force_on_p_world_x"; the whole where it is of none.
std::string quantity_of(const std::string& channel, const System& system) {
  std::size_t longest = 0;
  const auto see = [&](const std::string& name) {
    if (name.size() >= longest && channel.starts_with(name + ".")) longest = name.size() + 1;
  };
  for (const Body& body : system.bodies()) see(body.name);
  for (const Marker& marker : system.markers()) see(marker.name);
  for (const auto& link : system.links()) see(link->name());
  for (const auto& force : system.forces()) see(force->name());
  const std::string quantity = channel.substr(longest);
  return longest > 0 ? quantity.substr(0, quantity.find('@')) : quantity;
}

void refuse_columns_of_masses(const Mechanism& m, const std::vector<std::string>& without) {
  for (const ChannelRequest& request : m.run.record)
    for (const char* word : kOfMasses)
      if (quantity_of(request.channel, m.system).find(word) != std::string::npos)
        refuse(request.where, "run.record",
               "\"" + request.channel + "\" depends on masses, and " + text::join(without) +
                   (without.size() == 1 ? " has none" : " have none") + "; give them, or leave the column out");
}

/// Here nothing is integrated: a column of a work is refused.
void refuse_integrated_columns(Mechanism& m) {
  for (const ChannelRequest& request : m.run.record) {
    const std::size_t before = m.system.auxiliaries().size();
    make_channel(system_of(m), request.channel);
    for (std::size_t k = before; k < m.system.auxiliaries().size(); ++k)
      refuse(request.where, "run.record",
             "\"" + request.channel + "\" needs '" + m.system.auxiliaries()[k]->name() +
                 "', which is integrated over time: take lockstep run for it, or leave the column out");
  }
}

/// Columns of all drives and reactions, beside those that the scene records.
void record_reactions(Mechanism& m) {
  const auto add = [&](const std::string& channel) {
    if (std::ranges::none_of(m.run.record, [&](const ChannelRequest& r) { return r.channel == channel; }))
      m.run.record.push_back({channel, "", {}});
  };
  for (const auto& link : m.system.links()) {
    const Driven* driven = link->driven();
    if (link->pairs().empty()) continue;
    for (int d = 0; driven != nullptr && d < driven->n_drives(); ++d) {
      const std::string axis = driven->drive(d).name;
      add(link->name() + ".drive_" + axis +
          (axis.starts_with('r') ? ".torque_on_p_link_" + axis.substr(1) : ".force_on_p_link_" + axis));
      add(link->name() + ".drive_" + axis + ".power");
    }
  }
  for (const auto& link : m.system.links()) {
    if (link->pairs().empty() || m.system.merged(*link)) continue;
    for (const char* what : {".force_on_p_world_", ".torque_on_p_world_"})
      for (const char* axis : {"x", "y", "z"}) add(link->name() + what + axis);
  }
}

/// The times of the poses: those that the scene lists, or the multiples of an interval and the end.
class PoseTimes {
 public:
  explicit PoseTimes(const RunSettings& run)
      : times_(run.times), interval_(run.output > 0 ? run.output : run.until / kDefaultPoses), until_(run.until) {
    if (!times_.empty()) {
      n_ = static_cast<long>(times_.size());
      return;
    }
    const double whole = std::floor(until_ / interval_ * (1 + 1e-12));
    if (!(whole <= kMostPoses))
      throw UsageError(
          fmt::format("{:.3g} poses, one every {:.6g} s up to {:.6g} s, are more than {:.0e}: give a longer "
                      "interval, --output {:.6g}",
                      whole, interval_, until_, kMostPoses, until_ / kDefaultPoses));
    n_ = static_cast<long>(whole) + 1;
    if (whole * interval_ < until_ * (1 - 1e-12)) ++n_;
  }
  long size() const { return n_; }
  double operator[](long k) const {
    if (!times_.empty()) return times_[k];
    return std::min(static_cast<double>(k) * interval_, until_);
  }
  /// The interval goes beyond the end.
  bool only_ends() const { return times_.empty() && interval_ > until_ && n_ == 2; }
  double interval() const { return interval_; }

 private:
  static constexpr double kMostPoses = 1e8;
  const std::vector<double>& times_;
  double interval_, until_;
  long n_ = 0;
};

/// Peak of a column: its largest size and when.
struct Peak {
  double value = 0, t = 0;
};
Peak peak_of(const Table& table, const Column& column) {
  Peak peak;
  for (std::size_t i = 0; i < column.values.size(); ++i)
    if (std::abs(column.values[i]) > std::abs(peak.value)) peak = {column.values[i], table.columns().front().values[i]};
  return peak;
}

void print_end(const Table& table, const std::string& csv, long steps, double seconds, bool inverse) {
  fmt::print("  poses      {} by {} solutions, {:.3g} s\n", table.n_rows(), steps, seconds);
  if (inverse)
    for (const Column& c : table.columns())
      if (c.name.find(".drive") != std::string::npos)
        fmt::print("  {:<36} peak {:.6g} {} at t = {:.6g} s\n", c.name, peak_of(table, c).value, c.unit,
                   peak_of(table, c).t);
  fmt::print("  files      {} ({} rows)\n", csv, table.n_rows());
}

Json table_json(const Table& table) {
  Json all = Json::object();
  for (const Column& c : table.columns()) all[column_title(c)] = c.values;
  return all;
}

int follow(const Arguments& args, bool inverse) {
  if (args.has("--quiet")) set_logger(nullptr);
  Loaded loaded = load(args);
  const std::vector<std::string> without = inverse ? std::vector<std::string>{} : fill_masses(loaded.scene);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  if (!args["--output"].empty()) {
    m.run.output = positive_number("--output", args["--output"], Unit::time);
    m.run.times.clear();
  }
  if (m.run.until <= 0)
    refuse(m.run.where.line > 0 ? m.run.where : loaded.scene.root.where, "run.until",
           "the scene does not say how long it runs, or 0; say it there, or give --until 5");
  const PoseTimes times(m.run);
  if (times.only_ends())
    fmt::print(stderr,
               "lockstep: the interval of the poses, {:.6g} s, is longer than the {:.6g} s of the motion: only "
               "start and end are computed\n",
               times.interval(), m.run.until);
  record_places(m);
  if (!without.empty()) refuse_columns_of_masses(m, without);
  if (inverse) record_reactions(m);
  refuse_integrated_columns(m);
  const std::string csv = csv_path(args["--record"], args["scene"]);
  check_overwrites(csv, loaded.scene);
  GrowingFile file(csv);
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  State start = decided_start(dynamics, m);
  assemble(dynamics, start, m.start_speeds, m.assembly);
  if (!args.has("--quiet") && !args.has("--json")) fmt::print("{}\n", loaded.title());
  for (const EventRequest& e : m.events)
    fmt::print(stderr, "lockstep: event '{}' does not act: nothing runs here\n", e.event.name);

  const auto begun = std::chrono::steady_clock::now();
  DrivenMotion motion(dynamics, std::move(start));
  GrowingCsv rows(file, recorder->table());
  const StepReport report;
  Doubts doubts(!args.has("--quiet") && records_reactions(m.run), 0);
  std::exception_ptr failed;
  try {
    for (long k = 0; k < times.size(); ++k) {
      motion.to(times[k]);
      const Sample sample(dynamics, motion.state(), report);
      if (k == 0)
        recorder->start(sample), rows.start(sample), doubts.start(sample);
      else
        recorder->step(sample);
      recorder->output(sample), rows.output(sample), doubts.output(sample);
    }
  } catch (const Error&) {
    failed = std::current_exception();
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  file.write();
  if (failed) {
    fmt::print(stderr, "lockstep: {} rows up to there are in {}\n", recorder->table().n_rows(), file.partial());
    std::rethrow_exception(failed);
  }
  file.commit();
  for (const Finding& f : doubts.findings(motion.steps(), motion.state().t)) {
    CommandFindings::add(f);
    fmt::print(stderr, "lockstep: {}\n", f.text());
  }
  if (args.has("--json"))
    print_document(table_json(recorder->table()));
  else if (!args.has("--quiet"))
    print_end(recorder->table(), csv, motion.steps(), seconds, inverse);
  return kExitOk;
}

}  // namespace

int kinematics_command(const Arguments& args) { return follow(args, false); }
int inverse_command(const Arguments& args) { return follow(args, true); }

}  // namespace lockstep
