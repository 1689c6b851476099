// SPDX-License-Identifier: BSD-3-Clause
// The file of a shared library (ELF: System V ABI, chapters 4 and 5): its header, its segments, and views of its bytes
// that are checked against the end of the file and of the segments.
#pragma once

#include <elf.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/author/loader.h>

namespace lockstep {

/// Size and checksum of a file, whatever it holds. Throws PluginError when it is not a regular file or cannot be read.
PluginStamp stamp_of(const std::string& file);

/// The file of a shared library for this machine, which may be cut or damaged: views of its bytes are checked. Addresses are
/// those in the file: the loader adds the library's place. Each refusal is a PluginError with the file, what is wrong, its
/// value and the limit.
class ElfImage {
 public:
  /// Throws PluginError when the path is not a plain file, cannot be read, is empty, is larger than 2^30 bytes, or when
  /// its header is not that of a shared library for this machine, or a segment is not all in it.
  explicit ElfImage(std::string path);
  ElfImage(const ElfImage&) = delete;
  ElfImage& operator=(const ElfImage&) = delete;

  /// `count` values from an offset in the file on; refuses what is not all in the file, or not aligned.
  template <class T>
  std::span<const T> in_file(std::string_view what, std::uint64_t offset, std::uint64_t count) const {
    need_in_file(what, offset, count, sizeof(T), alignof(T));
    return {reinterpret_cast<const T*>(bytes_.data() + offset), static_cast<std::size_t>(count)};
  }
  /// The same from an address on; refuses what is not all in what one mapped segment takes from the file.
  template <class T>
  std::span<const T> at(std::string_view what, std::uint64_t address, std::uint64_t count) const {
    return in_file<T>(what, offset_of(what, address, count * sizeof(T)), count);
  }
  [[noreturn]] void refuse(std::string_view why) const;

  /// The first segment of a type (PT_DYNAMIC, ...), or null.
  const Elf64_Phdr* segment(std::uint32_t type) const;
  PluginStamp stamp() const;

 private:
  void read_header();
  void need_equal(std::string_view what, std::uint64_t value, std::uint64_t expected) const;
  void need_in_file(std::string_view what, std::uint64_t offset, std::uint64_t count, std::uint64_t each,
                    std::uint64_t alignment) const;
  std::uint64_t offset_of(std::string_view what, std::uint64_t address, std::uint64_t size) const;

  std::string path_;
  std::vector<char> bytes_;
  std::span<const Elf64_Phdr> segments_;
};

}  // namespace lockstep
