// SPDX-License-Identifier: Apache-2.0
#include "protocol/mavlink/frames.hpp"

#include "protocol/common/byte_reader.hpp"
#include "protocol/mavlink/checksum.hpp"

namespace sonard::mavlink {
namespace {

constexpr std::uint8_t magic_1 = 0xFE;
constexpr std::uint8_t magic_2 = 0xFD;
constexpr std::uint8_t flag_signed = 0x01;
constexpr std::size_t signature_size = 13;

bool is_magic(std::uint8_t byte) {
  return byte == magic_1 || byte == magic_2;
}

/// A possible frame: its header is plausible, and all of its bytes are there.
struct Candidate {
  Frame frame;
  std::uint8_t incompatible_flags = 0;
  std::span<const std::uint8_t> checked;  ///< covered by the checksum: all between magic and checksum
  std::uint16_t checksum = 0;
  std::size_t size = 0;
};

void read_header(ByteReader& reader, Candidate& candidate) {
  Frame& frame = candidate.frame;
  if (frame.version == 2) {
    candidate.incompatible_flags = reader.u8("incompat_flags");
    reader.skip(1, "compat_flags");
  }
  frame.sequence = reader.u8("seq");
  frame.system_id = reader.u8("sysid");
  frame.component_id = reader.u8("compid");
  frame.message_id = static_cast<std::uint32_t>(reader.little_endian(frame.version == 2 ? 3 : 1, "msgid"));
}

std::optional<Candidate> candidate_at_front(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  const std::uint8_t magic = reader.u8("magic");
  if (!is_magic(magic)) {
    return std::nullopt;
  }
  Candidate candidate;
  candidate.frame.version = magic == magic_1 ? 1 : 2;
  const std::size_t payload_size = reader.u8("len");
  read_header(reader, candidate);
  candidate.frame.payload = reader.bytes(payload_size, "payload");
  const std::size_t checked_end = reader.offset();
  candidate.checksum = reader.u16le("checksum");
  if ((candidate.incompatible_flags & flag_signed) != 0) {
    reader.skip(signature_size, "signature");
  }
  if (!reader.ok()) {
    return std::nullopt;
  }
  candidate.checked = bytes.subspan(1, checked_end - 1);
  candidate.size = reader.offset();
  candidate.frame.kind = kind_of(candidate.frame.message_id);
  return candidate;
}

enum class Verdict { good, bad_checksum, unknown_flags, no_frame };

Verdict verdict_of(const Candidate& candidate, std::span<const std::uint8_t> bytes) {
  if ((candidate.incompatible_flags & ~flag_signed) != 0) {
    return Verdict::unknown_flags;
  }
  if (candidate.frame.kind != nullptr) {
    const bool same = checksum(candidate.checked, candidate.frame.kind->seed) == candidate.checksum;
    return same ? Verdict::good : Verdict::bad_checksum;
  }
  const bool fits = candidate.size == bytes.size() || is_magic(bytes[candidate.size]);
  return fits ? Verdict::good : Verdict::no_frame;
}

}  // namespace

std::optional<Frame> FrameReader::next() {
  while (!rest_.empty()) {
    const std::optional<Candidate> candidate = candidate_at_front(rest_);
    const Verdict verdict = candidate ? verdict_of(*candidate, rest_) : Verdict::no_frame;
    if (verdict == Verdict::good) {
      rest_ = rest_.subspan(candidate->size);
      ++counters_.frames;
      return candidate->frame;
    }
    counters_.bad_checksums += verdict == Verdict::bad_checksum ? 1 : 0;
    counters_.unknown_flags += verdict == Verdict::unknown_flags ? 1 : 0;
    ++counters_.stray_bytes;
    rest_ = rest_.subspan(1);
  }
  return std::nullopt;
}

}  // namespace sonard::mavlink
