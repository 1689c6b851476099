// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/plugin_file.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>

#include "framework/description/registry/elf_image.h"

namespace lockstep {
namespace {

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

// How many symbols there are is in the hash tables only.
Number count_symbols(const ElfImage& image, const std::map<std::int64_t, Number>& tags) {
  if (const auto table = tags.find(DT_HASH); table != tags.end())
    return image.at<std::uint32_t>(kHash, table->second, 2).back();
  const auto table = tags.find(DT_GNU_HASH);
  if (table == tags.end()) image.refuse("its symbols have no hash table");
  return count_by_gnu_hash(image, table->second);
}

}  // namespace

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
