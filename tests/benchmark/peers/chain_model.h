// SPDX-License-Identifier: BSD-3-Clause
// A chain of rods in its joints' angles, in extended precision: the truth for the chains. Articulated bodies in world
// axes about the joints' points, so that the cost is linear in the number of rods.
#pragma once

#include <vector>

#include <lockstep/math.h>
#include "tests/benchmark/peers/extrapolate.h"
#include "tests/benchmark/peers/mechanisms.h"

namespace lockstep::peers {

class ChainModel {
 public:
  explicit ChainModel(const Mechanism& m);
  /// y: n angles of the joints, then their n rates; dy/dt.
  void rate(const RealVector& y, RealVector& dy);
  Positions positions(const RealVector& y);

 private:
  using V3 = Vec3T<Real>;
  using M3 = Mat3T<Real>;
  struct Link {
    M3 R;          // rod's axes -> world
    V3 axis, w;    // of the joint towards the ground; angular velocity
    V3 c;          // from the joint to the mass centre
    M3 A, B, C;    // articulated inertia [A B; B^T C] of (turn, point)
    V3 z_n, z_f;   // articulated bias: moment and force
    V3 a_n, a_f;   // what the velocities alone accelerate across the joint
    V3 U_n, U_f;   // inertia times axis
    Real D, load;  // axis . U_n; axis . (inertia a + bias)
  };
  void turn(const RealVector& y);
  void own_inertia(const RealVector& y, int k);
  void fold_into_parent(int k);
  void accelerate(const RealVector& y, RealVector& dy);

  const Mechanism& mechanism_;
  V3 gravity_;
  std::vector<Link> links_;
};

}  // namespace lockstep::peers
