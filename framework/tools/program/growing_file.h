// SPDX-License-Identifier: BSD-3-Clause
// GrowingFile: a file of results that loses neither the old results nor the new ones.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lockstep {

/// NAME.partial, which becomes NAME when it is done. It is locked: a second program that writes results of that name
/// gets an error. After a failure it stays, with whole lines only. If NAME is a link, its target is written. A device
/// or a pipe is written in place and never replaced; "-" is standard output.
class GrowingFile {
 public:
  /// Opens the file; what it holds stays until clear(), and an existing NAME until commit(). Throws FileError: it
  /// cannot be written, is write-protected, or another run writes it.
  explicit GrowingFile(std::string name);
  ~GrowingFile();  ///< removes NAME.partial if it is empty
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  const std::string& name() const { return name_; }
  const std::string& partial() const { return partial_; }  ///< the file that is written: NAME itself if in place
  bool in_place() const { return in_place_; }
  void clear();                        ///< begins again
  void append(std::string_view text);  ///< whole lines; they reach the file by write()
  void write();                        ///< Throws FileError.
  void commit();                       ///< The file is done, and safe on the disk. Throws FileError.

  // -- to continue a file later
  void sync();                                  ///< write(), and to the disk. Throws FileError.
  long length() const { return length_; }       ///< bytes that were written
  std::uint64_t hash() const { return hash_; }  ///< of these bytes (hash_of, checkpoint.h)
  /// In place of clear(): keeps the first `length` bytes of NAME.partial, or of NAME if the run has ended. Throws
  /// FileError if neither begins with bytes of that hash.
  void go_on(long length, std::uint64_t hash);

 private:
  bool is_still_partial() const;
  void cut(long length);
  void count_written(std::size_t n);
  [[noreturn]] void fail(const char* what) const;
  std::string name_, partial_, waiting_;
  bool in_place_ = false;
  long length_ = 0;  // of what was written whole,
  std::uint64_t hash_ = 0;
  int file_ = -1;
};

}  // namespace lockstep
