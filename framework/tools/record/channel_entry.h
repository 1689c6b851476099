// What the channel_*.cpp files offer to the lookup by name; internal to framework/record.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/recorder.h>
#include "framework/tools/record/frame.h"

namespace lockstep::channels {

inline constexpr const char* kAxisName[3] = {"x", "y", "z"};

/// A quantity of one object: its name without the object's, and how the channel is made.
struct Entry {
  std::string name, unit, help;
  std::function<void(System&, Channel&)> make;  ///< fills value, track, restart
};
using Entries = std::vector<Entry>;
using Value = std::function<double(const Sample&)>;

void add(Entries&, std::string name, std::string unit, std::string help, Value value);
/// Three of them: name + "x", "y", "z"; value(sample, k).
void add_vector(Entries&, const std::string& name, const std::string& unit, const std::string& help,
                std::function<Vec3(const Sample&)> value);

/// An angle on any branch and its rate.
struct RawAngle {
  double angle = 0, rate = 0;
};
/// An angle counted past full turns.
void add_angle(Entries&, std::string name, std::string help, std::function<RawAngle(const Sample&)> raw);
/// Integral over time of `rate` along the motion; one quadrature of the system, called `id`, for all who ask.
void add_integral(Entries&, std::string name, std::string unit, std::string help, std::string id,
                  std::function<double(const Evaluated&)> rate, bool of_reactions = false);

/// Offers of one subject each.
void of_frame(const Frame&, Entries&);
void of_body(const Body&, Entries&);
void of_pair(const Frame& m, const Frame& n, Entries&);
void of_link(const System&, const Lock&, Entries&);
void of_reactions(const Lock&, Entries&);
void of_force(const Force&, Entries&);
void of_totals(Entries&);
void of_run(Entries&);

/// Work of all drives and moving laws, power taken by the dampers and the friction of one force: rates that totals
/// integrate.
double power_of_laws(const Evaluated&);
double loss(const Force&, const Evaluated&);
/// Lost in the impacts of all one-sided links up to this state, J.
double lost_in_impacts(const System&, const State&);

}  // namespace lockstep::channels
