// A shared library as it stands in its file, by the ELF format (System V ABI, chapters 4 and 5), nothing opened. What
// the system's loader would stumble over - it trusts what it reads - is refused here first.
#pragma once

#include <elf.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lockstep {

/// A file read whole; every access is checked against its end.
class Image {
 public:
  /// Throws PluginError when it is no plain file, cannot be read, or is larger than a plugin can be.
  explicit Image(std::string path);

  template <class T>
  T at(std::uint64_t offset) const {
    need(offset, sizeof(T));
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  const char* data() const { return bytes_.data(); }
  std::size_t size() const { return bytes_.size(); }
  /// Throws PluginError when n bytes from the offset on are not all in the file.
  void need(std::uint64_t offset, std::uint64_t n) const;
  [[noreturn]] void refuse(const std::string& why) const;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::vector<char> bytes_;
};

/// Read and checked: header, segments, dynamic table, strings, symbols, hash tables, versions, relocations, and the
/// functions that run at opening and closing. Throws PluginError that names what is wrong.
class SharedFile {
 public:
  struct Place {
    std::uint64_t offset = 0, size = 0;
  };

  explicit SharedFile(const std::string& path);

  const Image& image() const { return image_; }
  /// Where the data of an exported symbol stand in the file; nothing when it exports no such data.
  std::optional<Place> exported(const std::string& symbol) const;
  /// Of what a loader takes into memory - header, segments, not the tables of sections that debuggers read - with the
  /// bytes of `left_out` as zeros.
  std::uint64_t checksum(const std::vector<Place>& left_out) const;

 private:
  // elf.cpp
  void read_header();
  void read_segments();
  void check_loaded();
  const Elf64_Phdr* segment(std::uint64_t address, std::uint64_t size, unsigned flags) const;  // in memory
  std::uint64_t offset_of(std::uint64_t address, std::uint64_t size, const char* what) const;  // in the file

  // elf_tables.cpp
  void read_dynamic();
  void check_pairs() const;
  std::optional<std::uint64_t> tag(std::int64_t which) const;
  std::uint64_t value(std::int64_t which, const char* what) const;
  std::string text(std::uint64_t name) const;
  void check_strings();
  void count_symbols();
  std::uint64_t count_by_hash(std::uint64_t at) const;
  std::uint64_t count_by_gnu_hash(std::uint64_t at) const;
  void check_symbols() const;
  std::uint64_t check_needed_versions() const;
  std::uint64_t check_own_versions() const;
  void check_versions() const;

  // elf_code.cpp
  void check_code();
  void check_relocations(std::int64_t table, std::int64_t size, const char* what);
  void check_relative() const;
  void check_function(std::int64_t which, const char* what) const;
  void check_functions(std::int64_t table, std::int64_t size, const char* what) const;

  Image image_;
  Elf64_Ehdr header_{};
  std::vector<Elf64_Phdr> segments_;  // all of them
  Elf64_Phdr dynamic_{};
  std::uint64_t thread_size_ = 0;  // of a segment of thread locals
  std::map<std::int64_t, std::uint64_t> tags_;
  std::vector<std::uint64_t> needed_;  // names of libraries
  std::uint64_t strings_ = 0, strings_size_ = 0, symbols_ = 0, n_symbols_ = 0;
  std::map<std::uint64_t, std::uint64_t> relative_;  // place -> address that is put there
};

}  // namespace lockstep
