// Site: where a link or force stands, handed to its maker together with its parameters.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/mechanism/model/marker.h"
#include "framework/mechanism/params/params.h"
#include "framework/foundation/support/error.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

class Lock;

/// The name of the thing and the markers it is given, P before S of each pair.
struct LOCKSTEP_API Site {  // shown, because the shelves are templates of it
  std::string name;
  std::vector<std::pair<Marker*, Marker*>> pairs;  ///< one for a lock; forces may have none, or a pair without S
  Lock* link = nullptr;                            ///< the link that carries a force (friction); most have none

  /// Of pair k; throw ModelError when the marker is not given.
  Marker& p(std::size_t k = 0) const { return given(name, k < pairs.size() ? pairs[k].first : nullptr, "p", k); }
  Marker& s(std::size_t k = 0) const { return given(name, k < pairs.size() ? pairs[k].second : nullptr, "s", k); }
  /// Throws ModelError when none is given.
  Lock& carrier() const {
    if (link == nullptr) throw ModelError("'" + name + "': its type acts in a link; name that as \"link\"");
    return *link;
  }

  /// The marker of one side of pair k; throws ModelError, naming `name`, when it is not given.
  template <class M>
  static M& given(const std::string& name, M* marker, const char* side, std::size_t k) {
    if (marker == nullptr)
      throw ModelError("'" + name + "': its type needs a marker or a body for \"" + side + "\"" +
                       (k == 0 ? "" : " of pair " + std::to_string(k + 1)) + "; add it");
    return *marker;
  }
};

}  // namespace lockstep
