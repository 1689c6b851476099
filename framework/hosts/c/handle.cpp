// SPDX-License-Identifier: BSD-3-Clause
#include "framework/hosts/c/handle.h"

#include <array>
#include <boost/locale/utf.hpp>
#include <cmath>
#include <new>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include <lockstep/version.h>
#include "framework/description/scene/json.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep::c {
namespace {

/// An error of a call, with its own code.
class Refusal final : public Error {
 public:
  Refusal(int its_code, const std::string& words) : Error(words), code(its_code) {}
  Kind kind() const noexcept override { return Kind::usage; }
  int code;
};

constexpr std::array kNames = {"",       "other",  "model", "assembly",  "solve", "step",        "non-finite",
                               "plugin", "scene",  "file",  "user code", "usage", "interrupted", "memory",
                               "null",   "closed", "busy"};

// The codes of errors are the kinds in their order; a kind that comes later has none.
static_assert(int(Error::Kind::other) + 1 == LOCKSTEP_OTHER && int(Error::Kind::step) + 1 == LOCKSTEP_STEP &&
              int(Error::Kind::scene) + 1 == LOCKSTEP_SCENE && int(Error::Kind::user_code) + 1 == LOCKSTEP_USER_CODE &&
              int(Error::Kind::interrupted) + 1 == LOCKSTEP_INTERRUPTED);
int code_of(const Error& error) {
  if (const auto* refusal = dynamic_cast<const Refusal*>(&error)) return refusal->code;
  return error.kind() <= Error::Kind::interrupted ? static_cast<int>(error.kind()) + 1 : int(LOCKSTEP_OTHER);
}

// Sentence and data of an error; what finds no memory stays as it was.
void write_error(const Error& error, int code, std::string& text, std::string& json) noexcept {
  try {
    text = utf8(error.what());
    const ErrorData& d = error.data();
    json = write_json_line(Value::object(
        {{"code", code},
         {"kind", to_string(error.kind())},
         {"text", text},
         {"thing",
          Value::object(
              {{"kind", d.thing.kind}, {"name", d.thing.name}, {"type", d.thing.type}, {"origin", d.thing.origin}})},
         {"key", d.key},
         {"value", d.value},
         {"problem", d.problem},
         {"advice", d.advice},
         {"file", d.file},
         {"line", d.line},
         {"column", d.column},
         {"t", number_or_null(d.t)}}));
  } catch (...) {  // no memory for them
  }
}

struct Table {
  std::mutex mutex;
  std::unordered_map<std::uintptr_t, std::shared_ptr<Object>> objects;
  std::uintptr_t last = 0;
};
// Never destroyed: programs free handles after the end of main().
Table& table() {
  static auto* const all = new Table;
  return *all;
}

}  // namespace

void* new_handle(std::shared_ptr<Object> object) {
  Table& all = table();
  const std::lock_guard lock(all.mutex);
  all.last += 16;  // as addresses are aligned
  all.objects.emplace(all.last, std::move(object));
  return reinterpret_cast<void*>(all.last);  // NOLINT: a number in the place of an address
}

std::shared_ptr<Object> object_of(const void* handle) noexcept {
  Table& all = table();
  const std::lock_guard lock(all.mutex);
  const auto found = all.objects.find(reinterpret_cast<std::uintptr_t>(handle));
  return found != all.objects.end() ? found->second : nullptr;
}

bool remove_handle(const void* handle) noexcept {
  Table& all = table();
  const std::lock_guard lock(all.mutex);
  return all.objects.erase(reinterpret_cast<std::uintptr_t>(handle)) == 1;
}

void Object::lock() {
  while (!try_lock()) std::this_thread::yield();
}

int Object::keep_error() noexcept {
  error_text.clear(), error_json = "{}", code = LOCKSTEP_MEMORY;
  try {
    throw;
  } catch (const std::bad_alloc&) {
    error_text = "no memory";  // short enough to need none
  } catch (const Error& error) {
    code = code_of(error);
    write_error(error, code, error_text, error_json);
  } catch (...) {
    code = LOCKSTEP_OTHER;
    try {
      write_error(Error(thrown_words(std::current_exception())), code, error_text, error_json);
    } catch (...) {  // no memory for the words
    }
  }
  return code;
}

std::string utf8(const std::string& text) { return *read_json(write_json_line(text), "").text(); }

void refuse(int code, const std::string& problem) { throw Refusal(code, problem); }
void refuse_null(const char* name) {
  refuse(LOCKSTEP_NULL, fmt::format("argument \"{}\" is null; give a pointer", name));
}

const char* needed_text(const char* text, const char* name) {
  using Utf8 = boost::locale::utf::utf_traits<char>;
  const std::string_view all = &needed(text, name);
  for (auto at = all.begin(); at != all.end();)
    if (const auto from = at; !boost::locale::utf::is_valid_codepoint(Utf8::decode(at, all.end())))
      refuse(LOCKSTEP_USAGE, fmt::format("argument \"{}\" is not UTF-8 from its byte {} on, 0x{:02x}; convert it", name,
                                         from - all.begin(), static_cast<unsigned char>(*from)));
  return text;
}

void check_given(const double* numbers, int count, const char* of) {
  for (int i = 0; i < count; ++i)
    if (const double x = numbers[i]; !std::isfinite(x))
      refuse(LOCKSTEP_USAGE, fmt::format("{}{} is {}; must be finite", of, count > 1 ? fmt::format("[{}]", i) : "", x));
}
int within(int value, int least, int most, const std::string& name) {
  if (value >= least && value <= most) return value;
  refuse(LOCKSTEP_USAGE, fmt::format("{} is {}; must be {} to {}", name, value, least, most));
}

}  // namespace lockstep::c

using namespace lockstep::c;

namespace {

struct LastError {
  int code;
  const char *text, *json;
};

LastError error_of(const void* handle) {
  const std::shared_ptr<Object> object = object_of(handle);
  if (object == nullptr) return {LOCKSTEP_CLOSED, "this is not a live handle; it was freed or never made", "{}"};
  const std::unique_lock hold(*object, std::try_to_lock);
  if (!hold) return {LOCKSTEP_BUSY, "the handle is in use", "{}"};
  return {object->code, object->error_text.c_str(), object->error_json.c_str()};
}

}  // namespace

extern "C" {

const char* lockstep_code_name(int code) {
  return code >= 0 && code < static_cast<int>(kNames.size()) ? kNames[static_cast<std::size_t>(code)] : "";
}
const char* lockstep_version() { return lockstep::library_version(); }

int lockstep_free(void* handle) {
  if (handle == nullptr) return LOCKSTEP_DONE;
  std::shared_ptr<Object> object = object_of(handle);  // destroyed here, after the hold
  if (object == nullptr) return LOCKSTEP_CLOSED;
  const std::unique_lock hold(*object, std::try_to_lock);
  if (!hold) return LOCKSTEP_BUSY;
  object->made = false;  // for a call that has looked it up and comes later
  return remove_handle(handle) ? LOCKSTEP_DONE : LOCKSTEP_CLOSED;
}

int lockstep_error_code(const void* handle) { return error_of(handle).code; }
const char* lockstep_error_text(const void* handle) { return error_of(handle).text; }
const char* lockstep_error_json(const void* handle) { return error_of(handle).json; }
}
