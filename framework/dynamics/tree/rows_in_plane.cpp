#include "framework/dynamics/tree/rows_in_plane.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <lockstep/error.h>
#include "framework/dynamics/tree/absent_rows.h"
#include "framework/foundation/math/limits.h"

namespace lockstep {

bool may_have_laws(const Lock& link) {
  const Jointed* joint = link.jointed();
  if (joint == nullptr || joint->has_laws()) return true;
  if (link.row_count() != count_rows(joint->rows())) return true;  // functions may read the time
  return std::ranges::any_of(link.pairs(), [](const auto& pair) {
    return pair.first->translation_law || pair.first->rotation_law || pair.second->translation_law ||
           pair.second->rotation_law;
  });
}

bool may_have_laws(const System& system) {
  return std::ranges::any_of(system.links(), [](const auto& link) { return may_have_laws(*link); });
}

namespace {

constexpr double kMostArm = 10;  // along the normal, in lengths of the mechanism
constexpr int kPoses = 3;

// A state of all coordinates away from zero, different for every k.
void set_pose(const JointTree& tree, const System& system, int k, State& y) {
  for (const TreeNode& n : tree.nodes())
    for (int i = 0; i < n.n_q(); ++i) {
      const double wave = std::sin(1.0 + 2.3 * (n.first_q + i) + 1.7 * k);
      y.q[n.first_q + i] = i < n.n_slides ? 0.2 * system.length() * wave : wave;
    }
}

// Largest numbers of a row: in the plane; along its normal; about axes in the plane; of its residual.
struct RowParts {
  double in = 0, along = 0, about = 0, C = 0;
  bool lies_in() const { return in > kNegligible * std::max(along, about); }
  // Lever arms along the normal give moments about axes in the plane, which the tree carries; a tilted axis gives more.
  bool is_tilted() const { return along > kNegligible * in || about > kMostArm * in; }
};

// Rows of the links of a table in some poses: link after link, row after row.
std::vector<std::vector<RowParts>> parts_of(const JointTree& tree, const System& system, RowTable& table) {
  std::vector<std::vector<RowParts>> out(table.entries.size());
  const Vec3 normal = Vec3::Unit(tree.planar()->plane().n);
  std::vector<Motion> motions(static_cast<std::size_t>(system.n_slots() + 1));
  State y = system.start();
  y.q.resize(tree.n_q()), y.v.setZero(tree.n_v());
  for (int pose = 0; pose < kPoses; ++pose) {
    set_pose(tree, system, pose, y);
    tree.motions(y, motions);
    Inputs in;
    in.t = y.t, in.motions = motions;
    in.s = {y.s.data(), static_cast<std::size_t>(y.s.size())};
    in.z = {y.z.data(), static_cast<std::size_t>(y.z.size())};
    for (std::size_t l = 0; l < out.size(); ++l) {
      const Lock* const link = system.links()[static_cast<std::size_t>(table.entries[l].link)].get();
      const RowShape shape = link->shape();
      link->gather(Group(&link, 1), in, table.spatial_span(shape));
      const RowBlock block = table.spatial(shape);
      out[l].resize(static_cast<std::size_t>(shape.m));
      for (int row = 0; row < shape.m; ++row) {
        double& C = out[l][static_cast<std::size_t>(row)].C;
        C = std::max(C, std::abs(block.C(row)));
        for (int i = 0; i < shape.n; ++i) {
          const std::array<double, 6> J = block.J(i, row);
          const Motion& own = motions[static_cast<std::size_t>(link->slots()[i] + 1)];
          const Vec3 f(J[0], J[1], J[2]), t = own.A * Vec3(J[3], J[4], J[5]) / system.length();
          RowParts& p = out[l][static_cast<std::size_t>(row)];
          const double along = f.dot(normal), turn = t.dot(normal);
          p.in = std::max({p.in, (f - along * normal).norm(), std::abs(turn)});
          p.along = std::max(p.along, std::abs(along)), p.about = std::max(p.about, (t - turn * normal).norm());
        }
      }
    }
  }
  return out;
}

}  // namespace

bool leave_out_normal_rows(const JointTree& tree, const System& system, RowTable& table) {
  const Plane plane = tree.planar()->plane();
  const auto link_of = [&](const RowEntry& e) -> const Lock& {
    return *system.links()[static_cast<std::size_t>(e.link)];
  };
  if (std::ranges::any_of(table.entries, [&](const RowEntry& e) { return !link_of(e).stays_in_plane(plane); }))
    return false;
  std::vector<std::vector<RowParts>> parts;
  try {
    parts = parts_of(tree, system, table);
  } catch (const Error&) {  // a function that is not everywhere
    return false;
  }
  std::vector<unsigned> absent(table.entries.size(), 0U);
  for (std::size_t l = 0; l < absent.size(); ++l) {
    const RowEntry& e = table.entries[l];
    for (int k = 0; k < e.m; ++k) {
      const RowParts& p = parts[l][static_cast<std::size_t>(e.own[static_cast<std::size_t>(k)])];
      if (p.lies_in() && p.is_tilted()) return false;
      if (p.lies_in()) continue;
      const bool is_met = p.C <= kNegligible * std::max(1.0, system.length()), is_normal = p.along > 0 || p.about > 0;
      if (!is_met || !is_normal) return false;
      if (may_have_laws(link_of(e))) return false;
      absent[l] |= 1U << k;
    }
  }
  take_out(absent, table);
  return true;
}

}  // namespace lockstep
