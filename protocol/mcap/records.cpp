// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/records.hpp"

#include <algorithm>

#include <zlib.h>

#include "protocol/common/byte_writer.hpp"
#include "protocol/mcap/compression.hpp"

namespace sonard::mcap {
namespace {

ByteView as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

void write_sized(ByteWriter& writer, ByteView bytes) {
  writer.u32le(static_cast<std::uint32_t>(bytes.size()));
  writer.bytes(bytes);
}

void write_string(ByteWriter& writer, std::string_view text) {
  write_sized(writer, as_bytes(text));
}

/// Writes a map: its length in bytes, then its entries.
void write_map(ByteWriter& writer, const std::map<std::string, std::string>& map) {
  Bytes entries;
  ByteWriter entry_writer{entries};
  for (const auto& [key, value] : map) {
    write_string(entry_writer, key);
    write_string(entry_writer, value);
  }
  write_sized(writer, entries);
}

/// Calls `read` with a reader at the front of the content. Ignores further bytes, which are of later
/// versions.
template <class Value, class Read>
Result<Value, WireError> read_content(const Record& record, Read read) {
  ByteReader reader{record.content};
  Value value;
  read(reader, value);
  if (!reader.ok()) {
    return shifted(*reader.error(), record.content_offset());
  }
  return value;
}

}  // namespace

std::uint32_t crc32(ByteView bytes, std::uint32_t before) {
  // With a null pointer zlib would start a new checksum.
  return bytes.empty() ? before : static_cast<std::uint32_t>(::crc32_z(before, bytes.data(), bytes.size()));
}

// ---- Writing

RecordScope::RecordScope(Bytes& out, Opcode opcode) : out_(out) {
  ByteWriter writer{out_};
  writer.u8(static_cast<std::uint8_t>(opcode));
  writer.u64le(0);
  content_start_ = out_.size();
}

RecordScope::~RecordScope() {
  const std::uint64_t length = out_.size() - content_start_;
  for (std::size_t i = 0; i < sizeof length; ++i) {
    out_[content_start_ - sizeof length + i] = static_cast<std::uint8_t>(length >> (8 * i));
  }
}

void append_header(Bytes& out, std::string_view profile, std::string_view library) {
  const RecordScope record{out, Opcode::header};
  ByteWriter writer{out};
  write_string(writer, profile);
  write_string(writer, library);
}

void append(Bytes& out, const Schema& schema) {
  const RecordScope record{out, Opcode::schema};
  ByteWriter writer{out};
  writer.u16le(schema.id);
  write_string(writer, schema.name);
  write_string(writer, schema.encoding);
  write_sized(writer, schema.data);
}

void append(Bytes& out, const Channel& channel) {
  const RecordScope record{out, Opcode::channel};
  ByteWriter writer{out};
  writer.u16le(channel.id);
  writer.u16le(channel.schema_id);
  write_string(writer, channel.topic);
  write_string(writer, channel.message_encoding);
  write_map(writer, channel.metadata);
}

void append(Bytes& out, const Message& message) {
  const RecordScope record{out, Opcode::message};
  ByteWriter writer{out};
  writer.u16le(message.channel_id);
  writer.u32le(message.sequence);
  writer.u64le(message.log_time_ns);
  writer.u64le(message.publish_time_ns);
  writer.bytes(message.data);
}

void append(Bytes& out, const ChunkIndex& index) {
  const RecordScope record{out, Opcode::chunk_index};
  ByteWriter writer{out};
  writer.u64le(index.start_time_ns);
  writer.u64le(index.end_time_ns);
  writer.u64le(index.offset);
  writer.u64le(index.length);
  writer.u32le(static_cast<std::uint32_t>(index.message_index_offsets.size() * 10));
  for (const auto& [channel_id, offset] : index.message_index_offsets) {
    writer.u16le(channel_id);
    writer.u64le(offset);
  }
  writer.u64le(index.message_index_length);
  write_string(writer, index.compression);
  writer.u64le(index.stored_size);
  writer.u64le(index.records_size);
}

void append_message_index(Bytes& out, std::uint16_t channel_id, std::span<const IndexEntry> entries) {
  const RecordScope record{out, Opcode::message_index};
  ByteWriter writer{out};
  writer.u16le(channel_id);
  writer.u32le(static_cast<std::uint32_t>(entries.size() * 16));
  for (const IndexEntry& entry : entries) {
    writer.u64le(entry.log_time_ns);
    writer.u64le(entry.offset);
  }
}

// ---- Reading

std::optional<Record> record_at(ByteView bytes, std::size_t offset) {
  if (offset > bytes.size()) {
    return std::nullopt;
  }
  ByteReader reader{bytes.subspan(offset)};
  const std::uint8_t opcode = reader.u8("opcode");
  const std::uint64_t length = reader.u64le("record_length");
  if (!reader.ok() || length > reader.remaining()) {
    return std::nullopt;
  }
  return Record{opcode, offset, reader.bytes(static_cast<std::size_t>(length), "content")};
}

bool begins_as_mcap(ByteView file) {
  return file.size() >= magic.size() && std::ranges::equal(file.first(magic.size()), magic);
}

std::string read_string(ByteReader& reader, std::string_view field) {
  const ByteView bytes = reader.bytes(reader.u32le(field), field);
  return {bytes.begin(), bytes.end()};
}

Result<Schema, WireError> read_schema(const Record& record) {
  return read_content<Schema>(record, [](ByteReader& reader, Schema& schema) {
    schema.id = reader.u16le("schema.id");
    schema.name = read_string(reader, "schema.name");
    schema.encoding = read_string(reader, "schema.encoding");
    const ByteView data = reader.bytes(reader.u32le("schema.data"), "schema.data");
    schema.data.assign(data.begin(), data.end());
  });
}

Result<Channel, WireError> read_channel(const Record& record) {
  return read_content<Channel>(record, [](ByteReader& reader, Channel& channel) {
    channel.id = reader.u16le("channel.id");
    channel.schema_id = reader.u16le("channel.schema_id");
    channel.topic = read_string(reader, "channel.topic");
    channel.message_encoding = read_string(reader, "channel.message_encoding");
    const std::size_t map_size = reader.u32le("channel.metadata");
    const std::size_t map_start = reader.offset();
    ByteReader entries{reader.bytes(map_size, "channel.metadata")};
    while (entries.ok() && entries.remaining() > 0) {
      std::string key = read_string(entries, "channel.metadata");
      channel.metadata[std::move(key)] = read_string(entries, "channel.metadata");
    }
    if (!entries.ok()) {
      reader.fail_at(map_start, WireErrorReason::bad_length, "channel.metadata");
    }
  });
}

Result<Message, WireError> read_message(const Record& record) {
  return read_content<Message>(record, [](ByteReader& reader, Message& message) {
    message.channel_id = reader.u16le("message.channel_id");
    message.sequence = reader.u32le("message.sequence");
    message.log_time_ns = reader.u64le("message.log_time");
    message.publish_time_ns = reader.u64le("message.publish_time");
    message.data = reader.bytes(reader.remaining(), "message.data");
  });
}

Result<ChunkIndex, WireError> read_chunk_index(const Record& record) {
  return read_content<ChunkIndex>(record, [](ByteReader& reader, ChunkIndex& index) {
    index.start_time_ns = reader.u64le("chunk_index.message_start_time");
    index.end_time_ns = reader.u64le("chunk_index.message_end_time");
    index.offset = reader.u64le("chunk_index.chunk_start_offset");
    index.length = reader.u64le("chunk_index.chunk_length");
    ByteReader entries{reader.bytes(reader.u32le("chunk_index.message_index_offsets"), "chunk_index.map")};
    while (entries.remaining() >= 10) {
      const std::uint16_t channel_id = entries.u16le("chunk_index.map");
      index.message_index_offsets[channel_id] = entries.u64le("chunk_index.map");
    }
    index.message_index_length = reader.u64le("chunk_index.message_index_length");
    index.compression = read_string(reader, "chunk_index.compression");
    if (!index.compression.empty() && index.compression != zstd_name) {
      reader.fail(WireErrorReason::bad_value, "chunk_index.compression");
    }
    index.stored_size = reader.u64le("chunk_index.compressed_size");
    index.records_size = reader.u64le("chunk_index.uncompressed_size");
  });
}

Result<Footer, WireError> read_footer(const Record& record) {
  return read_content<Footer>(record, [](ByteReader& reader, Footer& footer) {
    footer.summary_start = reader.u64le("footer.summary_start");
    footer.summary_offset_start = reader.u64le("footer.summary_offset_start");
    footer.summary_crc = reader.u32le("footer.summary_crc");
  });
}

WireError shifted(WireError error, std::size_t base) {
  error.offset += base;
  return error;
}

}  // namespace sonard::mcap
