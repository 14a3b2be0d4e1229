// SPDX-License-Identifier: Apache-2.0
// Small MCAP files for tests.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "protocol/mcap/reader.hpp"
#include "protocol/mcap/recovery.hpp"
#include "protocol/mcap/writer.hpp"

namespace sonard::mcap::testing {

inline void append(Bytes& out, const Bytes& more) {
  out.insert(out.end(), more.begin(), more.end());
}

/// A file in memory, as Piece::apply_to() changes it.
struct FileInMemory {
  Bytes bytes;

  void append(ByteView more) { bytes.insert(bytes.end(), more.begin(), more.end()); }
  void overwrite(std::uint64_t offset, ByteView by) {
    std::ranges::copy(by, bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  void truncate(std::uint64_t size) { bytes.resize(static_cast<std::size_t>(size)); }
};

inline Bytes bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

/// The file that rebuild() describes.
inline Bytes rebuilt_file(const Bytes& damaged, const Rebuilt& rebuilt) {
  Bytes file;
  for (const RebuiltPart& part : rebuilt.parts) {
    append(file, part.made);
    const auto kept = ByteView{damaged}.subspan(part.offset, part.size);
    file.insert(file.end(), kept.begin(), kept.end());
  }
  return file;
}

/// A message that a reader must return.
struct Said {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;
  std::string data;

  bool operator==(const Said&) const = default;
};

/// Two channels, seven messages in three chunks that overlap in time.
inline Bytes finished_file() {
  Writer writer{"test", 100'000};
  const auto schema = writer.add_schema("S", "protobuf", bytes_of("descriptor"));
  const auto a = writer.add_channel(schema, "/a", "protobuf", {{"head", "bow"}});
  writer.add_message(a, 50, 49, bytes_of("a0"));
  writer.add_message(a, 10, 9, bytes_of("a1"));
  writer.end_chunk();
  const auto b = writer.add_channel(schema, "/b", "protobuf");
  writer.add_message(b, 30, 30, bytes_of("b0"));
  writer.add_message(a, 60, 60, bytes_of("a2"));
  writer.add_message(b, 50, 50, bytes_of("b1"));
  writer.end_chunk();
  writer.add_message(b, 40, 40, bytes_of("b2"));
  writer.add_message(b, 70, 70, bytes_of(""));
  writer.finish();
  return writer.take().append;
}

inline const std::vector<Said> messages_in_order{{1, 1, 10, "a1"}, {2, 0, 30, "b0"}, {2, 2, 40, "b2"},
                                                 {1, 0, 50, "a0"}, {2, 1, 50, "b1"}, {1, 2, 60, "a2"},
                                                 {2, 3, 70, ""}};

inline std::vector<Said> all_of(MessageCursor cursor) {
  std::vector<Said> all;
  while (const auto message = cursor.next()) {
    all.push_back({message->channel_id, message->sequence, message->log_time_ns,
                   std::string{message->data.begin(), message->data.end()}});
  }
  return all;
}

}  // namespace sonard::mcap::testing
