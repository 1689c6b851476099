#include <lockstep/rows.h>

#include <algorithm>

namespace lockstep {

Auxiliary::~Auxiliary() = default;

void Auxiliary::start(std::span<double> s) const { std::fill(s.begin(), s.end(), 0.0); }
void Auxiliary::impact(const Evaluated&, std::span<double>) const {}

}  // namespace lockstep
