#include "framework/description/registry/plugin_file.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bit>
#include <map>
#include <set>

#include "framework/description/registry/elf_image.h"

namespace lockstep {
namespace {

using Number = std::uint64_t;
using MaybeNumber = std::optional<std::uint64_t>;

constexpr std::string_view kHash = "its hash table", kVersions = "its table of versions";

// What linkers write into a plugin. The system's loader obeys some other tags, and passes over those that it does not
// know, so that a damaged one would go unseen.
bool is_usual(std::int64_t tag) {
  constexpr std::int64_t kRefused[] = {DT_REL, DT_TEXTREL, DT_PREINIT_ARRAY, DT_CONFIG, DT_AUDIT, DT_DEPAUDIT};
  if (std::ranges::count(kRefused, tag) > 0) return false;
  return (tag >= 0 && tag < DT_NUM) || (tag >= DT_GNU_PRELINKED && tag <= DT_SYMINENT) ||
         (tag >= DT_GNU_HASH && tag <= DT_SYMINFO) || tag == DT_VERSYM || tag == DT_RELACOUNT || tag == DT_FLAGS_1 ||
         (tag >= DT_VERDEF && tag <= DT_VERNEEDNUM) || (tag >= DT_LOPROC && tag < DT_LOPROC + 16);
}

// Types of relocations that linkers write into a plugin, by what the loader writes: an address in the library, what a
// function in it returns, a symbol's address, a number or a pair of numbers for variables of a thread.
#if defined(__x86_64__)
constexpr Number kRelative = R_X86_64_RELATIVE, kCalled = R_X86_64_IRELATIVE, kThreadPair = R_X86_64_TLSDESC;
constexpr Number kSymbol[] = {R_X86_64_64, R_X86_64_GLOB_DAT, R_X86_64_JUMP_SLOT};
constexpr Number kThread[] = {R_X86_64_DTPMOD64, R_X86_64_DTPOFF64, R_X86_64_TPOFF64};
constexpr bool kKnown = true;
#elif defined(__aarch64__)
constexpr Number kRelative = R_AARCH64_RELATIVE, kCalled = R_AARCH64_IRELATIVE, kThreadPair = R_AARCH64_TLSDESC;
constexpr Number kSymbol[] = {R_AARCH64_ABS64, R_AARCH64_GLOB_DAT, R_AARCH64_JUMP_SLOT};
constexpr Number kThread[] = {R_AARCH64_TLS_DTPMOD, R_AARCH64_TLS_DTPREL, R_AARCH64_TLS_TPREL};
constexpr bool kKnown = true;
#else  // any type is taken
constexpr Number kNone = ~Number{0}, kRelative = kNone, kCalled = kNone, kThreadPair = kNone;
constexpr Number kSymbol[] = {kNone}, kThread[] = {kNone};
constexpr bool kKnown = false;
#endif

class PluginFile {
 public:
  explicit PluginFile(const std::string& path) : image_(path) {
    read_dynamic();
    check_tags();
    read_strings();
    read_symbols();
    check_versions();
    check_relocations("its relocations", DT_RELA, DT_RELASZ, tag(DT_RELACOUNT).value_or(0));
    check_relocations("its relocations of calls", DT_JMPREL, DT_PLTRELSZ, 0);
    check_packed_relocations();
    check_calls();
  }

  PluginStamp stamp() const { return image_.stamp(); }

  std::optional<std::string> exported(std::string_view symbol) const {
    for (const Elf64_Sym& s : symbols_.subspan(1)) {
      if (s.st_shndx == SHN_UNDEF || ELF64_ST_TYPE(s.st_info) != STT_OBJECT || symbol != text(s.st_name)) continue;
      const auto data = image_.at<char>("the data of a symbol", s.st_value, s.st_size);
      return std::string(data.begin(), data.end());
    }
    return {};
  }

 private:
  // The loader adds the library's place to the addresses in this table, so it must be writable.
  void read_dynamic() {
    const Elf64_Phdr& s = *image_.segment(PT_DYNAMIC);
    image_.need_mapped("its dynamic table", s.p_vaddr, s.p_filesz, PF_W);
    for (const Elf64_Dyn& e : image_.at<Elf64_Dyn>("its dynamic table", s.p_vaddr, s.p_filesz / sizeof(Elf64_Dyn))) {
      if (e.d_tag == DT_NULL) return;
      if (!is_usual(e.d_tag))
        image_.refuse(fmt::format("its dynamic table asks for what no plugin needs (tag {:#x})", e.d_tag));
      if (e.d_tag == DT_NEEDED)
        needed_.push_back(e.d_un.d_val);
      else if (!tags_.emplace(e.d_tag, e.d_un.d_val).second)
        image_.refuse(fmt::format("its dynamic table has tag {:#x} twice; must be once", e.d_tag));
    }
    image_.refuse(fmt::format("its dynamic table has no end: {} bytes; must end with tag 0", s.p_filesz));
  }

  // A table and what is said of it come together.
  void check_tags() const {
    constexpr std::int64_t kPairs[][2] = {{DT_RELA, DT_RELASZ},        {DT_RELA, DT_RELAENT},
                                          {DT_JMPREL, DT_PLTRELSZ},    {DT_JMPREL, DT_PLTREL},
                                          {kPacked, kPackedSize},        {kPacked, kPackedEntry},
                                          {DT_STRTAB, DT_STRSZ},       {DT_SYMTAB, DT_SYMENT},
                                          {DT_VERDEF, DT_VERDEFNUM},   {DT_INIT_ARRAY, DT_INIT_ARRAYSZ},
                                          {DT_VERNEED, DT_VERNEEDNUM}, {DT_FINI_ARRAY, DT_FINI_ARRAYSZ}};
    for (const auto& [table, its] : kPairs)
      if (tag(table).has_value() != tag(its).has_value())
        image_.refuse(fmt::format("its dynamic table has one of tags {:#x} and {:#x}; must be both", table, its));
    constexpr std::int64_t kValues[][2] = {{DT_SYMENT, sizeof(Elf64_Sym)},
                                           {DT_RELAENT, sizeof(Elf64_Rela)},
                                           {kPackedEntry, sizeof(PackedRelocation)},
                                           {DT_PLTREL, DT_RELA}};
    for (const auto& [which, must] : kValues)
      if (tag(which) && *tag(which) != static_cast<Number>(must))
        image_.refuse(fmt::format("tag {:#x} of its dynamic table is {}; must be {}", which, *tag(which), must));
    if ((tag(DT_FLAGS).value_or(0) & DF_TEXTREL) != 0) image_.refuse("its code is not position independent");
  }

  void read_strings() {
    strings_ = table<char>("its table of strings", DT_STRTAB, DT_STRSZ);
    if (strings_.empty() || strings_.back() != '\0')
      image_.refuse(fmt::format("its strings have no end: the last of {} bytes must be 0", strings_.size()));
    for (const Number name : needed_)
      if (*text(name) == '\0') image_.refuse("a library that it needs has no name");
    for (const std::int64_t which : {DT_SONAME, DT_RPATH, DT_RUNPATH})
      if (tag(which)) text(*tag(which));
  }

  // How many symbols there are is in the hash tables only.
  void read_symbols() {
    const auto hash = tag(DT_HASH), gnu_hash = tag(DT_GNU_HASH);
    if (!hash && !gnu_hash) image_.refuse("its symbols have no hash table");
    const Number n = std::max(hash ? count_by_hash(*hash) : 0, gnu_hash ? count_by_gnu_hash(*gnu_hash) : 0);
    symbols_ = image_.at<Elf64_Sym>("its table of symbols", value(DT_SYMTAB), n);
    const Elf64_Sym& none = symbols_.front();  // the symbol of relocations without one
    image_.need_equal("a part of the empty symbol", none.st_name | none.st_info | none.st_shndx | none.st_value, 0);
    const Elf64_Phdr* thread = image_.segment(PT_TLS);
    const Number thread_size = thread != nullptr ? thread->p_memsz : 0;
    for (const Elf64_Sym& s : symbols_.subspan(1)) {
      const unsigned type = ELF64_ST_TYPE(s.st_info);
      text(s.st_name);
      if (s.st_shndx == SHN_UNDEF) {
        image_.need_equal("the address of a symbol of another library", s.st_value, 0);
        image_.need_at_least("the binding of a symbol of another library", ELF64_ST_BIND(s.st_info), STB_GLOBAL);
      } else if (type == STT_TLS) {
        image_.need_at_most("the place of a thread's variable", s.st_value, thread_size);
      } else if (s.st_shndx != SHN_ABS || type == STT_GNU_IFUNC) {
        image_.need_mapped("a symbol", s.st_value, 0, type == STT_GNU_IFUNC ? PF_X : 0);
      }
    }
  }

  // Numbers of buckets and of symbols, then for each bucket and each symbol the next symbol of its chain, 0 at the end.
  Number count_by_hash(Number address) const {
    const auto head = image_.at<std::uint32_t>(kHash, address, 2);
    const Number n_buckets = head[0], n = head[1];
    image_.need_at_least("the number of symbols in its hash table", n, 1);
    image_.need_at_least("the number of buckets of its hash table", n_buckets, 1);
    const auto next = image_.at<std::uint32_t>(kHash, address + 8, n_buckets + n);
    for (const Number k : next) image_.need_at_most("a symbol in its hash table", k, n - 1);
    std::vector<bool> seen(n);
    for (Number k : next.first(n_buckets))
      for (; k != 0; k = next[n_buckets + k]) {
        if (seen[k]) image_.refuse(fmt::format("symbol {} is twice in its hash table; must be once", k));
        seen[k] = true;
      }
    return n;
  }

  // Here symbols before the first are in no bucket, each chain is a run of symbols, and its last has an odd number.
  Number count_by_gnu_hash(Number address) const {
    const auto head = image_.at<std::uint32_t>(kHash, address, 4);
    const Number n_buckets = head[0], first = head[1], n_filter = head[2], shift = head[3];
    image_.need_at_least("the number of buckets of its hash table", n_buckets, 1);
    image_.need_at_least("the first symbol in its hash table", first, 1);
    image_.need_at_most("the shift in its hash table", shift, 31);
    if (!std::has_single_bit(n_filter))
      image_.refuse(fmt::format("the filter of its hash table has {} words; must be a power of two", n_filter));
    image_.at<Number>(kHash, address + 16, n_filter);
    const auto buckets = image_.at<std::uint32_t>(kHash, address + 16 + 8 * n_filter, n_buckets);
    for (const Number k : buckets) image_.need_at_least("a symbol in its hash table", k == 0 ? first : k, first);
    Number last = std::ranges::max(buckets);
    if (last == 0) return first;
    const Number chains = address + 16 + 8 * n_filter + 4 * n_buckets;
    while ((image_.at<std::uint32_t>(kHash, chains + 4 * (last - first), 1).front() & 1) == 0) ++last;
    return last + 1;
  }

  // The loader makes an array of as many versions as the tables number, and looks each symbol's up there.
  void check_versions() const {
    const bool named = tag(DT_VERNEED) || tag(DT_VERDEF);
    if (tag(DT_VERSYM) && !named) image_.refuse("its symbols have versions that no table names");
    if (!named) return;
    const Number most = std::max<Number>({check_needed_versions(), check_own_versions(), 1});
    for (const Number version : image_.at<Elf64_Half>(kVersions, value(DT_VERSYM), symbols_.size()))
      image_.need_at_most("the version of a symbol", version & 0x7fff, most);
  }

  // The highest number that is given out.
  Number check_needed_versions() const {
    std::set<std::string_view> libraries;
    for (const Number name : needed_) libraries.insert(text(name));
    Number most = 0;
    for_chain(tag(DT_VERNEED), tag(DT_VERNEEDNUM), &Elf64_Verneed::vn_next, [&](Number at, const Elf64_Verneed& need) {
      image_.need_equal("the format of its table of versions", need.vn_version, VER_NEED_CURRENT);
      if (!libraries.contains(text(need.vn_file)))
        image_.refuse(fmt::format("a library with versions is '{}'; must be one that it needs", text(need.vn_file)));
      for_chain(at + need.vn_aux, need.vn_cnt, &Elf64_Vernaux::vna_next, [&](Number, const Elf64_Vernaux& version) {
        text(version.vna_name);
        most = std::max<Number>(most, version.vna_other & 0x7fff);
      });
    });
    return most;
  }

  Number check_own_versions() const {
    Number most = 0;
    for_chain(tag(DT_VERDEF), tag(DT_VERDEFNUM), &Elf64_Verdef::vd_next, [&](Number at, const Elf64_Verdef& own) {
      image_.need_equal("the format of its table of versions", own.vd_version, VER_DEF_CURRENT);
      for_chain(at + own.vd_aux, own.vd_cnt, &Elf64_Verdaux::vda_next,
                [&](Number, const Elf64_Verdaux& name) { text(name.vda_name); });
      most = std::max<Number>(most, own.vd_ndx & 0x7fff);
    });
    return most;
  }

  // Visits the entries of a chain, of which each says how far on the next one is, 0 at the end.
  template <class T, class Visit>
  void for_chain(MaybeNumber address, MaybeNumber count, Elf64_Word T::*next, Visit&& visit) const {
    for (Number k = 1; address; ++k) {
      const T& entry = image_.at<T>(kVersions, *address, 1).front();
      visit(*address, entry);
      const bool ends = entry.*next == 0;
      if (ends) image_.need_at_least("the number of entries in its table of versions", k, *count);
      image_.need_at_most("the number of entries in its table of versions", ends ? k : k + 1, *count);
      address = ends ? MaybeNumber() : *address + entry.*next;
    }
  }

  void write_once(Number place, MaybeNumber to) {
    if (!written_.emplace(place, to).second)
      image_.refuse(fmt::format("relocations write to {:#x} twice; must be once", place));
  }

  void check_relocations(std::string_view what, std::int64_t address, std::int64_t size, Number n_relative) {
    const auto all = table<Elf64_Rela>(what, address, size);
    image_.need_at_most("the number of relative relocations", n_relative, all.size());
    for (Number k = 0; k < all.size(); ++k) {
      const Number type = ELF64_R_TYPE(all[k].r_info), symbol = ELF64_R_SYM(all[k].r_info), place = all[k].r_offset;
      const auto to = static_cast<Number>(all[k].r_addend);
      image_.need_at_most("the symbol of a relocation", symbol, symbols_.size() - 1);
      if (kKnown && k < n_relative) image_.need_equal("the type of a relative relocation", type, kRelative);
      if (type == 0 && address == DT_RELA) continue;  // on every machine: nothing is written
      image_.need_mapped("what a relocation writes", place, type == kThreadPair ? 16 : 8, PF_W);
      write_once(place, type == kRelative ? MaybeNumber(to) : MaybeNumber());
      if (type == kRelative) {
        image_.need_mapped("what a relocation points to", to, 0, 0);
      } else if (type == kCalled) {
        image_.need_mapped("what a relocation calls", to, 1, PF_X);
      } else if (std::ranges::count(kSymbol, type) > 0) {
        image_.need_at_least("the symbol of a relocation", symbol, 1);
      } else if (kKnown && type != kThreadPair && std::ranges::count(kThread, type) == 0) {
        image_.refuse(fmt::format("the type of a relocation is {}; must be one that linkers write", type));
      }
    }
  }

  // The packed form: an even number is a place, an odd one says by its bits which of the 63 places after it follow.
  // Linkers write the places in ascending order. A place with a small number in it is no pointer.
  void check_packed_relocations() {
    Number last = 0;
    const auto relocate = [&](Number place) {
      const Number to = image_.at<Number>("what a packed relocation writes", place, 1).front();
      image_.need_mapped("what a packed relocation writes", place, 8, PF_W);
      image_.need_mapped("what a packed relocation points to", to, 0, 0);
      image_.need_at_least("what a packed relocation points to", to, image_.end_of_headers());
      write_once(place, to);
      image_.need_at_least("the place of a packed relocation after another one", place, last);
      last = place;
    };
    Number next = 0;
    for (const PackedRelocation word : table<PackedRelocation>("its packed relocations", kPacked, kPackedSize)) {
      const bool is_place = (word & 1) == 0;
      if (!is_place && next == 0) image_.refuse("its packed relocations begin with bits; must begin with a place");
      if (is_place) relocate(word);
      for (Number bit = 0; bit < 63 && !is_place; ++bit)
        if ((word >> (bit + 1) & 1) != 0) relocate(next + 8 * bit);
      next = is_place ? word + 8 : next + Number{63} * 8;
    }
  }

  void check_calls() const {
    if (tag(DT_INIT)) image_.need_mapped("the function that opens it", *tag(DT_INIT), 1, PF_X);
    if (tag(DT_FINI)) image_.need_mapped("the function that closes it", *tag(DT_FINI), 1, PF_X);
    if (tag(DT_PLTGOT)) image_.need_mapped("its table of calls", *tag(DT_PLTGOT), 24, PF_W);
    check_functions("its list of functions that open it", DT_INIT_ARRAY, DT_INIT_ARRAYSZ);
    check_functions("its list of functions that close it", DT_FINI_ARRAY, DT_FINI_ARRAYSZ);
  }

  // The address of a function depends on the library's place, so a relocation writes it.
  void check_functions(std::string_view what, std::int64_t address, std::int64_t size) const {
    const Number n = table<Number>(what, address, size).size();
    for (Number place = tag(address).value_or(0), k = 0; k < n && kKnown; ++k, place += 8) {
      const auto found = written_.find(place);
      if (found == written_.end()) image_.refuse(fmt::format("{} has no relocation at {:#x}", what, place));
      if (found->second) image_.need_mapped(fmt::format("a function of {}", what), *found->second, 1, PF_X);
    }
  }

  MaybeNumber tag(std::int64_t which) const {
    const auto found = tags_.find(which);
    return found != tags_.end() ? MaybeNumber(found->second) : MaybeNumber();
  }

  Number value(std::int64_t which) const {
    if (!tag(which)) image_.refuse(fmt::format("its dynamic table has no tag {:#x}; must have it", which));
    return *tag(which);
  }

  // The last of all strings ends, so each does.
  const char* text(Number name) const {
    image_.need_at_most("the place of a name in its strings", name, strings_.size() - 1);
    return strings_.data() + name;
  }

  // Nothing when there is no such table.
  template <class T>
  std::span<const T> table(std::string_view what, std::int64_t address, std::int64_t size) const {
    if (!tag(address)) return {};
    const Number n_bytes = value(size);
    if (n_bytes % sizeof(T) != 0)
      image_.refuse(fmt::format("{} has {} bytes; must be a multiple of {}", what, n_bytes, sizeof(T)));
    return image_.at<T>(what, *tag(address), n_bytes / sizeof(T));
  }

  ElfImage image_;
  std::map<std::int64_t, Number> tags_;  // of the dynamic table
  std::vector<Number> needed_;           // names of libraries
  std::span<const char> strings_;
  std::span<const Elf64_Sym> symbols_;
  std::map<Number, MaybeNumber> written_;  // by a relocation: place -> address in this file, or nothing known
};

}  // namespace

CheckedFile exported_data(const std::string& path, std::string_view symbol) {
  const PluginFile file(path);
  return {file.stamp(), file.exported(symbol)};
}

}  // namespace lockstep
