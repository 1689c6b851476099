#include "framework/tools/analysis/fading_rows.h"

#include <Eigen/SVD>
#include <algorithm>

#include "framework/tools/analysis/loop_rows.h"

namespace lockstep {

namespace {

constexpr int kMostFadingRows = 300;
constexpr double kFadedAway = 1e-7;     // singular value of rows of length 1: redundant everywhere
constexpr double kFaded = 0.03;         // of what it is in the regular position
constexpr double kShareOfFading = 0.1;  // of the combination: a row with less takes no part

}  // namespace

std::vector<std::string> fading_links(System& system, const State& regular, const State& singular) {
  const Evaluation before(system, regular), there(system, singular);
  std::vector<std::string> names;
  for (const std::vector<int>& entries : loops_of(system, there.rows())) {
    const LoopRows rows(system, there.rows(), entries), usual(system, before.rows(), entries);
    if (rows.n() > kMostFadingRows || rows.n() != usual.n()) continue;
    const Eigen::BDCSVD<MatX> svd(rows.matrix(), Eigen::ComputeFullV);
    const VecX was = usual.matrix().bdcSvd().singularValues(), now = svd.singularValues();
    Eigen::Index rank = 0;
    while (rank < was.size() && was[rank] > kFadedAway) ++rank;
    if (rank == 0 || !(now[rank - 1] < kFaded * was[rank - 1])) continue;
    const VecX shares = svd.matrixV().col(rank - 1).cwiseAbs();
    for (int k = 0; k < rows.n(); ++k) {
      if (shares[k] < kShareOfFading * shares.maxCoeff()) continue;
      const RowEntry& entry = entry_of_row(there.rows(), rows.number(k));
      const std::string& name = system.links()[static_cast<std::size_t>(entry.link)]->name();
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace lockstep
