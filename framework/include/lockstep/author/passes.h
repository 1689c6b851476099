// SPDX-License-Identifier: BSD-3-Clause
// The passes over a mechanism after setup: slots -> joints -> forces -> states. Each reads the results of the earlier.
#pragma once

#include <string>
#include <vector>

#include <lockstep/detail/rows.h>
#include <lockstep/state.h>
#include <lockstep/system.h>

/// The evaluation of a mechanism, after System::setup().
namespace lockstep::passes {

/// Lays out the rows of the active joints, `modes` by joint number, group after group. Allocates only when the table
/// grows. `all`: with rows that were left out.
LOCKSTEP_API void lay_out(const System&, const std::vector<bool>& modes, RowTable& table, bool all = false);
/// Motions of the ground and then the slots, from the state; quaternions are normalised.
LOCKSTEP_API void motions(const System&, const State&, std::vector<Motion>& out);
/// Writes the rows of every joint in the table, group by group. Throws what joints and laws throw, named by
/// rethrow_in(); ModelError for a row that leaves the plane.
LOCKSTEP_API void gather_rows(const System&, const Inputs&, RowTable& table);
/// Writes gravity, -w x J w and all forces to f: per slot 6, force (world, N) and moment about the centre of mass (slot
/// axes, N m). f has its size already. Throws what forces and laws throw, named by rethrow_in(); ModelError for a
/// force that leaves the plane.
LOCKSTEP_API void gather_forces(const System&, const Inputs&, VecX& f);
/// Throws ModelError for a force that exerts a moment on a particle or leaves the plane, by its name. `f`: the sums of
/// the forces, with or without weights, as gather_forces() writes them.
LOCKSTEP_API void check_forces(const System&, const Inputs&, const VecX& f);
/// Writes the rates of State::s to sd, which has its size already; zero for inactive joints. `values` as
/// solved.
LOCKSTEP_API void state_rates(const System&, const Evaluated& values, VecX& sd);
/// The same for counted angles only.
LOCKSTEP_API void angle_rates(const System&, const Inputs&, VecX& sd);
/// Updates what a state keeps after an accepted step: memories of joints and forces, and counted angles. `in`: of that
/// state.
LOCKSTEP_API void accept(const System&, const Inputs& in, State&);
/// Whether accept() does anything.
inline bool keeps_anything(const System& system) { return system.n_memory() > 0 || !system.counted_angles().empty(); }
/// Times in (t0, t1), s, at which any law of joints and forces jumps, increasing, each once.
LOCKSTEP_API std::vector<double> breakpoints(const System&, double t0, double t1);
/// The same, replacing the contents of `times`, whose memory is reused.
LOCKSTEP_API void breakpoints(const System&, double t0, double t1, std::vector<double>& times);
/// "constraint e1 of joint 'C'" for a row of the table; for messages.
LOCKSTEP_API std::string row_name(const System&, const RowTable& table, int row);

}  // namespace lockstep::passes
