// SPDX-License-Identifier: BSD-3-Clause
// scenes FOLDER [MOST]: writes the scenes of the mechanisms with at most so many bodies (default: all) into a folder.
// scenes --names: the names of all mechanisms.
#include <cstdio>
#include <fstream>

#include "tests/benchmark/peers/scenes.h"

using namespace lockstep::peers;

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: %s FOLDER [MOST_BODIES]\n", argv[0]), 2;
  if (std::string(argv[1]) == "--names") {
    for (const Mechanism& m : all_mechanisms()) std::printf("%s\n", m.name.c_str());
    return 0;
  }
  const int most = argc > 2 ? std::stoi(argv[2]) : 1'000'000;
  for (const Mechanism& m : all_mechanisms()) {
    if (!is_generated(m) || n_bodies(m) > most) continue;
    const std::string path = std::string(argv[1]) + "/" + scene_name(m) + ".json";
    std::ofstream out(path);
    if (!(out << scene_text(m))) return std::fprintf(stderr, "cannot write %s\n", path.c_str()), 1;
  }
  return 0;
}
