#include "framework/tools/analysis/doubts.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include <lockstep/text.h>
#include "framework/dynamics/solvers/graph.h"

namespace lockstep {

namespace {

constexpr double kUncertain = 1e-2;  // of a reaction
constexpr double kGrowth = 5;        // measured: an error of the motion becomes this, over the indicator, of a reaction
constexpr double kFixed = 1e-9;      // error of the motion for a method that promises none: that of its projection,
constexpr double kLeastError = 1e-13;  // and of one that promises more than rounding allows

}  // namespace

void Doubts::start(const Sample& sample) {
  loops_ = has_loops(sample.system(), sample.state.modes);
  unmet_ = {}, n_uncertain_ = 0;
  uncertain_.clear();
}

void Doubts::save(Snapshot& out) const {
  out.put(static_cast<double>(unmet_.steps)), out.put(unmet_.largest), out.put(unmet_.first);
  out.put(static_cast<double>(n_uncertain_));
  out.put_all(uncertain_);
}

void Doubts::load(SnapshotReader& in) {
  unmet_.steps = in.get_count(), unmet_.largest = in.get(), unmet_.first = in.get();
  n_uncertain_ = in.get_count();
  in.get_all(uncertain_);
}

void Doubts::step(const Sample& sample) { unmet_.count(sample.report.error, sample.state.t); }

// Beside a singular position, at the distance theta, an error of the motion appears in the extra direction divided by
// theta, and in what its velocity asks of the rows by theta once more; the indicator falls as theta^2. At a residual the
// rows themselves were not met.
void Doubts::output(const Sample& sample) {
  if (!reactions_ || !loops_ || (sample.state.coordinates && !sample.state.coordinates->has_rows())) return;
  const Solution& solution = sample.values();
  SolveReport report = solution.report;
  solution.factor.complete(report);
  const double error = tolerance_ > 0 ? std::max(tolerance_, kLeastError) : kFixed;
  if (!(std::max(kGrowth * error, report.residual) > kUncertain * report.detector)) return;
  ++n_uncertain_;
  if (uncertain_.size() < kNamed) uncertain_.push_back(sample.state.t);
}

std::vector<std::string> Doubts::words(long steps) const {
  constexpr double kMostRounding = 1e-7;  // relative error: beyond, it is not rounding that spoils a step
  std::vector<std::string> all;
  if (unmet_.steps > 0)
    all.push_back(fmt::format(
        "the tolerance of {:g} was not reached in {} of {} step{}, from t = {:.6g} s on: {} errors of up to {:.2g} "
        "times it there; the run went on with what can be reached",
        tolerance_, unmet_.steps, steps, steps == 1 ? "" : "s", unmet_.first,
        tolerance_ * unmet_.largest > kMostRounding ? "a singular position leaves" : "rounding leaves",
        unmet_.largest));
  if (const long n = n_uncertain_; n > 0)
    all.push_back(fmt::format(
        "the reactions at t = {}{} are uncertain by more than 1 %: {} in or beside a singular position, where they "
        "magnify the errors of the motion; look at those before and after",
        times_of(uncertain_, static_cast<std::size_t>(n)),
        n > static_cast<long>(kNamed) ? fmt::format(" ({} instants)", n) : "", n == 1 ? "it lies" : "they lie"));
  return all;
}

std::string times_of(const std::vector<double>& first, std::size_t n) {
  std::string words;
  const std::size_t shown = std::min(Doubts::kNamed, first.size());
  for (std::size_t k = 0; k < shown; ++k) words += fmt::format("{}{:.6g}", k > 0 ? ", " : "", first[k]);
  return words + (n > shown ? ", ... s" : " s");
}

std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 24;  // in one line
  if (names.size() <= kMost) return text::join(names);
  return fmt::format("{} and {} more", fmt::join(names.begin(), names.begin() + kMost, ", "), names.size() - kMost);
}

bool records_reactions(const RunSettings& run) {
  return std::ranges::any_of(run.record, [](const ChannelRequest& r) {
    return r.channel.find("_on_p_") != std::string::npos || r.channel.find("_on_s_") != std::string::npos ||
           r.channel.find(".lambda_") != std::string::npos;
  });
}

}  // namespace lockstep
