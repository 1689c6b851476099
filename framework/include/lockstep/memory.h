// Aligned buffers, and the numbers that an integrator saves.
#pragma once

#include <cassert>
#include <cstddef>
#include <new>
#include <vector>

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

// Snapshot: numbers saved in order and restored in the same order; what an integrator keeps outside the State.

/// Numbers that an integrator saves, and restores in the same order.
class Snapshot {
 public:
  void put(double x) { numbers_.push_back(x); }  ///< appends a number
  /// Appends a vector: its size, then its numbers.
  template <class V>
  void put_all(const V& v) {
    put(static_cast<double>(v.size()));
    for (decltype(v.size()) i = 0; i < v.size(); ++i) put(v[i]);
  }
  /// The next number; asserts that there is one.
  double get() const {
    assert(at_ < numbers_.size());
    return numbers_[at_++];
  }
  /// Reads a vector that put_all wrote; resizes v.
  template <class V>
  void get_all(V& v) const {
    v.resize(static_cast<decltype(v.size())>(get()));
    for (decltype(v.size()) i = 0; i < v.size(); ++i) v[i] = get();
  }
  void rewind() const { at_ = 0; }             ///< the next get() returns the first number again
  void clear() { numbers_.clear(), at_ = 0; }  ///< removes all numbers

 private:
  std::vector<double> numbers_;
  mutable std::size_t at_ = 0;
};

}  // namespace lockstep
