// PhiFunction: a function phi of one to three pairs of markers, evaluated with all that a link makes of it (theory,
// (7.2), (7.3)). PhiLock and PhiCoupling are links around it.
#pragma once

#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "framework/mechanism/lock/geometric_stiffness.h"
#include "framework/mechanism/lock/marker_frame.h"
#include "framework/mechanism/lock/phi.h"
#include "framework/mechanism/lock/relative.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

template <class Phi>
class PhiFunction {
 public:
  using Traits = PhiTraits<Phi>;
  static constexpr int kPairs = Traits::kPairs, kRows = Traits::kRows;
  using Grad = Jet<Traits::kWidth>;
  using Rows = std::array<Grad, static_cast<std::size_t>(kRows)>;
  using MarkerPair = std::pair<const Marker*, const Marker*>;
  using Pairs = std::array<MarkerPair, static_cast<std::size_t>(kPairs)>;

  PhiFunction(Phi phi, const Pairs& pairs) : phi_(std::move(phi)), pairs_(pairs) {}

  const Phi& phi() const { return phi_; }
  const Pairs& pairs() const { return pairs_; }

  /// Folds the markers into their slots. Throws ModelError, naming `link`, when the turn of a particle is asked for.
  void setup(const std::string& link) {
    moving_ = false;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto [p, s] = pairs_[k];
      if (Traits::needs(static_cast<int>(k), Needs::rotation)) refuse_particles(link, *p, *s);
      Side& side = sides_[k];
      side.P = MarkerFrame(*p), side.S = MarkerFrame(*s);
      moving_ = moving_ || side.P.slide || side.P.spin || side.S.slide || side.S.spin;
    }
    const Coords<Time> y = at_home();
    if constexpr (Traits::kCountsTurns) refuse_opposed(link, y);
    std::apply(
        [&](const auto&... each) {
          if constexpr (requires { phi_.at_home(link, each...); }) phi_.at_home(link, each...);
        },
        y);
  }
  void add_slots(SlotList& slots) const {
    for (const Side& side : sides_) slots.add(side.P.slot), slots.add(side.S.slot);
  }

  // -- laws
  void breakpoints(double t0, double t1, std::vector<double>& out) const {
    if constexpr (requires { phi_.breakpoints(t0, t1, out); }) phi_.breakpoints(t0, t1, out);
  }
  std::string blame(double t) const {
    if constexpr (requires { phi_.blame(t); }) return phi_.blame(t);
    return {};
  }

  // -- evaluation; `memory`: what remember() and begin() wrote
  /// Rows first, first + 1, ... of the block: each number of them.
  ///
  ///   (7.2)  C = phi,  Ct = phi_y Ct_y + phi_t,  Jh = phi_y Jh_y,  Qhat = phi_y Qhat_y - phi'' along the motion
  void fill(const Inputs& in, const double* memory, const SlotList& slots, int first, const RowBlock& block) const {
    if (moving_)
      fill_by(pairs_seen<MovingPair>(in), in, memory, slots, first, block);
    else
      fill_still(in, memory, slots, first, block);
  }

  /// (9.11), (9.12) K = lambda ( J_i^T phi_ij J_j + K_lock of each pair ), one multiplier a row.
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
      for (int r = 0; r < kRows; ++r) part<k>(phi_y) += lambda[r] * gradient<k>(f[static_cast<std::size_t>(r)]);
      const Side& side = sides_[k];
      const MarkerMotion P = side.P.at(in.t), S = side.S.at(in.t);
      if (Traits::needs(k, Needs::translation))
        add_translation_stiffness(in, side.P.slot, side.S.slot, P, S, phi_y.template head<3>(), out);
      if (Traits::needs(k, Needs::rotation))
        add_rotation_stiffness(in, side.P.slot, side.S.slot, P, S, Quat{}, Quat::from(phi_y.template tail<4>()), out);
    });
    for (int a = 0; a < 2 * kPairs; ++a)
      for (int b = 0; b < 2 * kPairs; ++b)
        out.add_K(slot_of(a), slot_of(b),
                  J[static_cast<std::size_t>(a)].transpose() * full(H, a / 2, b / 2) * J[static_cast<std::size_t>(b)]);
  }

  // -- memory: for each pair that counts turns the last angle, its rate and instant; then phi's own numbers
  static constexpr int kAngles = Traits::kCountsTurns ? 3 * kPairs : 0;
  static constexpr int kOwn = [] {
    if constexpr (requires { Phi::kMemory; }) return int(Phi::kMemory);
    return 0;
  }();
  static constexpr int kMemory = kAngles + kOwn;

  void begin(std::span<double> z) const {
    const Coords<Time> y = at_home();
    if constexpr (Traits::kCountsTurns)
      for (std::size_t k = 0; k < y.size(); ++k) z[3 * k] = y[k].angle_z().v, z[3 * k + 1] = z[3 * k + 2] = 0;
    if constexpr (kOwn > 0) std::apply([&](const auto&... each) { phi_.begin(z.subspan(kAngles), each...); }, y);
  }
  void remember(const Inputs& in, std::span<double> z) const {
    const Coords<Time> y = along_motion(in, z.data());
    if constexpr (kOwn > 0) std::apply([&](const auto&... each) { phi_.remember(z.subspan(kAngles), each...); }, y);
    if constexpr (Traits::kCountsTurns)
      for (std::size_t k = 0; k < y.size(); ++k) {
        const Time angle = y[k].angle_z();
        z[3 * k] = angle.v, z[3 * k + 1] = angle.d, z[3 * k + 2] = in.t;
      }
  }

  /// tell(phi, y...) with the coordinates as they move: value and rate of each; for channels of the link's own.
  template <class Tell>
  auto seen(const Inputs& in, const double* memory, Tell&& tell) const {
    return std::apply([&](const auto&... each) { return tell(phi_, each...); }, along_motion(in, memory));
  }

 private:
  struct Side {
    MarkerFrame P, S;
  };
  using Points = std::array<RelativeKinematics, static_cast<std::size_t>(kPairs)>;
  static constexpr int kV = Traits::kVariables;
  using MatV = Eigen::Matrix<double, kV, kV>;
  template <class T>
  using Coords = std::array<LockCoords<T>, static_cast<std::size_t>(kPairs)>;

  template <class F>
  static void each_pair(F&& f) {
    [&]<std::size_t... k>(std::index_sequence<k...>) { (f(std::integral_constant<std::size_t, k>{}), ...); }
    (std::make_index_sequence<static_cast<std::size_t>(kPairs)>{});
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
      const Side& side = sides_[static_cast<std::size_t>(k)];
      y[static_cast<std::size_t>(k)] =
          relative_kinematics(in.slot(side.P.slot), in.slot(side.S.slot), side.P.at(in.t), side.S.at(in.t),
                              moving_ ? 1u : 0u, Traits::kNeeds[static_cast<std::size_t>(k)]);
    }
    return y;
  }

  template <class T>
  void expect(LockCoords<T>& y, std::size_t k, double t, const double* memory) const {
    if constexpr (Traits::kCountsTurns) y.near_angle = memory[3 * k] + memory[3 * k + 1] * (t - memory[3 * k + 2]);
    if constexpr (kOwn > 0) y.memory = memory + kAngles;
  }
  /// Coordinates of pair k; `variable(n, i)` makes number n of the variables, coordinate i of the pair.
  template <int k, class T, class Variable>
  void place(LockCoords<T>& c, double t, const T& time, const double* memory, Variable&& variable) const {
    const auto v = [&](int i) { return variable(Traits::start(k) + i - Traits::first(k), i); };
    if constexpr (Traits::needs(k, Needs::translation)) c.x = v(0), c.y = v(1), c.z = v(2);
    if constexpr (Traits::needs(k, Needs::rotation)) c.e0 = v(3), c.e1 = v(4), c.e2 = v(5), c.e3 = v(6);
    c.t = time;
    expect(c, k, t, memory);
  }
  template <class T, class Variable>
  Coords<T> coords(double t, const T& time, const double* memory, Variable&& variable) const {
    Coords<T> y;
    each_pair(
        [&](auto k) { place<k>(y[k], t, time, memory, [&](int n, int i) { return variable(n, i, std::size_t(k)); }); });
    return y;
  }
  Coords<Time> along_motion(const Inputs& in, const double* memory) const {
    const Points points = look_at(in);
    Coords<Time> y;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const RelativeKinematics& L = points[k];
      const auto v = [&](int i) { return Time(L.y[i], L.yd[i], 0); };
      y[k] = {v(0), v(1), v(2), v(3), v(4), v(5), v(6), Time(in.t, 1, 0)};
      expect(y[k], k, in.t, memory);
    }
    return y;
  }
  Coords<Time> at_home() const {
    Coords<Time> y;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const Pose rel = start_of(*pairs_[k].first, *pairs_[k].second, sides_[k]);
      y[k] = {rel.x[0], rel.x[1], rel.x[2], rel.q.w, rel.q.x, rel.q.y, rel.q.z, Time(0, 1, 0)};
    }
    return y;
  }
  template <class T>
  std::array<T, static_cast<std::size_t>(kRows)> call(const Coords<T>& y) const {
    return std::apply(
        [&](const auto&... each) -> std::array<T, static_cast<std::size_t>(kRows)> {
          if constexpr (kRows == 1)
            return {phi_(each...)};
          else
            return phi_(each...);
        },
        y);
  }

  template <template <Needs> class Seen>
  auto pairs_seen(const Inputs& in) const {
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      return std::tuple<Seen<Traits::kNeeds[k]>...>(Seen<Traits::kNeeds[k]>(sides_[k].P, sides_[k].S, in)...);
    }
    (std::make_index_sequence<static_cast<std::size_t>(kPairs)>{});
  }

  /// In one piece, phi included: half of the time would go into calls.
  [[gnu::flatten]] void fill_still(const Inputs& in, const double* memory, const SlotList& slots, int first,
                                   const RowBlock& block) const {
    fill_by(pairs_seen<StillPair>(in), in, memory, slots, first, block);
  }

  template <class Seen>
  void fill_by(const Seen& pairs, const Inputs& in, const double* memory, const SlotList& slots, int first,
               const RowBlock& block) const {
    Coords<Grad> y;
    each_pair([&](auto k) {
      const auto& pair = std::get<k>(pairs);
      place<k>(y[k], in.t, Grad(in.t, 1.0, 0.0), memory,
               [&](int n, int i) { return Grad::variable(n, pair.y()[i], pair.yd()[i]); });
    });
    const Rows f = call(y);
    for (int r = 0; r < kRows; ++r) {
      const Grad& phi = f[static_cast<std::size_t>(r)];
      Columns columns(slots);
      double Ct = phi.d, Qhat = -phi.h;
      each_pair([&](auto k) {
        const auto& pair = std::get<k>(pairs);
        const Eigen::Matrix<double, Traits::end(k) - Traits::first(k), 1> g = gradient<k>(phi);
        const PulledRow row = pair.pull(g);
        Ct += row.Ct - g.dot(part<k>(pair.yd()));
        Qhat += row.Qhat;
        columns.add(sides_[k], row);
      });
      block.C(first + r) = phi.v, block.Ct(first + r) = Ct, block.Qhat(first + r) = Qhat;
      columns.write(first + r, block);
    }
  }

  Rows value(const Points& y, const Inputs& in, const double* memory) const {
    return call(coords(in.t, Grad(in.t, 1.0, 0.0), memory,
                       [&](int n, int i, std::size_t k) { return Grad::variable(n, y[k].y[i], y[k].yd[i]); }));
  }
  /// sum of lambda phi'' along the variables' direction d, time fixed.
  double bend(const Points& y, const Inputs& in, const double* memory, const double* lambda,
              const Eigen::Matrix<double, kV, 1>& d) const {
    const auto f = call(coords(in.t, Time(in.t, 0.0, 0.0), memory,
                               [&](int n, int i, std::size_t k) { return Time(y[k].y[i], d[n], 0.0); }));
    double sum = 0;
    for (int r = 0; r < kRows; ++r) sum += lambda[r] * f[static_cast<std::size_t>(r)].h;
    return sum;
  }
  /// By its bends along each variable and along each pair of them: exact, and no more than what phi can tell.
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
    const Side& pair = sides_[static_cast<std::size_t>(side / 2)];
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
    static Vec3& at(std::array<Vec3, kMaxSlots>& a, int i) { return a[static_cast<std::size_t>(i)]; }

    void add(const Side& side, const PulledRow& row) {
      const int i = slots.position(side.P.slot), j = slots.position(side.S.slot);
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

  static void refuse_particles(const std::string& link, const Marker& p, const Marker& s) {
    for (const Marker* m : {&p, &s})
      if (m->body->freedoms == Freedoms::particle)
        throw ModelError("link '" + link + "' holds turns (phi) of '" + m->body->name +
                         "', which is a particle and does not turn; give it an inertia, or take a link that leaves "
                         "turns free");
  }
  void refuse_opposed(const std::string& link, const Coords<Time>& y) const {
    for (std::size_t k = 0; k < y.size(); ++k)
      if (!(y[k].e0.v * y[k].e0.v + y[k].e3.v * y[k].e3.v > 1e-12))
        throw ModelError("link '" + link + "': the z axes of '" + pairs_[k].first->name + "' and '" +
                         pairs_[k].second->name +
                         "' point against one another at the start, so that there is no angle about them; turn one "
                         "marker by half a turn about its x axis");
  }
  /// P seen from S in the home poses, the markers' own laws at t = 0 included.
  static Pose start_of(const Marker& p, const Marker& s, const Side& side) {
    const auto in_world = [](const Marker& m, const MarkerMotion& k) {
      const Pose slot = m.body->slot == kGround ? Pose{} : m.body->home * inverse(m.body->in_slot);
      return slot * Pose{k.u, k.q};
    };
    return inverse(in_world(s, side.S.at(0.0))) * in_world(p, side.P.at(0.0));
  }

  Phi phi_;
  Pairs pairs_;
  std::array<Side, static_cast<std::size_t>(kPairs)> sides_;
  bool moving_ = false;  // a marker that has a law of its own
};

}  // namespace lockstep
