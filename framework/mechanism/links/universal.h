// Link 'universal'.
#pragma once

#include <memory>

#include "framework/mechanism/lock/phi_lock.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// (7.4) phi = x_S . y_P = 2 (e1 e2 - e0 e3): the two pins of the cross stay normal to each other.
struct Cross {
  static constexpr Reads kReads = Reads::rotation;
  static constexpr std::array<const char*, 1> kNames = {"cross"};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return 2.0 * (y.e1 * y.e2 - y.e0 * y.e3);
  }
};

/// Hooke's joint: free to turn about x of S and about y of P, the pins of its cross; origins coincide.
class LOCKSTEP_API Universal final : public PhiLock<Cross> {
 public:
  Universal(std::string name, Marker& p, Marker& s);
  std::string_view type() const override { return "universal"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
