// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/encoded_ping.hpp"

#include <array>
#include <span>
#include <utility>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/rle.hpp"

namespace sonard::gemini {

namespace {

constexpr std::size_t line_header_size = 16;
constexpr std::uint16_t resent_head_bit = 0x0100;  // bit of PingHead::ping_id

/// Samples of single lines, encoded as in PingLine::data.
class LineSamples {
 public:
  LineSamples(const PingHead& head, const PingImage& image) : head_(head), image_(image) {}

  /// Valid until the next call.
  std::span<const std::uint8_t> line(int number) {
    const std::size_t first = static_cast<std::size_t>(number) * beam_count;
    if (!head_.eight_bit()) {
      return big_endian(std::span(image_.u16).subspan(first, beam_count));
    }
    const auto beams = std::span(image_.u8).subspan(first, beam_count);
    if (head_.rle_threshold == 0) {
      return beams;
    }
    scratch_.clear();
    rle_encode(beams, head_.rle_threshold, scratch_);
    return scratch_;
  }

 private:
  std::span<const std::uint8_t> big_endian(std::span<const std::uint16_t> beams) {
    scratch_.clear();
    for (const std::uint16_t sample : beams) {
      scratch_.push_back(static_cast<std::uint8_t>(sample >> 8));
      scratch_.push_back(static_cast<std::uint8_t>(sample & 0xFF));
    }
    return scratch_;
  }

  const PingHead& head_;
  const PingImage& image_;
  std::vector<std::uint8_t> scratch_;
};

}  // namespace

bool fits(const PingImage& image, const PingJob& job) {
  const std::size_t samples = static_cast<std::size_t>(job.bins()) * beam_count;
  return job.sixteen_bit ? image.u16.size() == samples && image.u8.empty()
                         : image.u8.size() == samples && image.u16.empty();
}

EncodedPing::EncodedPing(const PingHead& head, std::uint16_t line_scale, const PingImage& image)
    : head_(head), line_scale_(line_scale) {
  const auto lines = static_cast<std::size_t>(line_count());
  const std::size_t sample_size = head_.eight_bit() ? 1 : 2;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(64 + lines * (line_header_size + sample_size * beam_count));
  offsets_.reserve(lines + 3);
  const auto mark = [&] { offsets_.push_back(static_cast<std::uint32_t>(bytes.size())); };

  mark();
  encode(Report{head_}, bytes);
  LineSamples samples(head_, image);
  for (int number = 0; number < line_count(); ++number) {
    mark();
    encode(Report{make_line(number, samples.line(number))}, bytes);
  }
  mark();
  encode(Report{make_tail()}, bytes);
  mark();
  bytes_ = std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes));
}

SharedBytes EncodedPing::datagram(int index) const {
  const auto i = static_cast<std::size_t>(index);
  return {bytes_, offsets_[i], offsets_[i + 1] - offsets_[i]};
}

SharedBytes EncodedPing::resent_head() const {
  PingHead head = head_;
  head.ping_id |= resent_head_bit;
  return SharedBytes(encode(Report{head}));
}

SharedBytes EncodedPing::resent_line(int number) const {
  const SharedBytes original = datagram(1 + number);
  PingLine line = make_line(number, std::span(original.data(), original.size()).subspan(line_header_size));
  line.line_id |= gemini::resent_line;
  return SharedBytes(encode(Report{line}));
}

SharedBytes EncodedPing::resent_tail() const {
  PingTail tail = make_tail();
  tail.flags |= gemini::resent_tail;
  return SharedBytes(encode(Report{tail}));
}

PingLine EncodedPing::make_line(int number, std::span<const std::uint8_t> data) const {
  PingLine line;
  line.header = head_.header;
  line.ping_id = static_cast<std::uint8_t>(head_.ping_id & 0xFF);
  line.line_id = static_cast<std::uint16_t>(number);
  line.scale = line_scale_;
  line.line_info = make_line_info(data.size(), number + 1 == line_count(), head_.ext_mode);
  line.data = data;
  return line;
}

PingTail EncodedPing::make_tail() const {
  PingTail tail;
  tail.header = head_.header;
  tail.ping_id = static_cast<std::uint8_t>(head_.ping_id & 0xFF);
  return tail;
}

}  // namespace sonard::gemini
