// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/peers/costs.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/benchmark/peers/mechanisms.h"

namespace lockstep::peers {

namespace {

/// The number after "key=" in a text, 0 when absent.
double number_after(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key + "=");
  return at == std::string::npos ? 0 : std::stod(text.substr(at + key.size() + 1));
}

/// Measured costs go before guesses.
void take_better(MaybeCost& best, const MaybeCost& cost) {
  if (cost && (!best || std::pair(cost->guess, cost->cpu) < std::pair(best->guess, best->cpu))) best = cost;
}

bool counts(const Line& line, const std::vector<Line>& all, double limit, ErrorOf error) {
  if (!line.done() || !std::isfinite(line.cpu) || !(line.*error <= limit)) return false;
  return std::all_of(all.begin(), all.end(), [&](const Line& finer) {
    return finer.setting >= line.setting || (finer.done() ? finer.*error <= 2 * limit : !finer.wrong());
  });
}

}  // namespace

bool Line::wrong() const {
  return status.rfind("NaN", 0) == 0 || status.rfind("blown-up", 0) == 0 || status.rfind("incomplete", 0) == 0;
}

std::vector<Line> read_lines(const std::string& path) {
  std::vector<Line> lines;
  std::ifstream in(path);
  for (std::string text; std::getline(in, text);) {
    std::istringstream cells(text);
    std::vector<std::string> c;
    for (std::string cell; std::getline(cells, cell, ',');) c.push_back(cell);
    if (c.size() < 10 || c[0] == "peer") continue;
    lines.push_back({c[0], c[1], c[2], c[9], std::stod(c[3]), std::stod(c[4]), std::stod(c[5]), std::stod(c[6]),
                     number_after(c[9], "steps"),
                     number_after(c[9], "evaluations") + number_after(c[9], "realizations")});
  }
  return lines;
}

MaybeCost cheapest_of(const std::vector<Line>& method, double limit, ErrorOf error) {
  MaybeCost best;
  double coarsest = 0;
  for (const Line& line : method) {
    if (!counts(line, method, limit, error)) continue;
    coarsest = std::max(coarsest, line.setting);
    take_better(best, Cost{line.cpu, true, false, line.method, line.setting});
  }
  for (const Line& line : method)
    if (best && line.setting > coarsest && !line.cut_short()) best->bound = false;
  return best;
}

MaybeCost continued(const std::vector<Line>& method, double limit, ErrorOf error) {
  std::vector<Line> lines;
  for (const Line& line : method)
    if (line.done() && std::isfinite(line.cpu) && line.*error > 0) lines.push_back(line);
  if (lines.size() < 3) return {};
  std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.setting > b.setting; });
  const Line &before = lines[lines.size() - 2], &last = lines.back();
  for (const Line& line : method)
    if (line.setting < last.setting && !line.cut_short()) return {};
  if (last.cpu <= before.cpu || last.*error >= before.*error || last.*error <= limit) return {};
  const double order = std::log(before.*error / (last.*error)) / std::log(last.cpu / before.cpu);
  const double factor = std::pow(last.*error / limit, 1 / order);
  if (order < 0.8 || factor > 40) return {};
  return Cost{last.cpu * factor, false, true, last.method, last.setting};
}

Costs::Costs(const std::vector<Line>& lines) {
  for (const Line& line : lines) {
    if (std::find(systems_.begin(), systems_.end(), line.system) == systems_.end()) systems_.push_back(line.system);
    methods_[{line.mechanism, line.system}][line.method].push_back(line);
  }
  std::stable_sort(systems_.begin(), systems_.end(),
                   [](const std::string& a, const std::string& b) { return (a == kOurs) > (b == kOurs); });
}

std::vector<std::string> Costs::mechanisms() const {
  std::vector<Mechanism> all = all_mechanisms();
  std::stable_sort(all.begin(), all.end(), [](const Mechanism& a, const Mechanism& b) { return a.kind < b.kind; });
  std::vector<std::string> names;
  for (const Mechanism& m : all)
    if (std::any_of(systems_.begin(), systems_.end(), [&](const std::string& s) { return tried(m.name, s); }))
      names.push_back(m.name);
  return names;
}

std::map<std::string, std::vector<Line>> Costs::methods(const std::string& mechanism, const std::string& system) const {
  const auto found = methods_.find({mechanism, system});
  return found == methods_.end() ? std::map<std::string, std::vector<Line>>() : found->second;
}

bool Costs::tried(const std::string& mechanism, const std::string& system) const {
  return methods_.count({mechanism, system}) > 0;
}

MaybeCost Costs::cheapest(const std::string& mechanism, const std::string& system, double limit, ErrorOf error) const {
  MaybeCost best;
  for (const auto& [name, lines] : methods(mechanism, system)) take_better(best, cheapest_of(lines, limit, error));
  if (best) return best;
  for (const auto& [name, lines] : methods(mechanism, system)) take_better(best, continued(lines, limit, error));
  return best;
}

MaybeCost Costs::best_peer(const std::string& mechanism, double limit, ErrorOf error) const {
  MaybeCost best;
  for (const std::string& system : systems_)
    if (system != kOurs) take_better(best, cheapest(mechanism, system, limit, error));
  return best;
}

}  // namespace lockstep::peers
