// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/plugin_file.h"

#include <elf.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include <lockstep/error.h>
#include "framework/foundation/support/hash.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;

// The header of the library, or of the program that contains it: the linker defines it.
extern "C" __attribute__((visibility("hidden"))) const Elf64_Ehdr __ehdr_start;  // NOLINT: the linker's name

std::string machine_name(unsigned machine) {
  static const std::map<unsigned, const char*> kNames = {
      {EM_X86_64, "x86-64"}, {EM_386, "x86 of 32 bits"},       {EM_AARCH64, "AArch64"}, {EM_ARM, "ARM of 32 bits"},
      {EM_RISCV, "RISC-V"},  {EM_PPC64, "PowerPC of 64 bits"}, {EM_S390, "S/390"}};
  const auto found = kNames.find(machine);
  return found != kNames.end() ? found->second : "machine number " + std::to_string(machine);
}

// A pipe is not opened: that would wait for its writer forever.
std::string bytes_of(const std::string& path) {
  static const std::map<fs::file_type, const char*> kOthers = {{fs::file_type::directory, "a folder"},
                                                               {fs::file_type::fifo, "a pipe"},
                                                               {fs::file_type::character, "a device"},
                                                               {fs::file_type::block, "a device"},
                                                               {fs::file_type::socket, "a socket"}};
  const std::string who = "plugin file '" + path + "' ";
  std::error_code error;
  if (const auto kind = kOthers.find(fs::status(path, error).type()); kind != kOthers.end())
    throw PluginError(who + "is " + kind->second + ", not a regular file");
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file)
    throw PluginError(who + "cannot be opened (" + std::strerror(errno) + "); check the path and that you may read it");
  const std::streamoff end = file.tellg();
  if (end < 0) throw PluginError(who + "has no end; a plugin is a regular file");
  const auto size = static_cast<std::uint64_t>(end);
  if (size > kMostBytes) throw PluginError(fmt::format("{}has {} bytes; a plugin has at most 2^30", who, size));
  std::string bytes(size, '\0');
  if (!file.seekg(0).read(bytes.data(), static_cast<std::streamsize>(size)))
    throw PluginError(who + "cannot be read to its end; try again");
  return bytes;
}

PluginStamp stamp_of_bytes(const std::string& bytes) { return {bytes.size(), hash_of(bytes)}; }

[[noreturn]] void refuse_image(const std::string& path, const std::string& why) {
  throw PluginError("plugin file '" + path + "' is not a shared library that can be loaded here: " + why +
                    "; rebuild it with lockstep_add_plugin");
}

// Refuses a file that ends before n bytes from `offset` on.
void require(const std::string& bytes, std::uint64_t offset, std::uint64_t n, const std::string& path) {
  if (offset > bytes.size() || bytes.size() - offset < n)
    refuse_image(path, fmt::format("the file is truncated: {} bytes, but its headers require at least {}", bytes.size(),
                                   std::max({offset, n, offset + n})));
}

template <class T>
T read_at(const std::string& bytes, std::uint64_t offset, const std::string& path) {
  require(bytes, offset, sizeof(T), path);
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// The faults that the system's loader does not report: another machine, and a file that was cut (ELF: System V ABI,
// chapters 4 and 5).
void check_image(const std::string& bytes, const std::string& path) {
  if (!bytes.starts_with(ELFMAG))
    refuse_image(path, bytes.empty() ? "it is empty" : "it does not begin with an ELF header");
  const auto header = read_at<Elf64_Ehdr>(bytes, 0, path);
  for (const int kind : {EI_CLASS, EI_DATA})
    if (header.e_ident[kind] != __ehdr_start.e_ident[kind])
      refuse_image(path, "it is made for a machine of another word size or byte order");
  if (header.e_machine != __ehdr_start.e_machine)
    refuse_image(path, "it is made for " + machine_name(header.e_machine) + ", this host is " +
                           machine_name(__ehdr_start.e_machine));
  for (unsigned k = 0; k < header.e_phnum; ++k) {
    const auto s = read_at<Elf64_Phdr>(bytes, header.e_phoff + k * sizeof(Elf64_Phdr), path);
    require(bytes, s.p_offset, s.p_filesz, path);
  }
}

}  // namespace

PluginStamp stamp_of(const std::string& file) { return stamp_of_bytes(bytes_of(file)); }

CheckedFile data_from(const std::string& path, std::string_view magic, std::size_t most) {
  const std::string bytes = bytes_of(path);
  check_image(bytes, path);
  return {stamp_of_bytes(bytes), bytes.substr(std::min(bytes.find(magic), bytes.size()), most)};
}

}  // namespace lockstep
