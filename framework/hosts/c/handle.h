// SPDX-License-Identifier: BSD-3-Clause
// Handles: numbers that stand for live objects, the calls with them, and their errors.
#pragma once

#include "framework/hosts/c/lockstep/c.h"

#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>

namespace lockstep::c {

/// What a handle stands for. A handle is a number of the table of live objects, never an address: one that was freed
/// is found to be so.
class Object {
 public:
  virtual ~Object() = default;

  /// While it is locked, no other call may use the object: a std::unique_lock holds it for one call.
  bool try_lock() { return !busy_.exchange(true); }
  void unlock() { busy_ = false; }
  /// Waits for a call in progress.
  void lock();

  /// Calls `act`, and keeps what it throws as the error; returns its code. Throws nothing.
  template <class Act>
  int attempt(Act&& act) noexcept {
    try {
      act();
      return LOCKSTEP_DONE;
    } catch (...) {
      return keep_error();
    }
  }
  /// The text, which the object keeps until the next one.
  const char* keep(std::string text) { return (text_ = std::move(text)).c_str(); }

  int code = LOCKSTEP_DONE;  ///< of the last error
  std::string error_text, error_json = "{}";
  std::shared_ptr<Object> also{};  ///< what a call uses too; null: nothing
  bool made = true;                ///< false: it keeps the error of its making alone, or was freed

 private:
  int keep_error() noexcept;
  std::atomic<bool> busy_ = false;
  std::string text_;
};

/// A registry as a handle.
struct RegistryObject final : Object {
  Registry registry;
};

/// Adds an object to the table and returns its handle.
void* new_handle(std::shared_ptr<Object>);
/// The object of a handle; null if it is none.
std::shared_ptr<Object> object_of(const void* handle) noexcept;
/// Takes a handle out of the table; returns whether it was there.
bool remove_handle(const void* handle) noexcept;

/// The text; bytes that are not UTF-8, as files and hosts may give, are replaced.
std::string utf8(const std::string& text);
/// A number as JSON has it: null if it is not finite.
inline Value number_or_null(double x) { return std::isfinite(x) ? Value(x) : Value(); }

/// Throws an error with this code.
[[noreturn]] void refuse(int code, const std::string& problem);
/// Throws LOCKSTEP_NULL about an argument.
[[noreturn]] void refuse_null(const char* name);
/// What an argument points to.
template <class T>
T& needed(T* pointer, const char* name) {
  if (pointer == nullptr) refuse_null(name);
  return *pointer;
}
/// A text. Throws LOCKSTEP_NULL, and LOCKSTEP_USAGE for what is not UTF-8.
const char* needed_text(const char* text, const char* name);
/// The same; null stands for another text.
inline const char* text_or(const char* text, const char* name, const char* otherwise = "") {
  return text != nullptr ? needed_text(text, name) : otherwise;
}
/// Throws LOCKSTEP_USAGE for numbers of an argument that are not finite.
void check_given(const double* numbers, int count, const char* name);
/// A number from `least` to `most`. Throws LOCKSTEP_USAGE.
int within(int value, int least, int most, const std::string& name);
inline bool flag(int value, const char* name) { return within(value, 0, 1, name) != 0; }
/// Writes a result, if it is wanted.
template <class T>
void put(T* to, const auto& value) {
  if (to != nullptr) *to = static_cast<T>(value);
}

/// Calls `act` with the object of a handle, an H, which no other call may use meanwhile; with_also: nor what it uses too.
template <class H, bool with_also = true, class Act>
int call(const void* handle, Act&& act) noexcept {
  if (handle == nullptr) return LOCKSTEP_NULL;
  const std::shared_ptr<Object> object = object_of(handle);
  auto* const self = dynamic_cast<H*>(object.get());
  if (self == nullptr) return LOCKSTEP_CLOSED;
  const std::unique_lock hold(*self, std::try_to_lock);
  if (!hold) return LOCKSTEP_BUSY;
  if (!self->made) return LOCKSTEP_CLOSED;
  if (!with_also || self->also == nullptr) return self->attempt([&] { act(*self); });
  const std::unique_lock both(*self->also, std::try_to_lock);
  return both ? self->attempt([&] { act(*self); }) : int(LOCKSTEP_BUSY);
}

/// Calls `act` with the object of another argument. Throws an error about it that has the code of that call.
template <class H, class Act>
void with_argument(const void* handle, const std::string& name, Act&& act) {
  if (const int code = call<H, false>(handle, act); code != LOCKSTEP_DONE)
    refuse(code, "argument \"" + name + "\" is " + (code == LOCKSTEP_BUSY ? "in use" : "no live handle of its kind"));
}

/// Makes an H, fills it by `fill`, and writes its handle to `made`, also if that fails.
template <class H, class Public, class Fill>
int make(Public** made, Fill&& fill) noexcept {
  if (made == nullptr) return LOCKSTEP_NULL;
  *made = nullptr;
  try {
    const auto object = std::make_shared<H>();
    const int code = object->attempt([&] { fill(*object); });
    object->made = code == LOCKSTEP_DONE;
    *made = static_cast<Public*>(new_handle(object));
    return code;
  } catch (...) {
    return LOCKSTEP_MEMORY;
  }
}

}  // namespace lockstep::c
