#include "framework/description/registry/elf.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>

#include "framework/description/registry/checksum.h"
#include "framework/foundation/support/error.h"

namespace lockstep {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kMostPage = std::uint64_t{1} << 16;
constexpr std::uint64_t kMostAddress = std::uint64_t{1} << 40;

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
  switch (machine) {
    case EM_X86_64:
      return "x86-64";
    case EM_386:
      return "x86 of 32 bits";
    case EM_AARCH64:
      return "AArch64";
    case EM_ARM:
      return "ARM of 32 bits";
    case EM_RISCV:
      return "RISC-V";
    case EM_PPC64:
      return "PowerPC of 64 bits";
    case EM_S390:
      return "S/390";
    default:
      return "machine number " + std::to_string(machine);
  }
}

// Closes what was opened.
struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) close(number);
  }
};

std::string kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  if (S_ISSOCK(mode)) return "a socket";
  return "no plain file";
}

}  // namespace

// Opened without waiting: a pipe would wait for its writer for ever.
Image::Image(std::string path) : path_(std::move(path)) {
  const std::string who = "plugin file '" + path_ + "' ";
  const Descriptor file{open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  struct stat about {};
  if (file.number < 0 && errno == ENXIO) throw PluginError(who + "is a socket or a pipe, no plain file");
  if (file.number < 0 || fstat(file.number, &about) != 0)
    throw PluginError(who + "cannot be opened (" + std::strerror(errno) + "); check the path and that you may read it");
  if (!S_ISREG(about.st_mode)) throw PluginError(who + "is " + kind_of(about.st_mode) + ", no plain file");
  if (static_cast<std::uint64_t>(about.st_size) > kMostBytes)
    throw PluginError(who + "has " + std::to_string(about.st_size) + " bytes; a plugin has at most 2^30");
  bytes_.resize(static_cast<std::size_t>(about.st_size));
  std::size_t n = 0;
  while (n < bytes_.size()) {
    const ssize_t got = read(file.number, bytes_.data() + n, bytes_.size() - n);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw PluginError(who + "cannot be read to its end; try again");
    n += static_cast<std::size_t>(got);
  }
  if (bytes_.empty()) refuse("it is empty");
}

void Image::need(std::uint64_t offset, std::uint64_t n) const {
  if (offset > bytes_.size() || bytes_.size() - offset < n) refuse("it ends too early");
}

void Image::refuse(const std::string& why) const {
  throw PluginError("plugin file '" + path_ + "' is no shared library that can be loaded here: " + why +
                    "; rebuild it with lockstep_add_plugin");
}

SharedFile::SharedFile(const std::string& path) : image_(path) {
  read_header();
  read_segments();
  check_loaded();
  read_dynamic();
  check_strings();
  count_symbols();
  check_symbols();
  check_versions();
  check_code();
}

void SharedFile::read_header() {
  if (image_.size() < SELFMAG || std::memcmp(image_.data(), ELFMAG, SELFMAG) != 0)
    image_.refuse("it does not begin as one");
  const auto ident = image_.at<std::array<unsigned char, EI_NIDENT>>(0);
  const unsigned char order = std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;
  if (ident[EI_CLASS] != ELFCLASS64) image_.refuse("it is made for a machine of another word size");
  if (ident[EI_DATA] != order) image_.refuse("it is made for a machine of another byte order");
  header_ = image_.at<Elf64_Ehdr>(0);
  if (kMachine != EM_NONE && header_.e_machine != kMachine)
    image_.refuse("it is made for " + machine_name(header_.e_machine) + ", this host is " + machine_name(kMachine));
  if (ident[EI_VERSION] != EV_CURRENT || header_.e_version != EV_CURRENT)
    image_.refuse("its format is of an unknown version");
  if (ident[EI_OSABI] != ELFOSABI_NONE && ident[EI_OSABI] != ELFOSABI_GNU)
    image_.refuse("it is made for another operating system");
  if (header_.e_type != ET_DYN) image_.refuse("it is an object file or a program");
  if (header_.e_ehsize != sizeof(Elf64_Ehdr) || header_.e_phentsize != sizeof(Elf64_Phdr) || header_.e_phnum == 0 ||
      header_.e_phnum > 64 || header_.e_phoff % 8 != 0)
    image_.refuse("its header is damaged");
}

void SharedFile::read_segments() {
  image_.need(header_.e_phoff, header_.e_phnum * sizeof(Elf64_Phdr));
  std::uint64_t last = 0;
  int n_dynamic = 0;
  for (unsigned k = 0; k < header_.e_phnum; ++k) {
    const auto s = image_.at<Elf64_Phdr>(header_.e_phoff + k * sizeof(Elf64_Phdr));
    segments_.push_back(s);
    if (s.p_type == PT_NULL || s.p_type == PT_GNU_STACK) continue;
    image_.need(s.p_offset, s.p_filesz);
    if (s.p_memsz > kMostAddress || s.p_vaddr > kMostAddress || s.p_filesz > s.p_memsz)
      image_.refuse("a segment has an impossible size");
    if (s.p_align > 1 && (!std::has_single_bit(s.p_align) || s.p_align > kMostBytes ||
                          (s.p_type == PT_LOAD && s.p_vaddr % s.p_align != s.p_offset % s.p_align)))
      image_.refuse("a segment has an impossible alignment");
    if (s.p_type == PT_LOAD) {
      if (s.p_vaddr < last) image_.refuse("its segments overlap or stand in disorder");
      if (s.p_vaddr % 4096 != s.p_offset % 4096) image_.refuse("a segment cannot be mapped");
      last = s.p_vaddr + s.p_memsz;
    } else if (s.p_type == PT_DYNAMIC) {
      dynamic_ = s;
      ++n_dynamic;
    } else if (s.p_type == PT_TLS) {
      thread_size_ = s.p_memsz;
    }
  }
  if (last == 0) image_.refuse("it has nothing to load");
  if (n_dynamic != 1) image_.refuse("it has no table of what it needs");
}

// Segments that only point into what is loaded, and what may be done with it.
void SharedFile::check_loaded() {
  for (const Elf64_Phdr& s : segments_) {
    if (s.p_type == PT_GNU_STACK) {
      if ((s.p_flags & PF_X) != 0) image_.refuse("it asks for a stack that can be executed");
    } else if (s.p_type == PT_LOAD) {
      if ((s.p_flags & PF_R) == 0 || (s.p_flags & PF_W && s.p_flags & PF_X))
        image_.refuse("a segment cannot be read, or can be written and executed");
    } else if (s.p_type == PT_DYNAMIC || s.p_type == PT_TLS || s.p_type == PT_GNU_RELRO || s.p_type == PT_NOTE ||
               s.p_type == PT_GNU_PROPERTY || s.p_type == PT_GNU_EH_FRAME) {
      const std::uint64_t size = s.p_type == PT_TLS || s.p_type == PT_GNU_RELRO ? s.p_filesz : s.p_memsz;
      if (segment(s.p_vaddr, size, PF_R) == nullptr) image_.refuse("a part that it points to is not loaded");
      if (s.p_type == PT_GNU_RELRO && s.p_memsz - s.p_filesz >= kMostPage)
        image_.refuse("a part that it points to is larger than it can be");
      if (s.p_filesz > 0 && offset_of(s.p_vaddr, s.p_filesz, "a part") != s.p_offset)
        image_.refuse("a part that it points to stands elsewhere");
    }
  }
}

const Elf64_Phdr* SharedFile::segment(std::uint64_t address, std::uint64_t size, unsigned flags) const {
  for (const Elf64_Phdr& s : segments_)
    if (s.p_type == PT_LOAD && (s.p_flags & flags) == flags && address >= s.p_vaddr &&
        address - s.p_vaddr <= s.p_memsz && s.p_memsz - (address - s.p_vaddr) >= size)
      return &s;
  return nullptr;
}

std::uint64_t SharedFile::offset_of(std::uint64_t address, std::uint64_t size, const char* what) const {
  for (const Elf64_Phdr& s : segments_)
    if (s.p_type == PT_LOAD && address >= s.p_vaddr && address - s.p_vaddr <= s.p_filesz &&
        s.p_filesz - (address - s.p_vaddr) >= size)
      return s.p_offset + (address - s.p_vaddr);
  image_.refuse(std::string(what) + " is not in it");
}

std::optional<SharedFile::Place> SharedFile::exported(const std::string& symbol) const {
  for (std::uint64_t k = 1; k < n_symbols_; ++k) {
    const auto entry = image_.at<Elf64_Sym>(symbols_ + k * sizeof(Elf64_Sym));
    if (entry.st_shndx == SHN_UNDEF || ELF64_ST_TYPE(entry.st_info) != STT_OBJECT) continue;
    if (text(entry.st_name) != symbol) continue;
    return Place{offset_of(entry.st_value, entry.st_size, "the data of a symbol"), entry.st_size};
  }
  return {};
}

std::uint64_t SharedFile::checksum(const std::vector<Place>& left_out) const {
  std::vector<char> bytes(image_.data(), image_.data() + image_.size());
  const auto blank = [&](std::uint64_t offset, std::uint64_t n) {
    image_.need(offset, n);
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), n, '\0');
  };
  blank(offsetof(Elf64_Ehdr, e_shoff), sizeof header_.e_shoff);  // what `strip` changes
  blank(offsetof(Elf64_Ehdr, e_shnum), sizeof header_.e_shnum);
  blank(offsetof(Elf64_Ehdr, e_shstrndx), sizeof header_.e_shstrndx);
  for (const Place& p : left_out) blank(p.offset, p.size);
  Checksum sum;
  sum.add(bytes.data(), sizeof(Elf64_Ehdr));
  sum.add(bytes.data() + header_.e_phoff, header_.e_phnum * sizeof(Elf64_Phdr));
  for (const Elf64_Phdr& s : segments_)
    if (s.p_type == PT_LOAD) sum.add(bytes.data() + s.p_offset, s.p_filesz);
  return sum.value();
}

}  // namespace lockstep
