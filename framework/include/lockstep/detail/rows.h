// SPDX-License-Identifier: BSD-3-Clause
// Constraint rows, wrench and tangent sums, as joints and forces write them.
#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/author/memory.h>
#include <lockstep/body.h>
#include <lockstep/math.h>
#include <lockstep/state.h>

namespace lockstep {

// Rows: joints write their constraints here, and solvers read them here. Neither depends on the other.
//
// One block per joint: C, Ct, Qhat (m numbers each, in the joint's axes), for a triple or a pair R, then the Jacobian
// on each moving slot that the joint touches, column by column, each column padded to a pack. Joints of one group (same
// type, same pattern) are adjacent, so that a group is gathered by one call.

/// What a row measures.
enum class RowKind : unsigned char {
  translation,  ///< a length, m; the multiplier is a force
  rotation,  ///< a component of the error quaternion, half the angle for small errors; the multiplier is twice a moment
  function   ///< the value of a function
};

inline constexpr int kMaxSlots = 4;  ///< moving slots that one joint may touch
inline constexpr int kMaxRows = 8;   ///< rows that one joint may have

/// How the Jacobian of a joint is stored.
enum class RowLayout : unsigned char {
  dense,   ///< any rows: 6 columns per slot, v (world) then w (slot axes)
  triple,  ///< the first three rows are the three translations: in world axes they are [+-1 | A], and only A is stored,
           ///< with R, which takes the joint's axes to the world's; the other rows have columns on w only
  planar,  ///< any rows of a planar mechanism: 3 columns per slot, the velocities in the plane
  pair     ///< of a planar mechanism: the first two rows are both translations in the plane, stored as in a triple
};
/// Columns stored per slot.
constexpr int n_columns(RowLayout layout) {
  constexpr int n[] = {6, 3, 3, 1};
  return n[static_cast<int>(layout)];
}
/// Rows whose linear part is +-R^T: 3 of a triple, 2 of a pair, otherwise none.
constexpr int n_turned(RowLayout layout) { return layout == RowLayout::triple ? 3 : layout == RowLayout::pair ? 2 : 0; }

/// The moving slots that a joint touches, each listed once.
struct SlotList {
  std::array<int, kMaxSlots> slot{};  ///< numbers of the slots, the first n of them
  int n = 0;                          ///< how many there are
  SlotList() = default;
  /// Adds slot k unless it is the ground or in the list already. Not more than kMaxSlots.
  void add(int k) {
    if (k == kGround || position(k) >= 0) return;
    assert(n < kMaxSlots);
    slot[static_cast<std::size_t>(n++)] = k;
  }
  /// Position of slot k in the list; -1 for the ground and for a slot that is not in the list.
  int position(int k) const {
    for (int i = 0; i < n; ++i)
      if (slot[static_cast<std::size_t>(i)] == k) return i;
    return -1;
  }
  /// Slot at position i.
  int operator[](int i) const { return slot[static_cast<std::size_t>(i)]; }
};

/// The shape of a block of rows: the meaning of its numbers and their places.
struct RowShape {
  int m = 0,                            ///< rows
      n = 0;                            ///< slots
  RowLayout layout = RowLayout::dense;  ///< how the Jacobian is stored
  double sign = 1;  ///< triple, pair: of the 1 in [+-1 | A] on the first slot, +1 for P's body, -1 if only S's moves
  Plane plane;      ///< planar, pair: the plane of the mechanism

  int ld() const { return pack_size(m); }  ///< numbers from one column to the next
  std::size_t R() const { return at(3); }  ///< index at which R begins; triple, pair
  /// Index at which the columns on the i-th slot begin.
  std::size_t J(int i) const { return at(3 + n_turned(layout) + n_columns(layout) * i); }
  std::size_t size() const { return J(n); }                     ///< numbers of the block
  double sign_of(int i) const { return i == 0 ? sign : -1.0; }  ///< the sign on the i-th slot; triple, pair

 private:
  std::size_t at(int column) const { return static_cast<std::size_t>(column * ld()); }
};

/// A view of the rows of one joint: a RowBlock may be written, a RowView only read.
template <class Number>
class BasicRowBlock {
 public:
  /// The block of this shape whose numbers begin at `base`.
  BasicRowBlock(Number* base, const RowShape& shape) : p_(base), shape_(shape), ld_(shape.ld()) {}
  /// A RowBlock as a RowView.
  operator BasicRowBlock<const double>() const { return {p_, shape_}; }

  int rows() const { return shape_.m; }                  ///< number of rows
  int slots() const { return shape_.n; }                 ///< number of slots that they touch
  RowLayout layout() const { return shape_.layout; }     ///< how the Jacobian is stored
  Number& C(int k) const { return p_[k]; }               ///< residual of row k
  Number& Ct(int k) const { return p_[ld_ + k]; }        ///< its partial derivative in time
  Number& Qhat(int k) const { return p_[2 * ld_ + k]; }  ///< right-hand side of row k: Jh acc = Qhat

  /// Jacobian of row k on the joint's i-th slot, in any layout: v (world), then w (slot axes).
  std::array<double, 6> J(int i, int k) const {
    const double* a = p_ + shape_.J(i);
    if (shape_.layout == RowLayout::dense)
      return {a[k], a[ld_ + k], a[2 * ld_ + k], a[3 * ld_ + k], a[4 * ld_ + k], a[5 * ld_ + k]};
    if (shape_.layout == RowLayout::planar || shape_.layout == RowLayout::pair) return in_space(i, k);
    if (k >= 3) return {0, 0, 0, a[k], a[ld_ + k], a[2 * ld_ + k]};
    const double* r = p_ + shape_.R() + k * ld_;  // column k of R: the joint's axis k in the world
    const double s = shape_.sign_of(i);
    const auto turned = [&](int c) { return r[0] * a[c * ld_] + r[1] * a[c * ld_ + 1] + r[2] * a[c * ld_ + 2]; };
    return {s * r[0], s * r[1], s * r[2], turned(0), turned(1), turned(2)};
  }

  /// The same of a planar mechanism, layouts planar and pair: v along i and j of the plane, then w about its normal.
  std::array<double, 3> J_in_plane(int i, int k) const {
    const double* a = p_ + shape_.J(i);
    if (shape_.layout == RowLayout::planar) return {a[k], a[ld_ + k], a[2 * ld_ + k]};
    if (k >= 2) return {0, 0, a[k]};
    const double *r = p_ + shape_.R() + k * ld_, s = shape_.sign_of(i);
    return {s * r[0], s * r[1], r[0] * a[0] + r[1] * a[1]};
  }

  /// Sets the Jacobian of row k on the joint's i-th slot, v (world) and w (slot axes); i < 0, the ground, is ignored. A
  /// triple or pair takes only rows after its translations, and ignores v. In a plane only its three velocities count.
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
  /// Adds to that Jacobian.
  template <class V, class W>
  void add(int i, int k, const V& v, const W& w) const {
    if (i < 0) return;
    const std::array<double, 6> r = J(i, k);
    set(i, k, Vec3(r[0] + v[0], r[1] + v[1], r[2] + v[2]), Vec3(r[3] + w[0], r[4] + w[1], r[5] + w[2]));
  }

  /// Triple, pair: sets R, joint axes -> world; 3 x 3, in the plane 2 x 2.
  template <class M>
  void set_R(const M& R) const {
    put(p_ + shape_.R(), R);
  }
  /// Triple, pair: sets A on the i-th slot; 3 x 3, in the plane 2 x 1. Row k is the Jacobian on w (slot axes) of the
  /// translation along axis k of the world. i < 0, the ground, is ignored.
  template <class M>
  void set_A(int i, const M& A) const {
    if (i >= 0) put(p_ + shape_.J(i), A);
  }

  /// All numbers of the block, including the zeros that pad its columns.
  const double* numbers() const { return p_; }
  /// How many they are.
  std::size_t size() const { return shape_.size(); }

 private:
  template <class M>
  void put(double* a, const M& A) const {
    for (int c = 0; c < M::ColsAtCompileTime; ++c)
      for (int k = 0; k < M::RowsAtCompileTime; ++k) a[c * ld_ + k] = A(k, c);
  }
  std::array<double, 6> in_space(int i, int k) const {
    const Plane& plane = shape_.plane;
    const std::array<double, 3> flat = J_in_plane(i, k);
    std::array<double, 6> out{};
    out[plane.i()] = flat[0], out[plane.j()] = flat[1];
    out[3 + plane.n] = flat[2];
    return out;
  }
  Number* p_;
  RowShape shape_;
  int ld_;
};
/// The rows of one joint, to be written and read.
using RowBlock = BasicRowBlock<double>;
/// The rows of one joint, to be read.
using RowView = BasicRowBlock<const double>;

/// A view of the rows of a group, joint after joint.
class RowSpan {
 public:
  /// The rows of joints of this shape, whose numbers begin at `base`.
  RowSpan(double* base, const RowShape& shape) : base_(base), shape_(shape), stride_(stride(shape)) {}
  /// The rows of the k-th joint of the group.
  RowBlock lane(std::size_t k) const { return {base_ + k * stride_, shape_}; }
  /// Numbers from one joint to the next, so that every block is aligned.
  static std::size_t stride(const RowShape& shape) { return aligned_to(shape.size(), 8); }

 private:
  double* base_;
  RowShape shape_;
  std::size_t stride_;
};

/// Place of the rows of one active joint in a table.
struct RowEntry {
  int link = 0;                          ///< number of the joint in the system
  int first_row = 0;                     ///< its first row among all rows of the table
  int m = 0;                             ///< number of its rows
  SlotList slots;                        ///< the slots that it touches
  RowLayout layout = RowLayout::dense;   ///< how its Jacobian is stored
  double sign = 1;                       ///< as in RowShape
  Plane plane;                           ///< of a planar mechanism
  std::size_t offset = 0;                ///< of its block in the table
  std::array<RowKind, kMaxRows> kind{};  ///< what each row measures
  /// The joint's own number of each row; a planar mechanism leaves rows out.
  std::array<int, kMaxRows> own{0, 1, 2, 3, 4, 5, 6, 7};

  /// Shape of its block.
  RowShape shape() const { return {m, slots.n, layout, sign, plane}; }
};

/// Adjacent joints of the table that one call gathers.
struct RowRun {
  int first_entry = 0,    ///< number of the first in RowTable::entries
      n = 0;              ///< how many there are
  int first_link = 0;     ///< position of the first in the system's order of joints
  bool in_plane = false;  ///< by Planar::gather_plane, not by Lock::gather
  bool in_parts = false;  ///< rows of its joints are left out, so that each is gathered by itself and copied
};

/// The rows of all active joints.
class RowTable {
 public:
  std::vector<RowEntry> entries;   ///< active joints, group after group
  std::vector<RowRun> runs;        ///< which of them are gathered together
  std::vector<int> entry_of_link;  ///< by number of the joint; -1: it has no rows in the table
  int n_rows = 0;                  ///< rows of all entries
  double held = 0;                 ///< as System::hold_down_to()

  /// Lays out the blocks of `entries` one after another, all numbers zero. Memory only grows.
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
  /// Block of an entry of this table.
  RowBlock block(const RowEntry& e) { return {data_.data() + e.offset, e.shape()}; }
  /// Block of an entry of this table, to be read.
  RowView block(const RowEntry& e) const { return {data_.data() + e.offset, e.shape()}; }
  /// Blocks of a run whose first entry this is.
  RowSpan span(const RowEntry& first) { return {data_.data() + first.offset, first.shape()}; }
  /// Numbers of all blocks; RowEntry::offset counts from here.
  const double* data() const { return data_.data(); }
  /// Grows whenever the rows are gathered, so that a factor recognises that its numbers were overwritten.
  long revision() const { return revision_; }
  /// Counts one revision; called before the rows are gathered.
  void renew() { ++revision_; }
  /// Scratch for the rows of a single joint as a group of one, apart from the blocks of the table. One at a time.
  RowSpan alone(const RowShape& shape) {
    if (alone_.size() < RowSpan::stride(shape)) alone_.resize(RowSpan::stride(shape));
    return {alone_.data(), shape};
  }

 private:
  Aligned<double> data_, alone_;
  long revision_ = 0;
};

// Auxiliary: the user's own differential equations: controllers, actuators, quadratures.

/// Inputs and their solution. Views, valid during the call.
struct Evaluated {
  const Inputs& in;      ///< what was evaluated
  const VecX& a;         ///< 6 per slot: acceleration (world, m/s^2), angular acceleration (slot axes, rad/s^2)
  const VecX& lambda;    ///< multipliers, one per row of `rows`
  const RowTable& rows;  ///< the rows, gathered at `in`
  /// Power of all laws in time, W: the sum of lambda . Ct over all rows (8.8). NaN: it is the one over `rows`.
  double law_power = NAN;
};

/// The sum of lambda . Ct over the rows of a table (8.8), W, or J of impulses.
LOCKSTEP_API double power_of_laws(const RowTable&, const VecX& lambda);

/// Differential equations that are integrated along with the mechanism: a slice of State::s with its rates.
class LOCKSTEP_API Auxiliary {
 public:
  /// `name` is used in messages.
  explicit Auxiliary(std::string name) : name_(std::move(name)) {}
  virtual ~Auxiliary();
  Auxiliary(const Auxiliary&) = delete;
  Auxiliary& operator=(const Auxiliary&) = delete;

  const std::string& name() const { return name_; }  ///< as given
  virtual int size() const = 0;                      ///< number of its states
  /// Whether its error controls the step of an adaptive integrator; that of a mere quadrature should not.
  virtual bool controls_error() const { return true; }
  /// Whether rates() reads accelerations or multipliers. In joint coordinates they are then computed at every evaluation.
  virtual bool reads_solution() const { return true; }
  /// Whether the multipliers that rates() reads count only with laws in time, as the power lambda . Ct does: it then gets
  /// no other rows than those of joints with laws, and no accelerations if there are none.
  virtual bool vanishes_without_laws() const { return false; }
  /// Whether Evaluated::law_power is all that rates() reads of the solution: no row is gathered for it in joint coordinates.
  virtual bool reads_law_power_alone() const { return false; }
  /// Writes its states at the start; default: zeros.
  virtual void start(std::span<double> s) const;
  /// Writes d/dt of its states, which are in.s[first()], in.s[first() + 1], ...
  virtual void rates(const Evaluated&, std::span<double> sd) const = 0;
  /// Adds to its states `s` what an impact changes. In `impulses`, lambda holds the impulses, N s or N m s, and `a` the
  /// changes of velocity; `in` is before the impact. Default: nothing.
  virtual void impact(const Evaluated& /*impulses*/, std::span<double> /*s*/) const {}

  int first() const { return first_; }       ///< index of its states in State::s
  void place(int first) { first_ = first; }  ///< called by System::setup

 private:
  std::string name_;
  int first_ = 0;
};

// WrenchSum: adds forces up by slot, as the equations of motion take them (theory, (2.5), (2.9)).

/// Sum of the forces on each slot. Forces on the ground are ignored.
class WrenchSum {
 public:
  /// Adds to f, 6 numbers per slot: force (world, N), moment about the slot's origin (slot axes, N m). `motions`: as in
  /// Inputs. Both must outlive the sum.
  WrenchSum(std::span<const Motion> motions, VecX& f) : motions_(motions), f_(f) {}

  /// Adds the force F (world, N) at the point x (world, m).
  void force(int slot, const Vec3& F, const Vec3& x) const {
    if (slot == kGround) return;
    const Motion& O = motion(slot);
    for (int i = 0; i < 3; ++i) f_[6 * slot + i] += F[i];
    add_moment(slot, cross(Vec3(x[0] - O.x[0], x[1] - O.x[1], x[2] - O.x[2]), F));
  }
  /// Adds the moment tau (world axes, N m).
  void torque(int slot, const Vec3& tau) const {
    if (slot != kGround) add_moment(slot, tau);
  }
  /// Adds a generalised force with the parts v (world) and w (slot axes), as in the row of a Jacobian.
  void along(int slot, const Vec3& v, const Vec3& w) const {
    if (slot == kGround) return;
    for (int i = 0; i < 3; ++i) f_[6 * slot + i] += v[i], f_[6 * slot + 3 + i] += w[i];
  }

 private:
  const Motion& motion(int slot) const { return motions_[static_cast<std::size_t>(slot + 1)]; }
  // A^T M. By components, as above: an expression of Eigen's would be compiled in every file that includes this.
  void add_moment(int slot, const Vec3& M) const {
    const Mat3& A = motion(slot).A;
    for (int i = 0; i < 3; ++i) f_[6 * slot + 3 + i] += A(0, i) * M[0] + A(1, i) * M[1] + A(2, i) * M[2];
  }
  std::span<const Motion> motions_;
  VecX& f_;
};

// TangentSum: derivatives of forces and constraint forces with respect to pose and velocity, summed by pairs of slots
// (theory, section 9).
//
//   K = d( inertia + Jh^T lambda - f )/d(dx, dth)      dx: translation in the world, dth: rotation, slot axes,
//   D = d( inertia + Jh^T lambda - f )/d(v, w)         q <- q exp(dth/2); rows: force (world), moment (slot axes)
//
// So the tangent of an applied force enters with a minus sign, that of a constraint force Jh^T lambda with a plus sign
// (9.4), (9.14). Neither is symmetrised.

/// Index at which a half of a slot's six unknowns begins.
enum class Half {
  move = 0,  ///< translation (world); rows: force
  turn = 3   ///< rotation (slot axes); rows: moment
};

/// Scratch for tangents by central differences.
struct LOCKSTEP_API Differences {
  static constexpr double kStep = 6e-6;  ///< cube root of the rounding unit: best for central differences
  /// The motion, changed by h in unknown k: 0..2 x (world), 3..5 rotation (slot axes), 6..8 v (world), 9..11 w (slot).
  static Motion moved(const Motion&, int k, double h);
  /// Length with which translations of these slots are scaled, m: the sum of their distances from the first; if that is
  /// zero, the distance of the first from the world's origin; at least 1e-3. If both are zero, 1.
  static double distance(std::span<const int> slots, const Inputs&);

  std::vector<Motion> motions;  ///< the ground first, then the slots; to be changed and restored
  VecX f;                       ///< wrench of one force, 6 numbers per slot
  RowTable rows;                ///< scratch for the rows of one joint
  bool fresh = false;           ///< whether `motions` are those of the present inputs
};

/// Sum of K and D, by pairs of slots.
class LOCKSTEP_API TangentSum {
 public:
  /// Two slots that have a block in K and one in D.
  struct Pair {
    int row,     ///< slot whose force changes
        column;  ///< slot whose pose or velocity it changes with
  };

  TangentSum();  ///< of no slots
  ~TangentSum();
  /// Drops all pairs; for a system of n_slots slots.
  void lay_out(int n_slots);
  /// Sets all blocks to zero and keeps the pairs, so that nothing is allocated from the second evaluation on.
  void clear();

  // -- writing; blocks of the ground are ignored; with a new pair (row, column) comes (column, row)
  /// Adds d(force and moment on slot `row`)/d(translation and rotation of slot `column`).
  void add_K(int row, int column, const Mat6& K);
  /// Adds d(force and moment on slot `row`)/d(v and w of slot `column`).
  void add_D(int row, int column, const Mat6& D);
  /// The same for one quarter of the block.
  void add_K(int row, Half r, int column, Half c, const Mat3& K);
  /// The same for one quarter of the block.
  void add_D(int row, Half r, int column, Half c, const Mat3& D);

  // -- reading
  int n_slots() const { return static_cast<int>(neighbours_.size()); }  ///< as in lay_out()
  const std::vector<Pair>& pairs() const { return pairs_; }             ///< all pairs that have blocks
  const Mat6& K(std::size_t pair) const;                                ///< block of pairs()[pair]
  const Mat6& D(std::size_t pair) const;                                ///< block of pairs()[pair]
  /// Changes whenever pairs() does: a plan made for the pairs has to be made again.
  long revision() const { return revision_; }

  /// Scratch for differences, its motions equal to those of `in`: copied once per evaluation, at the first call.
  Differences& differences(const Inputs& in);

 private:
  struct Block;
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
