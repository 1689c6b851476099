// What a pass over nodes is instantiated for. Private to the room.
#pragma once

#include "framework/tools/batch/lane_schur.h"

namespace lockstep::lanes::LOCKSTEP_SET {

/// Calls f with the number of rows, and whether they begin with a triple, as constants.
template <class F>
LOCKSTEP_LANE void with_shape(const Node& node, F&& f) {
  if (node.triple) {
    switch (node.m) {
      case 3:
        return f.template operator()<3, true>();
      case 4:
        return f.template operator()<4, true>();
      case 5:
        return f.template operator()<5, true>();
      default:
        return f.template operator()<6, true>();
    }
  }
  switch (node.m) {
    case 1:
      return f.template operator()<1, false>();
    case 2:
      return f.template operator()<2, false>();
    case 3:
      return f.template operator()<3, false>();
    case 4:
      return f.template operator()<4, false>();
    default:
      return f.template operator()<5, false>();
  }
}
/// The same with the number of rows alone.
template <class F>
LOCKSTEP_LANE void with_size(const Node& node, F&& f) {
  switch (node.m) {
    case 1:
      return f.template operator()<1>();
    case 2:
      return f.template operator()<2>();
    case 3:
      return f.template operator()<3>();
    case 4:
      return f.template operator()<4>();
    case 5:
      return f.template operator()<5>();
    default:
      return f.template operator()<6>();
  }
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
