#include "framework/description/registry/elf_image.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bit>
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

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30, kMostAddress = std::uint64_t{1} << 40;
constexpr std::uint64_t kLeastPage = 4096;  // of all machines below

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

// The types of segments that are parts of mapped ones, and that the loader reads.
bool is_part(std::uint32_t type) {
  constexpr std::uint32_t kParts[] = {PT_DYNAMIC, PT_PHDR,         PT_TLS,         PT_GNU_RELRO,
                                      PT_NOTE,    PT_GNU_PROPERTY, PT_GNU_EH_FRAME};
  return std::ranges::count(kParts, type) > 0;
}

// A pipe is not opened: it would wait for its writer for ever.
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

}  // namespace

ElfImage::ElfImage(std::string path) : path_(std::move(path)), bytes_(bytes_of(path_)) {
  if (bytes_.empty()) refuse("it is empty");
  read_header();
  check_segments();
}

void ElfImage::read_header() {
  if (!std::string_view(bytes_.data(), bytes_.size()).starts_with(ELFMAG)) refuse("it does not begin with an ELF header");
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
  need_at_least("its header is damaged: the number of segments", h.e_phnum, 1);
  need_at_most("its header is damaged: the number of segments", h.e_phnum, 64);
  segments_ = in_file<Elf64_Phdr>("its list of segments", h.e_phoff, h.e_phnum);
  // The loader does not read sections; their list stands at the end of a file, and shows one that was cut.
  if (h.e_shoff != 0) in_file<char>("its list of sections", h.e_shoff, std::uint64_t(h.e_shnum) * h.e_shentsize);
}

void ElfImage::check_segments() const {
  std::uint64_t end = 0;                  // of the mapped segment before
  std::map<std::uint32_t, int> n_of_type;
  for (const Elf64_Phdr& s : segments_) {
    if (s.p_type == PT_GNU_STACK && (s.p_flags & PF_X) != 0) refuse("it asks for a stack that can be executed");
    if (s.p_type == PT_NULL || s.p_type == PT_GNU_STACK) continue;
    in_file<char>("a segment", s.p_offset, s.p_filesz);
    ++n_of_type[s.p_type];
    if (s.p_type != PT_LOAD && !is_part(s.p_type)) continue;  // for other tools than the loader
    need_at_most("the size of a segment", s.p_memsz, s.p_type == PT_TLS ? kMostBytes : kMostAddress);
    need_at_most("the size of a segment in the file", s.p_filesz, s.p_memsz);
    need_at_most("the address of a segment", s.p_vaddr, kMostAddress);
    need_at_most("the alignment of a segment", s.p_align, kMostBytes);
    if (!std::has_single_bit(s.p_align) && s.p_align != 0)
      refuse(fmt::format("the alignment of a segment is {}; must be a power of two", s.p_align));
    if (s.p_type != PT_LOAD) continue;
    check_mapped(s, end);
    end = s.p_vaddr + s.p_memsz;
  }
  if (end == 0) refuse("it has nothing to load");
  need_equal("the number of its dynamic tables", n_of_type[PT_DYNAMIC], 1);
  need_at_most("the number of its parts for the variables of a thread", n_of_type[PT_TLS], 1);
  need_at_most("the number of its parts that are made read-only", n_of_type[PT_GNU_RELRO], 1);
  for (const Elf64_Phdr& s : segments_) check_part(s);
}

void ElfImage::check_mapped(const Elf64_Phdr& s, std::uint64_t end_before) const {
  const std::uint64_t page = std::max<std::uint64_t>(s.p_align, kLeastPage);
  if ((s.p_flags & PF_R) == 0 || (s.p_flags & (PF_W | PF_X)) == (PF_W | PF_X))
    refuse(fmt::format("a segment has flags {}; must be readable, and not both writable and executable", s.p_flags));
  if ((s.p_flags & PF_W) == 0)
    need_equal("the size in the file of a segment of code or constants", s.p_filesz, s.p_memsz);
  need_at_least("its segments overlap or are in disorder: the address of one", s.p_vaddr, end_before);
  need_at_least("two segments share a page: the page of one", s.p_vaddr / kLeastPage,
                (end_before + kLeastPage - 1) / kLeastPage);
  need_equal("a segment cannot be mapped: its address in its page", s.p_vaddr % page, s.p_offset % page);
  for (const Elf64_Phdr& t : segments_)
    if (t.p_type == PT_LOAD && t.p_vaddr < s.p_vaddr &&
        std::max(s.p_offset, t.p_offset) < std::min(s.p_offset + s.p_filesz, t.p_offset + t.p_filesz))
      refuse(fmt::format("its segments overlap in the file: one is at offset {}; must be outside of {} to {}",
                         s.p_offset, t.p_offset, t.p_offset + t.p_filesz));
}

// A part of what is mapped. The loader uses its address, so its offset must be the same place. What is not in the file
// is the zeros of a thread's variables, or fills the last page that is made read-only.
void ElfImage::check_part(const Elf64_Phdr& s) const {
  if (!is_part(s.p_type)) return;
  const std::string what = fmt::format("the part of type {:#x}", s.p_type);
  const std::uint64_t rest = s.p_memsz - s.p_filesz;
  need_mapped(what, s.p_vaddr, s.p_type == PT_TLS || s.p_type == PT_GNU_RELRO ? s.p_filesz : s.p_memsz,
              s.p_type == PT_GNU_RELRO ? PF_W : 0);
  if (s.p_filesz > 0) {
    const std::uint64_t offset = offset_of(what, s.p_vaddr, s.p_filesz, 1, 0, &Elf64_Phdr::p_filesz);
    need_equal("the offset of " + what, s.p_offset, offset);
  }
  for (const Elf64_Phdr& t : segments_)  // the one that it is in
    if (s.p_type == PT_GNU_RELRO && t.p_type == PT_LOAD && t.p_vaddr <= s.p_vaddr && s.p_vaddr < t.p_vaddr + t.p_memsz)
      need_at_most("what is not in the file of " + what, rest, std::max<std::uint64_t>(t.p_align, kLeastPage) - 1);
  if (s.p_type == PT_PHDR && at<Elf64_Phdr>(what, s.p_vaddr, segments_.size()).data() != segments_.data())
    refuse(fmt::format("{} is at address {:#x}; must be the list of segments", what, s.p_vaddr));
}

const Elf64_Phdr* ElfImage::segment(std::uint32_t type) const {
  const auto found = std::ranges::find(segments_, type, &Elf64_Phdr::p_type);
  return found != segments_.end() ? &*found : nullptr;
}

PluginStamp stamp_of(const std::string& file) {
  const std::vector<char> bytes = bytes_of(file);
  return {bytes.size(), hash_of({bytes.data(), bytes.size()})};
}

PluginStamp ElfImage::stamp() const { return {bytes_.size(), hash_of({bytes_.data(), bytes_.size()})}; }

void ElfImage::need_in_file(std::string_view what, std::uint64_t offset, std::uint64_t count, std::uint64_t each,
                            std::uint64_t alignment) const {
  if (offset > bytes_.size() || (bytes_.size() - offset) / each < count)
    refuse(fmt::format("it ends too early: {} is {} bytes from {} on; must end at {} or before", what, count * each,
                       offset, bytes_.size()));
  if (offset % alignment != 0)
    refuse(fmt::format("the offset of {} is {}; must be a multiple of {}", what, offset, alignment));
}

std::uint64_t ElfImage::offset_of(std::string_view what, std::uint64_t address, std::uint64_t count, std::uint64_t each,
                                  std::uint32_t flags, Elf64_Xword Elf64_Phdr::*extent) const {
  for (const Elf64_Phdr& s : segments_) {
    const std::uint64_t before = address - s.p_vaddr;
    if (s.p_type == PT_LOAD && (s.p_flags & flags) == flags && address >= s.p_vaddr && before <= s.*extent &&
        (s.*extent - before) / each >= count)
      return s.p_offset + before;
  }
  const char* which = flags == PF_X ? "executable" : flags == PF_W ? "writable" : "mapped";
  refuse(fmt::format("{} is {} bytes at address {:#x}; must be in one {} segment{}", what, count * each, address, which,
                     extent == &Elf64_Phdr::p_filesz ? " of the file" : ""));
}

void ElfImage::need_equal(std::string_view what, std::uint64_t value, std::uint64_t expected) const {
  if (value != expected) refuse(fmt::format("{} is {}; must be {}", what, value, expected));
}

void ElfImage::need_at_least(std::string_view what, std::uint64_t value, std::uint64_t limit) const {
  if (value < limit) refuse(fmt::format("{} is {}; must be at least {}", what, value, limit));
}

void ElfImage::need_at_most(std::string_view what, std::uint64_t value, std::uint64_t limit) const {
  if (value > limit) refuse(fmt::format("{} is {}; must be at most {}", what, value, limit));
}

void ElfImage::refuse(std::string_view why) const {
  throw PluginError(fmt::format("plugin file '{}' is not a shared library that can be loaded here: {}; ", path_, why) +
                    "rebuild it with lockstep_add_plugin");
}

}  // namespace lockstep
