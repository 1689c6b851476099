// SPDX-License-Identifier: BSD-3-Clause
// What --json prints.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace lockstep {

/// Prints a document on standard output. Bytes that are no UTF-8, as names of files may have, are replaced.
void print_document(const nlohmann::ordered_json&);
/// The same of a result about a scene, with the command's findings under "findings".
void print_result(nlohmann::ordered_json);
/// This number, or null where it is none: NaN and infinities.
nlohmann::ordered_json json_number(double);

}  // namespace lockstep
