// SPDX-License-Identifier: Apache-2.0
// The records of MCAP files that sonard writes and reads: bytes <-> values.
// Source: the MCAP specification, mcap.dev/spec, section numbers by record name. A file is
//   magic, Header, data section (here: chunks, each followed by its message indexes), DataEnd, summary,
//   Footer, magic
// and every record is an opcode, the length of its content in 64 bits, and the content. Integers are
// little-endian; times are nanoseconds since the Unix epoch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/byte_reader.hpp"
#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"

namespace sonard::mcap {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// At both ends of a file: 0x89, "MCAP", major version '0', CR LF.
inline constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t record_prefix_size = 9;  ///< opcode and length

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  statistics = 0x0B,
  metadata = 0x0C,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// Format of the messages of a channel.
struct Schema {
  std::uint16_t id = 0;  ///< unique in a file, not 0
  std::string name;      ///< for "protobuf" the full name of the message
  std::string encoding;  ///< "protobuf": `data` is a serialised FileDescriptorSet with all imported files
  Bytes data;

  bool operator==(const Schema&) const = default;
};

/// A stream of messages with one schema.
struct Channel {
  std::uint16_t id = 0;  ///< unique in a file
  std::uint16_t schema_id = 0;
  std::string topic;
  std::string message_encoding;
  std::map<std::string, std::string> metadata;

  bool operator==(const Channel&) const = default;
};

struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;         ///< counts the messages of a channel
  std::uint64_t log_time_ns = 0;      ///< time of recording
  std::uint64_t publish_time_ns = 0;  ///< time for which the content is valid
  ByteView data;                      ///< not owned
};

/// Position of a message in the records of its chunk.
struct IndexEntry {
  std::uint64_t log_time_ns = 0;
  std::uint64_t offset = 0;

  bool operator==(const IndexEntry&) const = default;
};

/// Position of a chunk in the file, and of the message indexes after it.
struct ChunkIndex {
  std::uint64_t start_time_ns = 0;  ///< earliest log time; 0 if the chunk has no message
  std::uint64_t end_time_ns = 0;    ///< latest log time; 0 if the chunk has no message
  std::uint64_t offset = 0;         ///< of the chunk record in the file
  std::uint64_t length = 0;         ///< of the chunk record, with its prefix
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;  ///< by channel, in the file
  std::uint64_t message_index_length = 0;                        ///< total length of all message indexes
  std::uint64_t records_size = 0;                                ///< size of the unpacked records
  std::uint64_t stored_size = 0;                                 ///< size of the records in the file
  std::string compression{};                                     ///< empty: not compressed

  bool operator==(const ChunkIndex&) const = default;
};

struct Footer {
  std::uint64_t summary_start = 0;
  std::uint64_t summary_offset_start = 0;
  std::uint32_t summary_crc = 0;
};
inline constexpr std::size_t footer_record_size = record_prefix_size + 20;

/// CRC32 as in ZIP and PNG, of `bytes` after others with the CRC `before`.
std::uint32_t crc32(ByteView bytes, std::uint32_t before = 0);

// ---- Writing: each function appends one whole record.

void append_header(Bytes& out, std::string_view profile, std::string_view library);
void append(Bytes& out, const Schema& schema);
void append(Bytes& out, const Channel& channel);
void append(Bytes& out, const Message& message);
void append(Bytes& out, const ChunkIndex& index);
void append_message_index(Bytes& out, std::uint16_t channel_id, std::span<const IndexEntry> entries);

/// Writes an opcode, and its destructor fills in the length of the record.
class RecordScope {
 public:
  RecordScope(Bytes& out, Opcode opcode);
  ~RecordScope();
  RecordScope(const RecordScope&) = delete;
  RecordScope& operator=(const RecordScope&) = delete;

 private:
  Bytes& out_;
  std::size_t content_start_;
};

// ---- Reading. Offsets in errors are relative to the bytes of record_at(): the file or a chunk's records.

struct Record {
  std::uint8_t opcode = 0;  ///< Opcode or another value
  std::size_t offset = 0;   ///< of the opcode in the bytes of record_at()
  ByteView content;

  bool is(Opcode wanted) const { return opcode == static_cast<std::uint8_t>(wanted); }
  std::size_t content_offset() const { return offset + record_prefix_size; }
  std::size_t end() const { return content_offset() + content.size(); }
};

/// The record at `offset`; nullopt if the bytes end before the record does.
std::optional<Record> record_at(ByteView bytes, std::size_t offset);

/// True if `file` begins with the magic of MCAP.
bool begins_as_mcap(ByteView file);

Result<Schema, WireError> read_schema(const Record& record);
Result<Channel, WireError> read_channel(const Record& record);
Result<Message, WireError> read_message(const Record& record);
Result<ChunkIndex, WireError> read_chunk_index(const Record& record);
Result<Footer, WireError> read_footer(const Record& record);

/// `error` with `base` added to its offset, to convert it from a part to the whole.
WireError shifted(WireError error, std::size_t base);

/// Reads a text after its length in 32 bits.
std::string read_string(ByteReader& reader, std::string_view field);

}  // namespace sonard::mcap
