// SPDX-License-Identifier: BSD-3-Clause
// Summary: what moved in a run.
#pragma once

#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include "framework/tools/program/result.h"

namespace lockstep {

/// How far the bodies moved.
class Summary final : public Observer {
 public:
  void start(const Sample&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;

  /// How a body moved: along its way, from its start, and by turns.
  struct Way {
    std::string body;
    double path = 0, away = 0, turned = 0;  // m, m, rad
  };
  std::vector<Way> ways() const;  ///< those that moved most first
  bool nothing_moved() const;

 private:
  struct Place {
    Vec3 x, v, w;  // of the mass centre, m, m/s, rad/s, world
    Quat e;        // of the slot
  };
  struct Mover {
    const Body* body;
    Vec3 center;  // slot axes, m
    Vec3 x0;      // of the mass centre at the start, m
    Place last;
    double away = 0, path = 0, turned = 0;  // m, m, rad
  };
  static Place place(const Mover&, const Sample&);
  std::vector<Mover> movers_;
  double length_ = 1;  // of the system, m
};

const Fields<Summary::Way>& way_fields();

}  // namespace lockstep
