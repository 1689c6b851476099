#include "framework/force/force.h"

#include <algorithm>

namespace lockstep {

Force::Force(std::string name) : name_(std::move(name)) {}
Force::~Force() = default;

void Force::breakpoints(double, double, std::vector<double>&) const {}
std::vector<Quantity> Force::quantities() const { return {}; }
double Force::quantity(int, const Inputs&) const { return 0; }
double Force::potential(const Inputs&) const { return 0; }
double Force::dissipation(const Inputs&) const { return 0; }
double Force::supply(const Inputs&) const { return 0; }
void Force::start_memory(std::span<double> z) const { std::fill(z.begin(), z.end(), 0.0); }
void Force::accept(const Inputs&, std::span<double>) const {}

}  // namespace lockstep
