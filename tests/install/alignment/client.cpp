// SPDX-License-Identifier: BSD-3-Clause
// Memory of a state that the library made is resized and freed here, and the other way round.
#include <lockstep/system.h>

int main() {
  lockstep::System system;
  system.add_body("ball", lockstep::shapes::sphere(1.0, 0.1));
  system.setup();
  lockstep::State state = system.start();
  state.q.conservativeResize(100);
  state.v.resize(64);
  const Eigen::MatrixXd square = Eigen::MatrixXd::Identity(64, 64) * 2;  // packed blocks of the product
  state.v = (square * square).col(3);
  return state.q.size() == 100 && state.v[3] == 4 && system.start().v.size() == 6 ? 0 : 1;
}
