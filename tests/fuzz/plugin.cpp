// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/loader.h>
#include <lockstep/author/plugin.h>
#include "tests/fuzz/answered.h"
#include "tests/fuzz/scratch_file.h"
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

void plugin(Bytes bytes) {
  const std::string file = scratch_file(bytes, ".so");
  answered([&] { check_plugin_file(file); });
  answered([&] {
    const lockstep_abi_record record = read_abi(file);
    abi_words(record), abi_difference(record, abi_of_this_build());
  });
}

}  // namespace lockstep::fuzz
