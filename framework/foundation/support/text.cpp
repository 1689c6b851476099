// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/text.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <numeric>

namespace lockstep::text {
namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

// Optimal string alignment distance (insertion, deletion, substitution, transposition), case ignored, in three rows.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(above);
    above.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const char x = lower(a[i - 1]), y = lower(b[j - 1]);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (x != y)});
      const bool exchanged = i > 1 && j > 1 && x == lower(b[j - 2]) && y == lower(a[i - 2]);
      if (exchanged) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

template <class... Format>
std::string chars_of(double value, Format... format) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, value, format...).ptr};
}

// Words of Adams, Simscape, MuJoCo, URDF and plain English, each before the names that it may mean here.
constexpr std::string_view kSynonyms =
    "hinge=revolute pin=revolute pivot=revolute rotational=revolute continuous=revolute revolution=revolute "
    "ball=spherical socket=spherical ball_joint=spherical slider=prismatic translational=prismatic "
    "sliding=prismatic linear=prismatic weld=fixed rigid=fixed bolt=fixed hooke=universal cardan=universal "
    "u_joint=universal planar=plane_on_plane plane=plane_on_plane thread=screw helical=screw lead_screw=screw "
    "rack=rack_and_pinion pinion=rack_and_pinion gears=gear gear_pair=gear pulley=belt rod=distance rope=distance "
    "jprim=lock convel=rzeppa inline=point_on_line inplane=point_on_plane parallel_axes=angular_alignment "
    "cv_joint=homokinetic cam=cam_roller bushing6=bushing spring=spring_damper damper=spring_damper tsda=spring_damper "
    "sforce=function_force torsion_spring=torsion_spring_damper rotational_spring=torsion_spring_damper "
    "rsda=torsion_spring_damper force=applied_force torque=applied_torque motor=torque_motor,drive "
    "actuator=force_motor,drive friction=joint_friction motion=drive input=drive motors=drive joints=links "
    "constraints=joints parts=bodies colour=visual color=visual limits=stops range=stops limit=stops body1=p body2=s "
    "i=p j=s parent=s child=p base=s follower=p density=mass weight=mass diameter=radius origin=at,position "
    "rest_length=free_length "
    "location=at anchor=at pos=position quat=orientation euler=orientation rotation=orientation vel=velocity "
    "angular_velocity=omega_world dt=step timestep=step duration=until stop_time=until end=until tend=until time=until "
    "tol=tolerance rtol=tolerance k=stiffness c=damping d=damping rk45=dopri5 ode45=dopri5 dopri=dopri5 "
    "dopri853=dop853 rk8=dop853 euler_method=semi_implicit_euler rk=rk4 bdf=radau5 rkf45=dopri5 runge_kutta=rk4 "
    "verlet=semi_implicit_euler hht=generalized_alpha newmark=generalized_alpha ida=radau5 ode15s=radau5 gstiff=radau5 "
    "step5=poly345 step=poly345 havsin=harmonic_rise smoothstep=poly345 linear_law=ramp sin=sine table=spline "
    "csv=spline meter=m metre=m newton=N minute=min hour=h radian=rad kgm^2=kg*m^2 world=ground velocity=speed "
    "diaginertia=inertia fullinertia=inertia fx=force_on_p_world_x fy=force_on_p_world_y fz=force_on_p_world_z "
    "slide=prismatic,translation one_sided=unilateral spin=rotation slip=offset";

// The candidate that a synonym means; "" if there is none.
std::string meant(std::string_view word, std::span<const std::string> candidates) {
  std::string wanted(word);
  std::ranges::transform(wanted, wanted.begin(), lower);
  wanted = " " + wanted + "=";
  const std::size_t at = (" " + std::string(kSynonyms)).find(wanted);
  if (at == std::string::npos) return {};
  std::string_view names = kSynonyms.substr(at + wanted.size() - 1);
  names = names.substr(0, names.find(' '));
  for (const std::string& name : candidates)
    if (("," + std::string(names) + ",").find("," + name + ",") != std::string::npos) return name;
  return {};
}

}  // namespace

std::string closest_name(std::string_view word, std::span<const std::string> candidates) {
  std::string best = meant(word, candidates);
  if (!best.empty()) return best;
  std::size_t least = std::max<std::size_t>(word.size() > 1, word.size() / 3) + 1;
  for (const std::string& name : candidates) {
    const std::size_t longer = std::max(name.size(), word.size()), shorter = std::min(name.size(), word.size());
    if (longer - shorter >= least) continue;  // as many letters are inserted at least
    const std::size_t d = edit_distance(word, name);
    if (d < least && (d < 2 || lower(word.front()) == lower(name.front()))) {
      least = d;
      best = name;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string> candidates) {
  const std::string near = closest_name(word, candidates);
  if (!near.empty() && near != word) return "; did you mean \"" + near + "\"?";
  if (candidates.empty()) return {};
  constexpr std::size_t kMost = 12;
  const std::size_t n = std::min(kMost, candidates.size());
  std::string text = "; known: " + join(candidates.first(n), ", ");
  if (candidates.size() > n) text += ", ...";
  return text;
}

std::string join(std::span<const std::string> words, std::string_view last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? last : std::string_view(", ");
    text += words[i];
  }
  return text;
}

std::string_view trimmed(std::string_view s, std::string_view blanks) {
  const auto first = s.find_first_not_of(blanks);
  return first == std::string_view::npos ? std::string_view() : s.substr(first, s.find_last_not_of(blanks) - first + 1);
}

std::string number(double value) { return chars_of(value); }

std::string brief(double value) { return chars_of(value, std::chars_format::general, 3); }

}  // namespace lockstep::text
