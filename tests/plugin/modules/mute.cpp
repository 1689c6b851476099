// SPDX-License-Identifier: BSD-3-Clause
// A plugin that forgot its register function: the record stands alone.
#include <lockstep/author/plugin.h>

extern "C" LOCKSTEP_API const lockstep_abi_record lockstep_abi;
extern "C" LOCKSTEP_API constexpr lockstep_abi_record lockstep_abi = ::lockstep::abi_of_this_build();
