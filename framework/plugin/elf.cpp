#include "framework/plugin/elf.h"

#include <elf.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>

#include "framework/support/error.h"

namespace lockstep {
namespace {

// The whole file; every access is checked against its end, because a broken file is no reason to crash.
class Image {
 public:
  explicit Image(const std::string& path) : path_(path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
      throw PluginError("plugin file '" + path + "' cannot be opened; check the path and that you may read it");
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }

  template <class T>
  T at(std::uint64_t offset) const {
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) refuse("it ends too early");
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  std::string text(std::uint64_t offset) const {
    if (offset >= bytes_.size()) refuse("a name lies outside of it");
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
    return {begin, std::find(begin, bytes_.end(), '\0')};
  }
  std::vector<unsigned char> cut(std::uint64_t offset, std::uint64_t n) const {
    if (offset > bytes_.size() || bytes_.size() - offset < n) refuse("it ends too early");
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
    return {begin, begin + static_cast<std::ptrdiff_t>(n)};
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw PluginError("plugin file '" + path_ + "' is no shared library that can be loaded here: " + why +
                      "; rebuild it with lockstep_add_plugin");
  }

 private:
  std::string path_;
  std::vector<char> bytes_;
};

Elf64_Ehdr header_of(const Image& image) {
  const auto header = image.at<Elf64_Ehdr>(0);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) image.refuse("it does not begin as one");
  const unsigned char order = std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_ident[EI_DATA] != order)
    image.refuse("it is made for another kind of machine");
  if (header.e_type != ET_DYN) image.refuse("it is an object file or a program");
  return header;
}

// Place in the file of an address in memory, by the segments that are loaded; the bytes must stand in the file.
std::uint64_t offset_of(const Image& image, const Elf64_Ehdr& header, std::uint64_t address, std::uint64_t size) {
  for (unsigned k = 0; k < header.e_phnum; ++k) {
    const auto segment = image.at<Elf64_Phdr>(header.e_phoff + k * std::uint64_t(header.e_phentsize));
    if (segment.p_type != PT_LOAD || address < segment.p_vaddr) continue;
    const std::uint64_t inside = address - segment.p_vaddr;
    if (inside <= segment.p_filesz && segment.p_filesz - inside >= size) return segment.p_offset + inside;
  }
  image.refuse("the data of a symbol is not in it");
}

}  // namespace

std::vector<unsigned char> exported_data(const std::string& path, const std::string& symbol, std::size_t most) {
  const Image image(path);
  const Elf64_Ehdr header = header_of(image);
  for (unsigned k = 0; k < header.e_shnum; ++k) {
    const auto table = image.at<Elf64_Shdr>(header.e_shoff + k * std::uint64_t(header.e_shentsize));
    if (table.sh_type != SHT_DYNSYM) continue;
    const auto names = image.at<Elf64_Shdr>(header.e_shoff + table.sh_link * std::uint64_t(header.e_shentsize));
    for (std::uint64_t at = 0; at + sizeof(Elf64_Sym) <= table.sh_size; at += sizeof(Elf64_Sym)) {
      const auto entry = image.at<Elf64_Sym>(table.sh_offset + at);
      if (entry.st_shndx == SHN_UNDEF || ELF64_ST_TYPE(entry.st_info) != STT_OBJECT) continue;
      if (image.text(names.sh_offset + entry.st_name) != symbol) continue;
      const std::uint64_t size = std::min<std::uint64_t>(entry.st_size, most);
      return image.cut(offset_of(image, header, entry.st_value, size), size);
    }
  }
  return {};
}

}  // namespace lockstep
