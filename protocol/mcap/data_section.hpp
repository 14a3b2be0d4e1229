// SPDX-License-Identifier: Apache-2.0
// Scans the data section of an MCAP file, record by record.
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

/// Index entries by channel, in the order of the chunk.
using MessageIndexes = std::map<std::uint16_t, std::vector<IndexEntry>>;

/// The contents of a chunk record with correct sizes and CRC, in which every record is whole and readable.
struct Chunk {
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
  std::vector<Message> messages;         ///< their data view `records`
  ByteView records;                      ///< view of the file or of `storage`
  std::shared_ptr<const Bytes> storage;  ///< null if the chunk is not compressed
  std::string compression;
  std::uint64_t stored_size = 0;
  MessageIndexes indexes;
  std::uint64_t start_time_ns = 0;  ///< earliest log time; 0 if there is no message
  std::uint64_t end_time_ns = 0;    ///< latest log time; 0 if there is no message
  std::uint64_t records_size = 0;
  bool has_unknown_records = false;  ///< it has records of types that do not belong into a chunk
};

/// Bytes of a chunk before its records, without the name of the compression.
inline constexpr std::size_t chunk_start_size = record_prefix_size + 8 + 8 + 8 + 4 + 4 + 8;
/// Checksum of an open chunk, which may still grow and may have an outdated length.
inline constexpr std::uint32_t no_crc = 0;

/// Reads a chunk. Requires record.is(Opcode::chunk). Any compression other than Zstandard is an error.
Result<Chunk, WireError> read_chunk(const Record& record);

/// Reads the records in a chunk. Offsets in errors are relative to `records`.
Result<Chunk, WireError> read_chunk_records(ByteView records);

/// The whole records of the open chunk at `offset`, for any stated length; nullopt if there is no open
/// chunk or if it has no whole record.
std::optional<ByteView> open_chunk_records(ByteView file, std::size_t offset);

/// Adds new schemas and channels and the number of messages to `summary`.
void add_contents(const Chunk& chunk, Summary& summary);

/// What an unreadable part of the data section held.
enum class Holds : std::uint8_t {
  chunk,       ///< a chunk, whose message indexes may follow
  messages,    ///< a part of an open chunk
  no_message,  ///< a header, schema, channel or index
  unknown,     ///< perhaps chunks
};

/// An unreadable part of the data section.
struct DamagedChunk : Damage {
  /// By channel, from the message indexes after the chunk; empty if these are unreadable, too.
  std::map<std::uint16_t, std::uint64_t> lost_messages;
  Holds holds = Holds::chunk;
};

/// Result of a scan of a file.
struct DataSection {
  Summary summary;
  std::size_t end = 0;  ///< end of the whole records: offset of DataEnd or of the first unreadable record
  bool ended = false;   ///< there is a DataEnd at `end`
  std::size_t last_chunk_end = 0;  ///< without its message indexes; 0 if there is no chunk
  MessageIndexes last_indexes;
  bool last_chunk_open = false;  ///< the last chunk has no CRC
  /// Why the scan stopped before DataEnd or the end of the bytes. Other readers may be able to read the rest.
  std::optional<WireError> error;
  std::vector<DamagedChunk> damaged;  ///< parts that were skipped (OnDamage::skip)
};

/// Scans the data section from the magic on. Returns an error if magic or header are incomplete or not MCAP.
/// A message outside a chunk or an unreadable record stops the scan. OnDamage::skip continues with the next
/// consistent record or chunk, and lists the skipped parts, also at the start. It returns an error only if
/// the file does not begin as MCAP and holds no chunk.
Result<DataSection, WireError> scan_data_section(ByteView file, OnDamage on_damage = OnDamage::stop);

/// The bytes before the first readable record, if the magic is not whole or no header follows it; nullopt if
/// the start is whole, or if there is no readable record.
std::optional<DamagedChunk> damaged_start(ByteView file);

/// Number of messages by channel, from the message indexes in `index`, without unreadable ones.
std::map<std::uint16_t, std::uint64_t> indexed_messages(ByteView file, const ChunkIndex& index);

}  // namespace sonard::mcap
