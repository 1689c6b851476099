// SPDX-License-Identifier: BSD-3-Clause
// PhiFunction: a function of relative coordinates with its derivatives, as rows of a joint.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <memory>
#include <span>
#include <tuple>
#include <utility>

#include <lockstep/author/phi.h>
#include <lockstep/author/relative.h>
#include <lockstep/detail/phi_rows.h>
#include <lockstep/detail/rows.h>

namespace lockstep {

/// Whether Phi has a member that is named as a hook, which nothing would call.
template <class Phi>
concept HasUncalledHook =
    !std::derived_from<Phi, PhiHooks> &&
    (
        requires { &Phi::initialise; } || requires { &Phi::reset; } || requires { &Phi::accept_step; } ||
        requires { &Phi::breakpoints; } || requires { &Phi::diagnose; });
/// Whether Phi writes a memory.
template <class Phi>
concept WritesMemory =
    std::derived_from<Phi, PhiHooks> && !std::same_as<decltype(&Phi::reset), decltype(&PhiHooks::reset)>;

/// A function phi of the relative coordinates of its pairs. Gradients are jets; no Jacobian is written by hand.
template <class Phi>
class PhiFunction final : public PhiRows {
 public:
  static constexpr PhiSpec kSpec = Phi::spec;  ///< the declarations of phi
  static_assert(kSpec.pairs >= 1 && kSpec.pairs <= 3, "a function takes one to three pairs");
  static_assert(kSpec.rows >= 1 && kSpec.rows <= kMaxRows, "a joint has at most kMaxRows rows");
  static_assert(kSpec.names_fit(), "a function has one name for each of its rows, or none");
  static_assert(kSpec.memory == 0 || std::derived_from<Phi, PhiHooks>,
                "a function with a memory derives from PhiHooks and writes it by reset() and accept_step()");
  static_assert(
      !HasUncalledHook<Phi>,
      "initialise, reset, accept_step, breakpoints and diagnose are called of a function that derives from PhiHooks");
  static_assert(kSpec.memory > 0 || !WritesMemory<Phi>, "reset() writes a memory: give its size by PhiSpec::memory");

  /// Of this function.
  explicit PhiFunction(Phi phi) : PhiRows(kSpec), phi_(std::move(phi)) {
    if constexpr (std::derived_from<Phi, PhiHooks>) hooks_ = &phi_;
  }
  const Phi& phi() const { return phi_; }  ///< the function

  void fill(const Inputs& in, const double* memory, const SlotList& slots, int first,
            const RowBlock& block) const override {
    if (moving())
      fill_by(pairs_seen<MovingPair>(in), in, memory, slots, first, block);
    else
      fill_still(in, memory, slots, first, block);
  }

 protected:
  void values(PhiCoords y, std::span<Time> rows) const override { std::ranges::copy(call(y.data()), rows.begin()); }

 private:
  static constexpr int kPairs = kSpec.pairs, kRows = kSpec.rows;
  using Grad = Jet<(kSpec.variables() + 1) / 2 * 2>;  // an even number: whole packs

  template <class F>
  static void each_pair(F&& f) {
    [&]<std::size_t... k>(std::index_sequence<k...>) { (f(std::integral_constant<std::size_t, k>{}), ...); }
    (std::make_index_sequence<kPairs>{});
  }
  // Those of the seven numbers of pair k that phi reads.
  template <int k, class V>
  static auto part(V&& seven) {
    return seven.template segment<kSpec.end(k) - kSpec.first(k)>(kSpec.first(k));
  }

  template <class T>
  std::array<T, kRows> call(const LockCoords<T>* y) const {
    return [&]<std::size_t... k>(std::index_sequence<k...>)->std::array<T, kRows> {
      if constexpr (kRows == 1)
        return {phi_(y[k]...)};
      else
        return phi_(y[k]...);
    }
    (std::make_index_sequence<kPairs>{});
  }

  template <template <Reads> class Seen>
  auto pairs_seen(const Inputs& in) const {
    return [&]<std::size_t... k>(std::index_sequence<k...>) {
      return std::tuple<Seen<kSpec.reads.of[k]>...>(Seen<kSpec.reads.of[k]>(frames(k).P, frames(k).S, in)...);
    }
    (std::make_index_sequence<kPairs>{});
  }

  // Inlined as a whole, phi included: calls would cost half of the time.
  LOCKSTEP_FLAT void fill_still(const Inputs& in, const double* memory, const SlotList& slots, int first,
                                const RowBlock& block) const {
    fill_by(pairs_seen<StillPair>(in), in, memory, slots, first, block);
  }

  template <class Seen>
  void fill_by(const Seen& pairs, const Inputs& in, const double* memory, const SlotList& slots, int first,
               const RowBlock& block) const {
    std::array<LockCoords<Grad>, kPairs> y;
    each_pair([&](auto k) {
      const auto& pair = std::get<k>(pairs);
      LockCoords<Grad>& c = y[k];
      const auto v = [&](int i) {
        return Grad::variable(kSpec.start(k) + i - kSpec.first(k), pair.y()[i], pair.yd()[i]);
      };
      if constexpr (kSpec.reads_of(k, Reads::translation)) c.x = v(0), c.y = v(1), c.z = v(2);
      if constexpr (kSpec.reads_of(k, Reads::rotation)) c.e0 = v(3), c.e1 = v(4), c.e2 = v(5), c.e3 = v(6);
      c.t = Grad(in.t, 1.0, 0.0);
      c.memory = memory;
      if constexpr (kSpec.counts(k)) expect_angle(c, k, in);
    });
    const std::array<Grad, kRows> f = call(y.data());
    for (int r = 0; r < kRows; ++r) {
      const Grad& phi = f[static_cast<std::size_t>(r)];
      Columns columns(slots);
      double Ct = phi.d, Qhat = -phi.h;
      each_pair([&](auto k) {
        const auto& pair = std::get<k>(pairs);
        constexpr int n = kSpec.end(k) - kSpec.first(k);
        const Eigen::Matrix<double, n, 1> g = phi.g.template segment<n>(kSpec.start(k));
        const PulledRow row = pair.pull(g);
        Ct += row.Ct - g.dot(part<k>(pair.yd()));
        Qhat += row.Qhat;
        columns.add(frames(k), row);
      });
      block.C(first + r) = phi.v, block.Ct(first + r) = Ct, block.Qhat(first + r) = Qhat;
      columns.write(first + r, block);
    }
  }

  // Jh = phi_y Jh_y of one row, columns of a shared body added (7.3).
  struct Columns {
    const SlotList& slots;
    std::array<Vec3, kMaxSlots> v, w;
    explicit Columns(const SlotList& on) : slots(on) {
      if constexpr (kPairs > 1)
        for (int i = 0; i < slots.n; ++i) v[i].setZero(), w[i].setZero();
    }
    void add(const FramePair& frames, const PulledRow& row) {
      const int i = slots.position(frames.P.slot), j = slots.position(frames.S.slot);
      if constexpr (kPairs > 1) {
        if (i >= 0) v[i] += row.v, w[i] += row.w1;
        if (j >= 0) v[j] -= row.v, w[j] += row.w2;
      } else {
        if (i >= 0) v[i] = row.v, w[i] = row.w1;
        if (j >= 0) v[j] = -row.v, w[j] = row.w2;
      }
    }
    void write(int row, const RowBlock& block) {
      for (int i = 0; i < slots.n; ++i) block.set(i, row, v[i], w[i]);
    }
  };

  Phi phi_;
};

/// The rows of a function, for a joint that takes them.
template <class Phi>
std::unique_ptr<PhiRows> rows_of(Phi phi) {
  return std::unique_ptr<PhiRows>(new PhiFunction<Phi>(std::move(phi)));  // shorter errors than by make_unique
}
/// The function of rows that rows_of(Phi) made.
template <class Phi>
const Phi& phi_of(const PhiRows& rows) {
  return static_cast<const PhiFunction<Phi>&>(rows).phi();
}

}  // namespace lockstep
