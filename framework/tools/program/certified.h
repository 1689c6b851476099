// SPDX-License-Identifier: BSD-3-Clause
// A run and its certificate.
#pragma once

#include <string>

#include <lockstep/recorder.h>
#include "framework/tools/program/result.h"

namespace lockstep {

/// The certificate of a run.
struct CertifiedRun {
  std::string text;   ///< lines
  std::string doubt;  ///< a sentence that names the columns of which not one digit is certified; "" if there are none
};
/// `run`: its settings; `table`: what it recorded.
using Certify = CertifiedRun (*)(const Loaded&, const Arguments&, const RunSettings& run, const Table& table);

/// `run`, and the certificate after it.
Result run_and_certify(const Arguments&, Certify);

}  // namespace lockstep
