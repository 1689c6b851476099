// SPDX-License-Identifier: BSD-3-Clause
// Channels by formulas of channels.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <lockstep/error.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/scope.h"
#include "framework/tools/record/channel_entry.h"
#include "framework/tools/record/piece.h"
#include "framework/tools/record/smooth_parts.h"

namespace lockstep::channels {
namespace {

using expression::Expression;
using expression::FormulaFunction;
using expression::Function;
using expression::Node;
using expression::Operation;
using expression::Scope;

/// A formula of the motion up to an instant: of all of it, or of its last seconds.
class OfMotion {
 public:
  OfMotion(Function f, FormulaFunction of, double window, double instant)
      : f_(f), of_(std::move(of)), window_(window), instant_(instant) {}

  double now(std::span<const double> values) const { return of_(values); }  ///< at the state of these values

  void edges(std::span<const double> values, Row& out) const { of_.edges(values, out); }

  void begin(double t, double v) {
    pieces_.clear(), begin_ = t, at_ = v, total_ = is_sum() ? 0 : v;
    least_ = HUGE_VAL, most_ = -HUGE_VAL, off_ = n_off_ = 0;
    widen(v);
  }
  void widen(double v) {
    if (std::isfinite(v)) least_ = std::min(least_, v), most_ = std::max(most_, v);
  }
  bool fits(double misfit) const {
    constexpr double kMostNoisy = 3000;  // pieces that do not fit; of more, steps are not divided
    const double slack = kPart * (most_ - least_) + kNegligible * std::max(std::abs(most_), std::abs(least_));
    return n_off_ > kMostNoisy || misfit <= slack;
  }

  struct Seen : Piece {
    double whole = 0,  // part() of all of it
        off = 0;       // by how much it may differ
  };
  /// A part of a step; `at`: the value at an instant inside it. Of one that differs by `off` it is not asked for.
  template <class V>
  Seen seen(const Piece& p, double off, const V& at) const {
    return {p, part(p, p.t0, p.t1, at), off};
  }
  /// The parts of a step; of one that is seen again, up to where an event ends it, in place of what was seen.
  void add(const std::vector<Seen>& step, bool again) {
    if (again) {
      pieces_.erase(pieces_.end() - static_cast<std::ptrdiff_t>(n_last_), pieces_.end());
    } else if (window_ == kWhole) {
      for (const Seen& p : pieces_) total_ = with(p, begin_, HUGE_VAL, total_);
      pieces_.clear();
    }
    n_last_ = step.size();
    for (const Seen& p : step) {
      if (p.t0 <= instant_ && instant_ <= p.t1) at_ = p.at(instant_);
      if (p.off > 0) ++n_off_;
      if (is_sum()) off_ += p.off * (p.t1 - p.t0);
      if (!is_sum() && sign() * p.whole + p.off > (sign() > 0 ? most_ : -least_)) off_ = std::max(off_, p.off);
      pieces_.push_back(p);
    }
    while (pieces_.front().t1 < step.front().t0 - window_) pieces_.pop_front();  // windows begin inside the step too
  }
  bool is_resolved() const {
    constexpr double kPromised = 1e-4;  // of the range
    const double length = is_sum() && !pieces_.empty() ? pieces_.back().t1 - begin_ : 1;
    return off_ <= kPromised * (most_ - least_) * length || !(least_ < most_);
  }
  double value(double t, double present) const {
    if (f_ == Function("at")) return t < instant_ ? present : at_;
    const double from = std::max(begin_, t - window_), length = t - from;
    double total = window_ == kWhole ? total_ : is_sum() ? 0 : present;
    for (const Seen& p : pieces_) total = with(p, from, t, total);
    if (!is_sum()) return more(total, present);
    if (f_ == Function("integral")) return total;
    if (!(length > 0)) return f_ == Function("rms") ? std::abs(present) : present;
    return f_ == Function("mean") ? total / length : std::sqrt(total / length);
  }

  void save(Snapshot& out) const {
    for (const double x : {begin_, at_, total_, least_, most_, off_, n_off_, static_cast<double>(pieces_.size())})
      out.put(x);
    for (const Seen& p : pieces_) {
      out.put(p.t0), out.put(p.t1);
      for (const double x : p.v) out.put(x);
      out.put(p.whole);
    }
  }
  void load(SnapshotReader& in) {
    for (double* x : {&begin_, &at_, &total_, &least_, &most_, &off_, &n_off_}) *x = in.get();
    pieces_.resize(static_cast<std::size_t>(in.get_count()));
    for (Seen& p : pieces_) {
      p.t0 = in.get(), p.t1 = in.get();
      for (double& x : p.v) x = in.get();
      p.whole = in.get();
    }
  }

  static constexpr double kWhole = HUGE_VAL;

 private:
  bool is_sum() const { return f_ != Function("min") && f_ != Function("max"); }
  double sign() const { return f_ == Function("min") ? -1 : 1; }
  // What is NaN is left out.
  double more(double a, double b) const { return sign() * std::fmax(sign() * a, sign() * b); }
  // The integral or the extreme, with that of a piece between two times.
  double with(const Seen& p, double from, double to, double total) const {
    const double a = std::max(p.t0, from), b = std::min(p.t1, to);
    if (!(a < b)) return total;
    const double of = a == p.t0 && b == p.t1 ? p.whole : part(p, a, b, [&](double t) { return p.at(t); });
    return is_sum() ? total + of : more(total, of);
  }
  template <class V>
  double part(const Piece& p, double a, double b, const V& at) const {
    if (!is_sum()) return p.most(a, b, sign(), at);
    return p.integral(a, b, [&](double v) { return f_ == Function("rms") ? v * v : v; });
  }

  Function f_;
  FormulaFunction of_;
  double window_, instant_;
  std::deque<Seen> pieces_;                // of the last step, or of the window
  std::size_t n_last_ = 0;                 // of the last step
  double begin_ = 0, at_ = 0, total_ = 0;  // total_: of all before the pieces
  double least_ = 0, most_ = 0;            // of the values that were seen
  double off_ = 0, n_off_ = 0;             // by how much the pieces may differ; so many do
};

/// A formula of channels on the states of a run, which it follows for those that remember it.
class Computed final : public FormulaMemory {
 public:
  /// `margin`: of a condition, by how much it holds.
  Computed(System& system, const std::string& text, bool margin)
      : e_(text, kTime, expression::Naming::channels),
        system_(system),
        is_margin_(margin),
        scope_([this](const std::string& name) { return channel(name); }) {
    values_.resize(1);
    scope_.add("t", 0, dimension_of(Unit::time));
    scope_.add(system_.defined());
    const Node& root = e_.node(e_.root());
    const Operation o = root.operation;
    const bool below = o == Operation::less || o == Operation::less_equal;
    compares_ = margin && (below || o == Operation::greater || o == Operation::greater_equal);
    if (compares_) more_ = compiled(root.children[below ? 1 : 0]), formula_ = compiled(root.children[below ? 0 : 1]);
    if (!compares_) formula_ = compiled(e_.root());
    checked_unit(e_.root());
    unit_ = checked_unit(compares_ ? root.children[0] : e_.root());
  }

  const std::string& unit() const { return unit_; }

  double value(const Sample& s) {
    read_all(s);
    for (const auto& [k, x] : motions_) values_[k] = x->value(s.state.t, x->now(span()));
    const double v = formula_(span());
    return compares_ ? more_(span()) - v : is_margin_ ? (v != 0 ? 1.0 : -1.0) : v;
  }

  bool is_of_motion() const { return !motions_.empty(); }

  void edges(const Sample& s, std::vector<double>& out) override {
    value(s);
    formula_.edges(span(), out);
    if (compares_) more_.edges(span(), out);
    for (const auto& [k, x] : rates_) x.edges(span(), out);
  }
  bool is_resolved() const override {
    return std::ranges::all_of(motions_, [](const auto& m) { return m.second->is_resolved(); });
  }

  void start(const Sample& s) override {
    for (Observer* memory : memories_) memory->start(s);
    begin_row(s);
    for (std::size_t k = 0; k < motions_.size(); ++k) motions_[k].second->begin(s.state.t, last_[k + 1]);
  }
  void step(const Sample& s) override {
    for (Observer* memory : memories_) memory->step(s);
  }
  void jumped(const Sample& s) override {
    for (Observer* memory : memories_) memory->jumped(s);
    begin_row(s);
  }
  void inside(const InsideStep& step) override {
    if (!is_of_motion()) return;
    n_rows_ = 0, seen_.resize(motions_.size());
    for (std::vector<OfMotion::Seen>& each : seen_) each.clear();
    const bool again = step.begin() < last_[0];
    if (again)
      last_ = before_;
    else
      before_ = last_;
    const Row& end = row_of(step.end());
    const auto look = [&](double t) { return &row_of(step.at(t)); };
    const auto fits = [&](const Samples& rows, std::span<const Row* const> edge) { return resolve(rows, edge); };
    const auto take = [&](const Samples& rows, bool fitting) {
      Row off;
      for (std::size_t k = 1; k <= motions_.size(); ++k) {
        const OfMotion& x = *motions_[k - 1].second;
        if (fitting) seen_[k - 1].push_back(x.seen(Piece::of(rows, k), 0, [&](double t) { return (*look(t))[k]; }));
        const double misfit = Piece::misfit(rows, k);
        off.push_back(x.fits(misfit) ? 0 : std::fmax(0, misfit));
      }
      if (!fitting) add_lines(rows, off);
    };
    if (step.has_states())
      SmoothParts(motions_.size() + 1, look, fits, take).of_step(last_, end, step.along_laws() ? kAlongLaws : 1);
    else
      add_lines(std::array<const Row*, 2>{&last_, &end}, Row(motions_.size()));
    for (std::size_t k = 0; k < motions_.size(); ++k)  // once nothing can fail
      if (std::vector<OfMotion::Seen>& parts = seen_[k]; !parts.empty()) {
        double from = last_[0];
        for (OfMotion::Seen& p : parts) p.t0 = std::exchange(from, p.t1);  // no gap is left at an edge
        parts.back().t1 = end[0];
        motions_[k].second->add(parts, again);
      }
    last_ = end;
  }
  void save(Snapshot& out) const override {
    for (const auto& [k, x] : motions_) x->save(out);
    out.put_all(last_);
    for (const Observer* memory : memories_) memory->save(out);
  }
  void load(SnapshotReader& in) override {
    for (const auto& [k, x] : motions_) x->load(in);
    in.get_all(last_);
    for (Observer* memory : memories_) memory->load(in);
  }

 private:
  static inline const std::vector<std::string> kTime{"t"};
  std::span<const double> span() const { return values_; }

  void read(const Sample& s) {
    values_[0] = s.state.t;
    for (std::size_t i = 0; i < channels_.size(); ++i) values_[places_[i]] = channels_[i].value(s);
  }

  // With the rates, which are of a state too.
  void read_all(const Sample& s) {
    read(s);
    for (const auto& [k, x] : rates_) values_[k] = rate(x, s);
  }

  // -- the motion inside a step
  void begin_row(const Sample& s) {
    n_rows_ = 0;
    if (is_of_motion()) last_ = row_of(s);
  }
  Row& row_of(const Sample& s) {
    if (n_rows_ == rows_.size()) rows_.emplace_back();
    Row& row = rows_[n_rows_++];
    read_all(s);
    row.assign(1, s.state.t);
    for (const auto& [k, x] : motions_) row.push_back(x->now(span()));
    for (const auto& [k, x] : motions_) x->edges(span(), row);
    return row;
  }
  bool resolve(const Samples& rows, std::span<const Row* const> edge) {
    bool fits = true;
    for (std::size_t k = 0; k < motions_.size(); ++k) {
      for (const Row* row : rows) motions_[k].second->widen((*row)[k + 1]);
      fits = fits && motions_[k].second->fits(Piece::misfit(rows, k + 1, edge));
    }
    return fits;
  }
  // What no polynomial fits: no value is invented beyond those that were seen.
  void add_lines(std::span<const Row* const> rows, const Row& off) {
    for (std::size_t i = 1; i < rows.size(); ++i)
      for (std::size_t k = 0; k < motions_.size(); ++k) {
        const Row &a = *rows[i - 1], &b = *rows[i];
        const Piece p = Piece::line(a[0], b[0], a[k + 1], b[k + 1]);
        seen_[k].push_back(motions_[k].second->seen(p, off[k], [&](double t) { return p.at(t); }));
      }
  }

  FormulaFunction compiled(int node) {
    return scope_.compiled(e_, node, [this](const Node& n) { return of_motion(n); });
  }

  // A channel by its name.
  expression::Meaning channel(const std::string& name) {
    const Channel& c = channels_.emplace_back(make_channel(system_, name));
    if (c.memory) memories_.push_back(c.memory.get());
    places_.push_back(new_place());
    const std::optional<Dimension> d = c.unit.empty() ? Dimension{} : dimension_of(c.unit);
    return expression::Meaning::of_variable(places_.back(), d, true);
  }

  int new_place() {
    values_.push_back(0);
    return static_cast<int>(values_.size()) - 1;
  }

  // -- functions of the motion
  int of_motion(const Node& n) {
    const int place = new_place();
    if (n.function == Function("rate")) {
      rates_.emplace_back(place, scope_.compiled(e_, n.children[0]));
      return place;
    }
    if (n.function == Function("last"))
      e_.refuse(n, "last(x, T) is an argument of min, max, mean, rms or integral, as in mean(last(x, 2 s))");
    int of = n.children[0];
    double window = OfMotion::kWhole, instant = HUGE_VAL;
    if (const Node& inner = e_.node(of); inner.operation == Operation::call && inner.function == Function("last"))
      window = time_of(inner), of = inner.children[0];
    if (n.function == Function("at")) instant = time_of(n);
    const auto rate_of = [this](const Node& part) { return part.function == Function("rate") ? of_motion(part) : -1; };
    motions_.emplace_back(place,
                          std::make_shared<OfMotion>(n.function, scope_.compiled(e_, of, rate_of), window, instant));
    return place;
  }
  double time_of(const Node& call) {
    const FormulaFunction t = scope_.compiled(e_, call.children[1]);
    const double value = t.is_constant() ? t(span()) : NAN;
    if (!(value >= 0)) e_.refuse(e_.node(call.children[1]), "a constant time is expected, 0 or more");
    return value;
  }

  // By differences of order four along the motion.
  double rate(const FormulaFunction& x, const Sample& s) {
    constexpr double kPart = 1e-3, kFirst = 1e-2;  // of the last step, or of this time, s
    const double h = kPart * (s.report.h > 0 ? s.report.h : kFirst);
    Dynamics& dynamics = s.dynamics();
    State at = s.state;
    dynamics.to_slots(at);
    StateRate rate = sized_like(at);
    dynamics.rate(at, rate);
    s.forget();
    double sum = 0;
    for (const auto& [by, weight] : {std::pair(1, 8.0), {-1, -8.0}, {2, -1.0}, {-2, 1.0}}) {
      const double d = by * h;
      State near = at;
      dynamics.advance(near, d, at.v + 0.5 * d * rate.v);
      near.v += d * rate.v, near.t += d;
      near.s += d * rate.s;
      dynamics.normalize(near);
      read(Sample(dynamics, near, s.report));
      sum += weight * x(span());
    }
    read(s);
    return sum / (12 * h);
  }

  std::string checked_unit(int node) {
    const std::optional<expression::Amount> q = scope_.dimension_of(e_, node, "", true);
    return !q || q->any ? "" : expression::unit_of(*q);
  }

  const Expression e_;
  System& system_;
  FormulaFunction formula_, more_;  // more_: the greater side of a comparison
  bool is_margin_, compares_ = false;
  std::string unit_;
  std::vector<double> values_;  // the time, channels, functions of the motion
  std::vector<Channel> channels_;
  std::vector<Observer*> memories_;  // of the channels
  std::vector<int> places_;  // of the channels among the values
  std::vector<std::pair<int, std::shared_ptr<OfMotion>>> motions_;
  Row before_, last_;                              // the ends of the last step: values of motions_, their edges
  std::deque<Row> rows_;                           // of the present step
  std::size_t n_rows_ = 0;                         // of them
  std::vector<std::vector<OfMotion::Seen>> seen_;  // its parts, of each of motions_
  std::vector<std::pair<int, FormulaFunction>> rates_;
  Scope scope_;
};

}  // namespace

Channel computed_channel(System& system, const std::string& formula, bool margin) {
  const auto all = std::make_shared<Computed>(system, formula, margin);
  return {formula, all->unit(), [all](const Sample& s) { return all->value(s); }, all, all->is_of_motion()};
}

}  // namespace lockstep::channels
