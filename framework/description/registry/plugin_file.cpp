#include "framework/description/registry/plugin_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>

#include <lockstep/error.h>

namespace lockstep {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kMostAddress = std::uint64_t{1} << 40;

#if defined(__x86_64__)
constexpr unsigned kMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr unsigned kMachine = EM_AARCH64;
#elif defined(__riscv)
constexpr unsigned kMachine = EM_RISCV;
#else
constexpr unsigned kMachine = EM_NONE;  // unknown: any machine is accepted
#endif

std::string machine_name(unsigned machine) {
  static const std::map<unsigned, const char*> kNames = {
      {EM_X86_64, "x86-64"}, {EM_386, "32-bit x86"},       {EM_AARCH64, "AArch64"}, {EM_ARM, "32-bit ARM"},
      {EM_RISCV, "RISC-V"},  {EM_PPC64, "64-bit PowerPC"}, {EM_S390, "S/390"}};
  const auto found = kNames.find(machine);
  return found != kNames.end() ? found->second : "machine number " + std::to_string(machine);
}

// Closes the file.
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
  return "of an unknown kind";
}

}  // namespace

// Opened non-blocking: opening a pipe would wait for its writer.
Bytes::Bytes(std::string path) : path_(std::move(path)) {
  const std::string who = "plugin file '" + path_ + "' ";
  const Descriptor file{open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  struct stat about {};
  if (file.number < 0 && errno == ENXIO) throw PluginError(who + "is a socket or a pipe, not a regular file");
  if (file.number < 0 || fstat(file.number, &about) != 0)
    throw PluginError(who + "cannot be opened (" + std::strerror(errno) + "); check the path and that you may read it");
  if (!S_ISREG(about.st_mode)) throw PluginError(who + "is " + kind_of(about.st_mode) + ", not a regular file");
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

void Bytes::need(std::uint64_t offset, std::uint64_t n) const {
  if (offset > bytes_.size() || bytes_.size() - offset < n) refuse("it ends too early");
}

void Bytes::refuse(const std::string& why) const {
  throw PluginError("plugin file '" + path_ + "' is not a shared library that can be loaded here: " + why +
                    "; rebuild it with lockstep_add_plugin");
}

SharedFile::SharedFile(const std::string& path) : bytes_(path) {
  read_header();
  read_segments();
  read_dynamic();
  check_tables();
  count_symbols();
}

void SharedFile::read_header() {
  if (!bytes_.begins_with(ELFMAG)) bytes_.refuse("it does not begin with an ELF header");
  const auto ident = bytes_.at<std::array<unsigned char, EI_NIDENT>>(0);
  const unsigned char order = std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;
  if (ident[EI_CLASS] != ELFCLASS64) bytes_.refuse("it is made for a machine with another word size");
  if (ident[EI_DATA] != order) bytes_.refuse("it is made for a machine with another byte order");
  header_ = bytes_.at<Elf64_Ehdr>(0);
  if (kMachine != EM_NONE && header_.e_machine != kMachine)
    bytes_.refuse("it is made for " + machine_name(header_.e_machine) + ", this host is " + machine_name(kMachine));
  if (ident[EI_VERSION] != EV_CURRENT || header_.e_version != EV_CURRENT)
    bytes_.refuse("its format is of an unknown version");
  if (ident[EI_OSABI] != ELFOSABI_NONE && ident[EI_OSABI] != ELFOSABI_GNU)
    bytes_.refuse("it is made for another operating system");
  if (header_.e_type != ET_DYN) bytes_.refuse("it is an object file or a program");
  if (header_.e_ehsize != sizeof(Elf64_Ehdr) || header_.e_phentsize != sizeof(Elf64_Phdr) || header_.e_phnum == 0 ||
      header_.e_phnum > 64 || header_.e_phoff % 8 != 0)
    bytes_.refuse("its header is damaged");
}

void SharedFile::read_segments() {
  bytes_.need(header_.e_phoff, header_.e_phnum * sizeof(Elf64_Phdr));
  std::uint64_t last = 0;
  int n_dynamic = 0;
  for (unsigned k = 0; k < header_.e_phnum; ++k) {
    const auto s = bytes_.at<Elf64_Phdr>(header_.e_phoff + k * sizeof(Elf64_Phdr));
    if (s.p_type == PT_GNU_STACK && (s.p_flags & PF_X) != 0) bytes_.refuse("it asks for an executable stack");
    if (s.p_type == PT_NULL || s.p_type == PT_GNU_STACK) continue;
    bytes_.need(s.p_offset, s.p_filesz);
    if (s.p_memsz > kMostAddress || s.p_vaddr > kMostAddress || s.p_filesz > s.p_memsz)
      bytes_.refuse("a segment has an impossible size");
    if (s.p_align > 1 && (!std::has_single_bit(s.p_align) || s.p_align > kMostBytes))
      bytes_.refuse("a segment has an impossible alignment");
    if (s.p_type == PT_LOAD) {
      if ((s.p_flags & PF_R) == 0 || ((s.p_flags & PF_W) != 0 && (s.p_flags & PF_X) != 0))
        bytes_.refuse("a segment cannot be read, or can be written and executed");
      if (s.p_vaddr < last) bytes_.refuse("its segments overlap or are not in order");
      if (s.p_vaddr % 4096 != s.p_offset % 4096) bytes_.refuse("a segment cannot be mapped");
      last = s.p_vaddr + s.p_memsz;
      loaded_.push_back(s);
    } else if (s.p_type == PT_DYNAMIC) {
      dynamic_ = s;
      ++n_dynamic;
    }
  }
  if (loaded_.empty()) bytes_.refuse("it has nothing to load");
  if (n_dynamic != 1) bytes_.refuse("it has no dynamic table, or several");
}

std::uint64_t SharedFile::offset_of(std::uint64_t address, std::uint64_t size, const char* what) const {
  for (const Elf64_Phdr& s : loaded_)
    if (address >= s.p_vaddr && address - s.p_vaddr <= s.p_filesz && s.p_filesz - (address - s.p_vaddr) >= size)
      return s.p_offset + (address - s.p_vaddr);
  bytes_.refuse(std::string(what) + " is outside of the file");
}

void SharedFile::read_dynamic() {
  const std::uint64_t at = offset_of(dynamic_.p_vaddr, dynamic_.p_filesz, "its dynamic table");
  for (std::uint64_t k = 0; (k + 1) * sizeof(Elf64_Dyn) <= dynamic_.p_filesz; ++k) {
    const auto entry = bytes_.at<Elf64_Dyn>(at + k * sizeof(Elf64_Dyn));
    if (entry.d_tag == DT_NULL) return;
    if (entry.d_tag != DT_NEEDED && !tags_.emplace(entry.d_tag, entry.d_un.d_val).second)
      bytes_.refuse("its dynamic table has a duplicate entry");
  }
  bytes_.refuse("its dynamic table has no end");
}

// The system's loader uses these addresses without checking them.
void SharedFile::check_tables() const {
  struct Table {
    std::int64_t at, size;
    const char* what;
  };
  constexpr Table kSized[] = {{DT_STRTAB, DT_STRSZ, "its table of strings"},
                              {DT_RELA, DT_RELASZ, "its list of relocations"},
                              {DT_JMPREL, DT_PLTRELSZ, "its list of relocations of calls"},
                              {DT_INIT_ARRAY, DT_INIT_ARRAYSZ, "its list of initialisers"},
                              {DT_FINI_ARRAY, DT_FINI_ARRAYSZ, "its list of finalisers"}};
  for (const Table& t : kSized) {
    if (tag(t.at).has_value() != tag(t.size).has_value()) bytes_.refuse("its dynamic table is damaged");
    if (tag(t.at)) offset_of(*tag(t.at), *tag(t.size), t.what);
  }
  for (const std::int64_t which : {DT_VERSYM, DT_VERNEED, DT_VERDEF, DT_INIT, DT_FINI, DT_PLTGOT})
    if (tag(which)) offset_of(*tag(which), 1, "what its dynamic table points to");
  if (tag(DT_RELA) && value(DT_RELAENT, "the size of a relocation") != sizeof(Elf64_Rela))
    bytes_.refuse("its relocations have another size");
  for (const std::int64_t which :
       {DT_FILTER, DT_AUXILIARY, DT_CONFIG, DT_AUDIT, DT_DEPAUDIT, DT_PREINIT_ARRAY, DT_REL, DT_TEXTREL})
    if (tag(which))
      bytes_.refuse("its dynamic table has an entry that no plugin needs (tag " + std::to_string(which) + ")");
  if (tag(DT_VERSYM) && !tag(DT_VERNEED) && !tag(DT_VERDEF))
    bytes_.refuse("its symbols have versions that no table names");
}

std::optional<std::uint64_t> SharedFile::tag(std::int64_t which) const {
  const auto found = tags_.find(which);
  if (found == tags_.end()) return {};
  return found->second;
}

std::uint64_t SharedFile::value(std::int64_t which, const char* what) const {
  const auto found = tag(which);
  if (!found) bytes_.refuse(std::string("its dynamic table does not name ") + what);
  return *found;
}

// The number of symbols is only in the hash tables: the number of chains, or the end of the last chain, which is an odd
// hash.
void SharedFile::count_symbols() {
  const auto number = [&](std::uint64_t address) {
    return std::uint64_t{bytes_.at<std::uint32_t>(offset_of(address, 4, "its hash table"))};
  };
  const auto hash = tag(DT_HASH), gnu_hash = tag(DT_GNU_HASH);
  if (!hash && !gnu_hash) bytes_.refuse("its symbols have no hash table");
  if (hash) n_symbols_ = number(*hash + 4);
  if (gnu_hash) {
    const std::uint64_t n_buckets = number(*gnu_hash), first = number(*gnu_hash + 4);
    const std::uint64_t buckets = *gnu_hash + 16 + 8 * number(*gnu_hash + 8), chains = buckets + 4 * n_buckets;
    if (n_buckets == 0 || first == 0) bytes_.refuse("its hash table is damaged");
    std::uint64_t last = 0;
    for (std::uint64_t b = 0; b < n_buckets; ++b) last = std::max(last, number(buckets + 4 * b));
    if (last != 0 && last < first) bytes_.refuse("its hash table is damaged");
    if (last != 0)
      while ((number(chains + 4 * (last - first)) & 1) == 0) ++last;
    n_symbols_ = std::max(n_symbols_, last == 0 ? first : last + 1);
  }
  if (value(DT_SYMENT, "the size of a symbol") != sizeof(Elf64_Sym)) bytes_.refuse("its symbols have another size");
  symbols_ = offset_of(value(DT_SYMTAB, "its symbols"), n_symbols_ * sizeof(Elf64_Sym), "its table of symbols");
  strings_size_ = value(DT_STRSZ, "the size of its strings");
  strings_ = offset_of(value(DT_STRTAB, "its strings"), strings_size_, "its table of strings");
  if (strings_size_ == 0 || bytes_.at<char>(strings_ + strings_size_ - 1) != '\0')
    bytes_.refuse("its strings are not terminated");
}

std::optional<SharedFile::Place> SharedFile::exported(const std::string& symbol) const {
  for (std::uint64_t k = 1; k < n_symbols_; ++k) {
    const auto entry = bytes_.at<Elf64_Sym>(symbols_ + k * sizeof(Elf64_Sym));
    if (entry.st_name >= strings_size_) bytes_.refuse("a name lies outside of it");
    if (entry.st_shndx == SHN_UNDEF || ELF64_ST_TYPE(entry.st_info) != STT_OBJECT) continue;
    if (symbol == bytes_.data() + strings_ + entry.st_name)  // the last string is terminated, so each is
      return Place{offset_of(entry.st_value, entry.st_size, "the data of a symbol"), entry.st_size};
  }
  return {};
}

}  // namespace lockstep
