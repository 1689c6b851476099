#include "framework/mechanism/lock/lock.h"

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

void Lock::tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const {
  Differences& scratch = out.differences(in);
  Inputs at = in;
  at.motions = scratch.motions;
  RowTable& rows = scratch.rows;
  rows.entries.resize(1);
  RowEntry& entry = rows.entries.front();
  entry.link = number_, entry.m = row_count(), entry.slots = slots();
  entry.layout = layout(), entry.sign = row_sign();
  for (int k = 0; k < entry.m; ++k) entry.kind[static_cast<std::size_t>(k)] = row_kind(k);
  rows.lay_out();
  const SlotList& on = entry.slots;
  const Lock* self = this;

  Eigen::Matrix<double, 6 * kMaxSlots, 1> column;
  const auto add_force = [&](double factor) {  // Jh^T lambda of the moved pose
    gather(Group(&self, 1), at, rows.span(entry));
    const RowBlock block = rows.block(entry);
    for (int i = 0; i < on.n; ++i)
      for (int k = 0; k < entry.m; ++k) {
        const auto r = block.J(i, k);
        for (int j = 0; j < 6; ++j) column[6 * i + j] += factor * lambda[static_cast<std::size_t>(k)] * r[j];
      }
  };
  const double h_move =
      Differences::kStep * Differences::distance({on.slot.data(), static_cast<std::size_t>(on.n)}, in);
  for (int j = 0; j < on.n; ++j)
    for (int k = 0; k < 6; ++k) {
      const double h = k < 3 ? h_move : Differences::kStep;
      Motion& O = scratch.motions[static_cast<std::size_t>(on[j] + 1)];
      const Motion home = O;
      column.setZero();
      O = Differences::moved(home, k, h);
      add_force(0.5 / h);
      O = Differences::moved(home, k, -h);
      add_force(-0.5 / h);
      O = home;
      for (int i = 0; i < on.n; ++i) {
        Mat6 K = Mat6::Zero();
        K.col(k) = column.segment<6>(6 * i);
        out.add_K(on[i], on[j], K);
      }
    }
}

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
