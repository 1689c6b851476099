// SPDX-License-Identifier: BSD-3-Clause
// A, B, C, D in minimal coordinates.
//
//   dx = N y + G u,  J N = 0,  J G = -C_u:    Mr y'' + Dr y' + Kr y = -N^T ( (K G + R_u) u + (D G + R_ud) u' + M G u'' )
//
// R = J^T lambda - f at fixed positions, velocities and multipliers, as a function of the input.
#include <lockstep/linearization.h>
#include "framework/foundation/support/finding_kinds.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/foundation/math/decompositions.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/at_end.h"
#include "framework/tools/analysis/mechanism_matrices.h"
#include "framework/tools/analysis/minimal_coordinates.h"

namespace lockstep {
namespace {

constexpr double kDifferenceStep = 4e-3;  // of a difference, in rad, or of the length; the second step is half of it
constexpr double kRateStep = 1e-2;        // the same of rates, in their units: what depends on them is nearly quadratic

// Derivative of a vector at 0 by central differences of sixth order with steps h and h/2; `off`: their largest
// difference.
template <class F>
VecX derivative(F&& at, double h, VecX& off) {
  static constexpr double kWeights[] = {45.0 / 60, -9.0 / 60, 1.0 / 60};
  const auto with = [&](double step) {
    VecX sum;
    for (int k = 1; k <= 3; ++k) {
      const VecX d = kWeights[k - 1] / step * (at(k * step) - at(-k * step));
      sum = k == 1 ? d : VecX(sum + d);
    }
    return sum;
  };
  const VecX coarse = with(h), fine = with(0.5 * h);
  off = (coarse - fine).cwiseAbs();
  return fine;
}

// How an input acts: it is added to its law; where that is the speed of a drive, the value of the coordinate is a
// state, and u its rate.
class Actuator {
 public:
  Actuator(const System& system, const LinearInput& input) : law_(input.law.get()), unit_(input.unit) {
    for (const auto& link : system.links()) {
      if (link->jointed() == nullptr) continue;
      for (const Drive& drive : link->jointed()->imposed().drives)
        if (drive.speed && drive.law.get() == law_) state_ = link->first_state() + drive.state;
    }
    if (is_speed() && unit_.ends_with("/s")) unit_.resize(unit_.size() - 2);
  }

  bool is_speed() const { return state_ >= 0; }
  const std::string& unit() const { return unit_; }  // of the value
  // The value, its rate and its second rate, at a state that is to be evaluated.
  void set(const LawValue& u, State& at) const {
    law_->add(is_speed() ? LawValue{u.yd, u.ydd, 0} : u);
    if (is_speed()) at.s[state_] += u.y;
  }
  void clear() const { law_->add({}); }

 private:
  InputLaw* law_;
  std::string unit_;
  int state_ = -1;
};

// C, and R below it, at a state with an input.
VecX response(Dynamics& dynamics, const State& state, const LinearMotion& m, const Actuator& input, const LawValue& u) {
  const Unknowns unknowns(dynamics.system());
  State at = state;
  input.set(u, at);
  const Evaluation& e = dynamics.gather(at);
  const RowTable& rows = e.rows();
  VecX f = e.force(), C, Cd;
  e.react(m.lambda, f);
  e.residuals(C, Cd);
  VecX out(rows.n_rows + unknowns.n());
  out << C, unknowns.rows(rows, up_to(rows.entries.size())) * m.lambda - unknowns.of_slots(f);
  input.clear();
  return out;
}

// What changes with a state or an input, per unit of it.
struct Direction {
  Signal signal;
  VecX acceleration;               // y''
  double step;                     // of differences
  VecX dx{}, dv{};                 // where they are not zero
  const Actuator* acts = nullptr;  // of an input
  LawValue u{};
  Eigen::Index rate_of = -1;  // the state of which it is the rate
};

// The values of the outputs at a state that differs.
class Outputs {
 public:
  Outputs(Dynamics& dynamics, const State& state, const std::vector<Channel>& channels)
      : dynamics_(dynamics), state_(state), channels_(channels), unknowns_(dynamics.system()) {
    const Sample sample(dynamics_, state_, report_);
    for (const Channel& c : channels_)
      if (c.memory) c.memory->start(sample);
  }
  // With h of what a column stands for.
  VecX at(const Direction& column, double h) const {
    State moved = state_;
    if (column.dx.size() > 0) advance_state(moved, h, unknowns_.to_slots(column.dx));
    if (column.dv.size() > 0) moved.v += h * unknowns_.to_slots(column.dv);
    if (column.acts == nullptr) return of(moved);
    column.acts->set({h * column.u.y, h * column.u.yd, h * column.u.ydd}, moved);
    VecX y = of(moved);
    column.acts->clear();
    return y;
  }
  VecX of(const State& state) const {
    const Sample sample(dynamics_, state, report_);
    VecX out(static_cast<Eigen::Index>(channels_.size()));
    for (std::size_t k = 0; k < channels_.size(); ++k) out[static_cast<Eigen::Index>(k)] = channels_[k].value(sample);
    return out;
  }
  // Throws for channels of integrated states other than coordinates of drives: the linear equations have none.
  void refuse_integrals() const {
    if (state_.s.size() == 0) return;
    State moved = state_;
    moved.s.array() += kRateStep;
    for (const auto& link : dynamics_.system().links()) {
      const Eigen::Index own = link->jointed() != nullptr ? link->n_own_states() : 0;
      if (own > 0) moved.s.segment(link->first_state(), own) = state_.s.segment(link->first_state(), own);
    }
    const VecX now = of(state_), then = of(moved);
    for (std::size_t k = 0; k < channels_.size(); ++k)
      if (now[static_cast<Eigen::Index>(k)] != then[static_cast<Eigen::Index>(k)])
        throw ModelError("output '" + channels_[k].name +
                         "' depends on an integrated state, which linearisation does not support; use its rate (a "
                         "power in place of a work)");
  }

 private:
  Dynamics& dynamics_;
  const State& state_;
  const std::vector<Channel>& channels_;
  Unknowns unknowns_;
  StepReport report_{};
};

struct Reduced {
  MatX N;                   // with ones at the chosen unknowns
  std::vector<int> chosen;  // unknowns that are the coordinates
  Eigen::LLT<MatX> M;
  MatX D, K;
};

Reduced reduce(const LinearMotion& m, const MatX& N) {
  Reduced r;
  r.chosen = independent_unknowns(m, N);
  r.N = N * MatX(N(r.chosen, Eigen::all)).partialPivLu().inverse();
  r.M = mass_factor(MatX(r.N.transpose() * (m.M * r.N)));
  r.D = r.N.transpose() * (m.D * r.N), r.K = r.N.transpose() * (m.K * r.N);
  return r;
}

// Two for each degree of freedom: a displacement, whose velocity is that of the axes, and its rate.
void add_states(const System& system, const State& state, const LinearMotion& m, const Reduced& r,
                std::vector<Direction>& out) {
  static constexpr const char* kNames[] = {"move_x", "move_y", "move_z", "turn_x", "turn_y", "turn_z"};
  const SparseMat carried = carried_by(m.spin, system, state);
  for (const bool rate : {false, true})
    for (Eigen::Index k = 0; k < r.N.cols(); ++k) {
      const UnknownVelocity& u = m.unknowns[r.chosen[k]];
      const bool turn = u.velocity >= 3;
      const VecX N = r.N.col(k);
      const double largest = N.cwiseAbs().maxCoeff();
      const double h = (turn ? 1.0 : m.length) / std::max(1.0, turn ? largest : largest * m.length);
      const std::string name = system.body_of_slot(u.slot).name + "." + kNames[u.velocity];
      if (rate)
        out.push_back({.signal = {name + "_d", turn ? "rad/s" : "m/s"},
                       .acceleration = -r.M.solve(r.D.col(k)),
                       .step = kRateStep * h,
                       .dv = N,
                       .rate_of = k});
      else
        out.push_back({.signal = {name, turn ? "rad" : "m"},
                       .acceleration = -r.M.solve(r.K.col(k)),
                       .step = kDifferenceStep * h,
                       .dx = N,
                       .dv = carried * N});
    }
}

// How far two derivatives of C, with R below it, are apart, relative to the largest in the same block: rows by what
// they measure, forces, moments.
double accuracy_of(const VecX& derivative, const VecX& off, const LinearMotion& m) {
  struct Block {
    double scale = 0, largest = 0, apart = 0;
  };
  std::array<Block, 3> of_rows{Block{m.length}, {1}, {1}};  // by RowKind
  Block forces, moments;
  const auto count = [&](Block& block, Eigen::Index i, double scale) {
    block.scale = std::max(block.scale, scale);
    block.largest = std::max(block.largest, std::abs(derivative[i])), block.apart = std::max(block.apart, off[i]);
  };
  const Eigen::Index rows = m.J.rows();
  for (Eigen::Index i = 0; i < rows; ++i) count(of_rows[static_cast<std::size_t>(m.kinds[i])], i, 0);
  const VecX sizes = m.f.cwiseAbs() + m.J.cwiseAbs().transpose() * m.lambda.cwiseAbs();
  for (Eigen::Index i = 0; i < sizes.size(); ++i)
    count(m.unknowns[i].velocity < 3 ? forces : moments, rows + i, sizes[i]);
  moments.scale = std::max(moments.scale, m.length * forces.scale);
  double worst = 0;
  for (const Block& block : {of_rows[0], of_rows[1], of_rows[2], forces, moments})
    if (block.largest > kNegligible * block.scale) worst = std::max(worst, block.apart / block.largest);
  return worst;
}

// How far two derivatives of the outputs are apart, relative to the largest of the same row. A row that is round-off
// relative to one of the same unit, or at all, does not count.
double accuracy_of_outputs(const MatX& derivatives, const MatX& off, const std::vector<Channel>& channels) {
  const VecX largest = derivatives.rowwise().lpNorm<Eigen::Infinity>();
  double worst = 0;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    double round_off = 100 * std::numeric_limits<double>::epsilon();
    for (std::size_t other = 0; other < channels.size(); ++other)
      if (channels[other].unit == channels[k].unit)
        round_off = std::max(round_off, kNegligible * largest[static_cast<Eigen::Index>(other)]);
    const auto row = static_cast<Eigen::Index>(k);
    if (largest[row] > round_off) worst = std::max(worst, off.row(row).maxCoeff() / largest[row]);
  }
  return worst;
}

// Per unit of an input: the value, its rate and its second rate, as far as they act. respond(u): the response to it.
template <class Respond>
void add_inputs(const LinearInput& input, const Actuator& acts, const LinearMotion& m, const Reduced& r,
                Respond&& respond, double& accuracy, std::vector<Direction>& states, std::vector<Direction>& inputs) {
  const Eigen::Index rows = m.J.rows();
  const double length_step = kDifferenceStep * (acts.unit() == "m" ? m.length : 1.0);
  VecX off;
  const VecX by_value = derivative([&](double h) { return respond({h, 0, 0}); }, length_step, off);
  accuracy = std::max(accuracy, accuracy_of(by_value, off, m));
  const VecX by_rate = derivative([&](double h) { return respond({0, h, 0}); }, kRateStep, off);
  accuracy = std::max(accuracy, accuracy_of(by_rate, off, m));
  const VecX C_u = by_value.head(rows);
  const VecX R_u = by_value.tail(by_value.size() - rows), R_ud = by_rate.tail(by_rate.size() - rows);
  if (by_value.isZero(0) && by_rate.isZero(0))
    throw ModelError("input '" + input.name + "' has no effect at this state; put its law in an active drive or force");
  VecX G = VecX::Zero(m.M.rows());
  const bool moves = !C_u.isZero(0);
  if (moves) {
    const MatX J = m.J;
    G = -least_norm(J, C_u, kNegligible);
    if ((J * G + C_u).norm() > 10 * kNegligible * C_u.norm())
      throw ModelError("input '" + input.name +
                       "' contradicts other constraints: the joints allow no motion that follows it");
    G -= r.N * VecX(G(r.chosen));
  }
  const auto column = [&](std::vector<Direction>& to, const std::string& suffix, const std::string& unit,
                          const VecX& load, double step) -> Direction& {
    return to.emplace_back(Direction{.signal = {input.name + suffix, acts.unit() + unit},
                                     .acceleration = -r.M.solve(r.N.transpose() * load),
                                     .step = step,
                                     .acts = &acts});
  };
  const bool speed = acts.is_speed(), by_value_alone = !moves && R_ud.isZero(0);
  Direction& value = column(speed ? states : inputs, "", "", m.K * G + R_u, length_step);
  value.dx = G, value.u.y = 1;
  if (by_value_alone && !speed) return;  // a state of its own has a rate, which moves it
  // dv of dx' = G u' in the axes: the rotation of dx itself is in the column of the value
  Direction& rate = column(inputs, speed ? "" : "_d", "/s", m.D * G + R_ud, kRateStep);
  rate.dv = G, rate.u.yd = 1;
  if (speed) rate.rate_of = static_cast<Eigen::Index>(states.size()) - 1;
  if (by_value_alone) return;
  column(inputs, speed ? "_d" : "_dd", "/s^2", m.M * G, kRateStep).u.ydd = 1;
}

}  // namespace

LawValue InputLaw::at(double t) const {
  LawValue y = law_ ? law_->at(t) : LawValue{};
  y.y += u_.y, y.yd += u_.yd, y.ydd += u_.ydd;
  return y;
}

void InputLaw::breakpoints(double t0, double t1, std::vector<double>& out) const {
  if (law_) law_->breakpoints(t0, t1, out);
}

StateSpace linearize(Dynamics& dynamics, const State& given, const std::vector<LinearInput>& inputs,
                     const std::vector<Channel>& channels, const LinearMotionOptions& options) {
  const State state = dynamics.in_slots(given);
  const System::InSpace look = dynamics.look_in_space();
  const auto clear = [&] {
    for (const LinearInput& input : inputs) input.law->add({});
  };
  clear();
  const AtEnd put_back(clear);
  const System& system = dynamics.system();
  const LinearMotion m = linear_motion(dynamics, state, options);
  const Reduced r = reduce(m, minimal_coordinates(dynamics, state, m).N);
  const Eigen::Index f = r.N.cols();

  StateSpace out;
  out.spin = m.spin, out.unrest = m.unrest, out.notes = m.notes;
  if (!out.spin.isZero(0))
    out.notes.push_back({&finding::analysis_note, "",
                         "about a steady rotation: outputs that depend on the angle are valid at this time only"});
  const Outputs outputs(dynamics, state, channels);
  outputs.refuse_integrals();
  std::vector<Direction> columns, of_inputs;
  add_states(system, state, m, r, columns);
  std::vector<Actuator> actuators;
  for (const LinearInput& input : inputs) actuators.emplace_back(system, input);
  for (std::size_t k = 0; k < inputs.size(); ++k)
    add_inputs(
        inputs[k], actuators[k], m, r, [&](const LawValue& u) { return response(dynamics, state, m, actuators[k], u); },
        out.accuracy, columns, of_inputs);
  const auto n = static_cast<Eigen::Index>(columns.size());
  columns.insert(columns.end(), of_inputs.begin(), of_inputs.end());
  const auto n_all = static_cast<Eigen::Index>(columns.size());
  MatX of_states = MatX::Zero(n, n_all), of_outputs(static_cast<Eigen::Index>(channels.size()), n_all),
       off = of_outputs;
  for (Eigen::Index k = 0; k < n_all; ++k) {
    const Direction& column = columns[k];
    of_states.col(k).segment(f, f) = column.acceleration;
    if (column.rate_of >= 0) of_states(column.rate_of, k) = 1;
    VecX apart;
    of_outputs.col(k) = derivative([&](double h) { return outputs.at(column, h); }, column.step, apart);
    off.col(k) = apart;
    (k < n ? out.states : out.inputs).push_back(column.signal);
  }
  out.accuracy = std::max(out.accuracy, accuracy_of_outputs(of_outputs, off, channels));
  for (const Channel& channel : channels) out.outputs.push_back({channel.name, channel.unit});
  out.A = of_states.leftCols(n), out.B = of_states.rightCols(n_all - n);
  out.C = of_outputs.leftCols(n), out.D = of_outputs.rightCols(n_all - n);
  for (MatX* matrix : {&out.A, &out.B, &out.C, &out.D}) matrix->array() += 0.0;  // no zero with a sign
  return out;
}

}  // namespace lockstep
