// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/deflate.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <zlib.h>

namespace sonard::glf {
namespace {

/// Maximum ratio of deflate: 258 bytes from two codes of one bit each.
constexpr std::uint64_t max_deflate_ratio = 1032;
constexpr std::size_t zlib_step = std::size_t{1} << 30;  // zlib's counters have 32 bits

}  // namespace

void Crc32::add(std::span<const std::uint8_t> bytes) {
  value_ = static_cast<std::uint32_t>(crc32_z(value_, bytes.data(), bytes.size()));
}

std::optional<Bytes> deflate_shorter(std::span<const std::uint8_t> bytes, int level) {
  if (level < Z_NO_COMPRESSION || level > Z_BEST_COMPRESSION) {
    throw std::invalid_argument("zlib level out of 0..9");
  }
  if (bytes.empty()) {
    return std::nullopt;
  }
  // The buffer has room only for a shorter result; otherwise zlib returns an error.
  Bytes packed(bytes.size() - 1);
  uLongf size = packed.size();
  if (compress2(packed.data(), &size, bytes.data(), bytes.size(), level) != Z_OK) {
    return std::nullopt;
  }
  packed.resize(size);
  return packed;
}

std::optional<Bytes> inflate_exactly(std::span<const std::uint8_t> stream, std::uint64_t size,
                                     DeflateForm form) {
  if (size > max_deflate_ratio * stream.size()) {
    return std::nullopt;
  }
  Bytes out(size);
  z_stream state{};
  if (inflateInit2(&state, form == DeflateForm::zlib ? MAX_WBITS : -MAX_WBITS) != Z_OK) {
    throw std::bad_alloc();
  }
  std::uint8_t none = 0;  // zlib requires an address even if there is nothing to write
  state.next_out = out.empty() ? &none : out.data();
  state.next_in = const_cast<Bytef*>(stream.data());  // zlib's interface is older than const
  std::size_t in_left = stream.size();
  std::size_t out_left = out.size();
  int result = Z_OK;
  while (result == Z_OK) {
    state.avail_in = static_cast<uInt>(std::min(in_left, zlib_step));
    state.avail_out = static_cast<uInt>(std::min(out_left, zlib_step));
    in_left -= state.avail_in;
    out_left -= state.avail_out;
    result = inflate(&state, Z_NO_FLUSH);
    in_left += state.avail_in;
    out_left += state.avail_out;
  }
  inflateEnd(&state);
  if (result != Z_STREAM_END || out_left != 0) {
    return std::nullopt;
  }
  return out;
}

Bytes inflate_front(std::span<const std::uint8_t> stream, std::uint64_t max_size) {
  z_stream state{};
  if (inflateInit2(&state, -MAX_WBITS) != Z_OK) {
    throw std::bad_alloc();
  }
  Bytes out;
  Bytes window(std::size_t{1} << 16);
  state.next_in = const_cast<Bytef*>(stream.data());  // zlib's interface is older than const
  std::size_t in_left = stream.size();
  int result = Z_OK;
  while (result == Z_OK && out.size() < max_size) {
    state.avail_in = static_cast<uInt>(std::min(in_left, zlib_step));
    in_left -= state.avail_in;
    state.next_out = window.data();
    state.avail_out = static_cast<uInt>(std::min<std::uint64_t>(window.size(), max_size - out.size()));
    const std::size_t room = state.avail_out;
    result = inflate(&state, Z_NO_FLUSH);
    in_left += state.avail_in;
    out.insert(out.end(), window.begin(),
               window.begin() + static_cast<std::ptrdiff_t>(room - state.avail_out));
  }
  inflateEnd(&state);
  return out;
}

}  // namespace sonard::glf
