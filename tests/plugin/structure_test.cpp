// SPDX-License-Identifier: BSD-3-Clause
// Plugins in which a table is damaged that leads to their record: each is refused before it is opened, by a sentence with the
// file, what is wrong, its value and the limit.
#include <elf.h>

#include <cstring>
#include <filesystem>
#include <functional>

#include <lockstep/author/loader.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace structure_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

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

TEST_CASE("a plugin whose tables lead nowhere is refused", "[plugin][structure]") {
  const std::vector<Case> cases = {
      {"it ends too early: a segment is 1073741824 bytes from 0 on; must end at ",
       [](auto& l) { l.segment(PT_LOAD).p_filesz = l.segment(PT_LOAD).p_memsz = kFar; }},
      {"it has no dynamic table", [](auto& l) { l.segment(PT_DYNAMIC).p_type = PT_NULL; }},
      {"the offset of its dynamic table is ", [](auto& l) { l.segment(PT_DYNAMIC).p_offset += 1; }},
      {"its dynamic table has no tag 0x5; must have it", [](auto& l) { l.lose(DT_STRTAB); }},
      {"its dynamic table has no tag 0xa; must have it", [](auto& l) { l.lose(DT_STRSZ); }},
      {"its dynamic table has no tag 0x6; must have it", [](auto& l) { l.lose(DT_SYMTAB); }},
      {"its table of strings is 1073741824 bytes at address ", [](auto& l) { l.value(DT_STRSZ) = kFar; }},
      {"its table of symbols is ", [](auto& l) { l.value(DT_SYMTAB) = kFar; }},
      {"the offset of its table of symbols is ", [](auto& l) { l.value(DT_SYMTAB) += 1; }},
      {"the data of a symbol is ", [](auto& l) { l.symbol("lockstep_abi").st_value = kFar; }},
      {"its hash table is ", [](auto& l) { l.value(DT_GNU_HASH) = kFar; }},
      {"its hash table is ", [](auto& l) { l.template table<std::uint32_t>(DT_GNU_HASH) = 0xffffffff; }},
      {"its symbols have no hash table", [](auto& l) {
         l.lose(DT_GNU_HASH);
         if (l.find(DT_HASH) != nullptr) l.lose(DT_HASH);  // linkers that clang calls write both
       }}};
  check("probe.so", cases);
}

TEST_CASE("a plugin whose record ends before its last numbers is refused", "[plugin][structure]") {
  Library library(kModules + "/probe.so");
  constexpr auto whole = sizeof(lockstep_abi_record);
  library.symbol("lockstep_abi").st_size = whole - 4;
  const std::string answer = answer_of(plugin_file("structure", "short_record.so", library.bytes()));
  INFO(answer);
  CHECK(contains(answer, "short_record.so' has a record of " + number(whole) + " bytes, of which " + number(whole - 4) +
                             " exist; rebuild"));
  fs::remove_all(kModules + "/structure");
}

}  // namespace structure_test
