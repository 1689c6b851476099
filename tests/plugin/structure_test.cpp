// Plugins in which one table is damaged that the system's loader trusts: each is refused before it is opened, by a
// sentence with the file, what is wrong, its value and the limit.
#include <elf.h>

#include <cstring>
#include <filesystem>
#include <functional>

#include <lockstep/error.h>
#include <lockstep/loader.h>
#include "framework/description/registry/elf_image.h"
#include "tests/support/catch.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace structure_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

#if defined(__aarch64__)
constexpr std::uint64_t kCalled = R_AARCH64_IRELATIVE, kSymbol = R_AARCH64_GLOB_DAT;
#else
constexpr std::uint64_t kCalled = R_X86_64_IRELATIVE, kSymbol = R_X86_64_GLOB_DAT;
#endif
constexpr std::uint64_t kFar = std::uint64_t{1} << 30;  // beyond any plugin, as an address and as an offset

// The bytes of a sound plugin, and its entries, to be changed.
class Library {
 public:
  explicit Library(const std::string& path) : bytes_(bytes_of(path)) {}

  const std::string& bytes() const { return bytes_; }
  template <class T>
  T& in_file(std::uint64_t offset, std::uint64_t k = 0) {
    REQUIRE(offset + (k + 1) * sizeof(T) <= bytes_.size());
    return reinterpret_cast<T*>(bytes_.data() + offset)[k];
  }
  Elf64_Phdr& segment(std::uint32_t type, int which = 0) {
    auto& header = in_file<Elf64_Ehdr>(0);
    for (unsigned k = 0; k < header.e_phnum; ++k) {
      auto& s = in_file<Elf64_Phdr>(header.e_phoff, k);
      if (s.p_type == type && which-- == 0) return s;
    }
    FAIL("no such segment");
    std::abort();
  }
  Elf64_Phdr& segment_with(std::uint32_t flags) {
    for (int k = 0;; ++k)
      if ((segment(PT_LOAD, k).p_flags & flags) == flags) return segment(PT_LOAD, k);
  }
  Elf64_Dyn* find(std::int64_t tag) {
    for (unsigned k = 0;; ++k) {
      auto& entry = in_file<Elf64_Dyn>(segment(PT_DYNAMIC).p_offset, k);
      if (entry.d_tag == tag) return &entry;
      if (entry.d_tag == DT_NULL) return nullptr;
    }
  }
  Elf64_Dyn& tag(std::int64_t which) {
    REQUIRE(find(which) != nullptr);
    return *find(which);
  }
  std::uint64_t& value(std::int64_t which) { return tag(which).d_un.d_val; }
  // Entry k of what is at an address.
  template <class T>
  T& at(std::uint64_t address, std::uint64_t k = 0) {
    for (int n = 0;; ++n) {
      const Elf64_Phdr& s = segment(PT_LOAD, n);
      if (address >= s.p_vaddr && address - s.p_vaddr < s.p_filesz)
        return in_file<T>(s.p_offset + (address - s.p_vaddr), k);
    }
  }
  template <class T>
  T& table(std::int64_t which, std::uint64_t k = 0) {
    return at<T>(value(which), k);
  }
  std::string text(std::uint64_t name) { return &at<char>(value(DT_STRTAB) + name); }
  Elf64_Sym& symbol(const std::string& name) {
    for (unsigned k = 1;; ++k)
      if (auto& s = table<Elf64_Sym>(DT_SYMTAB, k); text(s.st_name) == name) return s;
  }
  Elf64_Sym& undefined() {
    for (unsigned k = 1;; ++k)
      if (auto& s = table<Elf64_Sym>(DT_SYMTAB, k); s.st_shndx == SHN_UNDEF) return s;
  }
  Elf64_Rela& relocation_of(std::uint64_t place) {
    for (unsigned k = 0;; ++k)
      if (auto& r = table<Elf64_Rela>(DT_RELA, k); r.r_offset == place) return r;
  }
  // An entry that the loader does without becomes another.
  void say(std::int64_t which, std::uint64_t what) {
    tag(DT_RUNPATH).d_un.d_val = what;
    tag(DT_RUNPATH).d_tag = which;
  }
  // The loader passes over this number.
  void lose(std::int64_t which) { tag(which).d_tag = DT_LOPROC + 5; }

 private:
  std::string bytes_;
};

using Change = std::function<void(Library&)>;

struct Case {
  std::string says;
  Change change;
};

void check(const std::string& module, const std::vector<Case>& cases) {
  REQUIRE_NOTHROW(check_plugin_file(kModules + "/" + module));
  for (std::size_t k = 0; k < cases.size(); ++k) {
    Library library(kModules + "/" + module);
    cases[k].change(library);
    const std::string name = "damage" + std::to_string(k) + ".so";
    const std::string answer = answer_of(plugin_file("structure", name, library.bytes()));
    INFO(name << ": " << answer);
    CHECK(contains(answer, name + "' is not a shared library that can be loaded here: "));
    CHECK(contains(answer, cases[k].says));
  }
  fs::remove_all(kModules + "/structure");
}

std::string number(std::uint64_t n) { return std::to_string(n); }

}  // namespace

TEST_CASE("a plugin whose segments are damaged is refused", "[plugin][structure]") {
  const std::string page = number(Library(kModules + "/tables.so").segment_with(PF_W).p_align);
  check(
      "tables.so",
      {{"it ends too early: a segment is 1073741824 bytes from 0 on; must end at ",
        [](auto& l) { l.segment(PT_LOAD).p_filesz = l.segment(PT_LOAD).p_memsz = kFar; }},
       {"the size of a segment is 2199023255552; must be at most 1099511627776",
        [](auto& l) { l.segment_with(PF_W).p_memsz = kFar << 11; }},
       {"the size of a segment in the file is ", [](auto& l) { l.segment_with(PF_W).p_memsz = 1; }},
       {"the address of a segment is 2199023255552; must be at most 1099511627776",
        [](auto& l) { l.segment_with(PF_W).p_vaddr = kFar << 11; }},
       {"the alignment of a segment is 3; must be a power of two", [](auto& l) { l.segment(PT_LOAD).p_align = 3; }},
       {"the alignment of a segment is 2147483648; must be at most 1073741824",
        [](auto& l) { l.segment(PT_LOAD).p_align = 2 * kFar; }},
       {"its segments overlap or are in disorder: the address of one is 0; must be at least ",
        [](auto& l) { l.segment_with(PF_W).p_vaddr = 0; }},
       {"two segments share a page: the page of one is ",
        [](auto& l) { l.segment_with(PF_X).p_vaddr = l.segment(PT_LOAD).p_memsz; }},  // where the first ends
       {"a segment cannot be mapped: its address in its page is ", [](auto& l) { l.segment_with(PF_W).p_vaddr += 8; }},
       {"a segment cannot be mapped: its address in its page is ",
        [](auto& l) { l.segment_with(PF_W).p_vaddr += 0x1000, l.segment_with(PF_W).p_align = kFar; }},
       {"its segments overlap in the file: one is at offset ",
        [](auto& l) { l.segment_with(PF_X).p_offset = l.segment_with(PF_X).p_vaddr % l.segment_with(PF_X).p_align; }},
       {"a segment has flags 7; must be readable, and not both writable and executable",
        [](auto& l) { l.segment_with(PF_W).p_flags |= PF_X; }},
       {"a segment has flags 2; must be readable", [](auto& l) { l.segment_with(PF_W).p_flags = PF_W; }},
       {"it asks for a stack that can be executed", [](auto& l) { l.segment(PT_GNU_STACK).p_flags |= PF_X; }},
       {"the number of its dynamic tables is 0; must be 1", [](auto& l) { l.segment(PT_DYNAMIC).p_type = PT_NULL; }},
       {"the number of its dynamic tables is 2; must be 1", [](auto& l) { l.segment(PT_NOTE).p_type = PT_DYNAMIC; }},
       {"the part of type 0x2 is ", [](auto& l) { l.segment(PT_DYNAMIC).p_vaddr = kFar; }},
       {"the offset of the part of type 0x2 is ", [](auto& l) { l.segment(PT_DYNAMIC).p_offset += 16; }},
       {" at address 0x40000000; must be in one mapped segment", [](auto& l) { l.segment(PT_TLS).p_vaddr = kFar; }},
       {"the size of a segment is 2147483648; must be at most 1073741824",
        [](auto& l) { l.segment(PT_TLS).p_memsz = 2 * kFar; }},
       {" at address 0x40000000; must be in one mapped segment", [](auto& l) { l.segment(PT_NOTE).p_vaddr = kFar; }},
       {"the part of type 0x4 is 1073741824 bytes", [](auto& l) { l.segment(PT_NOTE).p_memsz = kFar; }},
       {"the part of type 0x6474e550 is 1073741824 bytes", [](auto& l) { l.segment(PT_GNU_EH_FRAME).p_memsz = kFar; }},
       {"the part of type 0x6474e552 is ", [](auto& l) { l.segment(PT_GNU_RELRO).p_vaddr = kFar; }},
       {"must be in one writable segment",
        [](auto& l) {
          auto& s = l.segment(PT_GNU_RELRO);
          const auto& code = l.segment_with(PF_X);
          s.p_vaddr = code.p_vaddr, s.p_offset = code.p_offset, s.p_filesz = s.p_memsz = 8;
        }},
       {"the number of its parts that are made read-only is 2; must be at most 1",
        [](auto& l) { l.segment(PT_GNU_EH_FRAME) = l.segment(PT_GNU_RELRO); }},
       {"what is not in the file of the part of type 0x6474e552 is 8192; must be at most ",
        [](auto& l) { l.segment(PT_GNU_RELRO).p_memsz = l.segment(PT_GNU_RELRO).p_filesz + 8192; }},
       {"; must be the list of segments", [](auto& l) { l.segment(PT_NOTE).p_type = PT_PHDR; }}});
}

TEST_CASE("a plugin whose dynamic table is damaged is refused", "[plugin][structure]") {
  check("probe.so",
        {{"asks for what no plugin needs (tag 0x6ffffefc)", [](auto& l) { l.say(DT_AUDIT, 1); }},
         {"asks for what no plugin needs (tag 0x7fffffff)", [](auto& l) { l.say(DT_FILTER, 1); }},
         {"asks for what no plugin needs (tag 0x20)", [](auto& l) { l.say(DT_PREINIT_ARRAY, 1); }},
         {"asks for what no plugin needs (tag 0x11)", [](auto& l) { l.say(DT_REL, 1); }},
         {"asks for what no plugin needs (tag 0x16)", [](auto& l) { l.say(DT_TEXTREL, 1); }},
         {"asks for what no plugin needs (tag 0x12345678)", [](auto& l) { l.say(0x12345678, 1); }},
         {"its code is not position independent", [](auto& l) { l.say(DT_FLAGS, DF_TEXTREL); }},
         {"its dynamic table has tag 0x5 twice; must be once", [](auto& l) { l.say(DT_STRTAB, 1); }},
         {" bytes; must end with tag 0",
          [](auto& l) {
            while (Elf64_Dyn* end = l.find(DT_NULL)) {
              *end = l.tag(DT_NEEDED);
              if (reinterpret_cast<char*>(end + 1) - l.bytes().data() ==
                  static_cast<std::ptrdiff_t>(l.segment(PT_DYNAMIC).p_offset + l.segment(PT_DYNAMIC).p_filesz))
                break;
            }
          }},
         {"its dynamic table is ",  // the segment that it is in cannot be written
          [](auto& l) {
            auto& s = l.segment_with(PF_W);
            s.p_flags = PF_R;
            s.p_memsz = s.p_filesz;
            l.segment(PT_GNU_RELRO).p_type = PT_NULL;  // nor made read-only later
          }},
         {"one of tags 0x7 and 0x8; must be both", [](auto& l) { l.lose(DT_RELA); }},
         {"one of tags 0x7 and 0x8; must be both", [](auto& l) { l.lose(DT_RELASZ); }},
         {"one of tags 0x17 and 0x2; must be both", [](auto& l) { l.lose(DT_JMPREL); }},
         {"one of tags 0x19 and 0x1b; must be both", [](auto& l) { l.lose(DT_INIT_ARRAY); }},
         {"one of tags 0x5 and 0xa; must be both", [](auto& l) { l.lose(DT_STRTAB); }},
         {"one of tags 0x6 and 0xb; must be both", [](auto& l) { l.lose(DT_SYMTAB); }},
         {"one of tags 0x6ffffffe and 0x6fffffff; must be both", [](auto& l) { l.lose(DT_VERNEED); }},
         {"tag 0xb of its dynamic table is 16; must be 24", [](auto& l) { l.value(DT_SYMENT) = 16; }},
         {"tag 0x9 of its dynamic table is 16; must be 24", [](auto& l) { l.value(DT_RELAENT) = 16; }},
         {"tag 0x14 of its dynamic table is 17; must be 7", [](auto& l) { l.value(DT_PLTREL) = DT_REL; }}});
}

TEST_CASE("a plugin whose record ends before its last numbers is refused", "[plugin][structure]") {
  Library library(kModules + "/probe.so");
  constexpr auto whole = sizeof(lockstep_abi_record);
  library.symbol("lockstep_abi").st_size = whole - 4;
  const std::string answer = answer_of(plugin_file("structure", "short_record.so", library.bytes()));
  INFO(answer);
  CHECK(contains(answer, "short_record.so' has a record of " + number(whole) + " bytes, of which " + number(whole - 4) +
                             " are there; rebuild"));
  fs::remove_all(kModules + "/structure");
}

TEST_CASE("a plugin whose strings or symbols are damaged is refused", "[plugin][structure]") {
  check("probe.so",
        {{"its table of strings is 1073741824 bytes at address ", [](auto& l) { l.value(DT_STRSZ) = kFar; }},
         {"its strings have no end: the last of ", [](auto& l) { l.value(DT_STRSZ) -= 1; }},
         {"its strings have no end: the last of 0 bytes must be 0", [](auto& l) { l.value(DT_STRSZ) = 0; }},
         {"the place of a name in its strings is 1073741824; must be at most ",
          [](auto& l) { l.value(DT_NEEDED) = kFar; }},
         {"a library that it needs has no name", [](auto& l) { l.value(DT_NEEDED) = 0; }},
         {"the place of a name in its strings is 1073741824; must be at most ",
          [](auto& l) { l.value(DT_RUNPATH) = kFar; }},
         {"the place of a name in its strings is 1073741824; must be at most ",
          [](auto& l) { l.undefined().st_name = kFar; }},
         {"its table of symbols is ", [](auto& l) { l.value(DT_SYMTAB) = kFar; }},
         {"the offset of its table of symbols is ", [](auto& l) { l.value(DT_SYMTAB) += 1; }},
         {"a part of the empty symbol is 1; must be 0",
          [](auto& l) { l.template table<Elf64_Sym>(DT_SYMTAB).st_value = 1; }},
         {"the address of a symbol of another library is 8; must be 0", [](auto& l) { l.undefined().st_value = 8; }},
         {"the binding of a symbol of another library is 0; must be at least 1",
          [](auto& l) { l.undefined().st_info = ELF64_ST_INFO(STB_LOCAL, STT_FUNC); }},
         {"a symbol is 0 bytes at address 0x40000000; must be in one mapped segment",
          [](auto& l) { l.symbol("lockstep_register_plugin").st_value = kFar; }},
         {"a symbol is 0 bytes at address ",  // a function that chooses a function, and is none
          [](auto& l) { l.symbol("lockstep_abi").st_info = ELF64_ST_INFO(STB_GLOBAL, STT_GNU_IFUNC); }},
         {"the place of a thread's variable is ",
          [](auto& l) { l.symbol("lockstep_abi").st_info = ELF64_ST_INFO(STB_GLOBAL, STT_TLS); }}});
}

TEST_CASE("a plugin whose hash tables are damaged is refused", "[plugin][structure]") {
  constexpr auto kGnu = DT_GNU_HASH;
  check("tables.so", {{"its symbols have no hash table",
                       [](auto& l) {
                         l.lose(DT_HASH);
                         l.tag(DT_GNU_HASH).d_tag = DT_LOPROC + 6;
                       }},
                      {"its hash table is 16 bytes at address 0x40000000", [](auto& l) { l.value(kGnu) = kFar; }},
                      {"the number of buckets of its hash table is 0; must be at least 1",
                       [](auto& l) { l.template table<std::uint32_t>(kGnu, 0) = 0; }},
                      {"the first symbol in its hash table is 0; must be at least 1",
                       [](auto& l) { l.template table<std::uint32_t>(kGnu, 1) = 0; }},
                      {"the filter of its hash table has 3 words; must be a power of two",
                       [](auto& l) { l.template table<std::uint32_t>(kGnu, 2) = 3; }},
                      {"the shift in its hash table is 64; must be at most 31",
                       [](auto& l) { l.template table<std::uint32_t>(kGnu, 3) = 64; }},
                      {"its hash table is 8589934592 bytes at address ",
                       [](auto& l) { l.template table<std::uint32_t>(kGnu, 2) = kFar; }},
                      {"its hash table is 4294967296 bytes at address ",
                       [](auto& l) { l.template table<std::uint32_t>(kGnu, 0) = kFar; }},
                      {"a symbol in its hash table is ",
                       [](auto& l) {
                         const auto n_filter = l.template table<std::uint32_t>(kGnu, 2);
                         l.template table<std::uint32_t>(kGnu, 4 + 2 * n_filter) = 1;
                         l.template table<std::uint32_t>(kGnu, 1) += 1;
                       }},
                      {"its hash table is 4 bytes at address ",  // a chain that begins beyond the table
                       [](auto& l) {
                         const auto n_filter = l.template table<std::uint32_t>(kGnu, 2);
                         l.template table<std::uint32_t>(kGnu, 4 + 2 * n_filter) = kFar;
                       }},
                      {"the number of buckets of its hash table is 0; must be at least 1",
                       [](auto& l) { l.template table<std::uint32_t>(DT_HASH, 0) = 0; }},
                      {"the number of symbols in its hash table is 0; must be at least 1",
                       [](auto& l) { l.template table<std::uint32_t>(DT_HASH, 1) = 0; }},
                      {" bytes at address ", [](auto& l) { l.template table<std::uint32_t>(DT_HASH, 1) = kFar; }},
                      {"a symbol in its hash table is 1073741824; must be at most ",
                       [](auto& l) { l.template table<std::uint32_t>(DT_HASH, 2) = kFar; }},
                      {"is twice in its hash table; must be once",  // a chain that leads to itself
                       [](auto& l) {
                         const auto n_buckets = l.template table<std::uint32_t>(DT_HASH, 0);
                         std::uint32_t bucket = 0;
                         while (l.template table<std::uint32_t>(DT_HASH, 2 + bucket) == 0) ++bucket;
                         const auto k = l.template table<std::uint32_t>(DT_HASH, 2 + bucket);
                         l.template table<std::uint32_t>(DT_HASH, 2 + n_buckets + k) = k;
                       }}});
}

TEST_CASE("a plugin whose versions are damaged is refused", "[plugin][structure]") {
  const auto needed = [](Library& l) -> Elf64_Verneed& { return l.table<Elf64_Verneed>(DT_VERNEED); };
  const auto own = [](Library& l) -> Elf64_Verdef& { return l.table<Elf64_Verdef>(DT_VERDEF); };
  const auto name = [=](Library& l) -> Elf64_Vernaux& {
    return l.at<Elf64_Vernaux>(l.value(DT_VERNEED) + needed(l).vn_aux);
  };
  check("tables.so",
        {{"its dynamic table has no tag 0x6ffffff0; must have it", [](auto& l) { l.lose(DT_VERSYM); }},
         {"its table of versions is ", [](auto& l) { l.value(DT_VERSYM) = kFar; }},
         {"the version of a symbol is 32766; must be at most ",
          [](auto& l) { l.template table<std::uint16_t>(DT_VERSYM, 1) = 0x7ffe; }},
         {"its table of versions is 16 bytes at address 0x40000000", [](auto& l) { l.value(DT_VERNEED) = kFar; }},
         {"the offset of its table of versions is ", [](auto& l) { l.value(DT_VERNEED) += 1; }},
         {"the format of its table of versions is 2; must be 1", [&](auto& l) { needed(l).vn_version = 2; }},
         {"a library with versions is ''; must be one that it needs", [&](auto& l) { needed(l).vn_file = 0; }},
         {"the place of a name in its strings is 1073741824", [&](auto& l) { needed(l).vn_file = kFar; }},
         {"its table of versions is 16 bytes at address ", [&](auto& l) { needed(l).vn_next = kFar; }},
         {"its table of versions is 16 bytes at address ", [&](auto& l) { needed(l).vn_aux = kFar; }},
         {"the number of entries in its table of versions is 1; must be at least ",
          [&](auto& l) { needed(l).vn_next = 0; }},
         {"the number of entries in its table of versions is ", [](auto& l) { l.value(DT_VERNEEDNUM) += 1; }},
         {"the number of entries in its table of versions is ", [](auto& l) { l.value(DT_VERNEEDNUM) -= 1; }},
         {"the number of entries in its table of versions is ", [&](auto& l) { needed(l).vn_cnt = 0; }},
         {"the number of entries in its table of versions is ", [&](auto& l) { needed(l).vn_cnt += 1; }},
         {"the place of a name in its strings is 1073741824", [&](auto& l) { name(l).vna_name = kFar; }},
         {"the format of its table of versions is 2; must be 1", [&](auto& l) { own(l).vd_version = 2; }},
         {"its table of versions is 20 bytes at address ", [&](auto& l) { own(l).vd_next = kFar; }},
         {"its table of versions is 8 bytes at address ", [&](auto& l) { own(l).vd_aux = kFar; }},
         {"the number of entries in its table of versions is ", [&](auto& l) { own(l).vd_cnt += 1; }},
         {"the place of a name in its strings is 1073741824",
          [&](auto& l) { l.template at<Elf64_Verdaux>(l.value(DT_VERDEF) + own(l).vd_aux).vda_name = kFar; }}});
}

TEST_CASE("a plugin whose relocations are damaged is refused", "[plugin][structure]") {
  const auto first = [](Library& l) -> Elf64_Rela& { return l.table<Elf64_Rela>(DT_RELA); };
  const auto call = [](Library& l) -> Elf64_Rela& { return l.table<Elf64_Rela>(DT_JMPREL); };
  check("probe.so", {{"its relocations is ", [](auto& l) { l.value(DT_RELA) = kFar; }},
                     {" bytes; must be a multiple of 24", [](auto& l) { l.value(DT_RELASZ) -= 8; }},
                     {" bytes; must be a multiple of 24", [](auto& l) { l.value(DT_PLTRELSZ) += 8; }},
                     {"the number of relative relocations is 1073741824; must be at most ",
                      [](auto& l) { l.value(DT_RELACOUNT) = kFar; }},
                     {"the type of a relative relocation is " + number(kSymbol) + "; must be ",
                      [&](auto& l) { first(l).r_info = ELF64_R_INFO(std::uint64_t{1}, kSymbol); }},
                     {"the type of a relocation is 4000; must be one that linkers write",
                      [&](auto& l) { call(l).r_info = ELF64_R_INFO(std::uint64_t{1}, 4000u); }},
                     {"the symbol of a relocation is 16777215; must be at most ",
                      [&](auto& l) { call(l).r_info = ELF64_R_INFO(std::uint64_t{0xffffff}, kSymbol); }},
                     {"the symbol of a relocation is 0; must be at least 1",
                      [&](auto& l) { call(l).r_info = ELF64_R_INFO(std::uint64_t{0}, kSymbol); }},
                     {"what a relocation writes is 8 bytes at address 0x40000000; must be in one writable segment",
                      [&](auto& l) { first(l).r_offset = kFar; }},
                     {" twice; must be once",
                      [&](auto& l) { call(l).r_offset = l.template table<Elf64_Rela>(DT_JMPREL, 1).r_offset; }},
                     {"what a relocation writes is 8 bytes at address ",  // code
                      [&](auto& l) { call(l).r_offset = l.value(DT_INIT); }},
                     {"what a relocation points to is 0 bytes at address 0x40000000; must be in one mapped segment",
                      [&](auto& l) { first(l).r_addend = kFar; }},
                     {"what a relocation calls is 1 bytes at address ",  // data
                      [&](auto& l) {
                        call(l).r_info = ELF64_R_INFO(std::uint64_t{0}, kCalled);
                        call(l).r_addend = static_cast<std::int64_t>(l.segment(PT_DYNAMIC).p_vaddr);
                      }}});
}

TEST_CASE("a plugin that has damaged functions called is refused", "[plugin][structure]") {
  check("probe.so",
        {{"the function that opens it is 1 bytes at address ",
          [](auto& l) { l.value(DT_INIT) = l.segment(PT_DYNAMIC).p_vaddr; }},
         {"the function that closes it is 1 bytes at address 0x40000000; must be in one executable segment",
          [](auto& l) { l.value(DT_FINI) = kFar; }},
         {"its table of calls is 24 bytes at address ", [](auto& l) { l.value(DT_PLTGOT) = l.value(DT_INIT); }},
         {"its list of functions that open it is ", [](auto& l) { l.value(DT_INIT_ARRAY) = kFar; }},
         {"its list of functions that open it has 9 bytes; must be a multiple of 8",
          [](auto& l) { l.value(DT_INIT_ARRAYSZ) = 9; }},
         {"its list of functions that close it has no relocation at ",
          [](auto& l) { l.value(DT_FINI_ARRAY) = l.segment(PT_DYNAMIC).p_vaddr; }},
         {"a function of its list of functions that open it is 1 bytes at address ", [](auto& l) {
            l.relocation_of(l.value(DT_INIT_ARRAY)).r_addend = static_cast<std::int64_t>(l.segment(PT_DYNAMIC).p_vaddr);
          }}});
}

TEST_CASE("a plugin whose packed relocations are damaged is refused", "[plugin][structure]") {
  if (Library(kModules + "/tables.so").find(kPacked) == nullptr) {
    WARN("skipped: this linker does not pack relocations");
    return;
  }
  check("tables.so",
        {{"its packed relocations is ", [](auto& l) { l.value(kPacked) = kFar; }},
         {" bytes; must be a multiple of 8", [](auto& l) { l.value(kPackedSize) -= 1; }},
         {"tag 0x25 of its dynamic table is 4; must be 8", [](auto& l) { l.value(kPackedEntry) = 4; }},
         {"one of tags 0x24 and 0x23; must be both", [](auto& l) { l.lose(kPacked); }},
         {"its packed relocations begin with bits; must begin with a place",
          [](auto& l) { l.template table<std::uint64_t>(kPacked) |= 1; }},
         {"what a packed relocation writes is 8 bytes at address 0x40000000",
          [](auto& l) { l.template table<std::uint64_t>(kPacked) = kFar; }},
         {"what a packed relocation writes is 8 bytes at address ",  // code
          [](auto& l) { l.template table<std::uint64_t>(kPacked) = l.value(DT_INIT) & ~std::uint64_t{7}; }},
         {"relocations write to ",
          [](auto& l) { l.template table<std::uint64_t>(kPacked, 1) = l.template table<std::uint64_t>(kPacked); }},
         {"what a packed relocation points to is 0 bytes at address 0x40000000; must be in one mapped segment",
          [](auto& l) { l.template at<std::uint64_t>(l.template table<std::uint64_t>(kPacked)) = kFar; }},
         {"the place of a packed relocation after another one is ",
          [](auto& l) {
            const std::uint64_t first = l.template table<std::uint64_t>(kPacked);
            l.template table<std::uint64_t>(kPacked, 1) = first;
            l.template table<std::uint64_t>(kPacked) = first + 8;
          }},
         {"what a packed relocation points to is 0; must be at least ",
          [](auto& l) { l.template at<std::uint64_t>(l.template table<std::uint64_t>(kPacked)) = 0; }},
         {"a function of its list of functions that open it is 1 bytes at address ",
          [](auto& l) { l.template table<std::uint64_t>(DT_INIT_ARRAY) = l.segment(PT_DYNAMIC).p_vaddr; }}});
}

}  // namespace structure_test
