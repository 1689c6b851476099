// The dynamic table of a shared library, its strings, symbols, hash tables and versions.
#include <algorithm>
#include <bit>
#include <set>

#include "framework/description/registry/elf.h"

namespace lockstep {
namespace {

// What the system's loader knows; it passes over all others, so that a damaged entry would go unseen.
bool is_known(std::int64_t tag) {
  return (tag >= 0 && tag < DT_NUM) || (tag >= DT_GNU_PRELINKED && tag <= DT_SYMINENT) ||
         (tag >= DT_GNU_HASH && tag <= DT_SYMINFO) || tag == DT_VERSYM || tag == DT_RELACOUNT || tag == DT_FLAGS_1 ||
         (tag >= DT_VERDEF && tag <= DT_VERNEEDNUM) || (tag >= DT_LOPROC && tag < DT_LOPROC + 16);
}

}  // namespace

void SharedFile::read_dynamic() {
  const std::uint64_t at = offset_of(dynamic_.p_vaddr, dynamic_.p_filesz, "its dynamic table");
  if (dynamic_.p_vaddr % 8 != 0 || segment(dynamic_.p_vaddr, dynamic_.p_filesz, PF_W) == nullptr)
    image_.refuse("its dynamic table stands where it cannot be used");
  for (std::uint64_t k = 0; (k + 1) * sizeof(Elf64_Dyn) <= dynamic_.p_filesz; ++k) {
    const auto entry = image_.at<Elf64_Dyn>(at + k * sizeof(Elf64_Dyn));
    if (entry.d_tag == DT_NULL) return check_pairs();
    if (!is_known(entry.d_tag)) image_.refuse("its dynamic table has an unknown entry");
    if (entry.d_tag == DT_NEEDED)
      needed_.push_back(entry.d_un.d_val);
    else if (!tags_.emplace(entry.d_tag, entry.d_un.d_val).second)
      image_.refuse("its dynamic table says one thing twice");
  }
  image_.refuse("its dynamic table has no end");
}

// A table and its size come together.
void SharedFile::check_pairs() const {
  constexpr std::int64_t kPairs[][2] = {{DT_RELA, DT_RELASZ},
                                        {DT_RELA, DT_RELAENT},
                                        {DT_JMPREL, DT_PLTRELSZ},
                                        {DT_JMPREL, DT_PLTREL},
                                        {DT_INIT_ARRAY, DT_INIT_ARRAYSZ},
                                        {DT_FINI_ARRAY, DT_FINI_ARRAYSZ},
                                        {DT_STRTAB, DT_STRSZ},
                                        {DT_SYMTAB, DT_SYMENT},
                                        {DT_RELR, DT_RELRSZ},
                                        {DT_VERNEED, DT_VERNEEDNUM},
                                        {DT_VERDEF, DT_VERDEFNUM}};
  for (const auto& [table, size] : kPairs)
    if (tag(table).has_value() != tag(size).has_value()) image_.refuse("its dynamic table is damaged");
  if (tag(DT_RELACOUNT) && !tag(DT_RELA)) image_.refuse("its dynamic table is damaged");
}

std::optional<std::uint64_t> SharedFile::tag(std::int64_t which) const {
  const auto found = tags_.find(which);
  if (found == tags_.end()) return {};
  return found->second;
}

std::uint64_t SharedFile::value(std::int64_t which, const char* what) const {
  const auto found = tag(which);
  if (!found) image_.refuse(std::string("its dynamic table does not name ") + what);
  return *found;
}

std::string SharedFile::text(std::uint64_t name) const {
  if (name >= strings_size_) image_.refuse("a name lies outside of it");
  return image_.data() + strings_ + name;  // the last of all strings ends, so each does
}

void SharedFile::check_strings() {
  strings_size_ = value(DT_STRSZ, "the size of its strings");
  strings_ = offset_of(value(DT_STRTAB, "its strings"), strings_size_, "its table of strings");
  if (strings_size_ == 0 || image_.at<char>(strings_ + strings_size_ - 1) != '\0')
    image_.refuse("its strings have no end");
  for (const std::uint64_t name : needed_)
    if (text(name).empty()) image_.refuse("a library that it needs has no name");
  for (const std::int64_t which : {std::int64_t{DT_SONAME}, std::int64_t{DT_RPATH}, std::int64_t{DT_RUNPATH}})
    if (const auto name = tag(which)) text(*name);
  for (const std::int64_t which :
       {std::int64_t{DT_FILTER}, std::int64_t{DT_AUXILIARY}, std::int64_t{DT_CONFIG}, std::int64_t{DT_AUDIT},
        std::int64_t{DT_DEPAUDIT}, std::int64_t{DT_PREINIT_ARRAY}, std::int64_t{DT_REL}, std::int64_t{DT_TEXTREL}})
    if (tag(which))
      image_.refuse("its dynamic table asks for what no plugin needs (tag " + std::to_string(which) + ")");
  if ((tag(DT_FLAGS).value_or(0) & DF_TEXTREL) != 0) image_.refuse("its code is not position independent");
}

// How many symbols there are stands in the hash tables only.
void SharedFile::count_symbols() {
  if (value(DT_SYMENT, "the size of a symbol") != sizeof(Elf64_Sym)) image_.refuse("its symbols have another size");
  const auto hash = tag(DT_HASH), gnu_hash = tag(DT_GNU_HASH);
  if (!hash && !gnu_hash) image_.refuse("its symbols have no hash table");
  if (gnu_hash) n_symbols_ = count_by_gnu_hash(*gnu_hash);
  if (hash) n_symbols_ = std::max(n_symbols_, count_by_hash(*hash));
  symbols_ = offset_of(value(DT_SYMTAB, "its symbols"), n_symbols_ * sizeof(Elf64_Sym), "its table of symbols");
}

std::uint64_t SharedFile::count_by_hash(std::uint64_t address) const {
  const std::uint64_t at = offset_of(address, 8, "its hash table");
  const std::uint64_t n_buckets = image_.at<std::uint32_t>(at), n = image_.at<std::uint32_t>(at + 4);
  offset_of(address, 8 + 4 * (n_buckets + n), "its hash table");
  if (n_buckets == 0) image_.refuse("its hash table is damaged");
  for (std::uint64_t k = 0; k < n_buckets + n; ++k)
    if (image_.at<std::uint32_t>(at + 8 + 4 * k) >= n) image_.refuse("its hash table is damaged");
  for (std::uint64_t b = 0; b < n_buckets; ++b) {  // a chain that comes back to itself has no end
    std::uint64_t steps = 0;
    for (std::uint64_t k = image_.at<std::uint32_t>(at + 8 + 4 * b); k != 0;
         k = image_.at<std::uint32_t>(at + 8 + 4 * (n_buckets + k)))
      if (++steps > n) image_.refuse("its hash table is damaged");
  }
  return n;
}

std::uint64_t SharedFile::count_by_gnu_hash(std::uint64_t address) const {
  const std::uint64_t at = offset_of(address, 16, "its hash table");
  const std::uint64_t n_buckets = image_.at<std::uint32_t>(at), first = image_.at<std::uint32_t>(at + 4),
                      n_filter = image_.at<std::uint32_t>(at + 8), shift = image_.at<std::uint32_t>(at + 12);
  if (n_buckets == 0 || first == 0 || !std::has_single_bit(n_filter) || shift >= 64)
    image_.refuse("its hash table is damaged");
  const std::uint64_t buckets = 16 + 8 * n_filter, chains = buckets + 4 * n_buckets;
  offset_of(address, chains, "its hash table");
  std::uint64_t last = 0;
  for (std::uint64_t b = 0; b < n_buckets; ++b) {
    const std::uint64_t k = image_.at<std::uint32_t>(at + buckets + 4 * b);
    if (k != 0 && k < first) image_.refuse("its hash table is damaged");
    last = std::max(last, k);
  }
  if (last == 0) return first;
  for (;; ++last) {  // the last chain ends with an odd number
    offset_of(address, chains + 4 * (last - first + 1), "its hash table");
    if ((image_.at<std::uint32_t>(at + chains + 4 * (last - first)) & 1) != 0) return last + 1;
  }
}

void SharedFile::check_symbols() const {
  for (std::uint64_t k = 1; k < n_symbols_; ++k) {
    const auto s = image_.at<Elf64_Sym>(symbols_ + k * sizeof(Elf64_Sym));
    text(s.st_name);
    if (s.st_shndx == SHN_UNDEF && s.st_value != 0) image_.refuse("a symbol of another library has a place in it");
    if (s.st_shndx == SHN_UNDEF || s.st_shndx == SHN_ABS) continue;
    const unsigned type = ELF64_ST_TYPE(s.st_info);
    if (type == STT_TLS ? s.st_value > thread_size_
                        : segment(s.st_value, 0, type == STT_GNU_IFUNC ? PF_X : 0) == nullptr)
      image_.refuse("a symbol lies outside of it");
  }
}

// Versions of other libraries' symbols. Each chain goes on by a distance to the next, 0 at its end; as distances are
// above zero, it leaves the file before it could run in a circle. The highest number that is given out.
std::uint64_t SharedFile::check_needed_versions() const {
  const auto at = tag(DT_VERNEED);
  if (!at) return 0;
  std::set<std::string> libraries;
  for (const std::uint64_t name : needed_) libraries.insert(text(name));
  std::uint64_t most = 0, address = *at, n = 0;
  for (;;) {
    const auto need = image_.at<Elf64_Verneed>(offset_of(address, sizeof(Elf64_Verneed), "its table of versions"));
    if (need.vn_version != VER_NEED_CURRENT || libraries.count(text(need.vn_file)) == 0)
      image_.refuse("its table of versions is damaged");
    std::uint64_t aux = address + need.vn_aux;
    for (unsigned k = 0;; ++k) {
      const auto v = image_.at<Elf64_Vernaux>(offset_of(aux, sizeof(Elf64_Vernaux), "its table of versions"));
      text(v.vna_name);
      most = std::max<std::uint64_t>(most, v.vna_other & 0x7fff);
      if ((v.vna_next == 0) != (k + 1 == need.vn_cnt)) image_.refuse("its table of versions is damaged");
      if (v.vna_next == 0) break;
      aux += v.vna_next;
    }
    ++n;
    if (need.vn_next == 0) break;
    address += need.vn_next;
  }
  if (n != value(DT_VERNEEDNUM, "the number of its versions")) image_.refuse("its table of versions is damaged");
  return most;
}

std::uint64_t SharedFile::check_own_versions() const {
  const auto at = tag(DT_VERDEF);
  if (!at) return 0;
  std::uint64_t most = 0, address = *at, n = 0;
  for (;;) {
    const auto own = image_.at<Elf64_Verdef>(offset_of(address, sizeof(Elf64_Verdef), "its table of versions"));
    if (own.vd_version != VER_DEF_CURRENT || own.vd_cnt == 0) image_.refuse("its table of versions is damaged");
    most = std::max<std::uint64_t>(most, own.vd_ndx & 0x7fff);
    std::uint64_t aux = address + own.vd_aux;
    for (unsigned k = 0; k < own.vd_cnt; ++k) {
      const auto v = image_.at<Elf64_Verdaux>(offset_of(aux, sizeof(Elf64_Verdaux), "its table of versions"));
      text(v.vda_name);
      aux += v.vda_next;
    }
    ++n;
    if (own.vd_next == 0) break;
    address += own.vd_next;
  }
  if (n != value(DT_VERDEFNUM, "the number of its versions")) image_.refuse("its table of versions is damaged");
  return most;
}

void SharedFile::check_versions() const {
  const std::uint64_t most = std::max<std::uint64_t>({check_needed_versions(), check_own_versions(), 1});
  const auto at = tag(DT_VERSYM);
  if (!at) return;
  if (!tag(DT_VERNEED) && !tag(DT_VERDEF)) image_.refuse("its symbols have versions that no table names");
  const std::uint64_t table = offset_of(*at, 2 * n_symbols_, "its table of versions");
  for (std::uint64_t k = 0; k < n_symbols_; ++k)
    if ((image_.at<std::uint16_t>(table + 2 * k) & 0x7fff) > most) image_.refuse("its table of versions is damaged");
}

}  // namespace lockstep
