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

/// "dop853{fixed:true;stages:auto}+dense" as the program spells it: "dop853:fixed=true:stages=auto+dense".
std::string spelled(std::string method) {
  std::erase(method, '}');
  for (char& c : method) c = c == ':' ? '=' : c == '{' || c == ';' ? ':' : c;
  return method;
}

/// As `--integrator` takes it: without the mark of its own interpolation, and without the default of `stages`.
std::string as_option(const std::string& method) {
  std::string option = spelled(method.substr(0, method.find("+dense")));
  const std::string usual = ":stages=auto";
  if (const std::size_t at = option.find(usual); at != std::string::npos) option.erase(at, usual.size());
  return option;
}

/// "5 to 109 (13)": an engine's time over lockstep's, of the mechanisms in which both met the error.
std::string ratios(const Costs& table, const std::string& system, double limit) {
  std::vector<double> all;
  for (const std::string& m : table.mechanisms()) {
    const MaybeCost ours = table.cheapest(m, kOurs, limit, &Line::error),
                    peer = table.cheapest(m, system, limit, &Line::error);
    if (ours && peer && !ours->guess && !peer->guess) all.push_back(peer->cpu / ours->cpu);
  }
  if (all.empty()) return "never";
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return rounded(*least) + (all.size() > 1 ? " to " + rounded(*most) : "") + " (" + std::to_string(all.size()) + ")";
}

void write_ratios(std::ostream& out, const Costs& table) {
  out << "\n## CPU time of each engine relative to lockstep\nEach entry has the smallest and the largest ratio over "
         "the "
         "mechanisms. In brackets: the number of mechanisms in which both met the error. Extrapolated values are "
         "excluded. The last column lists the methods, and for how many mechanisms each was measured.\n\n"
         "| engine | mechanisms |";
  for (const double limit : kLimits) out << " error " << rounded(limit) << " m |";
  out << " methods |\n|---|---|";
  for (std::size_t i = 0; i < kLimits.size() + 1; ++i) out << "---|";
  out << '\n';
  for (const std::string& system : table.systems()) {
    if (system == kOurs) continue;
    std::size_t n = 0;
    std::map<std::string, int> methods;
    for (const std::string& m : table.mechanisms()) {
      n += table.tried(m, system) ? 1 : 0;
      for (const auto& [method, lines] : table.methods(m, system)) ++methods[spelled(method)];
    }
    out << "| " << system << " | " << n << " |";
    for (const double limit : kLimits) out << ' ' << ratios(table, system, limit) << " |";
    std::string list;
    for (const auto& [method, count] : methods)
      list += (list.empty() ? "" : ", ") + method + " " + std::to_string(count);
    out << ' ' << list << " |\n";
  }
  out << "\nThese parts of a method's name are settings of the comparison:\n\n| part | meaning |\n|---|---|\n"
         "| `-fixed`, `-dense` | fixed steps; output by the interpolation of the method |\n"
         "| `+planes`, `+ball+angle`, `+redundant` | Simbody closes a loop by two constraints in the plane; by a ball "
         "and an "
         "angle; by a whole joint, with redundant constraints |\n"
         "| `+steady` | Simbody holds the crank at its speed by a constraint |\n"
         "| `+soft`, `+stiff`, `+stiffest` | MuJoCo's constraints: with its defaults; with an impedance of 0.9999; "
         "with that "
         "and a time constant of two steps |\n"
         "| `World`, `World(0.8)` | DART's own step; each step corrects 0.8 of a constraint error |\n"
         "| `ABA+RK4` | DART's forward dynamics with a Runge-Kutta method of the benchmark |\n"
         "| `direct(0.2)`, `quick(20)` | ODE's direct solver, correcting 0.2 of a constraint error; its iterative one, "
         "with 20 "
         "iterations |\n"
         "| `RigidBody-SI50`, `-Dantzig` | Bullet's maximal coordinates with 50 iterations; Dantzig's solver |\n"
         "| `BDF-banded` | IDA's method with a banded matrix |\n";
}

void write_markdown(std::ostream& out, const Costs& table) {
  out << "\n## CPU time in s for one simulated second, by the largest error over the run at 101 times\n\n| mechanism | error [m] |";
  for (const std::string& system : table.systems()) out << ' ' << system << " |";
  out << " best other engine / lockstep | lockstep's method | its step [s] or tolerance |\n|---|---|";
  for (std::size_t i = 0; i < table.systems().size() + 3; ++i) out << "---|";
  out << '\n';
  for (const std::string& m : table.mechanisms())
    for (const double limit : kLimits) {
      out << "| " << m << " | " << rounded(limit) << " |";
      bool any_peer = false;
      for (const std::string& system : table.systems()) {
        any_peer |= system != kOurs && table.tried(m, system);
        out << ' ' << shown(table.cheapest(m, system, limit, &Line::error), table.tried(m, system)) << " |";
      }
      const MaybeCost ours = table.cheapest(m, kOurs, limit, &Line::error);
      out << ' ' << ratio(ours, table.best_peer(m, limit, &Line::error), any_peer) << " | "
          << (ours && !ours->guess ? as_option(ours->method) + " | " + rounded(ours->setting) : " |") << " |\n";
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
         "median of the runs of the method. The mark `+dense` means that the method itself interpolated the output.\n\n"
         "| system, method |";
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
        out << "| " << system << ' ' << spelled(method) << " |" << text << '\n';
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
         "for readers who compare "
         "engines.\n[Benchmarks](../../../framework/docs/charts.md#comparison-with-other-engines) "
         "has a summary, and the limits of the comparison. [The method](../peers/README.md) describes mechanisms, "
         "engines and measurement.\n\nMeasured: "
      << argv[1]
      << "\n\nA line of the second table is one mechanism with one limit of the error, the largest over the bodies. "
         "Each engine has a column with the user CPU time in s for one simulated second, in its cheapest run within "
         "that error.\nThe next column divides the time of the best other engine by that of lockstep. The last two "
         "give lockstep's method as `--integrator` takes it, and its setting. The setting is the step of a method with "
         "fixed steps (`fixed=true`, `rk4`), otherwise the tolerance.\nlockstep is built for every x86-64 "
         "processor, as the packages are. It has no contact, rolling or flexible bodies.\nIn `flyball`, the limit of "
         "stability sets the "
         "steps of `dop853`: "
         "its cost does not depend on the error.\n\n| entry | meaning |\n|---|---|\n"
         "| a number in brackets | extrapolated from the two finest runs: none met the error, within the budget or "
         "among its settings |\n"
         "| `never` | no run of the engine met the error |\n"
         "| `only lockstep` | no run of any other engine met the error |\n"
         "| empty | not run; in the last two columns: extrapolated |\n";
  write_ratios(markdown, table);
  write_markdown(markdown, table);
  write_growth(markdown, table);
  markdown << "\nNext: [the method](../peers/README.md), [benchmarks](../../../framework/docs/charts.md).\n";
  write_csv(csv, table);
  if (!markdown || !csv) return std::fprintf(stderr, "cannot write %s or %s\n", argv[2], argv[3]), 1;
  return 0;
}
