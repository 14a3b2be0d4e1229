// SPDX-License-Identifier: Apache-2.0
// The summary of an MCAP file: collected by the writer, read from the end of a finished file, or restored by
// a scan of an unfinished file.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "protocol/mcap/records.hpp"

namespace sonard::mcap {

struct Summary {
  std::vector<Schema> schemas;     ///< in the order they were written; ids are unique
  std::vector<Channel> channels;   ///< in the order they were written; ids are unique
  std::vector<ChunkIndex> chunks;  ///< in the order of the file
  std::map<std::uint16_t, std::uint64_t>
      message_counts;  ///< by channel, without channels that have no messages

  std::uint64_t message_count() const;
  std::uint64_t start_time_ns() const;  ///< earliest log time of the file; 0 if it has no message
  std::uint64_t end_time_ns() const;    ///< latest log time of the file; 0 if it has no message
  const Channel* channel(std::uint16_t id) const;
  const Schema* schema(std::uint16_t id) const;

  bool operator==(const Summary&) const = default;
};

/// Adds a schema or channel unless its id is known.
void add_once(Summary& summary, Schema schema);
void add_once(Summary& summary, Channel channel);

/// The end of a file: DataEnd, the repeated schemas and channels, statistics, chunk indexes, summary offsets,
/// footer and magic. `offset` is its position in the file, `data_crc` the CRC32 of all bytes before it.
Bytes make_end(const Summary& summary, std::uint64_t offset, std::uint32_t data_crc);

/// The summary at the end of a file; an error if the file is not finished or the summary is invalid. The
/// start of the file may be damaged.
Result<Summary, WireError> read_summary(ByteView file);

}  // namespace sonard::mcap
