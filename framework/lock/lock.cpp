#include "framework/lock/lock.h"

#include <algorithm>

namespace lockstep {

Lock::Lock(std::string name) : name_(std::move(name)) {}
Lock::~Lock() = default;

int Lock::drive_row(int) const { return -1; }
int Lock::n_drives() const { return 0; }
Quantity Lock::drive(int) const { return {}; }
void Lock::breakpoints(double, double, std::vector<double>&) const {}
std::string Lock::blame(double) const { return {}; }
std::vector<Quantity> Lock::quantities() const { return {}; }
double Lock::quantity(int, const Inputs&) const { return 0; }

void Lock::start_states(std::span<double> s) const { std::fill(s.begin(), s.end(), 0.0); }
void Lock::state_rates(const Inputs&, std::span<double> sd) const { std::fill(sd.begin(), sd.end(), 0.0); }
void Lock::engage(const Inputs&, std::span<double>) const {}
void Lock::start_memory(std::span<double> z) const { std::fill(z.begin(), z.end(), 0.0); }
void Lock::accept(const Inputs&, std::span<double>) const {}

void Lock::place(int number, int first_state, int first_memory) {
  number_ = number;
  first_state_ = first_state;
  first_memory_ = first_memory;
}

}  // namespace lockstep
