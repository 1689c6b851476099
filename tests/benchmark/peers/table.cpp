// table NOTE OUT.md OUT.csv IN.csv...: of each system the cheapest run within 1e-3, 1e-6 and 1e-9 m, and how many times
// dearer than lockstep the best peer is. A run counts only when every finer run of its method stays within twice the
// limit (no lucky hits); "<=" marks an upper bound: the next coarser run of its method was not made.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/benchmark/peers/mechanisms.h"

namespace {

const std::string kOurs = "lockstep";
const std::vector<double> kLimits = {1e-3, 1e-6, 1e-9};  // m

struct Line {
  std::string system, mechanism, method, status;
  double setting = 0, cpu = 0, error = 0, error_end = 0;
  bool done() const { return status.rfind("ok", 0) == 0; }
  bool cut_short() const { return status.rfind("over", 0) == 0; }
};
using ErrorOf = double Line::*;

struct Cost {
  double cpu = 0;      // s a simulated s
  bool bound = false;  // an upper one
  bool guess = false;  // beyond the budget, continued from the two finest runs
  std::string method;
  double setting = 0;
};
using MaybeCost = std::optional<Cost>;

std::vector<Line> read_lines(const std::string& path) {
  std::vector<Line> lines;
  std::ifstream in(path);
  for (std::string text; std::getline(in, text);) {
    std::istringstream cells(text);
    std::vector<std::string> c;
    for (std::string cell; std::getline(cells, cell, ',');) c.push_back(cell);
    if (c.size() < 10 || c[0] == "peer") continue;
    lines.push_back({c[0], c[1], c[2], c[9], std::stod(c[3]), std::stod(c[4]), std::stod(c[5]), std::stod(c[6])});
  }
  return lines;
}

class Table {
 public:
  explicit Table(std::vector<Line> lines) {
    for (const Line& line : lines) {
      if (std::find(systems_.begin(), systems_.end(), line.system) == systems_.end()) systems_.push_back(line.system);
      methods_[{line.mechanism, line.system}][line.method].push_back(line);
    }
    std::stable_sort(systems_.begin(), systems_.end(),
                     [](const std::string& a, const std::string& b) { return (a == kOurs) > (b == kOurs); });
  }

  std::vector<std::string> mechanisms() const {
    std::vector<std::string> names;
    for (const lockstep::peers::Mechanism& m : lockstep::peers::all_mechanisms())
      for (const auto& [key, lines] : methods_)
        if (key.first == m.name && (names.empty() || names.back() != m.name)) names.push_back(m.name);
    return names;
  }
  const std::vector<std::string>& systems() const { return systems_; }
  bool tried(const std::string& mechanism, const std::string& system) const {
    return methods_.count({mechanism, system}) > 0;
  }

  MaybeCost cheapest(const std::string& mechanism, const std::string& system, double limit, ErrorOf error) const {
    MaybeCost best;
    const auto found = methods_.find({mechanism, system});
    if (found == methods_.end()) return best;
    for (const auto& [name, lines] : found->second) better(best, cheapest_of(lines, limit, error));
    if (best) return best;
    for (const auto& [name, lines] : found->second) better(best, continued(lines, limit, error));
    return best;
  }
  /// Of all systems but lockstep.
  MaybeCost best_peer(const std::string& mechanism, double limit, ErrorOf error, std::string& who) const {
    MaybeCost best;
    for (const std::string& system : systems_) {
      if (system == kOurs) continue;
      if (better(best, cheapest(mechanism, system, limit, error))) who = system;
    }
    return best;
  }

 private:
  /// Measured costs go before guesses. Whether it was taken.
  static bool better(MaybeCost& best, const MaybeCost& cost) {
    if (!cost || (best && std::pair(best->guess, best->cpu) <= std::pair(cost->guess, cost->cpu))) return false;
    best = cost;
    return true;
  }

  static bool counts(const Line& line, const std::vector<Line>& all, double limit, ErrorOf error) {
    if (!line.done() || !std::isfinite(line.cpu) || !(line.*error <= limit)) return false;
    return std::all_of(all.begin(), all.end(), [&](const Line& finer) {
      return finer.setting >= line.setting || !finer.done() || finer.*error <= 2 * limit;
    });
  }

  static MaybeCost cheapest_of(const std::vector<Line>& lines, double limit, ErrorOf error) {
    MaybeCost best;
    double coarsest = 0;
    for (const Line& line : lines) {
      if (!counts(line, lines, limit, error)) continue;
      coarsest = std::max(coarsest, line.setting);
      better(best, Cost{line.cpu, true, false, line.method, line.setting});
    }
    for (const Line& line : lines)
      if (best && line.setting > coarsest && !line.cut_short()) best->bound = false;
    return best;
  }

  /// What the error at the two finest runs promises, when it falls with the cost like cost^-0.8 or better, nothing
  /// finer failed, and the promise is within 40 times the dearest run.
  static MaybeCost continued(const std::vector<Line>& all, double limit, ErrorOf error) {
    std::vector<Line> lines;
    for (const Line& line : all)
      if (line.done() && std::isfinite(line.cpu) && line.*error > 0) lines.push_back(line);
    if (lines.size() < 3) return {};
    std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.setting > b.setting; });
    const Line &before = lines[lines.size() - 2], &last = lines.back();
    for (const Line& line : all)
      if (line.setting < last.setting && !line.cut_short()) return {};
    if (last.cpu <= before.cpu || last.*error >= before.*error || last.*error <= limit) return {};
    const double order = std::log(before.*error / (last.*error)) / std::log(last.cpu / before.cpu);
    const double factor = std::pow(last.*error / limit, 1 / order);
    if (order < 0.8 || factor > 40) return {};
    return Cost{last.cpu * factor, false, true, last.method, last.setting};
  }

  std::vector<std::string> systems_;
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::vector<Line>>> methods_;
};

std::string rounded(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", x);
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

void write_markdown(std::ostream& out, const Table& table, const std::string& title, ErrorOf error) {
  out << "\n## " << title << "\n\n| mechanism | error |";
  for (const std::string& system : table.systems()) out << ' ' << system << " |";
  out << " best peer / lockstep | lockstep's method |\n|---|---|";
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
      std::string who;
      const MaybeCost ours = table.cheapest(m, kOurs, limit, error);
      out << ' ' << ratio(ours, table.best_peer(m, limit, error, who), any_peer) << " | "
          << (ours && !ours->guess ? ours->method + " @ " + rounded(ours->setting) : "") << " |\n";
    }
}

void write_csv(std::ostream& out, const Table& table) {
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
  const Table table(std::move(lines));
  std::ofstream markdown(argv[2]), csv(argv[3]);
  markdown
      << "# lockstep and its peers\n\n"
      << argv[1]
      << "\n\nUser CPU seconds a simulated second of the cheapest run within the error (m, largest over the bodies). "
         "`<=`: an upper bound, the next coarser run was not made. `never`: no run of any method came within it. "
         "Empty: not run.\n";
  write_markdown(markdown, table, "Largest error over the whole history (101 times)", &Line::error);
  write_markdown(markdown, table, "Error at the end", &Line::error_end);
  write_csv(csv, table);
  if (!markdown || !csv) return std::fprintf(stderr, "cannot write %s or %s\n", argv[2], argv[3]), 1;
  return 0;
}
