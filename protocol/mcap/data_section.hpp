// SPDX-License-Identifier: Apache-2.0
// Going through the data section of an MCAP file, record by record.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/common/damage.hpp"
#include "protocol/mcap/summary.hpp"

namespace sonard::mcap {

/// By channel, in the order of the chunk.
using MessageIndexes = std::map<std::uint16_t, std::vector<IndexEntry>>;

/// A chunk record taken apart: sizes and CRC are right and every record in it is whole and readable.
struct Chunk {
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
  std::vector<Message> messages;         ///< their data view `records`
  ByteView records;                      ///< in the file, or in `storage`
  std::shared_ptr<const Bytes> storage;  ///< null where nothing had to be unpacked
  std::string compression;
  std::uint64_t stored_size = 0;
  MessageIndexes indexes;
  std::uint64_t start_time_ns = 0;  ///< earliest log time; 0 when there is no message
  std::uint64_t end_time_ns = 0;    ///< latest log time; 0 when there is no message
  std::uint64_t records_size = 0;
  bool has_unknown_records = false;  ///< of types that do not belong into a chunk
};

/// Bytes of a chunk before its records, but for the name of the compression.
inline constexpr std::size_t chunk_start_size = record_prefix_size + 8 + 8 + 8 + 4 + 4 + 8;
/// Checksum field of an open chunk, which may still grow and whose length field may be out of date.
inline constexpr std::uint32_t no_crc = 0;

/// Requires record.is(Opcode::chunk). One that is compressed otherwise than with Zstandard is an error.
Result<Chunk, WireError> read_chunk(const Record& record);

/// Reads the records in a chunk. Offsets in errors are relative to `records`.
Result<Chunk, WireError> read_chunk_records(ByteView records);

/// The whole records of the open chunk that begins at `offset`, however long it says that it is; nullopt when
/// none begins there, or it has none.
std::optional<ByteView> open_chunk_records(ByteView file, std::size_t offset);

/// Schemas and channels that are new, and the number of messages.
void add_contents(const Chunk& chunk, Summary& summary);

/// A part of the data section that cannot be read.
struct DamagedChunk : Damage {
  /// By channel, from the message indexes behind the chunk; empty when these cannot be read either.
  std::map<std::uint16_t, std::uint64_t> lost_messages;
  bool holds_messages = true;  ///< false: a header, schema, channel or index, so no message is lost
};

/// What a scan of a file finds.
struct DataSection {
  Summary summary;
  std::size_t end = 0;  ///< where the whole records end: of DataEnd, or of the first that is not whole
  bool ended = false;   ///< DataEnd stands at `end`
  std::size_t last_chunk_end = 0;  ///< without its message indexes; 0 when there is no chunk
  MessageIndexes last_indexes;     ///< what the last chunk's message indexes are
  bool last_chunk_open = false;    ///< it has no CRC
  /// Why it went no further, when neither DataEnd nor the end of the bytes stopped it. What follows is not
  /// lost to a reader that knows better.
  std::optional<WireError> error;
  std::vector<DamagedChunk> damaged;  ///< parts that were skipped (OnDamage::skip)
};

/// Reads all of it, from the magic on. An error when not even magic and header are whole, or are no MCAP
/// file's. A message outside of a chunk ends the whole part, as a record that cannot be read does.
/// OnDamage::skip goes on with the next record or chunk that is consistent, and lists what it skipped.
Result<DataSection, WireError> scan_data_section(ByteView file, OnDamage on_damage = OnDamage::stop);

/// Number of messages by channel, by the message indexes that `index` names; those that cannot be read are
/// left out.
std::map<std::uint16_t, std::uint64_t> indexed_messages(ByteView file, const ChunkIndex& index);

}  // namespace sonard::mcap
