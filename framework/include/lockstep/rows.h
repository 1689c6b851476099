// Constraint rows, wrench and tangent sums, as links and forces write them.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/export.h>
#include <lockstep/jet.h>
#include <lockstep/math.h>
#include <lockstep/memory.h>
#include <lockstep/state.h>

namespace lockstep {

// Rows: where links write what they constrain, and where solvers read it. Neither knows the other.
//
// One block per link: C, Ct, Qhat (m each, in the link's own axes), then the jacobian of each moving slot it touches,
// column after column, every column padded to a pack. Links of one group (same type, same pattern) follow one another,
// so that a group is gathered by one call.


/// What a row measures: metres (force multiplier), half turns (moment multiplier), or a function's own value.
enum class RowKind : unsigned char { translation, rotation, function };

inline constexpr int kMaxSlots = 4;  ///< bodies that one link may touch
inline constexpr int kMaxRows = 8;   ///< rows that one link may have

/// How the jacobian of a link is kept.
///   dense   any rows: 6 columns per slot, v (world) then w (slot axes)
///   triple  the first three rows are a full translational triple. In world axes they are +-[1 | A]: only A is computed,
///           kept and multiplied; the rows after them turn only. R turns the link's axes into the world's.
///   planar  any rows of a planar mechanism: 3 columns per slot, the plane's velocities
///   pair    the first two rows are a full translational pair of the plane, +-[1 | A], as in a triple
enum class RowLayout : unsigned char { dense, triple, planar, pair };
constexpr int n_columns(RowLayout layout) {
  constexpr int n[] = {6, 3, 3, 1};
  return n[static_cast<int>(layout)];
}
/// Rows whose linear part is +-R^T: 3 of a triple, 2 of a pair.
constexpr int n_turned(RowLayout layout) { return layout == RowLayout::triple ? 3 : layout == RowLayout::pair ? 2 : 0; }

/// Moving slots that a link touches, ground left out, a shared slot once.
struct SlotList {
  std::array<int, kMaxSlots> slot{};
  int n = 0;
  SlotList() = default;
  void add(int k) {
    if (k == kGround || position(k) >= 0) return;
    assert(n < kMaxSlots);
    slot[static_cast<std::size_t>(n++)] = k;
  }
  /// Position of slot k in the list; -1 for the ground.
  int position(int k) const {
    for (int i = 0; i < n; ++i)
      if (slot[static_cast<std::size_t>(i)] == k) return i;
    return -1;
  }
  int operator[](int i) const { return slot[static_cast<std::size_t>(i)]; }
};

/// What a block's numbers mean: its rows, slots and layout.
struct RowShape {
  int m = 0, n = 0;
  RowLayout layout = RowLayout::dense;
  double sign = 1;  ///< triple, pair: +1 when the first slot is P's body, -1 when only S's moves; a second slot has -1
  Plane plane;      ///< planar, pair: which

  int ld() const { return pack_size(m); }  ///< numbers from one column to the next
  std::size_t R() const { return at(3); }
  std::size_t J(int i) const { return at(3 + n_turned(layout) + n_columns(layout) * i); }
  std::size_t size() const { return J(n); }
  double sign_of(int i) const { return i == 0 ? sign : -1.0; }

 private:
  std::size_t at(int column) const { return static_cast<std::size_t>(column * ld()); }
};

/// The rows of one link: RowBlock to be written and read, RowView only to be read.
template <class Number>
class BasicRowBlock {
 public:
  BasicRowBlock(Number* base, const RowShape& shape) : p_(base), shape_(shape), ld_(shape.ld()) {}
  operator BasicRowBlock<const double>() const { return {p_, shape_}; }

  int rows() const { return shape_.m; }
  int slots() const { return shape_.n; }
  RowLayout layout() const { return shape_.layout; }
  Number& C(int k) const { return p_[k]; }
  Number& Ct(int k) const { return p_[ld_ + k]; }
  Number& Qhat(int k) const { return p_[2 * ld_ + k]; }

  /// Row k on the link's i-th slot: 6 numbers, v (world) then w (slot axes).
  std::array<double, 6> J(int i, int k) const {
    const double* a = p_ + shape_.J(i);
    if (shape_.layout == RowLayout::dense)
      return {a[k], a[ld_ + k], a[2 * ld_ + k], a[3 * ld_ + k], a[4 * ld_ + k], a[5 * ld_ + k]};
    if (shape_.layout == RowLayout::planar || shape_.layout == RowLayout::pair) return in_space(i, k, a);
    if (k >= 3) return {0, 0, 0, a[k], a[ld_ + k], a[2 * ld_ + k]};
    const double* r = p_ + shape_.R() + k * ld_;  // column k of R: the link's axis k in the world
    const double s = shape_.sign_of(i);
    const auto turned = [&](int c) { return r[0] * a[c * ld_] + r[1] * a[c * ld_ + 1] + r[2] * a[c * ld_ + 2]; };
    return {s * r[0], s * r[1], s * r[2], turned(0), turned(1), turned(2)};
  }

  /// Row k on slot number i; i < 0 (a grounded side) is ignored. In a triple or pair only rows that turn, v being zero;
  /// in the plane what leaves it is ignored.
  template <class V, class W>
  void set(int i, int k, const V& v, const W& w) const {
    if (i < 0) return;
    double* r = p_ + shape_.J(i) + k;
    if (shape_.layout == RowLayout::dense) {
      r[0] = v[0], r[ld_] = v[1], r[2 * ld_] = v[2];
      r += 3 * ld_;
    } else if (shape_.layout != RowLayout::triple) {
      const Plane& plane = shape_.plane;
      if (shape_.layout == RowLayout::planar) {
        r[0] = v[plane.i()], r[ld_] = v[plane.j()];
        r += 2 * ld_;
      }
      r[0] = w[plane.n];
      return;
    }
    r[0] = w[0], r[ld_] = w[1], r[2 * ld_] = w[2];
  }
  template <class V, class W>
  void add(int i, int k, const V& v, const W& w) const {
    if (i < 0) return;
    const std::array<double, 6> r = J(i, k);
    set(i, k, Vec3(r[0] + v[0], r[1] + v[1], r[2] + v[2]), Vec3(r[3] + w[0], r[4] + w[1], r[5] + w[2]));
  }

  /// Triple, pair: link axes -> world (3 x 3, 2 x 2), and the angular part of those rows on slot i, in world axes
  /// (3 x 3, 2 x 1).
  template <class M>
  void set_R(const M& R) const {
    put(p_ + shape_.R(), R);
  }
  template <class M>
  void set_A(int i, const M& A) const {
    if (i >= 0) put(p_ + shape_.J(i), A);
  }

  /// All numbers of the block, the padding (zeros) included.
  const double* numbers() const { return p_; }
  std::size_t size() const { return shape_.size(); }

 private:
  template <class M>
  void put(double* a, const M& A) const {
    for (int c = 0; c < M::ColsAtCompileTime; ++c)
      for (int k = 0; k < M::RowsAtCompileTime; ++k) a[c * ld_ + k] = A(k, c);
  }
  std::array<double, 6> in_space(int i, int k, const double* a) const {
    const Plane& plane = shape_.plane;
    std::array<double, 6> out{};
    const auto set_out = [&](double vi, double vj, double w) {
      out[static_cast<std::size_t>(plane.i())] = vi, out[static_cast<std::size_t>(plane.j())] = vj;
      out[static_cast<std::size_t>(3 + plane.n)] = w;
    };
    if (shape_.layout == RowLayout::planar) {
      set_out(a[k], a[ld_ + k], a[2 * ld_ + k]);
    } else if (k < 2) {
      const double *r = p_ + shape_.R() + k * ld_, s = shape_.sign_of(i);
      set_out(s * r[0], s * r[1], r[0] * a[0] + r[1] * a[1]);
    } else {
      set_out(0, 0, a[k]);
    }
    return out;
  }
  Number* p_;
  RowShape shape_;
  int ld_;
};
using RowBlock = BasicRowBlock<double>;
using RowView = BasicRowBlock<const double>;

/// The rows of a group, link after link.
class RowSpan {
 public:
  RowSpan(double* base, const RowShape& shape) : base_(base), shape_(shape), stride_(stride(shape)) {}
  RowBlock lane(std::size_t k) const { return {base_ + k * stride_, shape_}; }
  /// Numbers from one link to the next: blocks begin where packs may.
  static std::size_t stride(const RowShape& shape) { return aligned_to(shape.size(), 8); }

 private:
  double* base_;
  RowShape shape_;
  std::size_t stride_;
};

/// The rows of one active link in the table.
struct RowEntry {
  int link = 0;       ///< number of the link in the system
  int first_row = 0;  ///< its first row among all active ones
  int m = 0;          ///< its rows
  SlotList slots;
  RowLayout layout = RowLayout::dense;
  double sign = 1;  ///< as in RowShape
  Plane plane;
  std::size_t offset = 0;  ///< of its block in the table
  std::array<RowKind, kMaxRows> kind{};
  /// Which of the link's own rows each of them is; they differ where a planar mechanism leaves rows out.
  std::array<int, kMaxRows> own{0, 1, 2, 3, 4, 5, 6, 7};

  RowShape shape() const { return {m, slots.n, layout, sign, plane}; }
};

/// Neighbours in the table that one call gathers.
struct RowRun {
  int first_entry = 0, n = 0;
  int first_link = 0;     ///< where the run begins in the system's order of links
  bool in_plane = false;  ///< gathered by gather_plane
};

/// All active rows of the system.
class RowTable {
 public:
  std::vector<RowEntry> entries;  ///< in the order of the table, group after group
  std::vector<RowRun> runs;
  std::vector<int> entry_of_link;  ///< -1: not active
  int n_rows = 0;

  /// Lays the entries out one after another; memory only grows.
  void lay_out() {
    std::size_t at = 0;
    n_rows = 0;
    for (RowEntry& e : entries) {
      e.first_row = n_rows;
      e.offset = at;
      n_rows += e.m;
      at += RowSpan::stride(e.shape());
    }
    data_.assign(at, 0.0);  // what pads the columns stays zero
  }
  RowBlock block(const RowEntry& e) { return {data_.data() + e.offset, e.shape()}; }
  RowView block(const RowEntry& e) const { return {data_.data() + e.offset, e.shape()}; }
  RowSpan span(const RowEntry& first) { return {data_.data() + first.offset, first.shape()}; }
  const double* data() const { return data_.data(); }
  /// Grows whenever the numbers are written anew: a factor of older ones knows by it that they are gone.
  long revision() const { return revision_; }
  void renew() { ++revision_; }
  /// Room for the rows in space of one link, before those of a plane are taken from it.
  RowBlock spatial(const RowShape& shape) {
    if (spatial_.size() < RowSpan::stride(shape)) spatial_.resize(RowSpan::stride(shape));
    return {spatial_.data(), shape};
  }
  RowSpan spatial_span(const RowShape& shape) {
    (void)spatial(shape);
    return {spatial_.data(), shape};
  }

 private:
  Aligned<double> data_, spatial_;
  long revision_ = 0;
};


// Auxiliary: states of the user's own that are integrated with the mechanism: controllers, actuators, quadratures.


/// The inputs together with what the solution made of them. Views, valid during the call.
struct Evaluated {
  const Inputs& in;
  const VecX& a;       ///< 6 a slot: acceleration (world), angular acceleration (slot axes)
  const VecX& lambda;  ///< one a row of `rows`
  const RowTable& rows;
};

/// States that are integrated along with the mechanism.
class LOCKSTEP_API Auxiliary {
 public:
  explicit Auxiliary(std::string name) : name_(std::move(name)) {}
  virtual ~Auxiliary();
  Auxiliary(const Auxiliary&) = delete;
  Auxiliary& operator=(const Auxiliary&) = delete;

  const std::string& name() const { return name_; }
  virtual int size() const = 0;
  /// Whether its error controls the step of an adaptive integrator; of a mere quadrature it should not.
  virtual bool controls_error() const { return true; }
  /// Values at the start; default: zeros.
  virtual void start(std::span<double> s) const;
  /// d/dt of its slice of State::s. Its own values stand at in.s[first() ...].
  virtual void rates(const Evaluated&, std::span<double> sd) const = 0;
  /// What an impact adds to its slice: `impulses` has them, N s, in the place of the multipliers. Default: nothing.
  virtual void impact(const Evaluated& impulses, std::span<double> s) const;

  int first() const { return first_; }       ///< where its slice begins in State::s
  void place(int first) { first_ = first; }  ///< called by System::setup

 private:
  std::string name_;
  int first_ = 0;
};


// WrenchSum: adds the forces on each slot, in the coordinates of the equations of motion (theory, (2.5), (2.9)).


/// f: 6 a slot: force (world) at the slot's origin, moment about it (slot axes). The ground takes anything silently.
class WrenchSum {
 public:
  WrenchSum(std::span<const Motion> motions, VecX& f) : motions_(motions), f_(f) {}

  /// Force F (world, N) acting at the point x (world, m).
  void force(int slot, const Vec3& F, const Vec3& x) const {
    if (slot == kGround) return;
    const Motion& O = motion(slot);
    f_.segment<3>(6 * slot) += F;
    f_.segment<3>(6 * slot + 3) += O.A.transpose() * cross(Vec3(x - O.x), F);
  }
  /// Free moment (world axes, N m).
  void torque(int slot, const Vec3& tau) const {
    if (slot == kGround) return;
    f_.segment<3>(6 * slot + 3) += motion(slot).A.transpose() * tau;
  }
  /// Generalised force along a row: v and w parts as in a jacobian (world, slot axes).
  void along(int slot, const Vec3& v, const Vec3& w) const {
    if (slot == kGround) return;
    f_.segment<3>(6 * slot) += v;
    f_.segment<3>(6 * slot + 3) += w;
  }

 private:
  const Motion& motion(int slot) const { return motions_[static_cast<std::size_t>(slot + 1)]; }
  std::span<const Motion> motions_;
  VecX& f_;
};


// TangentSum: how forces and constraint forces change with the pose and the velocities, summed by pairs of slots
// (theory, section 9).
//
//   K = d( inertia + Jh^T lambda - f )/d(dx, dth)      dx: translation in the world, dth: turn in slot axes,
//   D = d( inertia + Jh^T lambda - f )/d(v, w)         q <- q exp(dth/2); rows: force (world), moment (slot axes)
//
// So the force of a spring enters with a minus sign, the tangent of a constraint force Jh^T lambda with a plus (9.4),
// (9.14). Neither is symmetrised.


/// Where a part of a slot's six unknowns begins: its translation (world) or its turn (slot axes).
enum class Half { move = 0, turn = 3 };

/// Scratch of tangents that nobody wrote by hand: motions that may be moved, the wrench of one force, the rows of one
/// link.
struct LOCKSTEP_API Differences {
  static constexpr double kStep = 6e-6;  ///< cube root of the rounding unit: best for central differences
  /// Moved by h along unknown k: x (world), turn (slot axes), v (world), w (slot axes), three each.
  static Motion moved(const Motion&, int k, double h);
  /// What translations of these slots compare with, m: their distances, else that to the origin, else 1.
  static double distance(std::span<const int> slots, const Inputs&);

  std::vector<Motion> motions;
  VecX f;
  RowTable rows;
  bool fresh = false;  ///< motions are those of the inputs
};

/// Sum of stiffness and damping tangents, by pairs of slots.
class LOCKSTEP_API TangentSum {
 public:
  /// A pair of slots with its two blocks.
  struct Pair {
    int row, column;  ///< slots
  };

  /// Forgets every pair.
  void lay_out(int n_slots);
  /// All numbers to zero; the pairs stay, so that nothing is allocated from the second evaluation on.
  void clear();

  // -- writing; the ground takes anything silently; a new pair brings its mirror image along
  void add_K(int row, int column, const Mat6& K) {
    if (row != kGround && column != kGround) block(row, column).K += K;
  }
  void add_D(int row, int column, const Mat6& D) {
    if (row != kGround && column != kGround) block(row, column).D += D;
  }
  /// One quarter of a block: d(force or moment of slot `row`)/d(translation or turn of slot `column`).
  void add_K(int row, Half r, int column, Half c, const Mat3& K) {
    if (row != kGround && column != kGround)
      block(row, column).K.block<3, 3>(static_cast<int>(r), static_cast<int>(c)) += K;
  }
  void add_D(int row, Half r, int column, Half c, const Mat3& D) {
    if (row != kGround && column != kGround)
      block(row, column).D.block<3, 3>(static_cast<int>(r), static_cast<int>(c)) += D;
  }

  // -- reading
  int n_slots() const { return static_cast<int>(neighbours_.size()); }
  const std::vector<Pair>& pairs() const { return pairs_; }
  const Mat6& K(std::size_t pair) const { return blocks_[pair].K; }
  const Mat6& D(std::size_t pair) const { return blocks_[pair].D; }
  /// Grows whenever a pair comes in: then whoever knows the pattern must look again.
  long revision() const { return revision_; }

  /// Motions to be moved about, equal to those of `in`; one copy an evaluation, made when first asked for.
  Differences& differences(const Inputs& in);

 private:
  struct Block {
    Mat6 K = Mat6::Zero(), D = Mat6::Zero();
  };
  struct Neighbour {
    int column;
    std::size_t block;
  };
  Block& block(int row, int column);
  void insert(int row, int column);

  std::vector<std::vector<Neighbour>> neighbours_;  // of each slot, by rising column
  std::vector<Pair> pairs_;
  std::vector<Block> blocks_;
  long revision_ = 0;
  Differences differences_;
};

}  // namespace lockstep
