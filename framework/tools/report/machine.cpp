// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/report/page.h"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>
#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <string_view>
#include <thread>

#include <lockstep/text.h>
#include <lockstep/version.h>

namespace lockstep::report {
namespace {

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':');
    if (line.starts_with("model name") && colon != std::string::npos)
      return std::string(text::trimmed(std::string_view(line).substr(colon + 1)));
  }
  return "";
}

}  // namespace

std::string machine_words() {
  utsname system{};
  std::string words = uname(&system) == 0 ? std::string(system.sysname) + " " + system.machine : "unknown system";
  if (const std::string name = processor_name(); !name.empty()) words += ", " + name;
  if (const unsigned n = std::thread::hardware_concurrency(); n > 0)
    words += ", " + std::to_string(n) + (n == 1 ? " processor" : " processors");
  return words;
}

std::string measured_words() {
  return fmt::format("lockstep {}, {:%Y-%m-%d}, {}", library_version(), fmt::gmtime(std::time(nullptr)),
                     machine_words());
}

}  // namespace lockstep::report
