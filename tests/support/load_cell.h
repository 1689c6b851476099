// SPDX-License-Identifier: BSD-3-Clause
// A force that reads what a link carries.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lockstep/author/force.h>
#include <lockstep/author/lock.h>

namespace lockstep::testing {

/// A load cell: pushes nothing, but wants to know what a link carries.
class LoadCell final : public Force, public Reacting {
 public:
  LoadCell(std::string name, const Lock& link)
      : Force(std::move(name)), Reacting(static_cast<const Force&>(*this)), link_(&link) {}
  std::string_view type() const override { return "load_cell"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs&, WrenchSum&) const override {}
  const Reacting* reacting() const override { return this; }
  std::vector<const Lock*> reads() const override { return {link_}; }
  void react(const Inputs&, const Reactions&, WrenchSum&) const override {}
  std::vector<Quantity> quantities() const override { return {{"weight", "N"}}; }
  double reacting_quantity(int, const Inputs& in, const Reactions& reactions) const override {
    return reactions.on_body_of(MarkerFrame(*link_->pairs().front().first), *link_, in).force[2];
  }

 private:
  const Lock* link_;
};

}  // namespace lockstep::testing
