// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/detail_rows.h"

#include <limits>

#include <lockstep/error.h>
#include <lockstep/finding.h>
#include "framework/dynamics/simulate/uncounted.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPictureRows = 600;
constexpr std::size_t kMostKept = 20000;  // with those at jumps

const std::vector<double>& times(const Table& table) { return table.columns().front().values; }

}  // namespace

PictureRows::PictureRows(std::unique_ptr<Recorder> own, const Recorder& rows, double spacing)
    : RowsAtJumps([this](const Sample& s) { add(s, true); }, rows), own_(std::move(own)), spacing_(spacing) {}

void PictureRows::start(const Sample& sample) {
  own_->start(sample);
  last_ = sample.state.t, n_between_ = n_steps_ = 0;
  of_jump_.clear();
}

// Without dense output the ends of steps are all there is.
void PictureRows::step(const Sample& sample) {
  own_->step(sample);
  ++n_steps_;
  if (n_between_ == 0 && sample.state.t - last_ >= spacing_) add(sample, false);
}

// On the grid of its spacing, after columns of the motion have read the step. A state that cannot be made is left out.
void PictureRows::inside(const InsideStep& step) {
  const double h = spacing_, from = step.begin(), to = step.end().state.t;
  const auto looking = uncounted(step.end().dynamics());
  own_->inside(step);
  if (!std::isfinite(h) || !step.has_states()) return;
  for (double k = std::floor(from / h) + 1; k * h < to; ++k)
    if (k * h > from) succeeds([&] { n_between_ += add(step.at(k * h), false) ? 1 : 0; });
}

void PictureRows::jumped(const Sample& sample) {
  own_->jumped(sample);
  RowsAtJumps::jumped(sample);
}

void PictureRows::save(Snapshot& out) const {
  own_->save(out);
  out.put(last_), RowsAtJumps::save(out);
  out.put(static_cast<double>(n_between_)), out.put(static_cast<double>(n_steps_));
  for (const bool jump : of_jump_) out.put(jump ? 1 : 0);
}

void PictureRows::load(SnapshotReader& in) {
  own_->load(in);
  last_ = in.get(), RowsAtJumps::load(in);
  n_between_ = in.get_count(), n_steps_ = in.get_count();
  of_jump_.resize(own_->table().n_rows());
  for (std::size_t i = 0; i < of_jump_.size(); ++i) of_jump_[i] = in.get_flag();
}

// Rows that cannot be computed are left out of the picture. The run must not depend on whether there is one, so this
// solution is not counted, and observers of the run solve again.
bool PictureRows::add(const Sample& sample, bool of_jump) {
  if (of_jump_.size() == kMostKept) return false;
  const auto looking = uncounted(sample.dynamics());
  const FindingScope unheard;  // the run's own rows report them
  Sample own(sample.dynamics(), sample.state, sample.report);
  own.cause = sample.cause;
  try {
    own_->output(own);
    of_jump_.push_back(of_jump);
    last_ = sample.state.t;
    return true;
  } catch (const Error&) {
    return false;
  }
}

// Of rows at one time the table's own come first: they show the values before a jump. Rows within steps that nearly
// meet one of its own are left out: a line between points that only rounding separates has spikes.
Table PictureRows::together(const Table& main) const {
  const Table& more = own_->table();
  Table all;
  std::vector<const std::vector<double>*> of_main, of_more;
  for (const Column& c : more.columns())
    all.add_column(c.name, c.unit), of_main.push_back(&main[c.name]), of_more.push_back(&c.values);
  all.reserve(main.n_rows() + more.n_rows());
  std::vector<double> row(more.n_columns());
  const auto take = [&](const std::vector<const std::vector<double>*>& from, std::size_t i) {
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = (*from[k])[i];
    all.add_row(row);
  };
  const std::vector<double>& own = times(main);
  const auto meets = [&](double t, std::size_t i) {
    const double near = 0.1 * spacing_;
    return (i > 0 && t - own[i - 1] < near) || (i < own.size() && own[i] - t < near);
  };
  std::size_t j = 0;
  for (std::size_t i = 0; i <= own.size(); ++i) {
    for (; j < more.n_rows() && (i == own.size() || times(more)[j] < own[i]); ++j)
      if (of_jump_[j] || !meets(times(more)[j], i)) take(of_more, j);
    if (i < own.size()) take(of_main, i);
  }
  return all;
}

double picture_spacing(const StepLoopOptions& options, double until) {
  const double spacing = until / kPictureRows;
  const bool dense = options.output_times.empty() && options.output > 0 && options.output <= spacing;
  return dense || !(spacing > 0) ? kInfinity : spacing;
}

}  // namespace lockstep
