// SPDX-License-Identifier: Apache-2.0
// Bytes of a datagram in memory that several datagrams share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace sonard {

/// A view of constant bytes that keeps them alive as long as any copy exists, even without the device that
/// made them. A copy costs one reference count, so the lines of a ping share one buffer without an allocation
/// per line. Converts to std::span<const std::uint8_t>. Copies may cross threads.
class SharedBytes {
 public:
  SharedBytes() = default;
  /// Takes ownership of a whole buffer.
  explicit SharedBytes(std::vector<std::uint8_t> bytes)
      : storage_(std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes))), view_(*storage_) {}
  /// Views a part of a shared buffer. Requires offset + size <= storage->size().
  SharedBytes(std::shared_ptr<const std::vector<std::uint8_t>> storage, std::size_t offset, std::size_t size)
      : storage_(std::move(storage)), view_(std::span(*storage_).subspan(offset, size)) {}

  const std::uint8_t* data() const { return view_.data(); }
  std::size_t size() const { return view_.size(); }
  const std::uint8_t* begin() const { return data(); }
  const std::uint8_t* end() const { return data() + size(); }
  std::uint8_t operator[](std::size_t index) const { return view_[index]; }

 private:
  std::shared_ptr<const std::vector<std::uint8_t>> storage_;
  std::span<const std::uint8_t> view_;
};

}  // namespace sonard
