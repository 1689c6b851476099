// SPDX-License-Identifier: BSD-3-Clause
// The program `lockstep`.
#include "framework/tools/program/options.h"

int main(int argc, char* argv[]) { return lockstep::run_program(lockstep::own_commands, true, argc, argv); }
