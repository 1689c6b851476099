#include "framework/description/registry/seal.h"

#include <cstddef>
#include <cstring>
#include <fstream>

#include "framework/foundation/support/error.h"

namespace lockstep {
namespace {

constexpr std::uint64_t kSealSize = offsetof(lockstep_abi_record, flags) - offsetof(lockstep_abi_record, sealed);

std::string who(const SharedFile& file) { return "plugin file '" + file.image().path() + "' "; }

SharedFile::Place place_of_record(const SharedFile& file) {
  const auto place = file.exported(kAbiSymbol);
  if (!place)
    throw PluginError(who(file) + "is no plugin of lockstep: it has no symbol \"" + kAbiSymbol +
                      "\"; add a LOCKSTEP_PLUGIN(registry) { ... } to it");
  return *place;
}

std::uint64_t sum_of(const SharedFile& file) {
  return file.checksum({{place_of_record(file).offset + offsetof(lockstep_abi_record, sealed), kSealSize}});
}

}  // namespace

lockstep_abi_record record_of(const SharedFile& file) {
  const SharedFile::Place place = place_of_record(file);
  lockstep_abi_record record{};
  constexpr std::uint64_t kHead = offsetof(lockstep_abi_record, compiler);  // magic, size and ABI: the same in all
  if (place.size < kHead)
    throw PluginError(who(file) + "has a record that cannot be read; rebuild it against this lockstep");
  std::memcpy(static_cast<void*>(&record), file.image().data() + place.offset, kHead);
  if (std::string(record.magic, strnlen(record.magic, sizeof record.magic)) != kAbiMagic)
    throw PluginError(who(file) + "has a record that cannot be read; rebuild it against this lockstep");
  if (record.size != sizeof record || place.size != sizeof record)
    throw PluginError(who(file) + "was built for ABI " + std::to_string(record.abi) + " with a record of " +
                      std::to_string(record.size) + " bytes, this host is ABI " + std::to_string(kAbiNumber) +
                      " with " + std::to_string(sizeof record) + "; rebuild the plugin against this lockstep");
  std::memcpy(static_cast<void*>(&record), file.image().data() + place.offset, sizeof record);
  return record;
}

bool check_seal(const SharedFile& file, const lockstep_abi_record& record) {
  if (record.sealed == 0 && record.seal == 0) return false;
  if (record.sealed == 1 && record.seal == sum_of(file)) return true;
  throw PluginError(who(file) +
                    "was changed after it was built: its checksum differs; build it again, or seal it again by "
                    "`lockstep plugins seal` if you changed it yourself");
}

void seal_plugin(const std::string& path) {
  const SharedFile file(path);
  lockstep_abi_record record = record_of(file);
  record.sealed = 1;
  record.seal = sum_of(file);
  std::fstream out(path, std::ios::binary | std::ios::in | std::ios::out);
  out.seekp(static_cast<std::streamoff>(place_of_record(file).offset));
  out.write(reinterpret_cast<const char*>(&record), sizeof record);
  out.close();
  if (!out) throw FileError("plugin file '" + path + "' cannot be written; check that you may write it");
}

}  // namespace lockstep
