// What the system's loader writes into a shared library and what it calls: relocations, functions at opening and
// closing.
#include "framework/description/registry/elf.h"

namespace lockstep {
namespace {

enum class Kind { nothing, symbol, relative, function, thread, unknown };

// Only machines that are known here are looked at in detail.
#if defined(__x86_64__)
constexpr bool kKnown = true;
Kind kind_of(std::uint64_t type) {
  switch (type) {
    case R_X86_64_NONE:
      return Kind::nothing;
    case R_X86_64_64:
    case R_X86_64_GLOB_DAT:
    case R_X86_64_JUMP_SLOT:
      return Kind::symbol;
    case R_X86_64_RELATIVE:
      return Kind::relative;
    case R_X86_64_IRELATIVE:
      return Kind::function;
    case R_X86_64_DTPMOD64:
    case R_X86_64_DTPOFF64:
    case R_X86_64_TPOFF64:
    case R_X86_64_TLSDESC:
      return Kind::thread;
    default:
      return Kind::unknown;
  }
}
#elif defined(__aarch64__)
constexpr bool kKnown = true;
Kind kind_of(std::uint64_t type) {
  switch (type) {
    case R_AARCH64_NONE:
      return Kind::nothing;
    case R_AARCH64_ABS64:
    case R_AARCH64_GLOB_DAT:
    case R_AARCH64_JUMP_SLOT:
      return Kind::symbol;
    case R_AARCH64_RELATIVE:
      return Kind::relative;
    case R_AARCH64_IRELATIVE:
      return Kind::function;
    case R_AARCH64_TLS_DTPMOD:
    case R_AARCH64_TLS_DTPREL:
    case R_AARCH64_TLS_TPREL:
    case R_AARCH64_TLSDESC:
      return Kind::thread;
    default:
      return Kind::unknown;
  }
}
#else
constexpr bool kKnown = false;
Kind kind_of(std::uint64_t) { return Kind::nothing; }
#endif

}  // namespace

void SharedFile::check_code() {
  if (tag(DT_JMPREL) && value(DT_PLTREL, "the kind of its relocations") != DT_RELA)
    image_.refuse("its relocations are of another kind");
  if (tag(DT_RELA) && value(DT_RELAENT, "the size of a relocation") != sizeof(Elf64_Rela))
    image_.refuse("its relocations have another size");
  check_relocations(DT_RELA, DT_RELASZ, "its relocations");
  check_relocations(DT_JMPREL, DT_PLTRELSZ, "its relocations of calls");
  check_relative();
  check_function(DT_INIT, "the function that opens it");
  check_function(DT_FINI, "the function that closes it");
  check_functions(DT_INIT_ARRAY, DT_INIT_ARRAYSZ, "its list of functions that open it");
  check_functions(DT_FINI_ARRAY, DT_FINI_ARRAYSZ, "its list of functions that close it");
  if (const auto plt = tag(DT_PLTGOT); plt && segment(*plt, 24, PF_W) == nullptr)
    image_.refuse("its table of calls is not in it");
}

void SharedFile::check_relocations(std::int64_t table, std::int64_t size_tag, const char* what) {
  const auto address = tag(table);
  if (!address) return;
  const std::uint64_t size = value(size_tag, "the size of a table");
  const std::uint64_t at = offset_of(*address, size, what);
  if (size % sizeof(Elf64_Rela) != 0) image_.refuse(std::string(what) + " are cut off");
  const std::uint64_t n = size / sizeof(Elf64_Rela), n_relative = table == DT_RELA ? tag(DT_RELACOUNT).value_or(0) : 0;
  if (n_relative > n) image_.refuse(std::string(what) + " are damaged");
  for (std::uint64_t k = 0; k < n; ++k) {
    const auto r = image_.at<Elf64_Rela>(at + k * sizeof(Elf64_Rela));
    const auto to = static_cast<std::uint64_t>(r.r_addend);
    if (kKnown) {
      const Kind kind = kind_of(ELF64_R_TYPE(r.r_info));
      if (kind == Kind::unknown || (k < n_relative && kind != Kind::relative))
        image_.refuse(std::string(what) + " are damaged");
      if (kind == Kind::nothing) continue;
      if (kind == Kind::relative) {
        if (segment(to, 0, 0) == nullptr) image_.refuse(std::string(what) + " point outside of it");
        relative_.emplace(r.r_offset, to);
      }
      if (kind == Kind::function && segment(to, 1, PF_X) == nullptr)
        image_.refuse(std::string(what) + " call what is no code");
    }
    if (segment(r.r_offset, 8, PF_W) == nullptr) image_.refuse(std::string(what) + " write outside of it");
    if (ELF64_R_SYM(r.r_info) >= n_symbols_) image_.refuse(std::string(what) + " name a symbol that is not there");
  }
}

// The packed form: an even number is a place, an odd one says by its bits which of the 63 places after it follow.
void SharedFile::check_relative() const {
  const auto address = tag(DT_RELR);
  if (!address) return;
  const std::uint64_t size = value(DT_RELRSZ, "the size of a table");
  const std::uint64_t at = offset_of(*address, size, "its packed relocations");
  if (size % 8 != 0 || value(DT_RELRENT, "the size of a relocation") != 8)
    image_.refuse("its packed relocations are damaged");
  const auto need = [&](std::uint64_t place) {
    if (place % 8 != 0 || segment(place, 8, PF_W) == nullptr)
      image_.refuse("its packed relocations write outside of it");
  };
  std::uint64_t next = 0;
  for (std::uint64_t k = 0; k < size / 8; ++k) {
    const auto word = image_.at<std::uint64_t>(at + 8 * k);
    if ((word & 1) == 0) {
      need(word);
      next = word + 8;
      continue;
    }
    if (k == 0) image_.refuse("its packed relocations are damaged");
    for (unsigned bit = 0; bit < 63; ++bit)
      if ((word >> (bit + 1) & 1) != 0) need(next + 8 * bit);
    next += 63 * 8;
  }
}

void SharedFile::check_function(std::int64_t which, const char* what) const {
  if (const auto address = tag(which); address && segment(*address, 1, PF_X) == nullptr)
    image_.refuse(std::string(what) + " is not in its code");
}

void SharedFile::check_functions(std::int64_t table, std::int64_t size_tag, const char* what) const {
  const auto address = tag(table);
  if (!address) return;
  const std::uint64_t size = value(size_tag, "the size of a table");
  const std::uint64_t at = offset_of(*address, size, what);
  if (*address % 8 != 0 || size % 8 != 0) image_.refuse(std::string(what) + " is damaged");
  for (std::uint64_t k = 0; k < size; k += 8) {
    const auto relative = relative_.find(*address + k);
    const std::uint64_t function = relative != relative_.end() ? relative->second : image_.at<std::uint64_t>(at + k);
    if (kKnown && segment(function, 1, PF_X) == nullptr) image_.refuse(std::string(what) + " names what is no code");
  }
}

}  // namespace lockstep
