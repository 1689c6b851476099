// Aligned buffers, and the numbers that an integrator saves.
#pragma once

#include <cassert>
#include <cstddef>
#include <new>
#include <vector>

namespace lockstep {

// Aligned: a vector whose first number stands at a boundary that the widest vector registers like.


/// Memory that is aligned for the widest vector registers.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};
  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kAlignment); }
  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

template <class T>
using Aligned = std::vector<T, AlignedAllocator<T>>;


// Snapshot: numbers saved in order and restored in the same order; what an integrator keeps beside the State.


/// The numbers that an integrator saves and restores.
class Snapshot {
 public:
  void put(double x) { numbers_.push_back(x); }
  template <class V>
  void put_all(const V& v) {
    put(static_cast<double>(v.size()));
    for (decltype(v.size()) i = 0; i < v.size(); ++i) put(v[i]);
  }
  double get() const {
    assert(at_ < numbers_.size());
    return numbers_[at_++];
  }
  template <class V>
  void get_all(V& v) const {
    v.resize(static_cast<decltype(v.size())>(get()));
    for (decltype(v.size()) i = 0; i < v.size(); ++i) v[i] = get();
  }
  void rewind() const { at_ = 0; }
  void clear() { numbers_.clear(), at_ = 0; }

 private:
  std::vector<double> numbers_;
  mutable std::size_t at_ = 0;
};

}  // namespace lockstep
