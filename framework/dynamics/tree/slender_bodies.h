// Where rounding makes joint coordinates the worse ones.
#pragma once

#include <string>

namespace lockstep {

class JointTree;
class System;

/// A body that turns freely about all axes, and carries by arms up to r a mass m on its least principal inertia J, in a
/// tree in space: "" where m r^2 <= 1e6 J for all of them, else who does not. Its turn about that axis comes out of sums
/// whose terms are as large as m r^2, with a relative error of 1e-16 m r^2 / J, which at tight tolerances no step brings
/// below the tolerance; omega finds it from the body's own inertia.
std::string slender_body(const JointTree&, const System&);

}  // namespace lockstep
