// SPDX-License-Identifier: BSD-3-Clause
// Aligned buffers, and the numbers that an integrator saves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep {

// Aligned: a vector whose data is aligned for the widest vector registers.

/// Allocator of memory that is aligned for the widest vector registers; for std::vector.
template <class T>
struct AlignedAllocator {
  using value_type = T;                              ///< type of the elements
  static constexpr std::align_val_t kAlignment{64};  ///< alignment of the first element, bytes
  AlignedAllocator() = default;
  /// Allocators have no state: every one is as good as any other.
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  /// Memory for n elements; throws std::bad_alloc.
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kAlignment); }  ///< frees what allocate returned
  /// Always true: memory of one can be freed by another.
  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

/// A std::vector whose data is aligned to 64 bytes.
template <class T>
using Aligned = std::vector<T, AlignedAllocator<T>>;

// Snapshot: numbers saved in order and restored in the same order; what an integrator or an observer keeps outside the
// State.

/// Numbers that are saved, to be restored in the same order by a SnapshotReader.
class LOCKSTEP_API Snapshot {
 public:
  void put(double x) { numbers_.push_back(x); }  ///< appends a number
  /// Appends a vector of numbers, or of bool: its size, then its numbers.
  template <class V>
  void put_all(const V& v) {
    put(static_cast<double>(v.size()));
    for (decltype(v.size()) i = 0; i < v.size(); ++i) put(static_cast<double>(v[i]));
  }
  void put_text(std::string_view text);                            ///< appends a text
  void put_part(const Snapshot& part);                             ///< appends another snapshot as one item
  void put_bits(std::uint64_t bits);                               ///< appends a word of 64 bits, as two numbers
  void clear() { numbers_.clear(); }                               ///< removes all numbers
  const std::vector<double>& numbers() const { return numbers_; }  ///< all of them, in order
  /// Replaces all numbers by these, of another snapshot.
  void assign(std::vector<double> numbers) { numbers_ = std::move(numbers); }

 private:
  std::vector<double> numbers_;
};

/// Reads a snapshot from its first number on. Any number of readers, in any threads, may read one snapshot, which must
/// outlive them unchanged.
class LOCKSTEP_API SnapshotReader {
 public:
  /// From the first number on. Wherever one is read, a snapshot may be given.
  SnapshotReader(const Snapshot& of) : left_(of.numbers()) {}  // NOLINT
  SnapshotReader(Snapshot&&) = delete;                         ///< the numbers would be gone
  /// The next number. Throws ModelError if there is none: more is read than was saved.
  double get() {
    if (left_.empty()) ran_out();
    const double x = left_.front();
    left_ = left_.subspan(1);
    return x;
  }
  bool get_flag() { return get() != 0; }  ///< the next number as yes (not 0) or no
  long get_count();                       ///< the next number as a whole one; throws as get()
  /// Reads a vector that put_all wrote; resizes v. Throws as get().
  template <class V>
  void get_all(V& v) {
    v.resize(static_cast<decltype(v.size())>(get_size()));
    for (decltype(v.size()) i = 0; i < v.size(); ++i) v[i] = static_cast<typename V::value_type>(get());
  }
  std::string get_text();                        ///< reads what put_text wrote; throws as get()
  SnapshotReader get_part();                     ///< a reader of what put_part wrote; throws as get()
  std::uint64_t get_bits();                      ///< reads what put_bits wrote; throws as get()
  bool at_end() const { return left_.empty(); }  ///< whether all that was saved has been read
  Snapshot rest() const;                         ///< a copy of what has not been read yet

 private:
  explicit SnapshotReader(std::span<const double> numbers) : left_(numbers) {}
  std::size_t get_size();
  [[noreturn]] static void ran_out();
  std::span<const double> left_;  // to be read
};

}  // namespace lockstep
