// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/ping_assembly.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "protocol/gemini/rle.hpp"

namespace sonard::gemini {
namespace {

constexpr int max_lines = 0x8000;  // line numbers have 15 bits
constexpr int max_beams = 1024;    // a line is one datagram

}  // namespace

bool is_receivable(const PingHead& head) {
  const bool magnitudes = (head.ext_mode & ext_bits::data_type_mask) == 0;
  return magnitudes && head.beams > 0 && head.beams <= max_beams && head.line_count() > 0 &&
         head.line_count() <= max_lines;
}

void PingAssembly::set_head(const PingHead& head) {
  assert(!head_ && is_receivable(head));
  head_ = head;
  const auto lines = static_cast<std::size_t>(head.line_count());
  const auto samples = lines * head.beams;
  if (head.eight_bit()) {
    samples_.u8.assign(samples, 0);
  } else {
    samples_.u16.assign(samples, 0);
  }
  // Count again: a waiting line counts only if its content can be decoded.
  received_.assign(lines, false);
  lines_received_ = 0;
  for (const Waiting& line : std::exchange(waiting_, {})) {
    if (line.number < head.line_count() && store(line.number, line.data)) {
      mark(line.number);
    }
  }
}

PingAssembly::Added PingAssembly::add_line(const PingLine& line) {
  const int number = line.line_number();
  if (has_line(number)) {
    return Added::duplicate;
  }
  if (!head_) {
    waiting_.push_back({number, {line.data.begin(), line.data.end()}});
    mark(number);
    return Added::fresh;
  }
  if (number >= line_count() || !store(number, line.data)) {
    return Added::unusable;
  }
  mark(number);
  return Added::fresh;
}

bool PingAssembly::has_line(int number) const {
  const auto index = static_cast<std::size_t>(number);
  return index < received_.size() && received_[index];
}

std::vector<LineRange> PingAssembly::missing(int from, int to) const {
  std::vector<LineRange> ranges;
  for (int number = from; number < to; ++number) {
    if (has_line(number)) {
      continue;
    }
    if (!ranges.empty() && ranges.back().first + ranges.back().count == number) {
      ++ranges.back().count;
    } else {
      ranges.push_back({number, 1});
    }
  }
  return ranges;
}

ReceivedSamples PingAssembly::take_samples() {
  return std::move(samples_);
}

bool PingAssembly::store(int number, std::span<const std::uint8_t> data) {
  const std::size_t beams = head_->beams;
  const std::size_t first = static_cast<std::size_t>(number) * beams;
  if (!head_->eight_bit()) {
    if (data.size() < 2 * beams) {
      return false;
    }
    for (std::size_t beam = 0; beam < beams; ++beam) {
      samples_.u16[first + beam] = static_cast<std::uint16_t>(data[2 * beam] << 8 | data[2 * beam + 1]);
    }
    return true;
  }
  const std::span<std::uint8_t> out{samples_.u8.data() + first, beams};
  if (head_->rle_threshold > 0) {
    return rle_decode(data, out) == beams;
  }
  if (data.size() < beams) {
    return false;
  }
  std::copy_n(data.begin(), beams, out.begin());
  return true;
}

void PingAssembly::mark(int number) {
  const auto index = static_cast<std::size_t>(number);
  if (index >= received_.size()) {
    received_.resize(index + 1, false);
  }
  received_[index] = true;
  ++lines_received_;
}

}  // namespace sonard::gemini
