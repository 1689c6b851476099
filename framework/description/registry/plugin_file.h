// Reads the ELF file of a plugin (System V ABI, chapters 4 and 5) before any of its code is loaded.
#pragma once

#include <elf.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lockstep {

/// The bytes of a file; every access is checked against its end.
class Bytes {
 public:
  /// Throws PluginError when it is not a regular file, cannot be read, is empty, or is larger than 2^30 bytes.
  explicit Bytes(std::string path);

  template <class T>
  T at(std::uint64_t offset) const {
    need(offset, sizeof(T));
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  const char* data() const { return bytes_.data(); }
  bool begins_with(std::string_view magic) const {
    return std::string_view(bytes_.data(), bytes_.size()).substr(0, magic.size()) == magic;
  }
  /// Throws PluginError when n bytes from the offset on are not all in the file.
  void need(std::uint64_t offset, std::uint64_t n) const;
  [[noreturn]] void refuse(const std::string& why) const;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::vector<char> bytes_;
};

/// A shared library's file. Header, segments, dynamic table and symbols are read, and checked where damage would crash
/// the system's loader. Throws PluginError that names what is wrong.
class SharedFile {
 public:
  struct Place {
    std::uint64_t offset = 0, size = 0;
  };

  explicit SharedFile(const std::string& path);

  const Bytes& bytes() const { return bytes_; }
  /// Where the data of an exported symbol are in the file; nothing when it exports no such data.
  std::optional<Place> exported(const std::string& symbol) const;

 private:
  void read_header();
  void read_segments();
  void read_dynamic();
  void check_tables() const;
  void count_symbols();
  std::optional<std::uint64_t> tag(std::int64_t which) const;
  std::uint64_t value(std::int64_t which, const char* what) const;
  std::uint64_t offset_of(std::uint64_t address, std::uint64_t size, const char* what) const;  // in the file

  Bytes bytes_;
  Elf64_Ehdr header_{};
  std::vector<Elf64_Phdr> loaded_;
  Elf64_Phdr dynamic_{};
  std::map<std::int64_t, std::uint64_t> tags_;
  std::uint64_t strings_ = 0, strings_size_ = 0, symbols_ = 0, n_symbols_ = 0;  // offsets and sizes in the file
};

}  // namespace lockstep
