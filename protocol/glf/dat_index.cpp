// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/dat_index.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/glf/headers.hpp"

namespace sonard::glf {
namespace {

using Front = std::array<std::uint8_t, ci_header_size + image_header_size>;

/// Copies the bytes at `offset` to `front`, fewer near the end; returns the copied part.
std::span<const std::uint8_t> read_front(const PiecewiseBytes& dat, std::uint64_t offset, Front& front) {
  const auto bytes = std::span{front}.first(std::min<std::uint64_t>(front.size(), dat.size() - offset));
  dat.copy(offset, bytes);
  return bytes;
}

WireError moved(WireError error, std::uint64_t offset) {
  error.offset += offset;
  return error;
}

bool terminator_at(const PiecewiseBytes& dat, std::uint64_t offset) {
  std::array<std::uint8_t, dat_terminator.size()> bytes{};
  if (dat.size() - offset != bytes.size()) {
    return false;
  }
  dat.copy(offset, bytes);
  return bytes == dat_terminator;
}

/// Size of the image after the header that `reader` has passed, from the image's own fields, because other
/// programs write a wrong length into the header.
Result<std::uint64_t, WireError> image_size(const PiecewiseBytes& dat, std::uint64_t offset,
                                            ByteReader& reader) {
  const ImageHeader image = read_image_header(reader);
  if (!reader.ok()) {
    return *reader.error();
  }
  const std::uint64_t size = reader.offset() + image.rest();
  if (size > dat.size() - offset) {
    return WireError{WireErrorReason::truncated, reader.offset(), "pixels"};
  }
  std::array<std::uint8_t, 3> end{};
  dat.copy(offset + size - end.size(), end);
  if (end[0] != 0) {
    return WireError{WireErrorReason::bad_value, size - 3, "acoustic_zoom"};
  }
  if ((end[1] | end[2] << 8) != image_end_tag) {
    return WireError{WireErrorReason::bad_value, size - 2, "end_tag"};
  }
  return size;
}

/// True if a header starts at `offset`, or the terminator ends the .dat there. Also checks two spare bytes
/// and the length, so that few other bytes pass.
bool goes_on_at(const PiecewiseBytes& dat, std::uint64_t offset) {
  Front front{};
  ByteReader reader{read_front(dat, offset, front)};
  const CiHeader header = read_ci_header(reader);
  const bool spare_is_zero = front[19] == 0 && front[20] == 0;
  return terminator_at(dat, offset) || (reader.ok() && header.length >= ci_header_size && spare_is_zero);
}

/// True if a whole image starts at `offset`, or a whole status that a record or the end follows.
bool record_starts_at(const PiecewiseBytes& dat, std::uint64_t offset) {
  Front front{};
  ByteReader reader{read_front(dat, offset, front)};
  const CiHeader header = read_ci_header(reader);
  const bool spare_is_zero = front[19] == 0 && front[20] == 0;
  if (!reader.ok() || header.version != CiHeader{}.version || !spare_is_zero) {
    return false;
  }
  if (header.type == static_cast<std::uint8_t>(RecordType::image)) {
    return image_size(dat, offset, reader).has_value();
  }
  const std::uint64_t end = offset + ci_header_size + status_body_size;
  return header.type == static_cast<std::uint8_t>(RecordType::status) && end <= dat.size() &&
         (end == dat.size() || goes_on_at(dat, end));
}

/// Offset of the next record after `offset`.
std::optional<std::uint64_t> next_record(const PiecewiseBytes& dat, std::uint64_t offset) {
  std::vector<std::uint8_t> window(std::size_t{1} << 16);
  for (std::uint64_t start = offset + 1; start < dat.size(); start += window.size()) {
    window.resize(static_cast<std::size_t>(std::min<std::uint64_t>(window.size(), dat.size() - start)));
    dat.copy(start, window);
    for (std::size_t i = 0; i < window.size(); ++i) {
      if (window[i] == record_id && record_starts_at(dat, start + i)) {
        return start + i;
      }
    }
  }
  return std::nullopt;
}

class Indexer {
 public:
  Indexer(const PiecewiseBytes& dat, OnDamage on_damage) : dat_(dat), on_damage_(on_damage) {}

  DatIndex run() {
    while (offset_ < dat_.size() && !terminator_at(dat_, offset_) && step()) {
    }
    index_.whole_size = offset_;
    index_.closed = offset_ < dat_.size() && terminator_at(dat_, offset_);
    index_.tail_size = index_.closed ? 0 : dat_.size() - offset_;
    return std::move(index_);
  }

 private:
  /// Steps over one record; false at the end.
  bool step() {
    Front front{};
    ByteReader reader{read_front(dat_, offset_, front)};
    const CiHeader header = read_ci_header(reader);
    if (!reader.ok()) {
      return stop(*reader.error());
    }
    switch (static_cast<RecordType>(header.type)) {
      case RecordType::image:
        return step_over_image(header, reader);
      case RecordType::status:
        return fits(ci_header_size + status_body_size)
                   ? take(header, ci_header_size + status_body_size)
                   : stop({WireErrorReason::truncated, ci_header_size, "status"});
    }
    if (const auto size = image_size(dat_, offset_, reader)) {
      skip_to(offset_ + *size, {WireErrorReason::bad_value, 14, "type"});  // an image with a damaged type
      return true;
    }
    if (header.length < ci_header_size) {
      return stop({WireErrorReason::bad_length, 2, "length"});
    }
    if (!fits(header.length)) {
      return stop({WireErrorReason::truncated, ci_header_size, "body"});
    }
    ++index_.other_records;
    offset_ += header.length;
    return true;
  }

  bool step_over_image(const CiHeader& header, ByteReader& reader) {
    const auto size = image_size(dat_, offset_, reader);
    if (size) {
      return take(header, *size);
    }
    // A damaged image does not hide the next record, if its length leads there. The length of a cut image
    // points beyond the end.
    if (header.length < ci_header_size || !fits(header.length) ||
        !goes_on_at(dat_, offset_ + header.length)) {
      return stop(size.error());
    }
    skip_to(offset_ + header.length, size.error());
    return true;
  }

  bool fits(std::uint64_t size) const { return size <= dat_.size() - offset_; }

  bool take(const CiHeader& header, std::uint64_t size) {
    index_.records.push_back({static_cast<RecordType>(header.type), header.origin(), offset_, size});
    offset_ += size;
    return true;
  }

  void skip_to(std::uint64_t next, const WireError& error) {
    index_.damaged.push_back({offset_, next - offset_, moved(error, offset_)});
    offset_ = next;
  }

  /// Records an error; true if a readable record follows.
  bool stop(const WireError& error) {
    const auto next = on_damage_ == OnDamage::skip ? next_record(dat_, offset_) : std::nullopt;
    if (next) {
      skip_to(*next, error);
    } else {
      index_.tail_error = moved(error, offset_);
    }
    return next.has_value();
  }

  const PiecewiseBytes& dat_;
  OnDamage on_damage_;
  std::uint64_t offset_ = 0;
  DatIndex index_;
};

}  // namespace

DatIndex index_dat(const PiecewiseBytes& dat, OnDamage on_damage) {
  return Indexer{dat, on_damage}.run();
}

}  // namespace sonard::glf
