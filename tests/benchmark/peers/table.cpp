// SPDX-License-Identifier: BSD-3-Clause
// table NOTE OUT.md OUT.csv IN.csv...: of each system the cheapest run within 1e-3, 1e-6 and 1e-9 m, and how many times
// dearer than lockstep the best peer is.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "tests/benchmark/peers/costs.h"
#include "tests/benchmark/peers/mechanisms.h"

using namespace lockstep::peers;

namespace {

const std::vector<double> kLimits = {1e-3, 1e-6, 1e-9};  // m

std::string rounded(double x) {
  char text[32];
  std::snprintf(text, sizeof text, x < 100 ? "%.2g" : "%.0f", x);
  const std::string s = text;
  const std::size_t zero = s.find("e-0");
  return zero == std::string::npos ? s : s.substr(0, zero) + "e-" + s.substr(zero + 3);
}

std::string shown(const MaybeCost& cost, bool tried) {
  if (!tried) return "";
  if (!cost) return "never";
  return cost->guess ? "(" + rounded(cost->cpu) + ")" : (cost->bound ? "<= " : "") + rounded(cost->cpu);
}

std::string ratio(const MaybeCost& ours, const MaybeCost& peer, bool any_peer) {
  if (!any_peer) return "";
  if (!ours) return peer ? "never" : "";
  if (!peer) return "only lockstep";
  const std::string mark = ours->bound && peer->bound ? "~ " : ours->bound ? ">= " : peer->bound ? "<= " : "";
  const double r = peer->cpu / ours->cpu;
  char text[32];
  std::snprintf(text, sizeof text, r < 10 ? "%.2g" : "%.0f", r);
  return ours->guess || peer->guess ? "(" + std::string(text) + ")" : mark + text;
}

void write_markdown(std::ostream& out, const Costs& table, const std::string& title, ErrorOf error) {
  out << "\n## " << title << "\n\n| mechanism | error |";
  for (const std::string& system : table.systems()) out << ' ' << system << " |";
  out << " best other engine / lockstep | lockstep's method |\n|---|---|";
  for (std::size_t i = 0; i < table.systems().size() + 2; ++i) out << "---|";
  out << '\n';
  for (const std::string& m : table.mechanisms())
    for (const double limit : kLimits) {
      out << "| " << m << " | " << rounded(limit) << " |";
      bool any_peer = false;
      for (const std::string& system : table.systems()) {
        any_peer |= system != kOurs && table.tried(m, system);
        out << ' ' << shown(table.cheapest(m, system, limit, error), table.tried(m, system)) << " |";
      }
      const MaybeCost ours = table.cheapest(m, kOurs, limit, error);
      out << ' ' << ratio(ours, table.best_peer(m, limit, error), any_peer) << " | "
          << (ours && !ours->guess ? ours->method + " @ " + rounded(ours->setting) : "") << " |\n";
    }
}

/// Median of CPU microseconds a body and step, and a body and evaluation, over a method's timed runs.
std::string per_body(const std::vector<Line>& lines, const Mechanism& m) {
  std::vector<double> steps, evaluations;
  for (const Line& line : lines) {
    if (!line.done() || !std::isfinite(line.cpu)) continue;
    const double micros = 1e6 * line.cpu * m.until / n_bodies(m);
    if (line.steps > 0) steps.push_back(micros / line.steps);
    if (line.evaluations > 1) evaluations.push_back(micros / line.evaluations);
  }
  const auto median = [](std::vector<double>& v) {
    std::sort(v.begin(), v.end());
    return rounded(v[v.size() / 2]);
  };
  if (steps.empty()) return "";
  return median(steps) + (evaluations.empty() ? "" : " (" + median(evaluations) + ")");
}

void write_growth(std::ostream& out, const Costs& table) {
  std::vector<Mechanism> chains;
  for (const std::string& name : table.mechanisms())
    for (const Mechanism& m : all_mechanisms())
      if (m.name == name && name.find("chain-") != std::string::npos) chains.push_back(m);
  if (chains.empty()) return;
  out << "\n## Cost of a body and step\nThis table shows how the cost of one body and step grows with the length of a "
         "chain, in microseconds of CPU time. In brackets: the cost of one body and evaluation. Each value is the "
         "median of the runs of the method.\n\n| system, method |";
  for (const auto& m : chains) out << ' ' << m.name << " |";
  out << "\n|---|";
  for (std::size_t i = 0; i < chains.size(); ++i) out << "---|";
  out << '\n';
  for (const std::string& system : table.systems()) {
    std::map<std::string, std::string> cells;
    for (std::size_t i = 0; i < chains.size(); ++i) {
      for (const auto& [method, lines] : table.methods(chains[i].name, system)) cells.try_emplace(method, "");
      for (auto& [method, text] : cells) {
        const auto methods = table.methods(chains[i].name, system);
        const auto found = methods.find(method);
        for (std::size_t n = std::size_t(std::count(text.begin(), text.end(), '|')); n < i; ++n) text += " |";
        text += " " + (found == methods.end() ? "" : per_body(found->second, chains[i])) + " |";
      }
    }
    for (const auto& [method, text] : cells)
      if (text.find_first_not_of(" |") != std::string::npos)
        out << "| " << system << ' ' << method << " |" << text << '\n';
  }
}

void write_csv(std::ostream& out, const Costs& table) {
  out << "judged_by,mechanism,limit_m,system,cpu_s_per_sim_s,kind,method,h_or_tol\n";
  const std::vector<std::pair<std::string, ErrorOf>> kinds = {{"history", &Line::error}, {"end", &Line::error_end}};
  for (const auto& [kind, error] : kinds)
    for (const std::string& m : table.mechanisms())
      for (const double limit : kLimits)
        for (const std::string& system : table.systems()) {
          if (!table.tried(m, system)) continue;
          const MaybeCost cost = table.cheapest(m, system, limit, error);
          out << kind << ',' << m << ',' << limit << ',' << system << ',';
          if (cost)
            out << cost->cpu << ','
                << (cost->guess   ? "continued"
                    : cost->bound ? "upper bound"
                                  : "measured")
                << ',' << cost->method << ',' << cost->setting << '\n';
          else
            out << "never,,,\n";
        }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) return std::fprintf(stderr, "usage: %s NOTE OUT.md OUT.csv IN.csv...\n", argv[0]), 2;
  std::vector<Line> lines;
  for (int i = 4; i < argc; ++i) {
    const std::vector<Line> more = read_lines(argv[i]);
    lines.insert(lines.end(), more.begin(), more.end());
  }
  if (lines.empty()) return std::fprintf(stderr, "there is no run to tabulate\n"), 1;
  const Costs table(lines);
  std::ofstream markdown(argv[2]), csv(argv[3]);
  markdown
      << "# Comparison with other engines: the results\n"
         "This page lists the CPU time that lockstep and other engines need for the same mechanisms and errors. It is "
         "for readers who compare engines. [The method](../peers/README.md) describes mechanisms, engines and "
         "measurement.\n\nMeasured: "
      << argv[1]
      << "\n\n| entry of the first two tables | meaning |\n|---|---|\n"
         "| error | limit of the error in m, the largest over the bodies |\n"
         "| a number of an engine | user CPU time in s for one simulated second: the cheapest run within the error |\n"
         "| a number in brackets | extrapolated beyond the budget |\n"
         "| `<=` | upper bound: the next coarser run was not made |\n"
         "| `never` | no run of any method met the error |\n"
         "| empty | not run |\n"
         "| name of a method | integrator and its options, such as `dop853{fixed:true}` for fixed steps |\n"
         "| `+dense` | the output was interpolated by the method itself |\n"
         "| `@` | before the step in s of a method with fixed steps, or the tolerance of others |\n";
  write_markdown(markdown, table, "Largest error over the run, at 101 times", &Line::error);
  write_markdown(markdown, table, "Error at the end of the run", &Line::error_end);
  write_growth(markdown, table);
  markdown << "\nNext: [the method](../peers/README.md), [benchmarks](../../../framework/docs/charts.md).\n";
  write_csv(csv, table);
  if (!markdown || !csv) return std::fprintf(stderr, "cannot write %s or %s\n", argv[2], argv[3]), 1;
  return 0;
}
