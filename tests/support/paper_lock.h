// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The lock in the source paper's own form, written out literally: seven rows, fourteen columns, every quaternion
/// product. Formulas are those of the theory, sections 3.1 and 4.1 (brackets: the paper's numbers), that is, with the
/// corrections of its section 6. Slow on purpose: an oracle, and the yardstick of what the compact form saves.

#include <Eigen/Core>

#include "tests/support/configuration.h"

namespace lockstep::oracle {

namespace paper {

/// a~, a~ b = a x b
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// (1.3) [p 56, 58] the matrices of one quaternion product, a b = [a]+ b = [b]- a
Eigen::Matrix4d plus(const Eigen::Vector4d& a);
Eigen::Matrix4d minus(const Eigen::Vector4d& b);

/// (1.5) [p 13-14] the lower right block of [q]+ [q']-
Eigen::Matrix3d rotation(const Eigen::Vector4d& q);

/// (1.6) [p 37] w = G(q) qd, body axes
Eigen::Matrix<double, 3, 4> G(const Eigen::Vector4d& q);

}  // namespace paper

/// Seven rows: translation in S axes (3), error quaternion minus identity (4). Columns x1(3) q1(4) x2(3) q2(4).
struct PaperLock {
  Eigen::Matrix<double, 7, 1> C, Ct;
  Eigen::Matrix<double, 7, 14> Cq;
  Eigen::Matrix<double, 7, 1> Qc;  ///< raw: Cdd = Cq (a1, qdd1, a2, qdd2) - Qc
};

/// Uses the quaternions' derivatives qd1, qd2 of the configuration, not w1, w2. Units: m, 1, and these per s, s^2.
PaperLock paper_lock(const Configuration&);

/// Cd by (3.4) and (4.3), all addenda.
Eigen::Matrix<double, 7, 1> paper_Cd(const Configuration&);

/// The rotational rows of Cdd by the sixty products of (4.5), with the bodies' qdd1, qdd2.
Eigen::Vector4d paper_rotational_Cdd(const Configuration&);

}  // namespace lockstep::oracle
