// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/plugin_file.h"

#include <elf.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <vector>

#include <lockstep/error.h>
#include "framework/foundation/support/hash.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr unsigned kMostSegments = 64;

#if defined(__x86_64__)
constexpr unsigned kMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr unsigned kMachine = EM_AARCH64;
#elif defined(__riscv)
constexpr unsigned kMachine = EM_RISCV;
#else
constexpr unsigned kMachine = EM_NONE;  // not known here: any is taken
#endif

std::string machine_name(unsigned machine) {
  static const std::map<unsigned, const char*> kNames = {
      {EM_X86_64, "x86-64"}, {EM_386, "x86 of 32 bits"},       {EM_AARCH64, "AArch64"}, {EM_ARM, "ARM of 32 bits"},
      {EM_RISCV, "RISC-V"},  {EM_PPC64, "PowerPC of 64 bits"}, {EM_S390, "S/390"}};
  const auto found = kNames.find(machine);
  return found != kNames.end() ? found->second : "machine number " + std::to_string(machine);
}

// A pipe is not opened: that would wait for its writer forever.
std::vector<char> bytes_of(const std::string& path) {
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
  std::vector<char> bytes(size);
  if (!file.seekg(0).read(bytes.data(), static_cast<std::streamsize>(size)))
    throw PluginError(who + "cannot be read to its end; try again");
  return bytes;
}

PluginStamp stamp_of_bytes(const std::vector<char>& bytes) {
  return {bytes.size(), hash_of({bytes.data(), bytes.size()})};
}

// The file of a shared library for this machine (ELF: System V ABI, chapters 4 and 5), which may be cut or damaged: views of
// its bytes are checked. Addresses are those in the file: the loader adds the library's place. Each error is a
// PluginError with the file, what is wrong, its value and the limit.
class ElfImage {
 public:
  explicit ElfImage(std::string path) : path_(std::move(path)), bytes_(bytes_of(path_)) {
    if (bytes_.empty()) refuse("it is empty");
    read_header();
    for (const Elf64_Phdr& s : segments_) in_file<char>("a segment", s.p_offset, s.p_filesz);
  }

  // `count` values from an offset in the file on; throws if they are not all in the file, or not aligned.
  template <class T>
  std::span<const T> in_file(std::string_view what, std::uint64_t offset, std::uint64_t count) const {
    need_in_file(what, offset, count, sizeof(T), alignof(T));
    return {reinterpret_cast<const T*>(bytes_.data() + offset), static_cast<std::size_t>(count)};
  }
  // The same from an address on; throws if they are not all in the part of the file of one mapped segment.
  template <class T>
  std::span<const T> at(std::string_view what, std::uint64_t address, std::uint64_t count) const {
    return in_file<T>(what, offset_of(what, address, count * sizeof(T)), count);
  }
  [[noreturn]] void refuse(std::string_view why) const {
    throw PluginError(
        fmt::format("plugin file '{}' is not a shared library that can be loaded here: {}; ", path_, why) +
        "rebuild it with lockstep_add_plugin");
  }

  // The first segment of a type (PT_DYNAMIC, ...), or null.
  const Elf64_Phdr* segment(std::uint32_t type) const {
    const auto found = std::ranges::find(segments_, type, &Elf64_Phdr::p_type);
    return found != segments_.end() ? &*found : nullptr;
  }
  PluginStamp stamp() const { return stamp_of_bytes(bytes_); }

 private:
  void read_header() {
    if (!std::string_view(bytes_.data(), bytes_.size()).starts_with(ELFMAG))
      refuse("it does not begin with an ELF header");
    const auto ident = in_file<unsigned char>("its header", 0, EI_NIDENT);
    constexpr unsigned kOrder = std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;
    need_equal("it is made for a machine of another word size: its class", ident[EI_CLASS], ELFCLASS64);
    need_equal("it is made for a machine of another byte order: its order", ident[EI_DATA], kOrder);
    const Elf64_Ehdr& h = in_file<Elf64_Ehdr>("its header", 0, 1).front();
    if (kMachine != EM_NONE && h.e_machine != kMachine)
      refuse("it is made for " + machine_name(h.e_machine) + ", this host is " + machine_name(kMachine));
    need_equal("its format is of an unknown version: it", ident[EI_VERSION], EV_CURRENT);
    need_equal("its format is of an unknown version: it", h.e_version, EV_CURRENT);
    if (ident[EI_OSABI] != ELFOSABI_NONE)
      need_equal("it is made for another operating system: its number", ident[EI_OSABI], ELFOSABI_GNU);
    need_equal("it is an object file or a program: its type", h.e_type, ET_DYN);
    need_equal("its header is damaged: its size", h.e_ehsize, sizeof h);
    need_equal("its header is damaged: the size of an entry for a segment", h.e_phentsize, sizeof(Elf64_Phdr));
    if (h.e_phnum == 0 || h.e_phnum > kMostSegments)
      refuse(fmt::format("its header is damaged: the number of segments is {}; must be from 1 to {}", h.e_phnum,
                         kMostSegments));
    segments_ = in_file<Elf64_Phdr>("its list of segments", h.e_phoff, h.e_phnum);
    // The loader does not read sections; their list is at the end of a file, and shows one that was cut.
    if (h.e_shoff != 0) in_file<char>("its list of sections", h.e_shoff, std::uint64_t(h.e_shnum) * h.e_shentsize);
  }

  void need_in_file(std::string_view what, std::uint64_t offset, std::uint64_t count, std::uint64_t each,
                    std::uint64_t alignment) const {
    if (offset > bytes_.size() || (bytes_.size() - offset) / each < count)
      refuse(fmt::format("it ends too early: {} is {} bytes from {} on; must end at {} or before", what, count * each,
                         offset, bytes_.size()));
    if (offset % alignment != 0)
      refuse(fmt::format("the offset of {} is {}; must be a multiple of {}", what, offset, alignment));
  }

  std::uint64_t offset_of(std::string_view what, std::uint64_t address, std::uint64_t size) const {
    for (const Elf64_Phdr& s : segments_)
      if (s.p_type == PT_LOAD && address >= s.p_vaddr && address - s.p_vaddr <= s.p_filesz &&
          s.p_filesz - (address - s.p_vaddr) >= size)
        return s.p_offset + (address - s.p_vaddr);
    refuse(fmt::format("{} is {} bytes at address {:#x}; must be in one segment of the file", what, size, address));
  }

  void need_equal(std::string_view what, std::uint64_t value, std::uint64_t expected) const {
    if (value != expected) refuse(fmt::format("{} is {}; must be {}", what, value, expected));
  }

  std::string path_;
  std::vector<char> bytes_;
  std::span<const Elf64_Phdr> segments_;
};

using Number = std::uint64_t;

constexpr std::string_view kHash = "its hash table";

std::map<std::int64_t, Number> dynamic_table(const ElfImage& image) {
  std::map<std::int64_t, Number> tags;
  const Elf64_Phdr* s = image.segment(PT_DYNAMIC);
  if (s == nullptr) image.refuse("it has no dynamic table");
  for (const Elf64_Dyn& e :
       image.in_file<Elf64_Dyn>("its dynamic table", s->p_offset, s->p_filesz / sizeof(Elf64_Dyn))) {
    if (e.d_tag == DT_NULL) break;
    tags[e.d_tag] = e.d_un.d_val;
  }
  for (const std::int64_t needed : {DT_SYMTAB, DT_STRTAB, DT_STRSZ})
    if (!tags.contains(needed)) image.refuse(fmt::format("its dynamic table has no tag {:#x}; must have it", needed));
  return tags;
}

// Symbols before the first are in no bucket, each chain is a run of symbols, and its last has an odd number.
Number count_by_gnu_hash(const ElfImage& image, Number address) {
  const auto head = image.at<std::uint32_t>(kHash, address, 4);
  const Number n_buckets = head[0], first = head[1], n_filter = head[2], buckets = address + 16 + 8 * n_filter;
  Number last = 0;
  for (const Number k : image.at<std::uint32_t>(kHash, buckets, n_buckets)) last = std::max(last, k);
  if (last < first) return first;
  while ((image.at<std::uint32_t>(kHash, buckets + 4 * (n_buckets + last - first), 1).front() & 1) == 0) ++last;
  return last + 1;
}

// How many symbols there are is in the hash tables only, of which the loader takes GNU's if there are both.
Number count_symbols(const ElfImage& image, const std::map<std::int64_t, Number>& tags) {
  if (const auto table = tags.find(DT_GNU_HASH); table != tags.end()) return count_by_gnu_hash(image, table->second);
  const auto table = tags.find(DT_HASH);
  if (table == tags.end()) image.refuse("its symbols have no hash table");
  return image.at<std::uint32_t>(kHash, table->second, 2).back();
}

}  // namespace

PluginStamp stamp_of(const std::string& file) { return stamp_of_bytes(bytes_of(file)); }

CheckedFile exported_data(const std::string& path, std::string_view symbol) {
  const ElfImage image(path);
  const std::map<std::int64_t, Number> tags = dynamic_table(image);
  const auto strings = image.at<char>("its table of strings", tags.at(DT_STRTAB), tags.at(DT_STRSZ));
  const std::string_view names(strings.data(), strings.size());
  const std::string ended = std::string(symbol) + '\0';
  for (const Elf64_Sym& s :
       image.at<Elf64_Sym>("its table of symbols", tags.at(DT_SYMTAB), count_symbols(image, tags))) {
    if (s.st_shndx == SHN_UNDEF || ELF64_ST_TYPE(s.st_info) != STT_OBJECT || s.st_name >= names.size()) continue;
    if (names.substr(s.st_name, symbol.size() + 1) != ended) continue;
    const auto data = image.at<char>("the data of a symbol", s.st_value, s.st_size);
    return {image.stamp(), std::string(data.begin(), data.end())};
  }
  return {image.stamp(), {}};
}

}  // namespace lockstep
