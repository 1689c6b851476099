// SPDX-License-Identifier: BSD-3-Clause
// What a host program does with the errors of lockstep.
#pragma once

#include <functional>
#include <string>

#include <lockstep/lockstep.h>

/// Runs `work`; "" when all went well, else the type of the error, and into `words` what it says with all its fields.
std::string handled(const std::function<void()>& work, std::string& words);

/// Provokes one error of every type and prints how each was caught; the number of those that came as another type.
int provoke_them_all(const lockstep::Registry& registry);
