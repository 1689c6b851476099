// SPDX-License-Identifier: BSD-3-Clause
// Checkpoints as files.
//
//   "lockstep checkpoint N\n" of layout N, the length n, n numbers as they are in memory, a hash of all of it
//
// The number in the first line is that of the layout: which numbers follow one another, down to those of integrators,
// solvers and observers. Whoever changes what one of them saves gives the layout another number.
// The first numbers are the version of lockstep as a text. Numbers are little-endian IEEE doubles, lengths and the hash
// unsigned 64-bit numbers. The hash (FNV-1a) detects any changed byte.
#pragma once

#include <string>

#include <lockstep/author/memory.h>
#include "framework/foundation/support/hash.h"

namespace lockstep {

/// The number of the layout that is written and read. A test holds kept checkpoints against it.
inline constexpr int kCheckpointLayout = 12;

/// Throws FileError if there is something that is no regular file, which a checkpoint would replace.
LOCKSTEP_API void check_replaceable(const std::string& file);
/// Writes a checkpoint to FILE.partial, which replaces FILE when it is whole and on the disk. Throws FileError.
LOCKSTEP_API void write_checkpoint(const std::string& file, const Snapshot&);
/// Reads a checkpoint. Throws FileError: there is none, it is cut or damaged, of another layout or version.
LOCKSTEP_API Snapshot read_checkpoint(const std::string& file);

}  // namespace lockstep
