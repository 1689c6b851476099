// SPDX-License-Identifier: BSD-3-Clause
// Summary: what moved, for the report at the end of a run, and an audit in words.
#pragma once

#include <string>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

/// How far the bodies moved.
class Summary final : public Observer {
 public:
  void start(const Sample&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;

  /// Lines of text, the bodies that moved most first.
  std::string text() const;
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

/// An audit in lines of text: the work, and that energy was conserved, if it was. `still`: nothing moved.
std::string words_of(const Audit&, bool still);

}  // namespace lockstep
