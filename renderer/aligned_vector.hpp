// SPDX-License-Identifier: Apache-2.0
// Vectors whose memory starts on a cache line, for wide vector loads.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace sonard::render {

constexpr std::size_t cache_line_bytes = 64;

template <class T>
struct CacheLineAllocator {
  using value_type = T;

  CacheLineAllocator() = default;
  template <class U>
  explicit CacheLineAllocator(const CacheLineAllocator<U>&) {}

  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{cache_line_bytes}));
  }
  void deallocate(T* memory, std::size_t) noexcept {
    ::operator delete (memory, std::align_val_t{cache_line_bytes});
  }
  template <class U>
  bool operator==(const CacheLineAllocator<U>&) const {
    return true;
  }
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

/// The smallest number of floats that fills whole cache lines and is at least `count`. As a stride it keeps
/// every row of a table aligned.
constexpr int aligned_stride(int count) {
  constexpr int floats = static_cast<int>(cache_line_bytes / sizeof(float));
  return (count + floats - 1) / floats * floats;
}

}  // namespace sonard::render
