// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/body.h>

#include <spdlog/fmt/fmt.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {
namespace {

void require_positive(double x, const std::string& what) {
  if (!(std::isfinite(x) && x > 0))
    throw ModelError(what + " is " + text::number(x) + "; it must be finite and greater than zero");
}

// Steiner's term of a mass at d: m (|d|^2 1 - d d').
Mat3 steiner(double mass, const Vec3& d) { return mass * (d.squaredNorm() * Mat3::Identity() - d * d.transpose()); }

// J in axes turned by A: A J A', exactly symmetric.
Mat3 turned(const Mat3& J, const Mat3& A) {
  const Mat3 K = A * J * A.transpose();
  return 0.5 * (K + K.transpose());
}

MassProperties diagonal(double mass, const Vec3& J) { return {.mass = mass, .J = J.asDiagonal()}; }

// Frame in the middle of a rod, x along it, z as close as possible to the world's z.
Pose rod_pose(const Vec3& from, const Vec3& to) {
  const Vec3 ex = (to - from).normalized();
  const bool upright = std::hypot(ex[0], ex[1]) < 1e-6;
  const Vec3 near = upright ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 ez = (near - ex.dot(near) * ex).normalized();
  Mat3 A;
  A << ex, cross(ez, ex), ez;
  return {0.5 * (from + to), quaternion_of(A)};
}

double rod_length(double mass, const Vec3& from, const Vec3& to) {
  require_positive(mass, "rod: the mass");
  const double length = (to - from).norm();
  require_positive(length, "rod: the length");
  return length;
}

// "principal moments 1, 1, 2.0000001 kg m^2": three digits, or as many as show that the two smaller do not add up to the
// largest where they do not.
std::string principal_moments(const Vec3& I) {
  std::array<std::string, 3> words;
  for (int digits = 3; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
    std::array<double, 3> shown{};
    for (std::size_t k = 0; k < 3; ++k) {
      words[k] = fmt::format("{:.{}g}", I[static_cast<Eigen::Index>(k)], digits);
      shown[k] = std::strtod(words[k].c_str(), nullptr);
    }
    if (!(I[0] + I[1] < I[2]) || shown[0] + shown[1] < shown[2]) break;
  }
  return fmt::format("principal moments {}, {}, {} kg m^2", words[0], words[1], words[2]);
}

}  // namespace

void check_mass(const MassProperties& p, const std::string& owner) {
  const std::string who = owner + ": ";
  require_positive(p.mass, who + "the mass");
  if (!p.center.allFinite()) throw ModelError(who + "the centre of mass is not finite; give three finite numbers");
  if (!p.J.allFinite()) throw ModelError(who + "the inertia is not finite; give nine finite numbers");

  const double size = p.J.cwiseAbs().maxCoeff();
  const double skewness = (p.J - p.J.transpose()).cwiseAbs().maxCoeff();
  if (skewness > 1e-10 * size)
    throw ModelError(who + "the inertia matrix is not symmetric: two entries across the diagonal differ by " +
                     text::brief(skewness) + " kg m^2; give the products as matrix entries, J_xy = J_yx");

  const Vec3 I = Eigen::SelfAdjointEigenSolver<Mat3>(p.J, Eigen::EigenvaluesOnly).eigenvalues();  // ascending
  const std::string principal = principal_moments(I);
  if (!(I[0] > 1e-14 * I[2]))
    throw ModelError(who + "the inertia is not positive definite (" + principal +
                     "); give a moment about every axis, or use a particle");
  if (I[0] + I[1] < I[2] * (1 - 1e-10))
    throw ModelError(who + "the inertia violates the triangle inequality (" + principal +
                     "): the two smaller must add up to at least the largest; "
                     "check whether products are given as matrix entries and about the centre of mass");
}

MassProperties shapes::about(double mass, const Vec3& center, const Mat3& J_origin, const Vec3& origin, const Quat& axes) {
  return {mass, center, turned(J_origin, rotation(axes)) - steiner(mass, center - origin)};
}

MassProperties shapes::moved(const MassProperties& p, const Pose& pose) {
  const Mat3 A = rotation(pose.q);
  return {p.mass, pose.x + A * p.center, turned(p.J, A)};
}

MassProperties shapes::compound(std::span<const MassProperties> parts) {
  if (parts.empty()) throw ModelError("a compound without parts; give at least one");
  MassProperties sum;
  for (const MassProperties& part : parts) {
    require_positive(part.mass, "compound: the mass of a part");
    sum.mass += part.mass;
    sum.center += part.mass * part.center;
  }
  sum.center /= sum.mass;
  for (const MassProperties& part : parts) sum.J += part.J + steiner(part.mass, part.center - sum.center);
  return sum;
}

Shape shapes::rod(double mass, const Vec3& from, const Vec3& to, double radius) {
  const double length = rod_length(mass, from, to);
  const double r = radius == -1 ? length / 50 : radius;
  require_positive(r, "rod: the radius");
  const double across = mass * (3 * r * r + length * length) / 12;
  return {diagonal(mass, {0.5 * mass * r * r, across, across}), rod_pose(from, to)};
}

Shape shapes::slender_rod(double mass, const Vec3& from, const Vec3& to, double axial_inertia) {
  const double length = rod_length(mass, from, to);
  require_positive(axial_inertia, "slender rod: the axial inertia");
  const double across = mass * length * length / 12;
  return {diagonal(mass, {axial_inertia, across, across}), rod_pose(from, to)};
}

MassProperties shapes::box(double mass, const Vec3& size) {
  require_positive(mass, "box: the mass");
  for (const double side : size) require_positive(side, "box: a side");
  const Vec3 d = size.cwiseProduct(size);
  return diagonal(mass, mass / 12 * Vec3(d[1] + d[2], d[0] + d[2], d[0] + d[1]));
}

MassProperties shapes::cylinder(double mass, double radius, double length) {
  require_positive(mass, "cylinder: the mass");
  require_positive(radius, "cylinder: the radius");
  require_positive(length, "cylinder: the length");
  const double across = mass * (3 * radius * radius + length * length) / 12;
  return diagonal(mass, {across, across, 0.5 * mass * radius * radius});
}

MassProperties shapes::sphere(double mass, double radius) {
  require_positive(mass, "sphere: the mass");
  require_positive(radius, "sphere: the radius");
  return diagonal(mass, Vec3::Constant(0.4 * mass * radius * radius));
}

double box_volume(const Vec3& size) { return size.prod(); }

double cylinder_volume(double radius, double length) { return kPi * radius * radius * length; }

double sphere_volume(double radius) { return 4.0 / 3.0 * kPi * radius * radius * radius; }

}  // namespace lockstep
