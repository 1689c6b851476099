// LinearSpring: spring, damper and actuator in one coordinate: a length, N and m, or an angle, N m and rad.
#pragma once

namespace lockstep {

/// Pulls its coordinate q back; qd is its rate.
///
///   force         T = k (q - q0) + T0 + c qd + law(t)
///   potential     V = 1/2 k (q - q0)^2 + T0 (q - q0)
///   dissipation   D = c qd^2
///   supply        -law(t) qd
struct LinearSpring {
  double stiffness, damping, free, preload;

  template <class T, class Load>
  T force(const T& q, const T& rate, double law, Load& load) const {
    const T x = q - free, elastic = stiffness * x;
    load.stores((0.5 * elastic + preload) * x);
    load.dissipates(damping * rate * rate);
    load.supplies(-law * rate);
    return elastic + preload + damping * rate + law;
  }
};

}  // namespace lockstep
