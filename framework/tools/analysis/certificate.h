// Certificate: how many digits of each recorded channel agree between one run and repeats of it by other means.
#pragma once

#include <string>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

/// One channel of one repeat against the run.
struct Agreement {
  double difference = 0;  ///< largest over the instants, in the channel's unit
  double digits = 0;      ///< log10(size / difference); 17 where nothing differs
};

struct CertifiedChannel {
  std::string name, unit;
  double size = 0;                       ///< largest magnitude in the run
  bool zero = false;                     ///< it is nothing but round-off: the difference counts, digits mean nothing
  std::vector<Agreement> by{};           ///< one a repeat
  LOCKSTEP_API Agreement worst() const;  ///< of all repeats; fewest digits
};

struct Certificate {
  std::vector<CertifiedChannel> channels;
  std::size_t n_rows = 0;  ///< instants that all tables have
  bool cut = false;        ///< the tables end at different instants; what is common was compared
};

/// The first column is the time. A channel is zero where all that it shows is below 1e-9 of the largest channel of its
/// unit, or of what is large in that unit's world: 1e-9 alone. Throws ModelError for tables with other columns.
LOCKSTEP_API Certificate certify(const Table& run, const std::vector<const Table*>& repeats);

/// A table of text: a line a channel, fewest digits marked. `names`: what the repeats are called.
LOCKSTEP_API std::string certificate_text(const Certificate&, const std::vector<std::string>& names);

}  // namespace lockstep
