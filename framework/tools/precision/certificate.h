// SPDX-License-Identifier: BSD-3-Clause
// Certificate: the digits of each recorded channel that agree between a run and repeats of it by other methods.
#pragma once

#include <string>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

/// One channel of one repeat against the run.
struct Agreement {
  double difference = 0;  ///< largest over the times, in the channel's unit
  double digits = 0;      ///< log10(size / difference); 17 if nothing differs
};

struct CertifiedChannel {
  std::string name, unit;
  double size = 0;                       ///< largest magnitude in the run, of energies at least the energy exchanged
  bool zero = false;                     ///< it is only round-off: digits are meaningless
  std::vector<Agreement> by{};           ///< one per repeat
  LOCKSTEP_API Agreement worst() const;  ///< largest difference and fewest digits of all repeats
};

struct Certificate {
  std::vector<CertifiedChannel> channels;
  std::size_t n_rows = 0;  ///< times that all tables have
  bool cut = false;        ///< the tables end at different times; the common part was compared
};

/// The first column is the time. A channel is zero if all its values are 0, or if they are below 1e-9 times the largest
/// value of its unit (at least 1) and fewer than 6 digits agree. `exchanged`: energy, J (Audit::scale), as the zero of an
/// energy is a matter of choice. Throws ModelError for tables with other columns.
LOCKSTEP_API Certificate certify(const Table& run, const std::vector<const Table*>& repeats, double exchanged = 0);

/// The channels without one digit that agrees with every repeat; those that are zero do not count.
LOCKSTEP_API std::vector<std::string> without_a_digit(const Certificate&);

/// A table as text, one line per channel. `names`: of the repeats.
LOCKSTEP_API std::string certificate_text(const Certificate&, const std::vector<std::string>& names);

}  // namespace lockstep
