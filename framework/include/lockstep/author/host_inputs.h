// SPDX-License-Identifier: BSD-3-Clause
// HostInputs: numbers that a host sets during the run of a scene, read by laws of the scene.
#pragma once

#include <algorithm>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/linearization.h>
#include <lockstep/system.h>

namespace lockstep {

/// The inputs of a scene. A law {"type": "input", "name": "torque", "value": 0, "unit": "N m"} reads one; laws of one
/// name read the same. Make the mechanism of the scene by the registry of add_to(), then bind() its system.
class HostInputs {
  // y = the input
  struct Reader final : MotionLaw {
    explicit Reader(double start) : value(start) {}
    LawValue at(double) const override { return {input != nullptr ? input->value() : value, 0, 0}; }
    const double value;                   // before bind()
    const ControlInput* input = nullptr;  // the system's
  };

 public:
  /// An input with its law.
  struct One {
    std::string name,                 ///< of the input
        unit;                         ///< for readers
    std::shared_ptr<Reader> reader;   ///< its value
    std::shared_ptr<InputLaw> law;    ///< to which a linearisation adds
    ControlInput* input = nullptr;    ///< null before bind()
  };

  /// Adds the law "input" to a registry, which makes inputs here.
  void add_to(Registry& registry) {
    registry.laws.add(info(), [all = all_](const Params& p) -> LawPtr<MotionLaw> {
      const std::string name = p.text("name");
      const auto found = std::ranges::find(*all, name, &One::name);
      if (found == all->end()) {
        const auto reader = std::make_shared<Reader>(p.number("value"));
        all->push_back({name, p.text("unit"), reader, std::make_shared<InputLaw>(reader)});
        return all->back().law;
      }
      if (p.has("value") && found->reader->value != p.number("value"))
        p.refuse("value", "differs from that of another law with the input \"" + name + "\"; give it once");
      return found->law;
    });
  }
  /// Adds the inputs to the system of the mechanism, which must live as long as the laws are read. Throws ModelError
  /// for a name that is taken.
  void bind(System& system) {
    for (One& one : *all_)
      one.reader->input = one.input = &system.add_input(one.name, one.reader->value, one.unit);
  }
  const std::deque<One>& all() const { return *all_; }  ///< in the order in which the scene names them

  /// Name, help and keys of the law.
  static TypeInfo info() {
    return {"input",
            "y = a number that the host sets between the steps of a run",
            {{"name", Form::text, Unit::none, kRequired, "name of the input"},
             {"value", Form::number, Unit::any, 0.0, "value at the start", {}, LawQuantity::value},
             {"unit", Form::text, Unit::none, "", "unit of the value, for readers: \"N m\""}}};
  }

 private:
  std::shared_ptr<std::deque<One>> all_ = std::make_shared<std::deque<One>>();
};

}  // namespace lockstep
