// SPDX-License-Identifier: BSD-3-Clause
// Looks at states that are no work of a run.
#pragma once

#include <lockstep/dynamics.h>

namespace lockstep {

/// Gives the counters of work back when it ends: what was looked at in between, as for pictures, does not count.
class Uncounted {
 public:
  explicit Uncounted(Dynamics& dynamics) : work_(dynamics.work()), before_(dynamics.work()) {}
  ~Uncounted() { work_ = before_; }
  Uncounted(const Uncounted&) = delete;
  Uncounted& operator=(const Uncounted&) = delete;

 private:
  WorkCount& work_;
  const WorkCount before_;
};

}  // namespace lockstep
