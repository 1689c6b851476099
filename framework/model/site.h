// Site: where a link or force stands, handed to its maker together with its parameters.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/model/marker.h"
#include "framework/model/params.h"
#include "framework/support/error.h"
#include "framework/support/export.h"

namespace lockstep {

/// The name of the thing and the markers it is given, P before S of each pair.
struct LOCKSTEP_API Site {  // shown, because the shelves are templates of it
  std::string name;
  std::vector<std::pair<Marker*, Marker*>> pairs;  ///< one for a lock; forces may have none, or a pair without S
  /// Throw ModelError when the marker is not given.
  Marker& p() const { return given(pairs.empty() ? nullptr : pairs.front().first, "p"); }
  Marker& s() const { return given(pairs.empty() ? nullptr : pairs.front().second, "s"); }

 private:
  Marker& given(Marker* marker, const char* side) const {
    if (marker == nullptr)
      throw ModelError("'" + name + "': its type needs a marker or a body for \"" + side + "\"; add it");
    return *marker;
  }
};

}  // namespace lockstep
