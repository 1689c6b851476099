// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <algorithm>
#include <utility>

#include "motionlaws/law_types.h"
#include "motionlaws/side.h"

namespace lockstep {
namespace {

class Sequence final : public MotionLaw {
 public:
  Sequence(std::vector<Piece> pieces, const SequenceSettings& k) : pieces_(std::move(pieces)), k_(k) {
    require_finite("sequence", "t0", k.t0);
    require(!pieces_.empty(), "sequence", "laws", "are missing; give at least one");
    double t = k.t0, y = 0;
    for (const Piece& piece : pieces_) {
      require_law("sequence", "laws", piece.law);
      require_positive("sequence", "durations", piece.duration);
      const bool first = start_.empty();
      start_.push_back(t);
      offset_.push_back(k.chained && !first ? y - piece.law->at(0).y : 0.0);
      y = piece.law->at(piece.duration).y + offset_.back();
      t += piece.duration;
    }
    start_.push_back(t);
  }
  LawValue at(double t) const override {
    const double early = kEarly * (start_.back() - start_.front());
    if (!k_.run_on) {
      if (t < start_.front() - early) return held(pieces_.front().law->at(0).y);
      if (t >= start_.back() - early) return held(pieces_.back().law->at(pieces_.back().duration).y + offset_.back());
    }
    const auto next = std::upper_bound(start_.begin() + 1, start_.end() - 1, t + early);
    const auto i = static_cast<std::size_t>(next - start_.begin()) - 1;
    const double own = t - start_[i];
    return raised(pieces_[i].law->at(own < 0 && own >= -early ? 0.0 : own), offset_[i]);
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (std::size_t i = k_.run_on ? 1 : 0; i < start_.size() - (k_.run_on ? 1 : 0); ++i)
      if (t0 < start_[i] && start_[i] < t1) out.push_back(start_[i]);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const bool on_left = k_.run_on && i == 0, on_right = k_.run_on && i + 1 == pieces_.size();
      const Part part{*pieces_[i].law, start_[i], on_left ? -HUGE_VAL : 0.0, on_right ? HUGE_VAL : pieces_[i].duration};
      append_breakpoints(part, t0, t1, out);
    }
  }

 private:
  std::vector<Piece> pieces_;
  SequenceSettings k_;
  std::vector<double> start_;   // T_0 .. T_n, the last one the end
  std::vector<double> offset_;  // o_0 .. o_(n-1)
};

}  // namespace

LawPtr<MotionLaw> laws::sequence(std::vector<Piece> pieces, const SequenceSettings& k) {
  return std::make_shared<const Sequence>(std::move(pieces), k);
}

void add_sequence(LawTypes& types) {
  types.laws.add({"sequence",
                  "laws one after another, each on its own time from 0",
                  {{"durations", Form::numbers, Unit::time, kRequired, "how long each law runs"},
                   value_key("laws", Form::laws, kRequired, "as many laws"),
                   {"continue", Form::boolean, Unit::none, false,
                    "each law continues from the value at which the one before ended"},
                   {"outside",
                    Form::choice,
                    Unit::none,
                    "hold",
                    "before and after: value held, or first and last law continued",
                    {"hold", "run_on"}},
                   {"t0", Form::number, Unit::time, 0, "start of the first law"}}},
                 [](const Params& p) {
                   const auto durations = p.numbers("durations");
                   const auto laws = p.laws("laws");
                   if (durations.size() != laws.size())
                     p.refuse("durations", "are " + std::to_string(durations.size()) + " for " +
                                               std::to_string(laws.size()) + " laws; give one per law");
                   std::vector<Piece> pieces;
                   for (std::size_t i = 0; i < laws.size(); ++i) pieces.push_back({durations[i], laws[i]});
                   return laws::sequence(std::move(pieces),
                                         {p.number("t0"), p.boolean("continue"), p.text("outside") == "run_on"});
                 });
}

}  // namespace lockstep
