// SPDX-License-Identifier: BSD-3-Clause
// Channels by formulas of channels.
#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <optional>

#include <lockstep/error.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/quantity.h"
#include "framework/mechanism/expression/quotes.h"
#include "framework/tools/record/channel_entry.h"
#include "framework/tools/record/piece.h"

namespace lockstep::channels {
namespace {

using expression::Expression;
using expression::FormulaFunction;
using expression::Function;
using expression::Meaning;
using expression::Node;
using expression::Operation;

/// A formula of the motion up to an instant: of all of it, or of its last seconds.
class OfMotion {
 public:
  OfMotion(Function f, FormulaFunction of, double window, double instant)
      : f_(f), of_(std::move(of)), window_(window), instant_(instant) {}

  double now(std::span<const double> values) const { return of_(values); }  ///< at the state of these values

  void begin(double t, double v) { pieces_.clear(), begin_ = t, last_ = at_ = v, total_ = is_sum() ? 0 : v; }
  void jump(double v) { last_ = v; }
  double last() const { return last_; }  ///< at the end of the last step
  void add(Piece p) {
    p.v[0] = last_, last_ = p.v.back();
    if (p.t0 <= instant_ && instant_ <= p.t1) at_ = p.at(instant_);
    if (window_ == kWhole && !pieces_.empty())
      total_ = with(pieces_.front(), begin_, HUGE_VAL, total_), pieces_.clear();
    pieces_.push_back(p);
    while (pieces_.front().t1 < p.t1 - window_) pieces_.pop_front();
  }
  double value(double t, double present) const {
    if (f_ == Function::at) return t < instant_ ? present : at_;
    const double from = std::max(begin_, t - window_), length = t - from;
    double total = window_ == kWhole ? total_ : is_sum() ? 0 : present;
    for (const Piece& p : pieces_) total = with(p, from, t, total);
    if (!is_sum()) return sign() * std::max(sign() * total, sign() * present);
    if (f_ == Function::integral) return total;
    if (!(length > 0)) return f_ == Function::rms ? std::abs(present) : present;
    return f_ == Function::mean ? total / length : std::sqrt(total / length);
  }

  void save(Snapshot& out) const {
    for (const double x : {begin_, last_, at_, total_, static_cast<double>(pieces_.size())}) out.put(x);
    for (const Piece& p : pieces_) {
      out.put(p.t0), out.put(p.t1);
      for (const double x : p.v) out.put(x);
    }
  }
  void load(SnapshotReader& in) {
    for (double* x : {&begin_, &last_, &at_, &total_}) *x = in.get();
    pieces_.resize(static_cast<std::size_t>(in.get_count()));
    for (Piece& p : pieces_) {
      p.t0 = in.get(), p.t1 = in.get();
      for (double& x : p.v) x = in.get();
    }
  }

  static constexpr double kWhole = HUGE_VAL;

 private:
  bool is_sum() const { return f_ != Function::min && f_ != Function::max; }
  double sign() const { return f_ == Function::min ? -1 : 1; }
  // The integral or the extreme, with that of a piece between two times.
  double with(const Piece& p, double from, double to, double total) const {
    const double a = std::max(p.t0, from), b = std::min(p.t1, to);
    if (!(a < b)) return total;
    if (!is_sum()) return sign() * std::max(sign() * total, sign() * p.most(a, b, sign()));
    return total + p.integral(a, b, [&](double v) { return f_ == Function::rms ? v * v : v; });
  }

  Function f_;
  FormulaFunction of_;
  double window_, instant_;
  std::deque<Piece> pieces_;  // the last, or those of the window
  double begin_ = 0, last_ = 0, at_ = 0, total_ = 0;  // total_: of all before the pieces
};

/// A formula of channels on the states of a run.
class Computed {
 public:
  /// `margin`: of a condition, by how much it holds.
  Computed(System& system, const std::string& text, bool margin)
      : e_(text, kTime, expression::Naming::channels), system_(system), is_margin_(margin) {
    values_.resize(1);
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
    read(s);
    for (const auto& [k, x] : motions_) values_[k] = x->value(s.state.t, x->now(span()));
    for (const auto& [k, x] : rates_) values_[k] = rate(x, s);
    const double v = formula_(span());
    return compares_ ? more_(span()) - v : is_margin_ ? (v != 0 ? 1.0 : -1.0) : v;
  }

  bool is_of_motion() const { return !motions_.empty(); }

  void track(const Sample& s) {
    for (Channel& c : channels_)
      if (c.track) c.track(s);
    if (begun_ || motions_.empty()) return;
    begun_ = true;
    read(s);
    for (const auto& [k, x] : motions_) x->begin(s.state.t, x->now(span()));
  }
  void jumped(const Sample& s) {
    for (Channel& c : channels_)
      if (c.jumped) c.jumped(s);
    read(s);
    for (const auto& [k, x] : motions_) x->jump(x->now(span()));
  }
  void inside(const InsideStep& step) {
    std::vector<Piece> pieces(motions_.size(), Piece{step.begin(), step.end().state.t});
    if (pieces.empty()) return;
    const auto take = [&](int k, const Sample& s) {
      read(s);
      for (std::size_t i = 0; i < pieces.size(); ++i) pieces[i].v[k] = motions_[i].second->now(span());
    };
    take(Piece::kNodes - 1, step.end());
    for (int k = 1; k + 1 < Piece::kNodes && step.has_states(); ++k) take(k, step.at(pieces[0].t(k)));
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      Piece& p = pieces[i];
      const double from = motions_[i].second->last();
      for (int k = 1; k + 1 < Piece::kNodes && !step.has_states(); ++k)
        p.v[k] = from + (p.v.back() - from) * k / (Piece::kNodes - 1);
      motions_[i].second->add(p);
    }
  }
  void restart() {
    begun_ = false;
    for (Channel& c : channels_)
      if (c.restart) c.restart();
  }
  void save(Snapshot& out) const {
    out.put(begun_ ? 1 : 0);
    for (const auto& [k, x] : motions_) x->save(out);
    for (const Channel& c : channels_)
      if (c.save) c.save(out);
  }
  void load(SnapshotReader& in) {
    begun_ = in.get_flag();
    for (const auto& [k, x] : motions_) x->load(in);
    for (Channel& c : channels_)
      if (c.load) c.load(in);
  }

 private:
  static inline const std::vector<std::string> kTime{"t"};
  std::span<const double> span() const { return values_; }

  void read(const Sample& s) {
    values_[0] = s.state.t;
    for (std::size_t i = 0; i < channels_.size(); ++i) values_[places_[i]] = channels_[i].value(s);
  }

  FormulaFunction compiled(int node) {
    return {e_, node, meanings(), [this](const Node& n) { return of_motion(n); }};
  }

  // -- names
  expression::Meanings meanings() {
    return [this](const Node& n) { return meaning(n); };
  }

  // A name in quotes is that of a channel.
  Meaning meaning(const Node& n) {
    if (n.name == "t") return note(n.name, Meaning{false, 0}, "s", false);
    if (const auto known = meanings_.find(n.name); known != meanings_.end()) return known->second;
    if (const auto constant = constant_of(n.name)) return note(n.name, constant->first, constant->second, true);
    const std::string called = expression::without_quotes(n.name);
    std::exception_ptr unknown;
    try {
      const Channel c = make_channel(system_, called);
      return note(n.name, Meaning{false, place_of(c)}, c.unit, true);
    } catch (const ModelError&) {
      unknown = std::current_exception();
    }
    for (const char* between : {"_", ".", ""})
      if (const auto v = vector_of(called + between)) return note(n.name, Meaning{true, v->first}, v->second, true);
    if (const std::size_t dot = called.rfind('.'); dot + 2 == called.size())
      if (const std::size_t k = std::string_view("xyz").find(called[dot + 1]); k != std::string::npos) {
        const std::string name = called.substr(0, dot);
        for (const char* between : {"_", ""})
          if (const auto v = vector_of(name + between))
            return note(n.name, Meaning{false, v->first + static_cast<int>(k)}, v->second, true);
      }
    try {
      std::rethrow_exception(unknown);
    } catch (const ModelError& error) {
      e_.refuse(n, error.what());
    }
  }

  // A number or vector of System::define(), or a component of one, with its unit.
  std::optional<std::pair<Meaning, std::string>> constant_of(const std::string& name) const {
    for (const NamedNumbers& c : system_.defined()) {
      Meaning m{c.values.size() == 3, -1, {c.values[0], c.values.back(), c.values.back()}};
      if (m.is_vector) m.value[1] = c.values[1];
      if (c.name == name) return std::pair(m, c.unit);
      for (std::size_t k = 0; m.is_vector && k < 3; ++k)
        if (name == c.name + "." + kAxisName[k]) return std::pair(Meaning{false, -1, {c.values[k]}}, c.unit);
    }
    return std::nullopt;
  }

  // The place of the first of three channels.
  std::optional<std::pair<int, std::string>> vector_of(const std::string& begin) {
    const std::size_t at = begin.find('@');
    if (at != std::string::npos) return std::nullopt;
    std::vector<Channel> found;
    try {
      for (const char* axis : kAxisName) found.push_back(make_channel(system_, begin + axis));
    } catch (const ModelError&) {
      return std::nullopt;
    }
    const auto first = static_cast<int>(values_.size());
    values_.resize(values_.size() + 3);
    for (int k = 0; k < 3; ++k) places_.push_back(first + k), channels_.push_back(found[k]);
    return std::pair(first, found[0].unit);
  }

  int place_of(const Channel& c) {
    channels_.push_back(c), places_.push_back(static_cast<int>(values_.size()));
    values_.push_back(0);
    return places_.back();
  }

  Meaning note(const std::string& name, const Meaning& m, const std::string& unit, bool strict) {
    meanings_[name] = m;
    expression::Amount& q = amounts_[name];
    const std::optional<Dimension> d = unit.empty() ? Dimension{} : dimension_of(unit);
    has_unknown_ = has_unknown_ || !d;
    q.is_vector = m.is_vector, q.v = Vec3::Ones();
    q.dimension = expression::exponents_of(d.value_or(Dimension{}));
    q.measured = m.variable >= 0 || !unit.empty(), q.with_unit = strict && q.measured;
    return m;
  }

  // -- functions of the motion
  int of_motion(const Node& n) {
    const auto place = static_cast<int>(values_.size());
    values_.push_back(0);
    if (n.function == Function::rate) {
      rates_.emplace_back(place, FormulaFunction(e_, n.children[0], meanings()));
      return place;
    }
    if (n.function == Function::last)
      e_.refuse(n, "last(x, T) is an argument of min, max, mean, rms or integral, as in mean(last(x, 2 s))");
    int of = n.children[0];
    double window = OfMotion::kWhole, instant = HUGE_VAL;
    if (const Node& inner = e_.node(of); inner.operation == Operation::call && inner.function == Function::last)
      window = time_of(inner), of = inner.children[0];
    if (n.function == Function::at) instant = time_of(n);
    motions_.emplace_back(place,
                          std::make_shared<OfMotion>(n.function, FormulaFunction(e_, of, meanings()), window, instant));
    return place;
  }
  double time_of(const Node& call) {
    const FormulaFunction t(e_, call.children[1], meanings());
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

  std::string checked_unit(int node) const {
    if (has_unknown_) return "";
    const auto amount = [this](const std::string& name) -> const expression::Amount* {
      const auto found = amounts_.find(name);
      return found != amounts_.end() ? &found->second : nullptr;
    };
    const auto varies = [this](const std::string& name) {
      const auto found = meanings_.find(name);
      return found != meanings_.end() && found->second.variable >= 0;
    };
    const expression::Amount q = expression::dimension_of(e_, node, amount, varies, "", true);
    return q.any ? "" : expression::unit_of(q);
  }

  const Expression e_;
  System& system_;
  FormulaFunction formula_, more_;  // more_: the greater side of a comparison
  bool is_margin_, compares_ = false;
  std::string unit_;
  std::vector<double> values_;  // the time, channels, functions of the motion
  std::vector<Channel> channels_;
  std::vector<int> places_;  // of the channels among the values
  std::vector<std::pair<int, std::shared_ptr<OfMotion>>> motions_;
  std::vector<std::pair<int, FormulaFunction>> rates_;
  std::map<std::string, Meaning> meanings_;
  std::map<std::string, expression::Amount> amounts_;
  bool has_unknown_ = false, begun_ = false;
};

}  // namespace

namespace {

Channel channel_of(const std::string& formula, const std::shared_ptr<Computed>& all) {
  Channel c{formula, all->unit(), [all](const Sample& s) { return all->value(s); }};
  c.track = [all](const Sample& s) { all->track(s); };
  c.restart = [all] { all->restart(); };
  c.save = [all](Snapshot& out) { all->save(out); };
  c.load = [all](SnapshotReader& in) { all->load(in); };
  if (!all->is_of_motion()) return c;
  c.inside = [all](const InsideStep& step) { all->inside(step); };
  c.jumped = [all](const Sample& s) { all->jumped(s); };
  return c;
}

}  // namespace

Channel computed_channel(System& system, const std::string& formula) {
  return channel_of(formula, std::make_shared<Computed>(system, formula, false));
}
Channel margin_channel(System& system, const std::string& condition) {
  return channel_of(condition, std::make_shared<Computed>(system, condition, true));
}

}  // namespace lockstep::channels
