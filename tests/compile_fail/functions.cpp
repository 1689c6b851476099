// Functions of joints that must not compile. Behind "refused:" what the compiler has to say of the function below;
// run.sh looks for each. `Right` must not be named.
#include <lockstep/phi_links.h>

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
static_assert(sizeof(PhiLock<CountTurns>) > 0);

// refused: by kRows
struct Row_ : Plain {
  static constexpr int kRow = 2;
};
static_assert(sizeof(PhiLock<Row_>) > 0);

// refused: by kReads (kNeeds is its old name)
struct Needs : Plain {
  static constexpr Reads kNeeds = Reads::translation;
};
static_assert(sizeof(PhiLock<Needs>) > 0);

// refused: by kPairs
struct Pair : Plain {
  static constexpr int kPair = 1;
};
static_assert(sizeof(PhiLock<Pair>) > 0);

// refused: by kKind
struct Kinds : Plain {
  static constexpr RowKind kKinds = RowKind::translation;
};
static_assert(sizeof(PhiLock<Kinds>) > 0);

// refused: by kStaysInPlane
struct IsPlanar : Plain {
  static constexpr bool kPlanar = true;
};
static_assert(sizeof(PhiLock<IsPlanar>) > 0);

// refused: by kNames
struct Name : Plain {
  static constexpr std::array<const char*, 1> kName = {"row"};
};
static_assert(sizeof(PhiLock<Name>) > 0);

// refused: by kMemory
struct OwnMemory : Plain {
  static constexpr int kOwnMemory = 1;
};
static_assert(sizeof(PhiLock<OwnMemory>) > 0);

// refused: is initialise(link, y...)
struct Initialize : Plain {
  template <class T>
  void initialize(const std::string&, const LockCoords<T>&) {}
};
static_assert(sizeof(PhiLock<Initialize>) > 0);

// refused: is reset(z, y...)
struct Begin : Plain {
  void begin(std::span<double>, const LockCoords<Time>&) const {}
};
static_assert(sizeof(PhiLock<Begin>) > 0);

// refused: is accept_step(z, y...)
struct Remember : Plain {
  void remember(std::span<double>, const LockCoords<Time>&) const {}
};
static_assert(sizeof(PhiLock<Remember>) > 0);

// refused: is breakpoints(t0, t1, out)
struct BreakPoints : Plain {
  void break_points(double, double, std::vector<double>&) const {}
};
static_assert(sizeof(PhiLock<BreakPoints>) > 0);

// refused: is diagnose(t)
struct Blame : Plain {
  std::string blame(double) const { return {}; }
};
static_assert(sizeof(PhiLock<Blame>) > 0);

// refused: initialise is not void initialise(const std::string& link, const LockCoords<Time>& y)
struct InitialisesNothing : Plain {
  void initialise(const LockCoords<Time>&) {}
};
static_assert(sizeof(PhiLock<InitialisesNothing>) > 0);

// refused: breakpoints is not void breakpoints(double t0, double t1, std::vector<double>& out) const
struct BreakpointsOfOne : Plain {
  void breakpoints(double, std::vector<double>&) const {}
};
static_assert(sizeof(PhiLock<BreakpointsOfOne>) > 0);

// refused: a function with kMemory writes it by reset(z, y...) and accept_step(z, y...)
struct NeverWritten : Plain {
  static constexpr int kMemory = 1;
};
static_assert(sizeof(PhiLock<NeverWritten>) > 0);

// refused: say by kMemory how many numbers it has
struct NoMemory : Plain {
  void reset(std::span<double>, const LockCoords<Time>&) const {}
};
static_assert(sizeof(PhiLock<NoMemory>) > 0);

// refused: say_kMemory
struct ReadsMemory {
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - y.memory[0];
  }
};
static_assert(sizeof(PhiLock<ReadsMemory>) > 0);

// refused: reads e0 ... e3, which its kReads leaves out; add rotation to kReads
struct ReadsTurn {
  static constexpr Reads kReads = Reads::translation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - 0.1 * y.e3;
  }
};
static_assert(sizeof(PhiLock<ReadsTurn>) > 0);

// refused: reads x, y or z, which its kReads leaves out; add translation to kReads
struct ReadsPlace {
  static constexpr Reads kReads = Reads::rotation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.x + y.e3;
  }
};
static_assert(sizeof(PhiLock<ReadsPlace>) > 0);

// refused: add_translation_to_kReads
struct RootOfPlace {
  static constexpr Reads kReads = Reads::rotation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    using std::sin;
    return sin(y.x) + y.e3;
  }
};
static_assert(sizeof(PhiLock<RootOfPlace>) > 0);

// refused: calls angle_z(), a turn, which its kReads leaves out
struct ReadsAngle {
  static constexpr bool kCountsTurns = true;
  static constexpr Reads kReads = Reads::translation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - y.angle_z();
  }
};
static_assert(sizeof(PhiLock<ReadsAngle>) > 0);

// refused: say static constexpr bool kCountsTurns = true, or false
struct TurnsUnsaid {
  static constexpr bool kCuontsTunrs = true;  // whatever the spelling
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - y.angle_z();
  }
};
static_assert(sizeof(PhiLock<TurnsUnsaid>) > 0);

// refused: kRows is not the number of rows that the function returns
struct TwoRows {
  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    return {y.x, y.y};
  }
};
static_assert(sizeof(PhiLock<TwoRows>) > 0);

// refused: a function returns T, or std::array<T, kRows>
struct NoRow {
  template <class T>
  void operator()(const LockCoords<T>&) const {}
};
static_assert(sizeof(PhiLock<NoRow>) > 0);

// refused: kPairs says how many
struct OfTwo {
  static constexpr Reads kReads = Reads::translation;
  template <class T>
  T operator()(const LockCoords<T>& a, const LockCoords<T>& b) const {
    return a.x - b.x;
  }
};
static_assert(sizeof(PhiCoupling<OfTwo>) > 0);

// refused: kNames has one name for each
struct OneNameTooMany : Plain {
  static constexpr std::array<const char*, 2> kNames = {"one", "two"};
};
static_assert(sizeof(PhiLock<OneNameTooMany>) > 0);

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
