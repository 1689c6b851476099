// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/simulation/checkpoint.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>

#include <lockstep/error.h>
#include <lockstep/version.h>
#include "framework/foundation/support/at_end.h"
#include "framework/mechanism/params/read.h"

namespace lockstep {

namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are written as numbers are in memory");

constexpr std::string_view kMagic = "lockstep checkpoint ";

// The first line.
std::string first_line() { return fmt::format("{}{}\n", kMagic, kCheckpointLayout); }

std::uint64_t number_at(std::string_view bytes, std::size_t at) {
  std::uint64_t n = 0;
  std::memcpy(&n, bytes.data() + at, 8);
  return n;
}

void append(std::string& bytes, std::uint64_t n) { bytes.append(reinterpret_cast<const char*>(&n), 8); }

[[noreturn]] void refuse(const std::string& file, const std::string& why) {
  throw FileError(fmt::format("checkpoint '{}' {}", file, why));
}

// Throws FileError if the first line is none of this layout. A number and the line's end follow kMagic.
void check_layout(std::string_view bytes, const std::string& file) {
  if (!bytes.starts_with(kMagic)) refuse(file, "is not a checkpoint; give a file written by lockstep run --checkpoint");
  const std::string_view rest = bytes.substr(kMagic.size());
  const std::size_t end = rest.find('\n');
  const std::optional<int> layout = end != rest.npos ? number_in<int>(rest.substr(0, end)) : std::nullopt;
  if (!layout) refuse(file, "is truncated or damaged: its first line has no layout number; use an older one");
  if (*layout != kCheckpointLayout)
    refuse(file, fmt::format("has layout {} instead of {}: another version or build of lockstep wrote it; use that "
                             "one, or run the scene again from its start",
                             *layout, kCheckpointLayout));
}

}  // namespace

void check_replaceable(const std::string& file) {
  std::error_code none;
  if (std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none))
    refuse(file, "would replace a folder, a device or a pipe; give a file name");
}

void write_checkpoint(const std::string& file, const Snapshot& snapshot) {
  check_replaceable(file);
  Snapshot all;
  all.put_text(kVersion);
  const std::vector<double>&head = all.numbers(), &rest = snapshot.numbers();
  std::string bytes = first_line();
  bytes.reserve(bytes.size() + 8 * (head.size() + rest.size()) + 16);
  append(bytes, head.size() + rest.size());
  for (const std::vector<double>* part : {&head, &rest})
    bytes.append(reinterpret_cast<const char*>(part->data()), 8 * part->size());
  append(bytes, hash_of(bytes));

  const std::string partial = file + ".partial";
  const auto fail = [&](const char* what) {
    refuse(file,
           fmt::format("{}: {}; check the folder and the free space, or use another file", what, std::strerror(errno)));
  };
  const int out = ::open(partial.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
  if (out < 0) fail("cannot be written");
  bool finished = false;
  const AtEnd closed([&] {
    ::close(out);
    if (!finished) std::remove(partial.c_str());
  });
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = ::write(out, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot be written");
    at += n;
  }
  if (::fsync(out) != 0 && errno != EINVAL && errno != EROFS) fail("cannot be flushed to disk");
  if (std::rename(partial.c_str(), file.c_str()) != 0) fail("cannot be renamed");
  finished = true;
}

Snapshot read_checkpoint(const std::string& file) {
  std::ifstream in_file(file, std::ios::binary);
  std::ostringstream text;
  if (in_file) text << in_file.rdbuf();
  if (!in_file) refuse(file, "cannot be read; give a file written by `lockstep run --checkpoint`");
  const std::string_view bytes = text.view();
  check_layout(bytes, file);
  const std::size_t head = first_line().size() + 8;  // bytes before the numbers
  const std::uint64_t n = bytes.size() < head + 8 ? 0 : number_at(bytes, head - 8);
  if (bytes.size() < head + 8 || (bytes.size() - head - 8) / 8 != n || (bytes.size() - head) % 8 != 0)
    refuse(file,
           fmt::format("is truncated or damaged: it has {} bytes, its header gives another number; use an older one",
                       bytes.size()));
  if (hash_of(bytes.substr(0, bytes.size() - 8)) != number_at(bytes, bytes.size() - 8))
    refuse(file, "is damaged: its content does not match its hash; use an older one");
  std::vector<double> numbers(n);
  if (n > 0) std::memcpy(numbers.data(), bytes.data() + head, 8 * n);
  Snapshot snapshot;
  snapshot.assign(std::move(numbers));
  SnapshotReader in(snapshot);
  if (const std::string version = in.get_text(); version != kVersion)
    refuse(file, fmt::format("was written by lockstep {}, this is {}; continue with that version, or run again",
                             version, kVersion));
  return in.rest();
}

}  // namespace lockstep
