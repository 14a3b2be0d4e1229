// SPDX-License-Identifier: Apache-2.0
// Values as bytes between a reader's child process and this process. Both run this program: host byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace sonard::render {

class BlobWriter {
 public:
  template <typename T>
  void put(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    put_sized(values.data(), values.size(), sizeof(T));
  }
  void put(const std::string& text) { put_sized(text.data(), text.size(), 1); }
  void put(std::uint64_t value) { append(&value, sizeof value); }

  std::string take() { return std::move(bytes_); }

 private:
  void put_sized(const void* data, std::size_t count, std::size_t element_size) {
    put(static_cast<std::uint64_t>(count));
    append(data, count * element_size);
  }
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  std::string bytes_;
};

/// Throws std::runtime_error if the bytes end early: a reader that damaged its own memory may return any
/// bytes.
class BlobReader {
 public:
  explicit BlobReader(const std::string& bytes) : bytes_(bytes) {}

  std::uint64_t get_number() {
    std::uint64_t value = 0;
    copy(&value, sizeof value);
    return value;
  }
  template <typename T>
  std::vector<T> get_vector() {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::uint64_t count = checked_count(sizeof(T));
    std::vector<T> values(count);
    copy(values.data(), count * sizeof(T));
    return values;
  }
  std::string get_string() {
    std::string text(checked_count(1), '\0');
    copy(text.data(), text.size());
    return text;
  }

 private:
  std::uint64_t checked_count(std::size_t element_size) {
    const std::uint64_t count = get_number();
    if (count > (bytes_.size() - at_) / element_size) {
      throw std::runtime_error("the reader returned a damaged result");
    }
    return count;
  }
  void copy(void* to, std::size_t size) {
    if (size > bytes_.size() - at_) {
      throw std::runtime_error("the reader returned a damaged result");
    }
    if (size > 0) {
      std::memcpy(to, bytes_.data() + at_, size);
      at_ += size;
    }
  }

  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace sonard::render
