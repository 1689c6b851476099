// CountedAngle: an angle that runs on past full turns, by numbers of State::z.
#pragma once

#include <cmath>
#include <span>

namespace lockstep {

/// The angle takes the branch nearest to where the mean of the rates, of the last accepted state and of now, has brought
/// it: a step may make several turns if that is right to half a turn.
struct CountedAngle {
  /// The angle accepted last, rad; its rate, rad/s; the time of both, s; 1 once a state was accepted. Zero at the start:
  /// the angle begins in (-pi, pi], or where it is led from there (begin_turns()).
  static constexpr int kMemory = 4;

  static double expected(const double* z, double t, double rate) {
    const double way = z[3] != 0 ? 0.5 * (t - z[2]) * (z[1] + rate) : 0.0;
    return std::isfinite(way) ? z[0] + way : z[0];
  }
  static void accept(double angle, double rate, double t, std::span<double> z) {
    z[0] = angle, z[1] = rate, z[2] = t, z[3] = 1;
  }
};

}  // namespace lockstep
