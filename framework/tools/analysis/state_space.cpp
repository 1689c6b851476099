// A, B, C, D in minimal coordinates.
//
//   dx = N y + G u,  J N = 0,  J G = -C_u:    Mr y'' + Dr y' + Kr y = -N^T ( (K G + R_u) u + (D G + R_ud) u' + M G u'' )
//
// R = J^T lambda - f at fixed positions, velocities and multipliers, as a function of the input.
#include <lockstep/linearization.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include <lockstep/error.h>
#include "framework/tools/analysis/mechanism_matrices.h"
#include "framework/tools/analysis/minimal_coordinates.h"
#include "framework/dynamics/evaluate/row_space.h"

namespace lockstep {
namespace {

constexpr double kDifferenceStep = 4e-3;  // of a difference, in rad, or of the length; the second step is half of it
constexpr double kRateStep = 1e-2;        // the same of rates, in their units: what depends on them is nearly quadratic
constexpr double kNothing = 1e-9;         // of the forces, or of the length: derivatives below may be round-off alone

// Puts the inputs back to zero, whatever happens.
class Inputs0 {
 public:
  explicit Inputs0(const std::vector<LinearInput>& all) : all_(all) { clear(); }
  ~Inputs0() { clear(); }
  Inputs0(const Inputs0&) = delete;
  Inputs0& operator=(const Inputs0&) = delete;

 private:
  void clear() const {
    for (const LinearInput& input : all_) input.law->add({});
  }
  const std::vector<LinearInput>& all_;
};

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

// How an input acts: it is added to its law; where that is the speed of a drive, the value of the coordinate is a state,
// and u its rate.
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

// Rows and forces of the mechanism at one state as functions of an input.
class Responses {
 public:
  Responses(Dynamics& dynamics, const State& state, const LinearMotion& motion)
      : dynamics_(dynamics), state_(state), motion_(motion), unknowns_(dynamics.system()) {}

  // C, and R below it.
  VecX operator()(const Actuator& input, const LawValue& u) const {
    State at = state_;
    input.set(u, at);
    const Evaluation& e = dynamics_.gather(at);
    const RowTable& rows = e.rows();
    VecX f = e.force();
    e.react(motion_.lambda, f);
    VecX out = VecX::Zero(rows.n_rows + unknowns_.n());
    VecX R = -f;
    for (const RowEntry& entry : rows.entries) {
      const RowView block = rows.block(entry);
      for (int k = 0; k < entry.m; ++k) {
        out[entry.first_row + k] = block.C(k);
        for (int i = 0; i < entry.slots.n; ++i) {
          const auto r = block.J(i, k);
          for (int j = 0; j < 6; ++j)
            R[6 * entry.slots[i] + j] += motion_.lambda[entry.first_row + k] * r[static_cast<std::size_t>(j)];
        }
      }
    }
    out.tail(unknowns_.n()) = unknowns_.of_slots(R);
    input.clear();
    return out;
  }

 private:
  Dynamics& dynamics_;
  const State& state_;
  const LinearMotion& motion_;
  Unknowns unknowns_;
};

// The values of the outputs at a state that differs by dx and dv, with an input in force.
class Outputs {
 public:
  Outputs(Dynamics& dynamics, const State& state, const std::vector<Channel>& channels)
      : dynamics_(dynamics), state_(state), channels_(channels), unknowns_(dynamics.system()) {
    const Sample sample(dynamics_, state_, report_);
    for (const Channel& c : channels_) {
      if (c.restart) c.restart();
      if (c.track) c.track(sample);
    }
  }
  VecX at(const VecX& dx, const VecX& dv) const { return of(moved(dx, dv)); }
  VecX at(const VecX& dx, const VecX& dv, const Actuator& input, const LawValue& u) const {
    State there = moved(dx, dv);
    input.set(u, there);
    VecX y = of(there);
    input.clear();
    return y;
  }
  State moved(const VecX& dx, const VecX& dv) const {
    State moved = state_;
    if (dx.size() > 0) advance_state(moved, 1.0, unknowns_.to_slots(dx));
    if (dv.size() > 0) moved.v += unknowns_.to_slots(dv);
    return moved;
  }
  VecX of(const State& state) const {
    const Sample sample(dynamics_, state, report_);
    VecX out(static_cast<Eigen::Index>(channels_.size()));
    for (std::size_t k = 0; k < channels_.size(); ++k) out[static_cast<Eigen::Index>(k)] = channels_[k].value(sample);
    return out;
  }
  // Refuses what reads integrated states other than coordinates of drives: the linear equations have none.
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
                         "' depends on an integrated state, which the linear equations do not hold; take its rate (a "
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

void name_states(const System& system, const LinearMotion& m, const Reduced& r, StateSpace& out) {
  static constexpr const char* kNames[] = {"move_x", "move_y", "move_z", "turn_x", "turn_y", "turn_z"};
  for (const bool rate : {false, true})
    for (const int i : r.chosen) {
      const UnknownVelocity& u = m.unknowns[static_cast<std::size_t>(i)];
      const bool turn = u.velocity >= 3;
      out.states.push_back({system.body_of_slot(u.slot).name + "." + kNames[u.velocity] + (rate ? "_d" : ""),
                            rate ? (turn ? "rad/s" : "m/s") : (turn ? "rad" : "m")});
    }
}

// One column of B and D each, or of A and C.
struct InputColumn {
  enum class Of { input, state, rate_of_state };
  Signal signal;
  VecX acceleration;                    // y''
  std::function<VecX(double)> outputs;  // at this size of the input
  double step = 0;
  Of of = Of::input;
};

// How far two derivatives of C, with R below it, are apart, relative to the largest in the same block: rows by what they
// measure, forces, moments.
double accuracy_of(const VecX& derivative, const VecX& off, const LinearMotion& m) {
  constexpr std::size_t kForces = 3, kMoments = 4;
  std::array<double, 5> largest{}, apart{}, scale{m.length, 1, 1, 0, 0};
  const auto count = [&](std::size_t block, Eigen::Index i) {
    largest[block] = std::max(largest[block], std::abs(derivative[i])), apart[block] = std::max(apart[block], off[i]);
  };
  const Eigen::Index rows = m.J.rows();
  for (Eigen::Index i = 0; i < rows; ++i) {
    const RowKind kind = m.kinds[static_cast<std::size_t>(i)];
    count(kind == RowKind::translation ? 0 : kind == RowKind::rotation ? 1 : 2, i);
  }
  const VecX forces = m.f.cwiseAbs() + m.J.cwiseAbs().transpose() * m.lambda.cwiseAbs();
  for (std::size_t i = 0; i < m.unknowns.size(); ++i) {
    const std::size_t block = m.unknowns[i].velocity < 3 ? kForces : kMoments;
    count(block, rows + static_cast<Eigen::Index>(i));
    scale[block] = std::max(scale[block], forces[static_cast<Eigen::Index>(i)]);
  }
  scale[kMoments] = std::max(scale[kMoments], m.length * scale[kForces]);
  double worst = 0;
  for (std::size_t block = 0; block < largest.size(); ++block)
    if (largest[block] > kNothing * scale[block]) worst = std::max(worst, apart[block] / largest[block]);
  return worst;
}

// How far two derivatives of the outputs are apart, relative to the largest of the same row. A row that is round-off
// beside one of the same unit, or at all, says nothing.
double accuracy_of_outputs(const MatX& derivatives, const MatX& off, const std::vector<Channel>& channels) {
  std::vector<double> largest;  // of each row
  for (const auto row : derivatives.rowwise()) largest.push_back(row.lpNorm<Eigen::Infinity>());
  double worst = 0;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    double scale = 100 * std::numeric_limits<double>::epsilon() / kNothing;
    for (std::size_t other = 0; other < channels.size(); ++other)
      if (channels[other].unit == channels[k].unit) scale = std::max(scale, largest[other]);
    if (largest[k] > kNothing * scale)
      worst = std::max(worst, off.row(static_cast<Eigen::Index>(k)).maxCoeff() / largest[k]);
  }
  return worst;
}

// Per unit of an input: the value, its rate and its second rate, as far as they act.
std::vector<InputColumn> columns_of(const LinearInput& input, const Actuator& acts, const LinearMotion& m,
                                    const Reduced& r, const Responses& response, const Outputs& outputs,
                                    double& accuracy) {
  const Eigen::Index rows = m.J.rows();
  const double length_step = kDifferenceStep * (acts.unit() == "m" ? m.length : 1.0);
  VecX off;
  const VecX by_value = derivative([&](double h) { return response(acts, {h, 0, 0}); }, length_step, off);
  accuracy = std::max(accuracy, accuracy_of(by_value, off, m));
  const VecX by_rate = derivative([&](double h) { return response(acts, {0, h, 0}); }, kRateStep, off);
  accuracy = std::max(accuracy, accuracy_of(by_rate, off, m));
  VecX C_u = by_value.head(rows);
  const VecX R_u = by_value.tail(by_value.size() - rows), R_ud = by_rate.tail(by_rate.size() - rows);
  if (by_value.isZero(0) && by_rate.isZero(0))
    throw ModelError("input '" + input.name +
                     "' acts on nothing at this state; put its law in a drive or a force that is "
                     "in force");
  VecX G = VecX::Zero(m.M.rows());
  const bool moves = C_u.cwiseAbs().size() > 0 && C_u.cwiseAbs().maxCoeff() > 0;
  if (moves) {
    const MatX J = m.J;
    Eigen::CompleteOrthogonalDecomposition<MatX> cod;
    cod.setThreshold(kDependent);
    cod.compute(J);
    G = -cod.solve(C_u);
    if ((J * G + C_u).norm() > 10 * kDependent * C_u.norm())
      throw ModelError("input '" + input.name +
                       "' moves against other rows: the joints leave nothing that could follow it");
    G -= r.N * VecX(G(r.chosen));
  }
  const auto column = [&](const std::string& suffix, const std::string& unit, const VecX& load, double step,
                          std::function<VecX(double)> at) {
    return InputColumn{{input.name + suffix, unit}, -r.M.solve(r.N.transpose() * load), std::move(at), step};
  };
  const auto with = [acts, &outputs](const LawValue& u, const VecX& dx, const VecX& dv) {
    return outputs.at(dx, dv, acts, u);
  };
  const std::string& unit = acts.unit();
  const bool speed = acts.is_speed();
  std::vector<InputColumn> out;
  out.push_back(column("", unit, m.K * G + R_u, length_step, [=](double h) {
    return with({h, 0, 0}, VecX(h * G), {});
  }));
  if (speed) out.back().of = InputColumn::Of::state;
  const bool by_value_alone = !moves && R_ud.isZero(0);
  if (by_value_alone && !speed) return out;  // a state of its own has a rate, which moves it
  // dv of dx' = G u' in the axes: the turning of dx itself is in the column of the value
  out.push_back(column(speed ? "" : "_d", unit + "/s", m.D * G + R_ud, kRateStep, [=](double h) {
    return with({0, h, 0}, {}, VecX(h * G));
  }));
  if (speed) out.back().of = InputColumn::Of::rate_of_state;
  if (by_value_alone) return out;
  out.push_back(column(speed ? "_d" : "_dd", unit + "/s^2", m.M * G, kRateStep, [=](double h) {
    return with({0, 0, h}, {}, {});
  }));
  return out;
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
  State state = given;
  dynamics.to_slots(state);
  const System::InSpace look = dynamics.look_in_space();
  const Inputs0 put_back(inputs);
  const System& system = dynamics.system();
  const LinearMotion m = linear_motion(dynamics, state, options);
  const MinimalCoordinates c = minimal_coordinates(m);
  refuse_singular_pose(dynamics, state, m, c);
  const Reduced r = reduce(m, c.N);
  const Eigen::Index f = r.N.cols();

  StateSpace out;
  out.spin = m.spin, out.unrest = m.unrest, out.notes = m.notes;
  if (!out.spin.isZero(0))
    out.notes.push_back(
        "about a steady rotation: outputs are those of this instant, and of every one only where they do "
        "not depend on the angle");
  name_states(system, m, r, out);
  const Responses response(dynamics, state, m);
  const Outputs outputs(dynamics, state, channels);
  outputs.refuse_integrals();
  std::vector<InputColumn> columns;  // of states, then of inputs
  for (const LinearInput& input : inputs)
    for (InputColumn& column : columns_of(input, Actuator(system, input), m, r, response, outputs, out.accuracy))
      columns.push_back(std::move(column));
  std::stable_partition(columns.begin(), columns.end(),
                        [](const InputColumn& one) { return one.of == InputColumn::Of::state; });
  const Eigen::Index driven =
      std::ranges::count_if(columns, [](const InputColumn& one) { return one.of == InputColumn::Of::state; });
  const Eigen::Index n = 2 * f + driven, n_in = static_cast<Eigen::Index>(columns.size()) - driven;
  out.A = MatX::Zero(n, n);
  out.A.block(0, f, f, f).setIdentity();
  out.A.block(f, 0, f, f) = -r.M.solve(r.K), out.A.block(f, f, f, f) = -r.M.solve(r.D);

  const auto n_out = static_cast<Eigen::Index>(channels.size());
  MatX all(n_out, 2 * f + static_cast<Eigen::Index>(columns.size())), off = all;
  VecX apart;
  // dv of a displacement in turning axes: Om x dx and W x dth; every v changes with the axes.
  const auto turned = [&](const VecX& dx) {
    VecX dv = VecX::Zero(dx.size());
    if (m.spin.isZero(0)) return dv;
    const Unknowns at(system);
    const VecX six = at.to_slots(dx);
    VecX v = VecX::Zero(six.size());
    for (int k = 0; k < system.n_slots(); ++k) {
      const Vec3 W = slot_motion(state, k).A.transpose() * m.spin;
      v.segment<3>(6 * k) = cross(m.spin, Vec3(six.segment<3>(6 * k)));
      v.segment<3>(6 * k + 3) = cross(W, Vec3(six.segment<3>(6 * k + 3)));
    }
    dv = at.of_slots(v);
    return dv;
  };
  for (Eigen::Index k = 0; k < f; ++k) {
    const VecX N = r.N.col(k), dv = turned(N);
    const bool turn = m.unknowns[static_cast<std::size_t>(r.chosen[static_cast<std::size_t>(k)])].velocity >= 3;
    const double largest = N.cwiseAbs().maxCoeff();
    const double h = kDifferenceStep * (turn ? 1.0 : m.length) / std::max(1.0, turn ? largest : largest * m.length);
    all.col(k) = derivative([&](double u) { return outputs.at(VecX(u * N), VecX(u * dv)); }, h, apart);
    off.col(k) = apart;
    all.col(f + k) =
        derivative([&](double u) { return outputs.at({}, VecX(u * N)); }, kRateStep * h / kDifferenceStep, apart);
    off.col(f + k) = apart;
  }
  out.B = MatX::Zero(n, n_in);
  Eigen::Index rates = 0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto col = static_cast<Eigen::Index>(k);
    const bool is_state = col < driven;
    (is_state ? out.states : out.inputs).push_back(columns[k].signal);
    (is_state ? out.A.col(2 * f + col) : out.B.col(col - driven)).segment(f, f) = columns[k].acceleration;
    if (columns[k].of == InputColumn::Of::rate_of_state) out.B(2 * f + rates++, col - driven) = 1;
    all.col(2 * f + col) = derivative(columns[k].outputs, columns[k].step, apart);
    off.col(2 * f + col) = apart;
  }
  out.accuracy = std::max(out.accuracy, accuracy_of_outputs(all, off, channels));
  for (const Channel& channel : channels) out.outputs.push_back({channel.name, channel.unit});
  out.C = all.leftCols(n), out.D = all.rightCols(n_in);
  for (MatX* matrix : {&out.A, &out.B, &out.C, &out.D}) matrix->array() += 0.0;  // no zero with a sign
  return out;
}

}  // namespace lockstep
