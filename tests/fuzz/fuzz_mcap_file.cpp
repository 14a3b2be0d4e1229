// SPDX-License-Identifier: Apache-2.0
// Any bytes as an MCAP file.
// Promises: errors and messages lie inside the file; log times never go back; a message is found again at its
// place; a recovered file is whole and has as many messages as its summary counts.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "protocol/mcap/reader.hpp"
#include "protocol/mcap/recovery.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::mcap;
using sonard::fuzz::require;

/// @return the number of messages before the end or an error
std::uint64_t read_all(const Reader& reader, ByteView file) {
  MessageCursor cursor = reader.messages();
  std::uint64_t count = 0;
  std::uint64_t last_time_ns = 0;
  while (const auto message = cursor.next()) {
    require(message->data.size() <= file.size(), "a message is no longer than the file");
    require(message->log_time_ns >= last_time_ns, "messages come in the order of their times");
    last_time_ns = message->log_time_ns;
    if (const auto place = cursor.place()) {
      const auto again = reader.data_at(*place);
      require(again && std::ranges::equal(*again, message->data), "a message is found again at its place");
    }
    ++count;
  }
  for (const auto& damaged : cursor.damaged()) {
    require(damaged.offset <= file.size() && damaged.error.offset <= file.size(),
            "damage lies inside the file");
  }
  return count;
}

void check_recovered(ByteView cut) {
  const auto recovery = recover(cut);
  if (!recovery) {
    require(recovery.error().offset <= cut.size(), "an error lies inside the file");
    return;
  }
  require(recovery->keep_size <= cut.size(), "what is kept was there");
  if (recovery->end.empty()) {
    return;  // the file has its own end, with any content
  }
  const ByteView kept = cut.first(static_cast<std::size_t>(recovery->keep_size));
  Bytes file{kept.begin(), kept.end()};
  file.insert(file.end(), recovery->end.begin(), recovery->end.end());
  const auto reader = Reader::open(file);
  require(reader.has_value() && reader->finished(), "a recovered file is whole");
  require(read_all(*reader, file) == recovery->summary.message_count(),
          "all messages of a recovered file are read");
}

void check_rebuilt(ByteView damaged) {
  const auto rebuilt = rebuild(damaged);
  if (!rebuilt) {
    require(rebuilt.error().offset <= damaged.size(), "an error lies inside the file");
    return;
  }
  Bytes file;
  for (const auto& part : rebuilt->parts) {
    require(part.offset <= damaged.size() && part.size <= damaged.size() - part.offset,
            "a kept part lies inside the file");
    const ByteView kept = damaged.subspan(part.offset, part.size);
    file.insert(file.end(), part.made.begin(), part.made.end());
    file.insert(file.end(), kept.begin(), kept.end());
  }
  const auto reader = Reader::open(file);
  require(reader.has_value() && reader->finished(), "a rebuilt file is whole");
  require(read_all(*reader, file) == rebuilt->summary.message_count(),
          "all messages of a rebuilt file are read");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ByteView file{data, size};
  if (const auto reader = Reader::open(file)) {
    read_all(*reader, file);
  }
  check_recovered(file);
  check_rebuilt(file);
  return 0;
}
