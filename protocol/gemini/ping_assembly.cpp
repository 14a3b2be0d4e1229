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
  (head.eight_bit() ? samples_.u8.resize(lines * head.beams) : samples_.u16.resize(lines * head.beams));
  received_.assign(lines, false);
  for (const auto& [number, data] : std::exchange(waiting_, {})) {
    store(number, data);
  }
}

PingAssembly::Added PingAssembly::add_line(const PingLine& line) {
  const int number = line.line_number();
  if (has_line(number)) {
    return Added::duplicate;
  }
  if (!head_) {
    waiting_.emplace(number, std::vector(line.data.begin(), line.data.end()));
    return Added::fresh;
  }
  return store(number, line.data) ? Added::fresh : Added::unusable;
}

bool PingAssembly::has_line(int number) const {
  const auto index = static_cast<std::size_t>(number);
  return head_ ? index < received_.size() && received_[index] : waiting_.contains(number);
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

bool PingAssembly::store(int number, std::span<const std::uint8_t> data) {
  const std::size_t beams = head_->beams;
  const bool coded = head_->eight_bit() && head_->rle_threshold > 0;
  if (number >= line_count() || (!coded && data.size() < (head_->eight_bit() ? 1 : 2) * beams)) {
    return false;
  }
  const std::size_t first = static_cast<std::size_t>(number) * beams;
  if (coded) {
    if (rle_decode(data, std::span(samples_.u8).subspan(first, beams)) != beams) {
      return false;
    }
  } else if (head_->eight_bit()) {
    std::copy_n(data.begin(), beams, samples_.u8.begin() + static_cast<std::ptrdiff_t>(first));
  } else {
    for (std::size_t beam = 0; beam < beams; ++beam) {
      samples_.u16[first + beam] = static_cast<std::uint16_t>(data[2 * beam] << 8 | data[2 * beam + 1]);
    }
  }
  received_[static_cast<std::size_t>(number)] = true;
  ++lines_received_;
  return true;
}

}  // namespace sonard::gemini
