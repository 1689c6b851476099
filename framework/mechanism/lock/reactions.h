// Reactions: the multipliers of the links in force, as a force that depends on them sees them.
#pragma once

#include <array>
#include <span>

#include "framework/mechanism/lock/lock.h"
#include "framework/mechanism/lock/marker_frame.h"
#include "framework/mechanism/rows/auxiliary.h"
#include "framework/mechanism/rows/rows.h"

namespace lockstep {

/// Force, N, and moment about a point, N m.
struct LinkWrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
};

class LOCKSTEP_API Reactions {
 public:
  Reactions(const RowTable& rows, std::span<const double> lambda) : rows_(rows), lambda_(lambda) {}
  explicit Reactions(const Evaluated& v)
      : Reactions(v.rows, {v.lambda.data(), static_cast<std::size_t>(v.lambda.size())}) {}

  bool in_force(const Lock& link) const { return entry(link) >= 0; }
  /// Multipliers of the link, by its own rows; zero for rows that a planar mechanism leaves out and while the link is
  /// not in force. The generalised force on the bodies is -Jh^T lambda (2.1).
  std::array<double, kMaxRows> of(const Lock& link) const {
    std::array<double, kMaxRows> lambda{};
    if (entry(link) < 0) return lambda;
    const RowEntry& e = rows_.entries[static_cast<std::size_t>(entry(link))];
    for (std::size_t k = 0; k < static_cast<std::size_t>(e.m); ++k)
      lambda[static_cast<std::size_t>(e.own[k])] = lambda_[static_cast<std::size_t>(e.first_row) + k];
    return lambda;
  }

  /// Rows of a link that count: the joint's own, those of all its drives, or those of drive number 0, 1, ...
  enum Part : int { kJoint = -2, kDrives = -1 };
  static bool belongs(const LinkRow& row, int part) {
    return part == kJoint ? row.drive < 0 : part == kDrives ? row.drive >= 0 : row.drive == part;
  }
  /// What the link does to the body of one of its markers, about the origin of that marker; world axes. Zero while it
  /// is not in force. The rows must be those gathered at `in`.
  LinkWrench on_body_of(const MarkerFrame& at, const Lock& link, const Inputs& in, int part = kJoint) const;

 private:
  int entry(const Lock& link) const { return rows_.entry_of_link[static_cast<std::size_t>(link.number())]; }
  const RowTable& rows_;
  std::span<const double> lambda_;
};

}  // namespace lockstep
