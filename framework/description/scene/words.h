// Words of scene files that are no objects and no types: keys, forms of values, units, channels.
#pragma once

#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/detail/export.h>

namespace lockstep {

/// What such a word means, and where it stands: "stops", "orientation", "stiffness", "record"; "" for another word.
LOCKSTEP_API std::string describe_word(const Registry&, const std::string& word);

/// All names that find_descriptions() knows, then all words that describe_word() knows.
LOCKSTEP_API std::vector<std::string> known_words(const Registry&);

}  // namespace lockstep
