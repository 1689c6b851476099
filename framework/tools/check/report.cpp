// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/tools/check/compare.h"

namespace lockstep {

void CheckReport::add(const std::string& key, CheckFinding finding, double weight) {
  const auto at = std::find_if(keys_.begin(), keys_.end(), [&](const Key& k) { return k.key == key; });
  if (at == keys_.end()) {
    keys_.push_back({key, weight});
    findings_.push_back(std::move(finding));
  } else if (weight > at->weight) {
    at->weight = weight;
    findings_[at - keys_.begin()] = std::move(finding);
  }
}

void CheckReport::note(std::string words) {
  const auto what = [](const std::string& note) { return std::string_view(note).substr(0, note.find(" at ")); };
  if (std::ranges::find(notes_, what(words), what) == notes_.end()) notes_.push_back(std::move(words));
}

void CheckReport::compared(double error) {
  constexpr double kBlind = 0.1;  // differences without a digit are not used
  ++n_comparisons_;
  if (!std::isfinite(error)) return;
  if (error >= kBlind)
    ++n_omitted_;
  else
    accuracy_ = std::max(accuracy_, error);
}

void CheckReport::take(const CheckReport& other) {
  for (std::size_t i = 0; i < other.findings_.size(); ++i)
    add(other.keys_[i].key, other.findings_[i], other.keys_[i].weight);
  for (const std::string& words : other.notes_) note(words);
  n_comparisons_ += other.n_comparisons_, n_omitted_ += other.n_omitted_;
  accuracy_ = std::max(accuracy_, other.accuracy_);
}

std::string CheckReport::text() const {
  constexpr std::size_t kMost = 20;
  std::string out = subject_ + ": ";
  if (ok()) {
    out += fmt::format("no findings in {} comparisons (seed {}", n_comparisons_, seed_);
    if (accuracy_ > 0) out += fmt::format("; finite differences accurate to {:.1g} or better", accuracy_);
    if (n_omitted_ > 0) out += fmt::format("; {} too inaccurate to compare", n_omitted_);
    out += ")\n";
  } else {
    out += fmt::format("{} {} (seed {})\n", findings_.size(), findings_.size() == 1 ? "finding" : "findings", seed_);
  }
  for (std::size_t i = 0; i < std::min(findings_.size(), kMost); ++i) {
    out += "  " + findings_[i].what;
    if (!findings_[i].look.empty()) out += "; look at " + findings_[i].look;
    out += "\n";
  }
  if (findings_.size() > kMost) out += fmt::format("  and {} more\n", findings_.size() - kMost);
  for (const std::string& words : notes_) out += "  note: " + words + "\n";
  return out;
}

std::string likeness(double is, double should_be) {
  const auto near = [&](double x) { return std::abs(is - x) <= 1e-5 * std::max(std::abs(is), std::abs(x)); };
  if (is == 0 && should_be != 0) return ", so it is missing";
  if (should_be == 0) return "";
  if (near(-should_be)) return ", so it has the wrong sign";
  if (near(0.5 * should_be)) return ", so it is half the value: a factor of 2 is missing";
  if (near(2 * should_be)) return ", so it is twice the value: a factor of 2 is superfluous";
  return "";
}

bool completes(CheckReport& report, const std::function<void()>& act, const std::function<std::string()>& where) {
  try {
    act();
    return true;
  } catch (const UserCodeError& error) {
    const std::string place = where ? where() : "";
    report.add("threw", {error.what() + (place.empty() ? "" : " (near " + place + ")"), ""});
    return false;
  }
}

bool compare(CheckReport& report, const Declared& d, const Slope& slope) {
  bool found = false;
  for (int c = 0; c < d.is.size(); ++c) {
    const double off = std::abs(d.is[c] - slope.value[c]);
    const double size = std::max({std::abs(d.is[c]), std::abs(slope.value[c]), d.size[c]});
    const auto rounded = [&](double x) { return std::abs(x) <= kRounding * size ? 0.0 : x; };
    const double is = rounded(d.is[c]), should_be = rounded(slope.value[c]);
    report.compared(size > 0 ? slope.error[c] / size : 0);
    if (!(off > slope.error[c] + d.rounding * size)) continue;
    found = true;
    report.add(fmt::format("{} {}", d.key, c / d.kind),
               {fmt::format("{} is {:.6g}, {} {:.6g}{}{}", d.what(c), is, d.source, should_be, likeness(is, should_be),
                            d.where),
                d.look(c)},
               off);
  }
  return found;
}

}  // namespace lockstep
