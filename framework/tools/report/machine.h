// The machine on which a report is made, in words.
#pragma once

#include <string>

namespace lockstep::report {

/// "Linux x86_64, Intel(R) Xeon(R) CPU @ 2.80GHz, 8 processors": system, processor as far as it is known, and how many.
std::string machine_words();

}  // namespace lockstep::report
