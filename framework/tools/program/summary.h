// Summary: what moved and what was conserved, for the table at the end of a run.
#pragma once

#include <string>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

/// Looks at the outputs of a run. Its channels integrate the works of drives and dampers with the motion.
class Summary final : public Observer {
 public:
  /// Before the run.
  explicit Summary(System& system);

  void start(const Sample&) override;
  void step(const Sample&) override;
  void output(const Sample&) override;

  /// Lines of text, the bodies that moved most first.
  std::string text() const;

 private:
  struct Mover {
    const Body* body;
    Vec3 x0, last_x;
    Quat last_q;
    double away = 0, path = 0, turned = 0;  // m, m, rad
  };
  /// 0 for what the system has not.
  double value(std::size_t channel, const Sample& s) const {
    return channels_[channel].value ? channels_[channel].value(s) : 0.0;
  }

  std::vector<Mover> movers_;
  std::vector<Channel> channels_;
  double length_ = 1;  // of the system, m
  double first_energy_ = 0, last_energy_ = 0, drives_ = 0, supplied_ = 0, dissipated_ = 0, balance_ = 0, scale_ = 0;
};

}  // namespace lockstep
