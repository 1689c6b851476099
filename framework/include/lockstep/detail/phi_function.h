// SPDX-License-Identifier: BSD-3-Clause
// Rows of a function of relative coordinates, with their derivatives.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <lockstep/author/relative.h>
#include <lockstep/detail/counted_angle.h>
#include <lockstep/detail/kernel.h>
#include <lockstep/detail/phi_check.h>
#include <lockstep/detail/rows.h>
#include <lockstep/error.h>

namespace lockstep {

// Geometric stiffness of a lock: the derivative of its force Jh^T lambda with respect to the poses; multipliers and
// time are fixed (theory, (9.2), (9.3)). Laws enter by their values, and cost nothing extra.

/// (9.2) Adds the stiffness of translational rows. lt: multipliers of x, y, z (S axes), zero where there is no row.
///
///   n = A_S lt (O2 axes),  A2 n (world),  g = A1^T A2 n (O1 axes)         F = ( A2 n | uP x g | -A2 n | n x s )
LOCKSTEP_API void add_translation_stiffness(const Inputs& in, int slot1, int slot2, const MarkerMotion& P,
                                            const MarkerMotion& S, const Vec3& lt, TangentSum& out);

/// (9.3) Adds the stiffness of rotational rows. qD: imposed rotation; L: multipliers (l0, lr) of the four components
/// of e, with l0 = 0 for a lock, whose rows are vec(e).
///
///   F_th1 = +(1/2) A_P ( e0 lr - l0 ev - ev x lr )          F_th2 = -(1/2) A_SD ( e0 lr - l0 ev + ev x lr )
LOCKSTEP_API void add_rotation_stiffness(const Inputs& in, int slot1, int slot2, const MarkerMotion& P,
                                         const MarkerMotion& S, const Quat& qD, const Quat& L, TangentSum& out);

// What links of pairs of markers check and measure at setup.

/// Throws ModelError if one of the markers is on a particle, whose turn the rows `rows` ("e1", "phi") of the link would
/// hold.
LOCKSTEP_API void refuse_particles(const std::string& link, const std::string& rows, const Marker& p, const Marker& s);

/// Pose of p seen from s with their bodies at home, including the markers' own laws at t = 0. P and S are p and s as
/// frames of their slots.
LOCKSTEP_API Pose pose_at_start(const Marker& p, const Marker& s, const MarkerFrame& P, const MarkerFrame& S);

// PhiFunction: a function phi of one to three pairs of markers, with the rows and the stiffness that follow from it
// (theory, (7.2), (7.3)). PhiLock and PhiCoupling are the links made of it.

/// A function of the relative coordinates of its pairs, evaluated as rows of a link.
template <class Phi>
class PhiFunction {
 public:
  using Traits = PhiTraits<Phi>;                                   ///< what phi defines about itself
  using Hooks = phi_check::Hooks<Phi>;                             ///< which functions phi has besides operator()
  static constexpr int kPairs = Traits::kPairs,                    ///< number of pairs
      kRows = Traits::kRows;                                       ///< number of rows
  using Grad = Jet<Traits::kWidth>;                                ///< a number with its gradient
  using Rows = std::array<Grad, kRows>;                            ///< the values of phi
  using MarkerPair = std::pair<const Marker*, const Marker*>;      ///< P and S
  using Pairs = std::array<MarkerPair, kPairs>;                    ///< the pairs that phi takes

  /// phi of these pairs.
  PhiFunction(Phi phi, const Pairs& pairs) : phi_(std::move(phi)), pairs_(pairs) {
    static_assert(phi_check::Spelling<Phi>::kChecked && Hooks::kChecked && phi_check::Reading<Phi>::kChecked);
    static_assert(phi_check::names_fit<Phi>(), "kNames has one name for each of the kRows rows");
  }

  const Phi& phi() const { return phi_; }        ///< the function
  const Pairs& pairs() const { return pairs_; }  ///< as given

  /// Takes the markers into their slots and calls phi.initialise(). Throws ModelError, naming `link`: phi reads the
  /// rotation of a particle, counts turns about z axes that are opposed at the start, or reads coordinates that its
  /// kReads leaves out.
  void setup(const std::string& link) {
    moving_ = false;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto [p, s] = pairs_[k];
      if (Traits::reads(static_cast<int>(k), Reads::rotation)) refuse_particles(link, "phi", *p, *s);
      FramePair& frames = frames_[k];
      frames.P = MarkerFrame(*p), frames.S = MarkerFrame(*s);
      moving_ = moving_ || frames.P.translation_law || frames.P.rotation_law || frames.S.translation_law ||
                frames.S.rotation_law;
    }
    const Coords<Time> y = at_start();
    if constexpr (Traits::kCountsTurns) refuse_opposed(link, y);
    if constexpr (Hooks::kInitialises) std::apply([&](const auto&... each) { phi_.initialise(link, each...); }, y);
    if constexpr (kPairs > 1) refuse_unread(link, y);
  }
  /// Asks for the angles of the pairs whose turns are counted. `coupled`: as AngleCounter::count.
  void count_angles(AngleCounter& counter, bool coupled) {
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      if (Traits::counts(static_cast<int>(k)))
        angles_[k] = &counter.count(*pairs_[k].first, *pairs_[k].second, 2, coupled);
  }
  /// Adds the slots of all markers.
  void add_slots(SlotList& slots) const {
    for (const FramePair& frames : frames_) slots.add(frames.P.slot), slots.add(frames.S.slot);
  }

  // -- laws
  /// Appends the instants in (t0, t1) where a law in phi jumps.
  void breakpoints(double t0, double t1, std::vector<double>& out) const {
    if constexpr (Hooks::kHasBreakpoints) phi_.breakpoints(t0, t1, out);
  }
  /// Which law in phi throws or is not finite at time t, in words; "" when none does.
  std::string diagnose(double t) const {
    if constexpr (Hooks::kDiagnoses) return phi_.diagnose(t);
    return {};
  }

  // -- evaluation; `memory`: what start_memory() and accept_step() wrote
  /// Writes rows first, first + 1, ... of the block, every number of them. `slots`: those of the link.
  ///
  ///   (7.2)  C = phi,  Ct = phi_y Ct_y + phi_t,  Jh = phi_y Jh_y,  Qhat = phi_y Qhat_y - phi'' along the motion
  void fill(const Inputs& in, const double* memory, const SlotList& slots, int first, const RowBlock& block) const {
    if (moving_)
      fill_by(pairs_seen<MovingPair>(in), in, memory, slots, first, block);
    else
      fill_still(in, memory, slots, first, block);
  }

  /// (9.11), (9.12) Adds K = lambda ( J_i^T phi_ij J_j + K_lock of each pair ), one multiplier per row.
  void tangent(const Inputs& in, const double* memory, const double* lambda, TangentSum& out) const {
    const Points y = look_at(in);
    const Rows f = value(y, in, memory);
    const MatV H = second_derivatives(y, in, memory, lambda);
    std::array<Eigen::Matrix<double, 7, 6>, 2 * static_cast<std::size_t>(kPairs)> J;
    each_pair([&](auto k) {
      const RelativeKinematics& L = y[k];
      J[2 * k] << L.Jv1, L.Jw1;
      J[2 * k + 1] << -L.Jv1, L.Jw2;
      Vec7T<double> phi_y = Vec7T<double>::Zero();
      for (int r = 0; r < kRows; ++r) part<k>(phi_y) += lambda[r] * gradient<k>(f[r]);
      const FramePair& frames = frames_[k];
      const MarkerMotion P = frames.P.at(in.t), S = frames.S.at(in.t);
      if (Traits::reads(k, Reads::translation))
        add_translation_stiffness(in, frames.P.slot, frames.S.slot, P, S, phi_y.template head<3>(), out);
      if (Traits::reads(k, Reads::rotation))
        add_rotation_stiffness(in, frames.P.slot, frames.S.slot, P, S, Quat{}, Quat::from(phi_y.template tail<4>()),
                               out);
    });
    for (int a = 0; a < 2 * kPairs; ++a)
      for (int b = 0; b < 2 * kPairs; ++b)
        out.add_K(slot_of(a), slot_of(b), J[a].transpose() * full(H, a / 2, b / 2) * J[b]);
  }

  // -- memory
  static constexpr int kMemory = Traits::kMemory;  ///< length of the memory

  /// Writes the memory at the start.
  void start_memory(std::span<double> z) const {
    if constexpr (kMemory > 0) std::apply([&](const auto&... each) { phi_.reset(z, each...); }, at_start());
  }
  /// Updates the memory after an accepted step.
  void accept_step(const Inputs& in, std::span<double> z) const {
    if constexpr (kMemory > 0)
      std::apply([&](const auto&... each) { phi_.accept_step(z, each...); }, along_motion(in, z.data()));
  }

  /// f(phi, y...), where each coordinate is a jet with its value and its rate; for channels of a link.
  template <class F>
  auto seen(const Inputs& in, const double* memory, F&& f) const {
    return std::apply([&](const auto&... each) { return f(phi_, each...); }, along_motion(in, memory));
  }

 private:
  struct FramePair {
    MarkerFrame P, S;
  };
  using Points = std::array<RelativeKinematics, kPairs>;
  static constexpr int kV = Traits::kVariables;
  using MatV = Eigen::Matrix<double, kV, kV>;
  template <class T>
  using Coords = std::array<LockCoords<T>, kPairs>;

  template <class F>
  static void each_pair(F&& f) {
    [&]<std::size_t... k>(std::index_sequence<k...>) { (f(std::integral_constant<std::size_t, k>{}), ...); }
    (std::make_index_sequence<kPairs>{});
  }
  /// Those of the seven numbers of pair k that phi reads.
  template <int k, class V>
  static auto part(V&& seven) {
    return seven.template segment<Traits::end(k) - Traits::first(k)>(Traits::first(k));
  }
  template <int k>
  static auto gradient(const Grad& f) {
    return f.g.template segment<Traits::end(k) - Traits::first(k)>(Traits::start(k));
  }

  Points look_at(const Inputs& in) const {
    Points y;
    for (int k = 0; k < kPairs; ++k) {
      const FramePair& frames = frames_[k];
      y[k] = relative_kinematics(in.slot(frames.P.slot), in.slot(frames.S.slot), frames.P.at(in.t), frames.S.at(in.t),
                                 moving_ ? 1u : 0u, Traits::kReads[k]);
    }
    return y;
  }

  /// What coordinates of pair k are not functions of the pose: where its angle is expected, and the memory.
  template <class T>
  void remember(LockCoords<T>& y, std::size_t k, const Inputs& in, const double* memory) const {
    if (Traits::counts(static_cast<int>(k))) y.near_rest = angles_[k]->rest(in.s), y.turns = angles_[k]->turns(in.s);
    if constexpr (kMemory > 0) y.memory = memory;
  }
  /// Coordinates of pair k; `variable(n, i)` makes number n of the variables, coordinate i of the pair.
  template <int k, class T, class Variable>
  void fill_coords(LockCoords<T>& c, const Inputs& in, const T& time, const double* memory, Variable&& variable) const {
    const auto v = [&](int i) { return variable(Traits::start(k) + i - Traits::first(k), i); };
    if constexpr (Traits::reads(k, Reads::translation)) c.x = v(0), c.y = v(1), c.z = v(2);
    if constexpr (Traits::reads(k, Reads::rotation)) c.e0 = v(3), c.e1 = v(4), c.e2 = v(5), c.e3 = v(6);
    c.t = time;
    remember(c, k, in, memory);
  }
  template <class T, class Variable>
  Coords<T> coords(const Inputs& in, const T& time, const double* memory, Variable&& variable) const {
    Coords<T> y;
    each_pair([&](auto k) {
      fill_coords<k>(y[k], in, time, memory, [&](int n, int i) { return variable(n, i, std::size_t(k)); });
    });
    return y;
  }
  Coords<Time> along_motion(const Inputs& in, const double* memory) const {
    const Points points = look_at(in);
    Coords<Time> y;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const RelativeKinematics& L = points[k];
      const auto v = [&](int i) { return Time(L.y[i], L.yd[i], 0); };
      y[k] = {v(0), v(1), v(2), v(3), v(4), v(5), v(6), Time(in.t, 1, 0)};
      remember(y[k], k, in, memory);
    }
    return y;
  }
  Coords<Time> at_start() const {
    Coords<Time> y;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const Pose rel = pose_at_start(*pairs_[k].first, *pairs_[k].second, frames_[k].P, frames_[k].S);
      y[k] = {rel.x[0], rel.x[1], rel.x[2], rel.q.w, rel.q.x, rel.q.y, rel.q.z, Time(0, 1, 0)};
    }
    return y;
  }
  template <class T>
  std::array<T, kRows> call(const Coords<T>& y) const {
    return std::apply(
        [&](const auto&... each) -> std::array<T, kRows> {
          if constexpr (kRows == 1)
            return {phi_(each...)};
          else
            return phi_(each...);
        },
        y);
  }

  template <template <Reads> class Seen>
  auto pairs_seen(const Inputs& in) const {
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      return std::tuple<Seen<Traits::kReads[k]>...>(Seen<Traits::kReads[k]>(frames_[k].P, frames_[k].S, in)...);
    }
    (std::make_index_sequence<kPairs>{});
  }

  /// Inlined as a whole, phi included: calls would cost half of the time.
  LOCKSTEP_FLAT void fill_still(const Inputs& in, const double* memory, const SlotList& slots, int first,
                                const RowBlock& block) const {
    fill_by(pairs_seen<StillPair>(in), in, memory, slots, first, block);
  }

  template <class Seen>
  void fill_by(const Seen& pairs, const Inputs& in, const double* memory, const SlotList& slots, int first,
               const RowBlock& block) const {
    Coords<Grad> y;
    each_pair([&](auto k) {
      const auto& pair = std::get<k>(pairs);
      fill_coords<k>(y[k], in, Grad(in.t, 1.0, 0.0), memory,
                     [&](int n, int i) { return Grad::variable(n, pair.y()[i], pair.yd()[i]); });
    });
    const Rows f = call(y);
    for (int r = 0; r < kRows; ++r) {
      const Grad& phi = f[r];
      Columns columns(slots);
      double Ct = phi.d, Qhat = -phi.h;
      each_pair([&](auto k) {
        const auto& pair = std::get<k>(pairs);
        const Eigen::Matrix<double, Traits::end(k) - Traits::first(k), 1> g = gradient<k>(phi);
        const PulledRow row = pair.pull(g);
        Ct += row.Ct - g.dot(part<k>(pair.yd()));
        Qhat += row.Qhat;
        columns.add(frames_[k], row);
      });
      block.C(first + r) = phi.v, block.Ct(first + r) = Ct, block.Qhat(first + r) = Qhat;
      columns.write(first + r, block);
    }
  }

  Rows value(const Points& y, const Inputs& in, const double* memory) const {
    return call(coords(in, Grad(in.t, 1.0, 0.0), memory,
                       [&](int n, int i, std::size_t k) { return Grad::variable(n, y[k].y[i], y[k].yd[i]); }));
  }
  /// Sum of lambda phi'' along the direction d of the variables, time fixed.
  double bend(const Points& y, const Inputs& in, const double* memory, const double* lambda,
              const Eigen::Matrix<double, kV, 1>& d) const {
    const auto f = call(coords(in, Time(in.t, 0.0, 0.0), memory,
                               [&](int n, int i, std::size_t k) { return Time(y[k].y[i], d[n], 0.0); }));
    double sum = 0;
    for (int r = 0; r < kRows; ++r) sum += lambda[r] * f[r].h;
    return sum;
  }
  /// From bend() along each variable and along the sum of each two of them: exact.
  MatV second_derivatives(const Points& y, const Inputs& in, const double* memory, const double* lambda) const {
    using Vec = Eigen::Matrix<double, kV, 1>;
    MatV H = MatV::Zero();
    for (int i = 0; i < kV; ++i) {
      H(i, i) = bend(y, in, memory, lambda, Vec::Unit(i));
      for (int j = 0; j < i; ++j)
        H(i, j) = H(j, i) = 0.5 * (bend(y, in, memory, lambda, Vec::Unit(i) + Vec::Unit(j)) - H(i, i) - H(j, j));
    }
    return H;
  }
  /// phi_ij of two pairs on all seven coordinates.
  static Eigen::Matrix<double, 7, 7> full(const MatV& H, int i, int j) {
    Eigen::Matrix<double, 7, 7> all = Eigen::Matrix<double, 7, 7>::Zero();
    const int ni = Traits::end(i) - Traits::first(i), nj = Traits::end(j) - Traits::first(j);
    all.block(Traits::first(i), Traits::first(j), ni, nj) = H.block(Traits::start(i), Traits::start(j), ni, nj);
    return all;
  }
  int slot_of(int side) const {
    const FramePair& pair = frames_[side / 2];
    return side % 2 == 0 ? pair.P.slot : pair.S.slot;
  }

  /// Jh = phi_y Jh_y of one row, columns of a shared body added (7.3).
  struct Columns {
    const SlotList& slots;
    std::array<Vec3, kMaxSlots> v, w;
    explicit Columns(const SlotList& on) : slots(on) {
      if constexpr (kPairs > 1)
        for (int i = 0; i < slots.n; ++i) at(v, i).setZero(), at(w, i).setZero();
    }
    static Vec3& at(std::array<Vec3, kMaxSlots>& a, int i) { return a[i]; }

    void add(const FramePair& frames, const PulledRow& row) {
      const int i = slots.position(frames.P.slot), j = slots.position(frames.S.slot);
      if constexpr (kPairs > 1) {
        if (i >= 0) at(v, i) += row.v, at(w, i) += row.w1;
        if (j >= 0) at(v, j) -= row.v, at(w, j) += row.w2;
      } else {
        if (i >= 0) at(v, i) = row.v, at(w, i) = row.w1;
        if (j >= 0) at(v, j) = -row.v, at(w, j) = row.w2;
      }
    }
    void write(int row, const RowBlock& block) {
      for (int i = 0; i < slots.n; ++i) block.set(i, row, at(v, i), at(w, i));
    }
  };

  void refuse_opposed(const std::string& link, const Coords<Time>& y) const {
    for (std::size_t k = 0; k < y.size(); ++k)
      if (Traits::counts(static_cast<int>(k)) && !(y[k].e0.v * y[k].e0.v + y[k].e3.v * y[k].e3.v > 1e-12))
        throw ModelError("link '" + link + "': the z axes of '" + pairs_[k].first->name + "' and '" +
                         pairs_[k].second->name +
                         "' point against one another at the start, so that there is no angle about them; turn one "
                         "marker by half a turn about its x axis");
  }
  /// What phi reads of a single pair is checked by the compiler (phi.h). Of several pairs the compiler checks only what
  /// all of them leave out; the rest is checked here, by coordinates that are NaN.
  void refuse_unread(const std::string& link, Coords<Time> y) const {
    std::array<double, kMemory + 1> memory{};
    start_memory({memory.data(), static_cast<std::size_t>(kMemory)});
    for (LockCoords<Time>& each : y) each.memory = memory.data();
    const auto finite = [&] {
      const auto rows = call(y);
      return std::all_of(rows.begin(), rows.end(), [](const Time& row) { return std::isfinite(row.v); });
    };
    if (!finite()) return;  // not a matter of what is read
    const Time none(std::numeric_limits<double>::quiet_NaN());
    for (std::size_t k = 0; k < y.size(); ++k) {
      if (!Traits::reads(static_cast<int>(k), Reads::translation)) y[k].x = y[k].y = y[k].z = none;
      if (!Traits::reads(static_cast<int>(k), Reads::rotation)) y[k].e0 = y[k].e1 = y[k].e2 = y[k].e3 = none;
      if (!finite())
        throw ModelError("link '" + link + "': its function reads coordinates of pair " + std::to_string(k + 1) +
                         " that its kReads leaves out; let kReads say what it reads of each pair");
    }
  }

  Phi phi_;
  Pairs pairs_;
  std::array<FramePair, kPairs> frames_;
  std::array<const CountedAngle*, kPairs> angles_{};  // null: its turns are not counted
  bool moving_ = false;  // whether a law moves one of the markers
};

}  // namespace lockstep
