#include "framework/dynamics/tree/loop_closures.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/scales.h"

namespace lockstep {

namespace {

constexpr double kClosureProximal = 1e-9;  // of the scale s_j, as in the solver schur

// The nodes on the way of a link's slots to where they meet, without that place.
struct Paths {
  std::vector<std::size_t> nodes;
  std::size_t end;  // the number of nodes: the ground
};

// Parents have smaller numbers than their children: from the largest number on, the paths meet in one.
Paths paths_of(std::vector<std::size_t> at, bool grounded, const std::vector<std::size_t>& parents) {
  const std::size_t ground = parents.size();
  Paths paths;
  const auto deeper = [&](std::size_t k) { return k == ground ? -1 : static_cast<int>(k); };
  const auto met = [&] {
    return std::ranges::all_of(at, [&](std::size_t k) { return k == (grounded ? ground : at.front()); });
  };
  while (!met()) {
    const std::size_t k = *std::ranges::max_element(at, {}, deeper);
    paths.nodes.push_back(k);
    std::ranges::replace(at, k, parents[k]);
  }
  paths.end = at.empty() ? ground : at.front();
  return paths;
}

// Whether a link holds something against the ground: then its rows are not met by the motions of its slots against one
// another alone.
bool is_grounded(const Lock& link, const RowEntry& e) {
  if (e.slots.n < 2) return true;
  return std::ranges::any_of(
      link.pairs(), [](const auto& pair) { return pair.first->body->slot == kGround || pair.second->body->slot == kGround; });
}

}  // namespace

void LoopClosures::begin(const JointTree& tree, const System& system, const RowTable& rows) {
  *this = {};
  n_nodes_ = tree.nodes().size();
  length_ = system.length();
  std::vector<std::size_t> node_of(static_cast<std::size_t>(system.n_slots()));
  for (std::size_t k = 0; k < n_nodes_; ++k) {
    const TreeNode& t = tree.nodes()[k];
    const Slot& slot = system.slot(t.slot);
    node_of[static_cast<std::size_t>(t.slot)] = k;
    parents_.push_back(t.parent < 0 ? n_nodes_ : static_cast<std::size_t>(t.parent));
    inverse_mass_.push_back(1.0 / slot.mass);
    inverse_inertia_.push_back(slot.freedoms == Freedoms::particle ? Mat3(Mat3::Zero()) : Mat3(slot.J.inverse()));
  }
  std::vector<Rows> open(n_nodes_), closing(n_nodes_), grounded;
  std::vector<std::vector<int>> together(n_nodes_);  // of each node: those of `grounded` that pass through it
  sources_.resize(static_cast<std::size_t>(rows.n_rows));
  for (const RowEntry& e : rows.entries) {
    std::vector<std::size_t> at;
    for (int i = 0; i < e.slots.n; ++i) at.push_back(node_of[static_cast<std::size_t>(e.slots[i])]);
    const Paths paths = paths_of(at, is_grounded(*system.links()[static_cast<std::size_t>(e.link)], e), parents_);
    Rows own;
    for (int k = 0; k < e.m; ++k) own.push_back(e.first_row + k);
    for (const std::size_t k : paths.nodes) open[k].insert(open[k].end(), own.begin(), own.end());
    if (paths.end < n_nodes_) {
      closing[paths.end].insert(closing[paths.end].end(), own.begin(), own.end());
      continue;
    }
    for (const std::size_t k : paths.nodes) together[k].push_back(static_cast<int>(grounded.size()));
    grounded.push_back(own);
  }
  for (std::size_t k = 0; k < n_nodes_; ++k) add_front(open[k], closing[k], tree.nodes()[k].n_v());
  for (std::size_t k = 0; k < n_nodes_; ++k)
    if (parents_[k] < n_nodes_) together[k].clear();  // at the roots they all meet
  add_ground_fronts(grounded, together);
  link_fronts();
  for (const RowEntry& e : rows.entries)
    for (int k = 0; k < e.m; ++k) {
      Source& source = sources_[static_cast<std::size_t>(e.first_row + k)];
      source.first_side = static_cast<int>(sides_.size()), source.n_sides = e.slots.n;
      source.kind = e.kind[static_cast<std::size_t>(k)];
      for (int i = 0; i < e.slots.n; ++i) {
        Side side;
        side.node = static_cast<int>(node_of[static_cast<std::size_t>(e.slots[i])]);
        side.place = fronts_[static_cast<std::size_t>(side.node)].first;
        while (row_of_[static_cast<std::size_t>(side.place)] != e.first_row + k) ++side.place;
        sides_.push_back(side);
      }
    }
  for (VecX* v : {&c_, &E_, &diagonal_, &scale_, &d_, &lambda_, &r_, &size_, &dlambda_}) v->setZero(rows.n_rows);
  l_.assign(rows_.size(), 0.0);
  wrenches_.assign(n_nodes_, {});
  changes_.assign(n_nodes_, {});
  du_.setZero(tree.n_v());
  watch_.begin(rows.n_rows);
}

void LoopClosures::add_front(const Rows& open, const Rows& closing, int n_v) {
  Front front;
  front.first = static_cast<int>(row_of_.size());
  row_of_.insert(row_of_.end(), open.begin(), open.end());
  row_of_.insert(row_of_.end(), closing.begin(), closing.end());
  front.n_open = static_cast<int>(open.size());
  front.n = front.n_open + static_cast<int>(closing.size());
  front.Lambda = static_cast<int>(Lambda_.size()), front.V = static_cast<int>(V_.size());
  Lambda_.resize(Lambda_.size() + static_cast<std::size_t>(front.n * front.n));
  V_.resize(V_.size() + static_cast<std::size_t>(front.n_open * n_v));
  fronts_.push_back(front);
}

// Links that end at the ground, `entries`, are coupled where they pass through one root, `together`. One front each, in
// the order of minimum degree: its open rows are those of the links that it couples with later.
void LoopClosures::add_ground_fronts(const std::vector<Rows>& entries, const std::vector<std::vector<int>>& together) {
  Neighbours neighbours(entries.size());
  for (const std::vector<int>& clique : together)
    for (const int a : clique)
      for (const int b : clique)
        if (a < b) couple(neighbours, a, b);
  std::vector<int> weights;
  for (const Rows& rows : entries) weights.push_back(static_cast<int>(rows.size()));
  std::vector<std::vector<int>> below;
  std::vector<std::size_t> order_of(entries.size());
  for (MinimumDegree order(std::move(neighbours), std::move(weights)); !order.done();) {
    MinimumDegree::Pivot pivot = order.next();
    order_of[static_cast<std::size_t>(pivot.node)] = below.size();
    below.push_back(std::move(pivot.below));
    below.back().push_back(pivot.node);  // itself, last
  }
  const auto first_of = [&](const auto& some) {
    std::size_t first = entries.size();
    for (const int e : some) first = std::min(first, order_of[static_cast<std::size_t>(e)]);
    return n_nodes_ + first;
  };
  for (std::size_t k = 0; k < n_nodes_; ++k)
    if (parents_[k] == n_nodes_ && !together[k].empty()) parents_[k] = first_of(together[k]);
  for (const std::vector<int>& group : below) {
    const std::span<const int> later(group.data(), group.size() - 1);
    Rows open;
    for (const int e : later)
      open.insert(open.end(), entries[static_cast<std::size_t>(e)].begin(), entries[static_cast<std::size_t>(e)].end());
    parents_.push_back(first_of(later));
    add_front(open, entries[static_cast<std::size_t>(group.back())], 0);
  }
}

// The places of open rows at the parents.
void LoopClosures::link_fronts() {
  above_.assign(row_of_.size(), -1);
  rows_.resize(row_of_.size());
  std::vector<int> place(sources_.size(), -1);  // of each row at the parent
  for (std::size_t k = 0; k < fronts_.size(); ++k) {
    const Front& front = fronts_[k];
    if (front.n_open == 0) continue;
    const Front& up = fronts_[parents_[k]];
    for (int i = 0; i < up.n; ++i) place[static_cast<std::size_t>(row_of(up, i))] = up.first + i;
    for (int i = 0; i < front.n_open; ++i)
      above_[static_cast<std::size_t>(front.first + i)] = place[static_cast<std::size_t>(row_of(front, i))];
  }
}

void LoopClosures::read(const JointTree& tree, std::span<const Motion> motions, const RowTable& table) {
  std::ranges::fill(rows_, Row{});
  std::ranges::fill(Lambda_, 0.0);
  diagonal_.setZero();
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    for (int k = 0; k < e.m; ++k) {
      const int row = e.first_row + k;
      c_[row] = block.Qhat(k);
      const Source& source = sources_[static_cast<std::size_t>(row)];
      for (int i = 0; i < source.n_sides; ++i) {
        Side& side = sides_[static_cast<std::size_t>(source.first_side + i)];
        const auto node = static_cast<std::size_t>(side.node);
        const std::array<double, 6> J = block.J(i, k);
        const Vec3 f(J[0], J[1], J[2]), t(J[3], J[4], J[5]);
        side.f = column(f);
        side.t = column(motions[static_cast<std::size_t>(tree.nodes()[node].slot + 1)].A * t);
        Row& there = rows_[static_cast<std::size_t>(side.place)];
        there.f += side.f, there.t += side.t;
        diagonal_[row] += inverse_mass_[node] * f.squaredNorm() + t.dot(inverse_inertia_[node] * t);
      }
      rows_[static_cast<std::size_t>(sides_[static_cast<std::size_t>(source.first_side)].place)].l = -c_[row];
    }
  }
  measure_diagonal(table);
}

void LoopClosures::measure_diagonal(const RowTable& table) {
  scale_ = diagonal_;
  for (const RowEntry& e : table.entries) average_scales(scale_.data() + e.first_row, e.m, KindBits(e.kind, e.m));
  E_ = kClosureProximal * scale_;
  if (floors_known_) return;
  PivotFloors floors;
  for (std::size_t row = 0; row < sources_.size(); ++row) {
    const Source& source = sources_[row];
    floors.add(source.kind, E_[static_cast<Eigen::Index>(row)]);
    for (int i = 0; i < source.n_sides && source.kind == RowKind::translation; ++i) {
      const Side& side = sides_[static_cast<std::size_t>(source.first_side + i)];
      floors.arm2 = std::max(floors.arm2, dot(side.t, side.t));
    }
  }
  for (const RowKind kind : {RowKind::translation, RowKind::rotation, RowKind::function})
    pivot_floors_[static_cast<std::size_t>(kind)] = floors.of(kind);
  floors_known_ = true;
}

void LoopClosures::subtract(const VecX& x) {
  c_ -= x;
  for (std::size_t row = 0; row < sources_.size(); ++row)
    rows_[static_cast<std::size_t>(sides_[static_cast<std::size_t>(sources_[row].first_side)].place)].l +=
        x[static_cast<Eigen::Index>(row)];
}

void LoopClosures::residuals(std::span<const Motion> motions, const RowTable& table, VecX& C, VecX& Cd) const {
  C.resize(table.n_rows), Cd.resize(table.n_rows);
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    for (int k = 0; k < e.m; ++k) {
      const int row = e.first_row + k;
      C[row] = block.C(k), Cd[row] = block.Ct(k);
      for (int i = 0; i < e.slots.n; ++i) {
        const Motion& O = motions[static_cast<std::size_t>(e.slots[i] + 1)];
        const std::array<double, 6> J = block.J(i, k);
        Cd[row] += Vec3(J[0], J[1], J[2]).dot(O.v) + Vec3(J[3], J[4], J[5]).dot(O.w);
      }
    }
  }
}

double LoopClosures::norm(const VecX& c) const {
  double worst = 0;
  for (std::size_t row = 0; row < sources_.size(); ++row) {
    const RowKind kind = sources_[row].kind;
    const double unit = kind == RowKind::translation ? 1.0 : kind == RowKind::rotation ? 2.0 * length_ : length_;
    const double x = unit * std::abs(c[static_cast<Eigen::Index>(row)]);
    worst = x > worst || std::isnan(x) ? x : worst;
  }
  return worst;
}

bool LoopClosures::met(const ArticulatedBodies& bodies) {
  std::array<double, 3> largest{};
  for (std::size_t j = 0; j < sources_.size(); ++j) {
    const Source& source = sources_[j];
    const auto row = static_cast<Eigen::Index>(j);
    double r = -c_[row], size = std::abs(c_[row]);
    for (int i = 0; i < source.n_sides; ++i) {
      const Side& side = sides_[static_cast<std::size_t>(source.first_side + i)];
      const auto& node = bodies.nodes_[static_cast<std::size_t>(side.node)];
      const double x = dot(side.f, node.a) + dot(side.t, node.al);
      r += x, size += std::abs(x);
    }
    // What lambda alone would cause, and what other rows balance: its rounding is left where nothing moves.
    r_[row] = r, size_[row] = std::max(size, kScaleFloor * scale_[row] * std::abs(lambda_[row]));
    double& most = largest[static_cast<std::size_t>(source.kind)];
    most = std::max(most, size_[row]);
  }
  worst_ = 0, worst_row_ = -1;
  for (std::size_t j = 0; j < sources_.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const double least = residual_floor(largest[static_cast<std::size_t>(sources_[j].kind)]);
    const double x = r_[row] == 0 ? 0.0 : std::abs(r_[row]) / std::max(size_[row], least);
    if (worst_row_ >= 0 && (x <= worst_ || std::isnan(worst_))) continue;
    worst_ = x, worst_row_ = static_cast<int>(j);
  }
  return worst_ <= kRowTolerance;
}

void LoopClosures::correct(const JointTree& tree, const ArticulatedBodies& bodies, VecX& dvd) {
  correct(tree, bodies, r_, dvd);
  lambda_ += dlambda_;
}

LOCKSTEP_FLAT_CLONES void LoopClosures::correct(const JointTree& tree, const ArticulatedBodies& bodies, const VecX& r,
                                                VecX& dv) {
  inward_again(tree, bodies, r);
  outward_again(tree, bodies, dv);
}

// The elimination again, for p = 0, c = 0 and l = r.
LOCKSTEP_INLINE void LoopClosures::inward_again(const JointTree& tree, const ArticulatedBodies& bodies,
                                                const VecX& r) {
  std::ranges::fill(l_, 0.0);
  std::ranges::fill(wrenches_, Row{});
  for (std::size_t j = 0; j < sources_.size(); ++j)
    l_[static_cast<std::size_t>(sides_[static_cast<std::size_t>(sources_[j].first_side)].place)] =
        r[static_cast<Eigen::Index>(j)];
  const auto close = [&](const Front& front, Row* p) {
    double* l = l_.data() + front.first;
    for (int j = front.n - 1; j >= front.n_open; --j) {
      const double* at = Lambda(front, j);
      const double x = l[j] / d_[row_of(front, j)];
      const Row& row = rows_[static_cast<std::size_t>(front.first + j)];
      if (p) p->f += row.f * x, p->t += row.t * x;
      for (int i = 0; i < j; ++i) l[i] -= at[i] * x;
    }
  };
  for (std::size_t k = tree.nodes().size(); k-- > 0;) {
    const Front& front = fronts_[k];
    Row& p = wrenches_[k];
    close(front, &p);
    const TreeNode& n = tree.nodes()[k];
    const ArticulatedBodies::Node& b = bodies.nodes_[k];
    const ArticulatedBodies::Dof* dof = bodies.dofs_.data() + n.first_v;
    const double* inverse = bodies.inverse_.data() + b.D_1;
    double* u = du_.data() + n.first_v;
    const int n_v = n.n_v();
    for (int x = 0; x < n_v; ++x) u[x] = -dot(dof[x].l, p.f) - dot(dof[x].n, p.t);
    for (int x = 0; x < n_v; ++x) {
      double y = 0;
      for (int i = 0; i < n_v; ++i) y += inverse[n_v * x + i] * u[i];
      p.f += dof[x].Uf * y, p.t += dof[x].Ut * y;
    }
    for (int i = 0; i < front.n_open; ++i) {
      double l = l_[static_cast<std::size_t>(front.first + i)];
      for (int x = 0; x < n_v; ++x) l += V_[static_cast<std::size_t>(front.V + i * n_v + x)] * u[x];
      l_[static_cast<std::size_t>(place_above(front, i))] += l;
    }
    if (n.parent < 0) continue;
    Row& up = wrenches_[static_cast<std::size_t>(n.parent)];
    up.f += p.f, up.t += p.t + Skew(b.r) * p.f;
  }
  for (std::size_t k = n_nodes_; k < fronts_.size(); ++k) {
    const Front& front = fronts_[k];
    close(front, nullptr);
    for (int i = 0; i < front.n_open; ++i)
      l_[static_cast<std::size_t>(place_above(front, i))] += l_[static_cast<std::size_t>(front.first + i)];
  }
  for (std::size_t k = fronts_.size(); k-- > n_nodes_;) {
    const Front& front = fronts_[k];
    for (int j = front.n_open; j < front.n; ++j)
      dlambda_[row_of(front, j)] = multiplier(front, j, l_[static_cast<std::size_t>(front.first + j)], dlambda_);
  }
}

LOCKSTEP_INLINE void LoopClosures::outward_again(const JointTree& tree, const ArticulatedBodies& bodies, VecX& dv) {
  dv.resize(tree.n_v());
  for (std::size_t k = 0; k < tree.nodes().size(); ++k) {
    const Front& front = fronts_[k];
    const TreeNode& n = tree.nodes()[k];
    const ArticulatedBodies::Node& b = bodies.nodes_[k];
    const ArticulatedBodies::Dof* dof = bodies.dofs_.data() + n.first_v;
    const double* inverse = bodies.inverse_.data() + b.D_1;
    Change& own = changes_[k];
    own = {};
    if (n.parent >= 0) {
      const Change& p = changes_[static_cast<std::size_t>(n.parent)];
      own.a = p.a - Skew(b.r) * p.al, own.al = p.al;
    }
    const int n_v = n.n_v();
    double left[6];
    for (int x = 0; x < n_v; ++x) left[x] = du_[n.first_v + x] - dot(dof[x].Uf, own.a) - dot(dof[x].Ut, own.al);
    for (int x = 0; x < n_v; ++x) {
      double y = 0;
      for (int i = 0; i < n_v; ++i) y += inverse[n_v * x + i] * left[i];
      for (int i = 0; i < front.n_open; ++i)
        y -= V_[static_cast<std::size_t>(front.V + i * n_v + x)] * dlambda_[row_of(front, i)];
      dv[n.first_v + x] = y;
      own.a += dof[x].l * y, own.al += dof[x].n * y;
    }
    for (int j = front.n_open; j < front.n; ++j) {
      const Row& row = rows_[static_cast<std::size_t>(front.first + j)];
      const double with = l_[static_cast<std::size_t>(front.first + j)] + dot(row.f, own.a) + dot(row.t, own.al);
      dlambda_[row_of(front, j)] = multiplier(front, j, with, dlambda_);
    }
  }
}

void LoopClosures::react(const RowTable& table, VecX& f) const {
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    for (int i = 0; i < e.slots.n; ++i)
      for (int k = 0; k < e.m; ++k) {
        const std::array<double, 6> J = block.J(i, k);
        for (int c = 0; c < 6; ++c) f[6 * e.slots[i] + c] -= lambda_[e.first_row + k] * J[static_cast<std::size_t>(c)];
      }
  }
}

void LoopClosures::save(Snapshot& out) const {
  out.put(static_cast<double>(sources_.size()));
  watch_.save(out);
  out.put(floors_known_ ? 1 : 0), out.put_all(pivot_floors_);
}

void LoopClosures::restore(const Snapshot& in) {
  const bool ours = in.get_count() == static_cast<long>(sources_.size());
  PivotWatch watch = watch_;
  watch.restore(in);
  const bool known = in.get_flag();
  std::vector<double> floors;
  in.get_all(floors);
  if (!ours || floors.size() != pivot_floors_.size()) return;
  watch_ = watch, floors_known_ = known;
  std::ranges::copy(floors, pivot_floors_.begin());
}

void LoopClosures::complete(SolveReport& report) {
  watch_.see([&](auto&& row) {
    for (std::size_t j = 0; j < sources_.size(); ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      row(d_[at], diagonal_[at], pivot_floors_[static_cast<std::size_t>(sources_[j].kind)]);
    }
  });
  report.residual = worst_, report.worst_row = worst_row_;
  report.smallest_pivot = watch_.smallest();
  report.detector = watch_.singularity_indicator();
}

}  // namespace lockstep
