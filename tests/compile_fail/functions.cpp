// SPDX-License-Identifier: BSD-3-Clause
// Functions of joints that must not compile. Behind "refused:" what the compiler has to say of the function below. run.sh
// compiles each with what stands before the first of them, which does compile.
#include <lockstep/author/phi_links.h>

namespace lockstep {

struct Plain {
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.1 * y.e3;
  }
};

struct Right : PhiHooks {
  LawPtr<MotionLaw> law;
  static constexpr PhiSpec spec{
      .rows = 2, .reads = Reads::rotation, .counts_turns = true, .memory = 1, .names = {"one", "two"}};
  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    using std::sin, std::pow, std::atan2;
    const T a = law ? sin(y.angle_z()) - law_at(*law, y.t) : y.angle_z();
    return {y.e1 < 0.5 ? pow(a, 3) : -a * y.e2, atan2(y.e1, y.e0) - y.memory[0]};
  }
  void initialise(const std::string&, PhiCoords) override {}
  void reset(std::span<double>, PhiCoords) const override {}
  void accept_step(std::span<double>, PhiCoords) const override {}
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { law->breakpoints(t0, t1, out); }
  std::string diagnose(double) const override { return {}; }
};
template class PhiLock<Right>;

// refused: 'spec'
struct Unsaid : Plain {};
template class PhiLock<Unsaid>;

// refused: 'row'
struct Misspelt : Plain {
  static constexpr PhiSpec spec{.row = 2};
};
template class PhiLock<Misspelt>;

// refused: override
struct OtherReset : Plain, PhiHooks {
  static constexpr PhiSpec spec{.memory = 1};
  void reset(std::span<double>) const override {}
};
template class PhiLock<OtherReset>;

// refused: a function with a memory derives from PhiHooks and writes it by reset() and accept_step()
struct NeverWritten : Plain {
  static constexpr PhiSpec spec{.memory = 1};
};
template class PhiLock<NeverWritten>;

// refused: are called of a function that derives from PhiHooks
struct NeverCalled : Plain {
  static constexpr PhiSpec spec{};
  std::string diagnose(double) const { return {}; }
};
template class PhiLock<NeverCalled>;

// refused: reset() writes a memory: give its size by PhiSpec::memory
struct MemoryOfNoSize : Plain, PhiHooks {
  static constexpr PhiSpec spec{};
  void reset(std::span<double>, PhiCoords) const override {}
};
template class PhiLock<MemoryOfNoSize>;

// refused: a function has one name for each of its rows, or none
struct OneNameTooMany : Plain {
  static constexpr PhiSpec spec{.names = {"one", "two"}};
};
template class PhiLock<OneNameTooMany>;

// refused: a function takes one to three pairs
struct OfFour : Plain {
  static constexpr PhiSpec spec{.pairs = 4};
};
template class PhiCoupling<OfFour>;

// refused: a function of several pairs makes a PhiCoupling
struct OfTwo {
  static constexpr PhiSpec spec{.pairs = 2};
  template <class T>
  T operator()(const LockCoords<T>& a, const LockCoords<T>& b) const {
    return a.x - b.x;
  }
};
template class PhiLock<OfTwo>;

// refused: TwoRows
struct TwoRows {
  static constexpr PhiSpec spec{};
  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    return {y.x, y.y};
  }
};
template class PhiLock<TwoRows>;

// refused: NoRow
struct NoRow {
  static constexpr PhiSpec spec{};
  template <class T>
  void operator()(const LockCoords<T>&) const {}
};
template class PhiLock<NoRow>;

// refused: a joint that derives from a facet
struct Unseen : Lock, Observable {};
template void check_facets<Unseen>();

}  // namespace lockstep
