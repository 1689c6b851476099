// SPDX-License-Identifier: BSD-3-Clause
// Functions of joints that must not compile. Behind "refused:" what the compiler has to say of the function below;
// run.sh looks for each. `Right` must not be named.
#include <lockstep/author/phi_links.h>

namespace lockstep {

struct Plain {
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.1 * y.e3;
  }
};

// refused: by kCountsTurns
struct CountTurns : Plain {
  static constexpr bool kCountTurns = true;
};
template class PhiLock<CountTurns>;

// refused: by kRows
struct Row_ : Plain {
  static constexpr int kRow = 2;
};
template class PhiLock<Row_>;

// refused: by kReads (kNeeds is its old name)
struct Needs : Plain {
  static constexpr Reads kNeeds = Reads::translation;
};
template class PhiLock<Needs>;

// refused: by kPairs
struct Pair : Plain {
  static constexpr int kPair = 1;
};
template class PhiLock<Pair>;

// refused: by kKind
struct Kinds : Plain {
  static constexpr RowKind kKinds = RowKind::translation;
};
template class PhiLock<Kinds>;

// refused: by kStaysInPlane
struct IsPlanar : Plain {
  static constexpr bool kPlanar = true;
};
template class PhiLock<IsPlanar>;

// refused: by kNames
struct Name : Plain {
  static constexpr std::array<const char*, 1> kName = {"row"};
};
template class PhiLock<Name>;

// refused: by kMemory
struct OwnMemory : Plain {
  static constexpr int kOwnMemory = 1;
};
template class PhiLock<OwnMemory>;

// refused: is initialise(link, y...)
struct Initialize : Plain {
  template <class T>
  void initialize(const std::string&, const LockCoords<T>&) {}
};
template class PhiLock<Initialize>;

// refused: is reset(z, y...)
struct Begin : Plain {
  void begin(std::span<double>, const LockCoords<Time>&) const {}
};
template class PhiLock<Begin>;

// refused: is accept_step(z, y...)
struct Remember : Plain {
  void remember(std::span<double>, const LockCoords<Time>&) const {}
};
template class PhiLock<Remember>;

// refused: is breakpoints(t0, t1, out)
struct BreakPoints : Plain {
  void break_points(double, double, std::vector<double>&) const {}
};
template class PhiLock<BreakPoints>;

// refused: is diagnose(t)
struct Blame : Plain {
  std::string blame(double) const { return {}; }
};
template class PhiLock<Blame>;

// refused: initialise is not void initialise(const std::string& link, const LockCoords<Time>& y)
struct InitialisesNothing : Plain {
  void initialise(const LockCoords<Time>&) {}
};
template class PhiLock<InitialisesNothing>;

// refused: breakpoints is not void breakpoints(double t0, double t1, std::vector<double>& out) const
struct BreakpointsOfOne : Plain {
  void breakpoints(double, std::vector<double>&) const {}
};
template class PhiLock<BreakpointsOfOne>;

// refused: a function with kMemory writes it by reset(z, y...) and accept_step(z, y...)
struct NeverWritten : Plain {
  static constexpr int kMemory = 1;
};
template class PhiLock<NeverWritten>;

// refused: say by kMemory how many numbers it has
struct NoMemory : Plain {
  void reset(std::span<double>, const LockCoords<Time>&) const {}
};
template class PhiLock<NoMemory>;

// refused: say_kMemory
struct ReadsMemory {
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - y.memory[0];
  }
};
template class PhiLock<ReadsMemory>;

// refused: reads e0 ... e3, which its kReads leaves out; add rotation to kReads
struct ReadsTurn {
  static constexpr Reads kReads = Reads::translation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.1 * y.e3;
  }
};
template class PhiLock<ReadsTurn>;

// refused: reads x, y or z, which its kReads leaves out; add translation to kReads
struct ReadsPlace {
  static constexpr Reads kReads = Reads::rotation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.x + y.e3;
  }
};
template class PhiLock<ReadsPlace>;

// refused: add_translation_to_kReads
struct RootOfPlace {
  static constexpr Reads kReads = Reads::rotation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    using std::sin;
    return sin(y.x) + y.e3;
  }
};
template class PhiLock<RootOfPlace>;

// refused: calls angle_z(), a turn, which its kReads leaves out
struct ReadsAngle {
  static constexpr bool kCountsTurns = true;
  static constexpr Reads kReads = Reads::translation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - y.angle_z();
  }
};
template class PhiLock<ReadsAngle>;

// refused: say static constexpr bool kCountsTurns = true, or false
struct TurnsUnsaid {
  static constexpr bool kCuontsTunrs = true;  // whatever the spelling
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - y.angle_z();
  }
};
template class PhiLock<TurnsUnsaid>;

// refused: kRows is not the number of rows that the function returns
struct TwoRows {
  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    return {y.x, y.y};
  }
};
template class PhiLock<TwoRows>;

// refused: a function returns T, or std::array<T, kRows>
struct NoRow {
  template <class T>
  void operator()(const LockCoords<T>&) const {}
};
template class PhiLock<NoRow>;

// refused: kPairs says how many
struct OfTwo {
  static constexpr Reads kReads = Reads::translation;
  template <class T>
  T operator()(const LockCoords<T>& a, const LockCoords<T>& b) const {
    return a.x - b.x;
  }
};
template class PhiCoupling<OfTwo>;

// refused: kNames has one name for each
struct OneNameTooMany : Plain {
  static constexpr std::array<const char*, 2> kNames = {"one", "two"};
};
template class PhiLock<OneNameTooMany>;

// refused: a link that derives from a facet
struct Unseen : Lock, Observable {};
template void check_facets<Unseen>();

struct Right {
  LawPtr<MotionLaw> law;
  static constexpr bool kCountsTurns = true;
  static constexpr int kMemory = 1, kRows = 2;
  static constexpr Reads kReads = Reads::rotation;
  static constexpr std::array<const char*, 2> kNames = {"one", "two"};
  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    using std::sin, std::pow, std::atan2;
    const T a = law ? sin(y.angle_z()) - law_at(*law, y.t) : y.angle_z();
    return {y.e1 < 0.5 ? pow(a, 3) : -a * y.e2, atan2(y.e1, y.e0) - y.memory[0]};
  }
  void initialise(const std::string&, const LockCoords<Time>&) {}
  void reset(std::span<double>, const LockCoords<Time>&) const {}
  void accept_step(std::span<double>, const LockCoords<Time>&) const {}
  void breakpoints(double t0, double t1, std::vector<double>& out) const { law->breakpoints(t0, t1, out); }
  std::string diagnose(double) const { return {}; }
};
static_assert(phi_check::Spelling<Right>::kChecked && phi_check::Reading<Right>::kChecked);
static_assert(phi_check::Hooks<Right>::kInitialises && phi_check::Hooks<Right>::kAccepts);

}  // namespace lockstep
