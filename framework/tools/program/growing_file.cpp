// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/growing_file.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include <lockstep/error.h>
#include "framework/foundation/support/hash.h"

namespace lockstep {

namespace {

constexpr double kInterval = 1.0;              // s, wall-clock: at most so much is lost,
constexpr std::size_t kMostWaiting = 1 << 20;  // or so many bytes

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

GrowingFile::GrowingFile(std::string name) : name_(std::move(name)) {
  namespace fs = std::filesystem;
  if (name_ == "-") {
    in_place_ = true, partial_ = "standard output";
    file_ = ::dup(STDOUT_FILENO);
    if (file_ < 0) fail("cannot be written");
    return;
  }
  std::error_code error;
  const bool there = fs::exists(name_, error);
  in_place_ = there && !fs::is_regular_file(name_, error);
  if (there && !in_place_ && fs::is_symlink(name_, error)) {
    const fs::path target = fs::canonical(name_, error);
    if (!error) name_ = target.string();
  }
  if (there && ::access(name_.c_str(), W_OK) != 0)
    throw FileError(fmt::format("file '{}' is write-protected; change that (chmod u+w), or name another", name_));
  partial_ = in_place_ ? name_ : name_ + ".partial";
  do {
    if (file_ >= 0) ::close(file_);
    file_ = ::open(partial_.c_str(), (in_place_ ? O_WRONLY : O_CREAT | O_RDWR) | O_CLOEXEC, 0666);
    if (file_ < 0) fail("cannot be written");
    if (in_place_) return;
    if (::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) continue;  // some file systems have no locks
    ::close(file_);
    throw FileError(fmt::format("file '{}' is being written by another run; wait for it, or name another", name_));
  } while (!is_still_partial());
}

// Whether the file that was opened has the name still: another run may have finished, and renamed it, in between.
bool GrowingFile::is_still_partial() const {
  struct stat opened, named;
  return ::fstat(file_, &opened) != 0 || (::stat(partial_.c_str(), &named) == 0 && opened.st_ino == named.st_ino);
}

GrowingFile::~GrowingFile() {
  struct stat left;
  if (!in_place_ && ::fstat(file_, &left) == 0 && left.st_size == 0 && is_still_partial()) ::unlink(partial_.c_str());
  ::close(file_);
}

void GrowingFile::fail(const char* what) const {
  throw FileError(fmt::format("file '{}' {}: {}; check the folder and the free space, or name another", partial_, what,
                              std::strerror(errno)));
}

void GrowingFile::clear() {
  waiting_.clear();
  hash_ = hash_of(""), written_ = now();
  cut(0);
}

void GrowingFile::cut(long length) {
  length_ = length;
  if (in_place_) return;
  if (::ftruncate(file_, length) != 0 || ::lseek(file_, length, SEEK_SET) != length) fail("cannot be emptied");
}

void GrowingFile::sync() {
  write();
  if (!in_place_ && ::fsync(file_) != 0 && errno != EINVAL && errno != EROFS) fail("cannot be brought to the disk");
}

void GrowingFile::go_on(long length, std::uint64_t hash) {
  constexpr long kBlock = 1 << 16;
  std::vector<char> block(kBlock);
  const auto begins_so = [&](const std::string& file, const auto& with) {
    std::ifstream in(file, std::ios::binary);
    std::uint64_t found = hash_of("");
    for (long at = 0; in && at < length; at += kBlock) {
      const long n = std::min(kBlock, length - at);
      if (!in.read(block.data(), n)) return false;
      found = hash_of({block.data(), static_cast<std::size_t>(n)}, found);
      with(std::string_view(block.data(), static_cast<std::size_t>(n)));
    }
    return in && found == hash;
  };
  waiting_.clear();
  if (begins_so(partial_, [](std::string_view) {})) {
    cut(length), hash_ = hash;
    return;
  }
  if (!begins_so(name_, [](std::string_view) {}))
    throw FileError(fmt::format(
        "the rows before the checkpoint are missing or changed in '{}' and '{}'; restore them, or run again", partial_,
        name_));
  clear();
  begins_so(name_, [&](std::string_view bytes) { append(bytes); });
  write();
}

void GrowingFile::append(std::string_view text) {
  waiting_ += text;
  if (waiting_.size() > kMostWaiting) write();
}

void GrowingFile::write_if_due() {
  const double t = now();
  if (t - written_ < kInterval) return;
  write();
  written_ = t;
}

// If the disk is full, whole lines stay, and a torn one is removed.
void GrowingFile::write() {
  std::size_t written = 0;
  while (written < waiting_.size()) {
    const ssize_t n = ::write(file_, waiting_.data() + written, waiting_.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int why = errno;
      const bool any = written > 0 && !in_place_;
      count_written(any ? waiting_.rfind('\n', written - 1) + 1 : written);  // npos + 1 = 0
      if (!in_place_ && ::ftruncate(file_, length_) == 0) ::lseek(file_, length_, SEEK_SET);
      errno = why;
      fail("cannot be written");
    }
    written += n;
  }
  count_written(written);
}

// The first n bytes of those that wait are in the file.
void GrowingFile::count_written(std::size_t n) {
  length_ += static_cast<long>(n);
  hash_ = hash_of(std::string_view(waiting_).substr(0, n), hash_);
  waiting_.erase(0, n);
}

void GrowingFile::commit() {
  sync();
  if (!in_place_ && std::rename(partial_.c_str(), name_.c_str()) != 0) fail("cannot be renamed");
}

}  // namespace lockstep
