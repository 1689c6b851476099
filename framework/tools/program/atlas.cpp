// The verb atlas: over any two numbers of a scene, where each method works, is inaccurate and fails.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <numeric>
#include <thread>

#include <nlohmann/json.hpp>

#include <lockstep/analysis.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/text.h>
#include "framework/foundation/support/thrown.h"
#include "framework/tools/charts/gnuplot.h"
#include "framework/tools/charts/map_grid.h"
#include "framework/tools/program/benchmark.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/run_queue.h"
#include "framework/tools/sweep/atlas_run.h"
#include "framework/tools/sweep/step_limit.h"

namespace lockstep {
namespace {

constexpr int kMostTheory = 40;  // bodies up to which small motions are analysed

/// One map: a method over the whole grid.
struct AtlasPanel {
  MethodSpec integrator;
  Stabilization::Kind stabilization;
  bool adaptive = false;
  std::vector<AtlasCell> cells{};  // by the run of the grid, from 0
  std::vector<double> limit_x{}, limit_y{};
  std::string unsuited{};  // why it is left out

  std::string name() const { return to_word(integrator) + ", " + to_string(stabilization); }
};

struct AtlasPlan {
  const Arguments& arguments;
  Loaded loaded;
  std::vector<Variable> variables;
  Grid grid;
  std::vector<AtlasPanel> panels;
  AtlasLimits limits;
  double budget;

  Scene scene(long run, const AtlasPanel& panel) const {
    Scene s = vary_scene(loaded.scene, variables, grid.at(run), loaded.registry);
    override_settings(s.run, arguments, loaded.registry);
    s.run.integrator = panel.integrator, s.run.stabilization.kind = panel.stabilization;
    return s;
  }
  // Runs of equal words have one reference: settings of the run but for its end make no difference to it.
  std::string reference_key(long run) const {
    const std::vector<std::size_t> at = grid.at(run);
    std::string key;
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (!variables[k].place.starts_with("run.") || variables[k].place == "run.until")
        key += fmt::format("{},", at[k]);
    return key;
  }
};

// "NAME=a:b:n:log" as a list of n values in geometric progression; anything else as it is.
std::string with_log(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || !text.ends_with(":log")) return text;
  const std::string range = text.substr(equals + 1, text.size() - equals - 5);
  const std::size_t first = range.find(':'), second = range.find(':', first + 1);
  const auto refuse = [&]() -> UsageError {
    return UsageError("--vary: \"" + text +
                      "\" is not a range; write NAME=a:b:n:log with a and b above 0, as in "
                      "run.step=1e-4:1e-1:20:log");
  };
  if (first == std::string::npos || second == std::string::npos) throw refuse();
  const auto number = [&](const std::string& word) {
    double x = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (error != std::errc() || !(x > 0) || !std::isfinite(x)) throw refuse();
    return std::pair(x, std::string(end, word.data() + word.size()));
  };
  const auto [a, unit_a] = number(range.substr(0, first));
  const auto [b, unit_b] = number(range.substr(first + 1, second - first - 1));
  const auto [n, rest] = number(range.substr(second + 1));
  if (!rest.empty() || n != std::floor(n) || n < 2 || n > 1000 ||
      (!unit_b.empty() && !unit_a.empty() && unit_a != unit_b))
    throw refuse();
  const std::string unit = unit_a.empty() ? unit_b : unit_a;
  std::string list;
  for (int k = 0; k < static_cast<int>(n); ++k)
    list += fmt::format("{}{:.6g}{}", k == 0 ? "" : ",", a * std::pow(b / a, k / (n - 1)), unit);
  return text.substr(0, equals + 1) + list;
}

template <class F>
auto as_usage(F&& read) {
  try {
    return std::forward<F>(read)();
  } catch (const ModelError& error) {
    throw UsageError(std::string("--vary: ") + error.what());
  } catch (const SceneError& error) {
    throw UsageError(std::string("--vary: ") + error.what());
  }
}

std::vector<double> numbers_of(const Variable& v) {
  std::vector<double> all;
  for (const Value& value : v.values) {
    if (value.number() == nullptr)
      throw UsageError("--vary: \"" + v.path +
                       "\": an axis of a map needs numbers; vary words by --integrators or "
                       "--stabilizations");
    all.push_back(*value.number());
  }
  if (all.size() < 2 || !std::ranges::is_sorted(all, std::ranges::less_equal()))
    throw UsageError("--vary: \"" + v.path + "\": an axis of a map needs two values at least, rising");
  return all;
}

// Whether the numbers lie rather on a logarithmic axis: decades apart, or evenly in the logarithm.
bool is_log(const std::vector<double>& x) {
  if (x.front() <= 0 || x.size() < 3 || x.back() < 3 * x.front()) return false;
  const double middle = x[x.size() / 2];
  return std::abs(std::log(middle / std::sqrt(x.front() * x.back()))) <
         std::abs(std::log(middle / (0.5 * (x.front() + x.back()))));
}

AtlasPlan make_plan(const Arguments& args) {
  Loaded loaded = read_with_plugins(args);
  std::vector<std::string> texts;
  for (const std::string& text : args.vary) texts.push_back(with_log(text));
  std::vector<Variable> variables = as_usage([&] { return read_variables(texts, loaded.scene, loaded.registry); });
  if (variables.size() != 2) throw UsageError("--vary: a map has two axes; give two of them");
  bool steps = false, gains = false;
  for (const Variable& v : variables) {
    numbers_of(v);
    steps = steps || v.place == "run.step", gains = gains || v.place.starts_with("run.stabilization.");
    if (v.place == "run.step" && !args.step.empty())
      throw UsageError("--step: \"run.step\" varies; leave one of the two out");
    if (v.place == "run.until" && !args.until.empty())
      throw UsageError("--until: \"run.until\" varies; leave one of the two out");
  }
  Grid grid = as_usage([&] { return Grid({variables[0].values.size(), variables[1].values.size()}); });
  AtlasPlan plan{args, std::move(loaded), std::move(variables), std::move(grid), {}, {}, budget_of(args)};
  if (!args.error.empty()) {
    plan.limits.works = positive_number("--error", args.error, Unit::none);
    plan.limits.wrong = std::max(plan.limits.wrong, plan.limits.works);
  }

  const std::vector<TypeInfo> types = types_of(plan.loaded.registry.integrators);
  std::vector<MethodSpec> methods;
  if (args.integrators.empty())
    for (const TypeInfo& type : types) methods.push_back({type.name, Value(Value::Object{}), {}});
  for (const std::string& name : args.integrators) methods.push_back(read_spec("--integrators", name, types));
  std::vector<Stabilization::Kind> kinds;
  for (const std::string& word : args.stabilizations) kinds.push_back(read_stabilization(word));
  if (kinds.empty())
    kinds.push_back(gains ? Stabilization::Kind::baumgarte
                          : plan.scene(1, {methods.front(), {}}).run.stabilization.kind);
  if (args.stabilizations.empty() && !gains) {
    Scene s = plan.loaded.scene;
    override_settings(s.run, args, plan.loaded.registry);
    kinds = {s.run.stabilization.kind};
  }
  for (const MethodSpec& method : methods)
    for (const Stabilization::Kind kind : kinds) {
      AtlasPanel panel{method, kind};
      try {
        const Scene first = plan.scene(1, panel);
        if (!(first.run.until > 0))
          throw UsageError(first.file +
                           ": run.until: the scene does not say how long it runs; add it, or give --until 5");
        panel.adaptive = make_integrator(first.run, plan.loaded.registry)->info().adaptive;
      } catch (const SceneError& error) {
        panel.unsuited = error.what();
      }
      plan.panels.push_back(std::move(panel));
    }
  return plan;
}

/// All runs of an atlas, shared out to threads; references first.
class Atlas {
 public:
  Atlas(AtlasPlan& plan, const Interrupt& interrupt, int jobs)
      : plan_(plan), interrupt_(interrupt), jobs_(jobs), n_(plan.grid.n_runs()) {
    long n_panels = 0;
    for (AtlasPanel& panel : plan_.panels)
      panel.cells.resize(static_cast<std::size_t>(n_)), n_panels += panel.unsuited.empty();
    total_ = n_ * n_panels;
    limit_ = std::max(0.1, 5 * plan.budget / static_cast<double>(std::max(1l, total_)));
  }

  void go(Progress& progress) {
    for (long run = 1; run <= n_; ++run) references_[plan_.reference_key(run)].runs.push_back(run);
    std::vector<Shared*> all;
    for (auto& [key, shared] : references_) all.push_back(&shared);
    share_out(static_cast<long>(all.size()), [&](long k) { prepare(*all[static_cast<std::size_t>(k)]); });
    // A stride without a common factor: when time is up, what is left out is spread over the maps.
    long stride = std::max(1l, static_cast<long>(0.618 * static_cast<double>(n_)));
    while (std::gcd(stride, n_) != 1) ++stride;
    std::vector<AtlasPanel*> panels;
    for (AtlasPanel& panel : plan_.panels)
      if (panel.unsuited.empty()) panels.push_back(&panel);
    const auto n_panels = static_cast<long>(panels.size());
    share_out(total_, [&](long k) {
      progress.at(static_cast<double>(done_++));
      if (spent_ > plan_.budget) return;
      compute(*panels[static_cast<std::size_t>(k % n_panels)], 1 + (k / n_panels * stride) % n_);
    });
    for (AtlasPanel* panel : panels) add_limit(*panel);
  }

  bool out_of_time() const { return spent_ > plan_.budget; }
  double agreement() const {
    double worst = 0;
    for (const auto& [key, shared] : references_) worst = std::max(worst, shared.reference.agreement);
    return worst;
  }
  std::string methods() const {
    std::vector<std::string> names;
    for (const auto& [key, shared] : references_)
      if (!shared.reference.method.empty() && std::ranges::find(names, shared.reference.method) == names.end())
        names.push_back(shared.reference.method);
    return names.empty() ? "none" : text::join(names);
  }
  std::string missing() const {
    for (const auto& [key, shared] : references_)
      if (shared.reference.method.empty()) return shared.reference.reason;
    return {};
  }

 private:
  struct Shared {
    std::vector<long> runs{};
    AtlasReference reference{};
  };

  template <class Work>
  void share_out(long n, Work&& work) {
    std::atomic<long> next = 0;
    std::exception_ptr failed;
    std::mutex mutex;
    const auto loop = [&] {
      try {
        for (long k = next++; k < n && !interrupt_.asked(); k = next++) work(k);
      } catch (...) {
        const std::lock_guard lock(mutex);
        failed = std::current_exception(), next = n;
      }
    };
    {
      std::vector<std::jthread> threads;
      for (int j = 0; j < jobs_; ++j) threads.emplace_back(loop);
    }
    if (failed) std::rethrow_exception(failed);
  }

  std::function<bool()> go_on() const {
    return [this] { return !interrupt_.asked(); };
  }

  void prepare(Shared& shared) {
    std::vector<double> instants;
    std::optional<Scene> scene;
    for (const AtlasPanel& panel : plan_.panels) {
      if (!panel.unsuited.empty()) continue;
      for (const long run : shared.runs) {
        try {
          scene = plan_.scene(run, panel);
        } catch (const Error& error) {
          shared.reference.reason = error.what();
          continue;
        }
        const std::vector<double> more = atlas_instants(scene->run, panel.adaptive);
        instants.insert(instants.end(), more.begin(), more.end());
      }
    }
    if (!scene) return;
    std::ranges::sort(instants);
    instants.erase(std::unique(instants.begin(), instants.end(), [](double a, double b) { return b - a <= 1e-9 * b; }),
                   instants.end());
    shared.reference = atlas_reference(*scene, plan_.loaded.registry, instants, 0.2 * plan_.budget, go_on());
  }

  void compute(AtlasPanel& panel, long run) {
    AtlasCell& cell = panel.cells[static_cast<std::size_t>(run - 1)];
    const AtlasReference& reference = references_.at(plan_.reference_key(run)).reference;
    if (reference.method.empty()) {
      cell.reason = "no reference: " + reference.reason;
      return;
    }
    try {
      const Scene scene = plan_.scene(run, panel);
      cell = atlas_run(scene, plan_.loaded.registry, reference, atlas_instants(scene.run, panel.adaptive), plan_.limits,
                       limit_, go_on());
    } catch (const Error& error) {
      cell.outcome = AtlasOutcome::stopped, cell.reason = error.what(), cell.error = HUGE_VAL;
    }
    const std::lock_guard lock(mutex_);
    spent_ = spent_ + cell.cpu;
  }

  // The limit of linear theory along the axis of steps, for each value of the other.
  void add_limit(AtlasPanel& panel) {
    const auto is_step = [](const Variable& v) { return v.place == "run.step"; };
    const auto at = std::ranges::find_if(plan_.variables, is_step);
    if (at == plan_.variables.end() || panel.adaptive || interrupt_.asked()) return;
    const auto k = static_cast<std::size_t>(at - plan_.variables.begin());
    const std::vector<double> steps = numbers_of(plan_.variables[k]), others = numbers_of(plan_.variables[1 - k]);
    for (std::size_t i = 0; i < others.size(); ++i) {
      const auto run = static_cast<long>(1 + (k == 0 ? i : i * steps.size()));
      double h = std::numeric_limits<double>::quiet_NaN();
      try {
        const Scene scene = plan_.scene(run, panel);
        if (build_mechanism(scene, plan_.loaded.registry).system.n_slots() <= kMostTheory)
          h = step_limit(panel.integrator, small_motions(scene, plan_.loaded.registry), 0.1 * steps.front(),
                         10 * steps.back());
      } catch (const Error&) {  // no theory of a start that cannot be evaluated
      }
      const bool shown = h > 0.1 * steps.front() && h < 10 * steps.back();
      const double along = shown ? h : std::numeric_limits<double>::quiet_NaN();
      panel.limit_x.push_back(k == 0 ? along : others[i]), panel.limit_y.push_back(k == 0 ? others[i] : along);
    }
  }

  AtlasPlan& plan_;
  const Interrupt& interrupt_;
  const int jobs_;
  const long n_;
  long total_ = 0;
  double limit_ = 0;
  std::map<std::string, Shared> references_;
  std::mutex mutex_;
  std::atomic<double> spent_ = 0;
  std::atomic<long> done_ = 0;
};

// -- what is written

std::string csv_text(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '"' ? '\'' : static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return out.find(',') == std::string::npos ? out : '"' + out + '"';
}

void write_cells(const std::string& file, const AtlasPlan& plan) {
  GrowingFile csv(file);
  csv.clear();
  std::string header = "integrator,stabilization";
  for (const Variable& v : plan.variables)
    header += "," + csv_text(v.unit.empty() ? v.path : v.path + " [" + v.unit + "]");
  csv.append(header + ",outcome,error [m],energy imbalance,drift [m],steps,rejected,cpu [s],reason\n");
  for (const AtlasPanel& panel : plan.panels) {
    for (std::size_t i = 0; i < panel.cells.size() && panel.unsuited.empty(); ++i) {
      const AtlasCell& c = panel.cells[i];
      const std::vector<std::size_t> at = plan.grid.at(static_cast<long>(i) + 1);
      std::string line = csv_text(to_word(panel.integrator)) + "," + to_string(panel.stabilization);
      for (std::size_t k = 0; k < at.size(); ++k) line += "," + plain_text(plan.variables[k].values[at[k]]);
      const bool ran = c.outcome != AtlasOutcome::untried;
      line +=
          fmt::format(",{},{},{},{},{},{},{},{}\n", csv_text(words_of(c.outcome)),
                      ran && std::isfinite(c.error) ? text::number(c.error) : "", ran ? text::number(c.energy) : "",
                      ran ? text::number(c.drift) : "", c.steps, c.rejected, text::number(c.cpu), csv_text(c.reason));
      csv.append(line);
    }
  }
  csv.commit();
}

const std::vector<MapSpec::Kind> kOutcomes{{"works", "#6fbfae"},
                                           {"inaccurate", "#f2c14e"},
                                           {"wrong, and the energy balance or the drift says so", "#e08a4f"},
                                           {"wrong without a word", "#8e2a5b"},
                                           {"stops with an error", "#cf5b50"},
                                           {"too slow", "#8a8fb5"},
                                           {"not tried", "#d9d9d9"}};

/// Decades of a number as kinds of a map.
struct Decades {
  std::vector<MapSpec::Kind> kinds;
  double kind_of(double x) const {
    if (!std::isfinite(x)) return static_cast<double>(kinds.size()) - 1;
    return std::clamp(std::floor((std::log10(std::max(x, 1e-300)) + 10) / 2) + 1, 0.0,
                      static_cast<double>(kinds.size()) - 2);
  }
};
Decades decades_of(const std::string& what) {
  constexpr const char* kColors[] = {"#1b4f8f", "#2f7fb8", "#58b1a8", "#a8d8a0", "#f2e08a", "#f2a65a", "#8e2a5b"};
  Decades d;
  for (int k = 0; k < 7; ++k)
    d.kinds.push_back({k == 0   ? fmt::format("{} below 1e-10", what)
                       : k == 6 ? "above 1"
                                : fmt::format("to 1e{}", -10 + 2 * k),
                       kColors[k]});
  d.kinds.push_back({"did not reach its end", "#b5b5b5"});
  return d;
}

MapGridSpec picture_of(const AtlasPlan& plan, const Atlas& atlas, const std::string& of, double size) {
  MapGridSpec grid;
  grid.title = plan.loaded.title();
  const std::vector<double> x = numbers_of(plan.variables[0]), y = numbers_of(plan.variables[1]);
  const auto label = [](const Variable& v) { return v.unit.empty() ? v.path : v.path + " [" + v.unit + "]"; };
  const Decades decades = decades_of(of == "energy" ? "energy imbalance, relative," : "error, m,");
  bool curves = false;
  for (const AtlasPanel& panel : plan.panels) {
    if (!panel.unsuited.empty()) continue;
    MapSpec map;
    map.title = panel.name();
    map.x_label = label(plan.variables[0]), map.y_label = label(plan.variables[1]);
    map.x = x, map.y = y, map.log_x = is_log(x), map.log_y = is_log(y);
    map.kinds = of == "status" ? kOutcomes : decades.kinds;
    map.cells.resize(x.size() * y.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t j = 0; j < y.size(); ++j) {
        const AtlasCell& c = panel.cells[i * y.size() + j];
        const bool ended = c.outcome < AtlasOutcome::stopped;
        map.cells[j * x.size() + i] = of == "status" ? static_cast<double>(c.outcome)
                                                     : decades.kind_of(!ended           ? HUGE_VAL
                                                                       : of == "energy" ? c.energy
                                                                                        : c.error);
      }
    const bool any = std::ranges::any_of(panel.limit_x, [](double v) { return std::isfinite(v); }) &&
                     std::ranges::any_of(panel.limit_y, [](double v) { return std::isfinite(v); });
    if (any) map.curves = {{"limit", panel.limit_x, panel.limit_y, SeriesStyle::lines}}, curves = true;
    grid.maps.push_back(std::move(map));
  }
  grid.n_columns = std::min<std::size_t>(3, grid.maps.size());
  grid.width = grid.maps.size() == 1 ? 900 : 1300;
  if (grid.maps.size() == 1) grid.map_height = 520;
  if (curves) grid.curve_label = "largest stable step by linear theory at the start";
  grid.remarks.push_back(fmt::format(
      "Error: largest over the run, against {}; works: up to {:g} of the largest displacement{}, wrong: beyond {:g} of "
      "it.",
      atlas.methods(), plan.limits.works, size > 0 ? fmt::format(" ({:.3g} m)", size) : "", plan.limits.wrong));
  return grid;
}

std::map<AtlasOutcome, long> counts_of(const AtlasPanel& panel) {
  std::map<AtlasOutcome, long> counts;
  for (const AtlasCell& c : panel.cells) ++counts[c.outcome];
  return counts;
}

nlohmann::ordered_json to_json(const AtlasPlan& plan, const Atlas& atlas, const std::vector<std::string>& files) {
  nlohmann::ordered_json j = {{"scene", plan.loaded.scene.file},
                              {"reference", atlas.methods()},
                              {"agreement", atlas.agreement()},
                              {"files", files}};
  for (const Variable& v : plan.variables)
    j["axes"].push_back({{"name", v.path}, {"unit", v.unit}, {"values", numbers_of(v)}});
  for (const AtlasPanel& panel : plan.panels) {
    nlohmann::ordered_json p = {{"integrator", to_word(panel.integrator)},
                                {"stabilization", to_string(panel.stabilization)}};
    if (!panel.unsuited.empty()) {
      p["left_out"] = panel.unsuited;
    } else {
      for (const auto& [outcome, n] : counts_of(panel)) p["counts"][words_of(outcome)] = n;
      const std::size_t n_y = plan.variables[1].values.size();
      for (std::size_t i = 0; i < panel.cells.size(); ++i) {
        if (i % n_y == 0) p["outcomes"].push_back(nlohmann::ordered_json::array());
        p["outcomes"].back().push_back(words_of(panel.cells[i].outcome));
      }
      if (!panel.limit_x.empty()) p["limit"] = {{"x", panel.limit_x}, {"y", panel.limit_y}};
    }
    j["maps"].push_back(std::move(p));
  }
  return j;
}

void print_panels(const AtlasPlan& plan) {
  for (const AtlasPanel& panel : plan.panels) {
    if (!panel.unsuited.empty()) {
      fmt::print("  {:<34} left out: {}\n", panel.name(), panel.unsuited);
      continue;
    }
    std::string line;
    for (const auto& [outcome, n] : counts_of(panel))
      line += fmt::format("{}{} {}", line.empty() ? "" : ", ", n, words_of(outcome));
    fmt::print("  {:<34} {}\n", panel.name(), line);
  }
}

}  // namespace

int atlas_command(const Arguments& args) {
  const std::string of = args.of == "position" ? "status" : args.of;  // the default of the other verbs
  AtlasPlan plan = make_plan(args);
  const std::string csv = csv_path(
      args.out.empty() ? "" : (std::filesystem::path(args.out) / stem_of(args.scene)).string() + ".csv", args.scene);
  const std::string base = std::filesystem::path(csv).replace_extension().string() + "_atlas";
  check_writable(base + ".csv");
  const Interrupt interrupt;
  set_logger(nullptr);
  Atlas atlas(plan, interrupt, args.jobs > 0 ? args.jobs : available_processors());
  const long n = plan.grid.n_runs() * static_cast<long>(plan.panels.size());
  {
    Progress progress(static_cast<double>(n), args.quiet || args.json, Counts::runs);
    atlas.go(progress);
    progress.finish();
  }
  write_cells(base + ".csv", plan);
  std::vector<std::string> files{base + ".csv"};
  const bool any = std::ranges::any_of(plan.panels, [](const AtlasPanel& p) { return p.unsuited.empty(); });
  if (any && !find_gnuplot().empty()) {
    write_map_grid(base, picture_of(plan, atlas, of, 0));
    files.push_back(base + ".png"), files.push_back(base + ".svg");
  }
  if (args.json) {
    fmt::print("{}\n", to_json(plan, atlas, files).dump(1, ' '));
  } else {
    fmt::print("{}\n  runs       {} of {} methods, each {} x {}\n  reference  {}, good to {:.1e} m\n",
               plan.loaded.title(), n, plan.panels.size(), plan.variables[0].values.size(),
               plan.variables[1].values.size(), atlas.methods(), atlas.agreement());
    print_panels(plan);
    if (!atlas.missing().empty()) fmt::print("  no reference for some values: {}\n", atlas.missing());
    if (atlas.out_of_time()) fmt::print("  the time was spent before every run was tried; give more with --budget\n");
    for (std::size_t k = 0; k < files.size(); ++k)
      fmt::print("{}{}\n", k == 0 ? "  files      " : "             ", files[k]);
  }
  if (interrupt.asked()) {
    fmt::print(stderr, "lockstep: interrupted; the runs up to there are written\n");
    return kExitInterrupted;
  }
  if (!any) throw UsageError("no method can run this scene: " + plan.panels.front().unsuited);
  return kExitOk;
}

}  // namespace lockstep
