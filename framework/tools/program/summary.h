// Summary: what moved and what was conserved, for the report at the end of a run.
#pragma once

#include <string>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

/// Its channels integrate the work of drives and dampers along with the motion.
class Summary final : public Observer {
 public:
  /// Make it before the run: its channels add states to the system.
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
  /// 0 if the system has no such channel.
  double value(std::size_t channel, const Sample& s) const {
    return channels_[channel].value ? channels_[channel].value(s) : 0.0;
  }

  std::vector<Mover> movers_;
  std::vector<Channel> channels_;
  double length_ = 1;  // of the system, m
  double first_energy_ = 0, last_energy_ = 0, drives_ = 0, supplied_ = 0, dissipated_ = 0, balance_ = 0, scale_ = 0;
};

}  // namespace lockstep
