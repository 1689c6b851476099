// Quadrature: a number that is integrated along with the motion, such as the work of a drive.
#pragma once

#include <functional>
#include <string>

#include <lockstep/system.h>

namespace lockstep {

class LOCKSTEP_API Quadrature final : public Auxiliary {
 public:
  /// `of_reactions`: the rate is a power of laws, lambda . Ct over rows of links; impulses add to it as forces do.
  Quadrature(std::string name, std::function<double(const Evaluated&)> rate, bool of_reactions = false)
      : Auxiliary(std::move(name)), rate_(std::move(rate)), of_reactions_(of_reactions) {}
  int size() const override { return 1; }
  bool reads_solution() const override { return of_reactions_; }
  bool vanishes_without_laws() const override { return of_reactions_; }
  bool controls_error() const override { return false; }  // what is only recorded must not change the run
  void rates(const Evaluated& values, std::span<double> sd) const override { sd[0] = rate_(values); }
  void impact(const Evaluated& impulses, std::span<double> s) const override {
    if (of_reactions_) s[0] += rate_(impulses);
  }
  double value(const State& s) const { return s.s[first()]; }

 private:
  std::function<double(const Evaluated&)> rate_;
  bool of_reactions_;
};

/// The system's quadrature of that name, added if it does not exist. Throws ModelError if another state has the name.
LOCKSTEP_API const Quadrature& quadrature(System&, const std::string& name,
                                          const std::function<double(const Evaluated&)>& rate,
                                          bool of_reactions = false);

}  // namespace lockstep
