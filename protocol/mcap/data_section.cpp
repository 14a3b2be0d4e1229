// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/data_section.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "protocol/mcap/compression.hpp"

namespace sonard::mcap {
namespace {

/// Adds one record to a chunk; only notes that there are unknown records.
std::optional<WireError> take(const Record& record, Chunk& chunk) {
  if (record.is(Opcode::schema)) {
    auto schema = read_schema(record);
    if (!schema) {
      return schema.error();
    }
    chunk.schemas.push_back(std::move(*schema));
  } else if (record.is(Opcode::channel)) {
    auto channel = read_channel(record);
    if (!channel) {
      return channel.error();
    }
    chunk.channels.push_back(std::move(*channel));
  } else if (record.is(Opcode::message)) {
    const auto message = read_message(record);
    if (!message) {
      return message.error();
    }
    chunk.messages.push_back(*message);
    chunk.indexes[message->channel_id].push_back({message->log_time_ns, record.offset});
  } else {
    chunk.has_unknown_records = true;
  }
  return std::nullopt;
}

/// True if the sizes in the front of a chunk match the length of its record, which is no coincidence.
bool looks_like_chunk(ByteView content) {
  ByteReader reader{content};
  reader.skip(8 + 8 + 8 + 4, "chunk.front");
  const std::uint32_t compression_size = reader.u32le("chunk.compression");
  reader.skip(compression_size, "chunk.compression");
  const std::uint64_t stored_size = reader.u64le("chunk.records");
  return reader.ok() && stored_size == reader.remaining();
}

/// Channel and number of entries; nullopt if the content is not a message index.
std::optional<std::pair<std::uint16_t, std::uint64_t>> read_message_index(ByteView content) {
  constexpr std::size_t entry_size = 16;
  ByteReader reader{content};
  const std::uint16_t channel_id = reader.u16le("message_index.channel_id");
  const std::uint32_t size = reader.u32le("message_index.records");
  if (!reader.ok() || size != reader.remaining() || size % entry_size != 0) {
    return std::nullopt;
  }
  return std::pair{channel_id, std::uint64_t{size / entry_size}};
}

/// True if the content is exactly `fixed` bytes and `strings` strings.
bool consists_of(ByteView content, std::size_t fixed, int strings) {
  ByteReader reader{content};
  reader.skip(fixed, "fixed");
  for (int i = 0; i < strings; ++i) {
    reader.skip(reader.u32le("size"), "string");
  }
  return reader.ok() && reader.remaining() == 0;
}

/// True if the sizes in the content match its length, for a record of the data section of type `opcode`.
bool has_form(ByteView content, Opcode opcode) {
  switch (opcode) {
    case Opcode::chunk:
      return looks_like_chunk(content);
    case Opcode::message_index:
      return read_message_index(content).has_value();
    case Opcode::header:
      return consists_of(content, 0, 2);
    case Opcode::schema:
      return consists_of(content, 2, 3);
    case Opcode::channel:
      return consists_of(content, 4, 3);
    case Opcode::data_end:
      return content.size() == 4;
    default:
      return false;
  }
}

bool is_consistent(const Record& record) {
  return has_form(record.content, static_cast<Opcode>(record.opcode));
}

/// Whether the content has the form of a record of any type except a chunk.
bool looks_like_no_chunk(ByteView content) {
  constexpr std::array others{Opcode::message_index, Opcode::header, Opcode::schema, Opcode::channel,
                              Opcode::data_end};
  return std::ranges::any_of(others, [&](Opcode opcode) { return has_form(content, opcode); });
}

/// True if the unreadable record at `at` is a chunk. With one wrong bit its type or its length is correct.
bool was_chunk(ByteView file, std::size_t at) {
  const auto record = record_at(file, at);
  const bool named = file[at] == static_cast<std::uint8_t>(Opcode::chunk);
  return record ? looks_like_chunk(record->content) || (named && !looks_like_no_chunk(record->content))
                : named;
}

/// The offset to continue at after an unreadable record at `from`: its end if the sizes in it match its
/// length, else at the next consistent record.
std::optional<std::size_t> next_readable(ByteView file, std::size_t from) {
  const auto damaged = record_at(file, from);
  if (damaged && (looks_like_chunk(damaged->content) || looks_like_no_chunk(damaged->content))) {
    return damaged->end();
  }
  for (std::size_t at = from + 1; at < file.size(); ++at) {
    const auto record = record_at(file, at);
    if (record && is_consistent(*record)) {
      return at;
    }
  }
  return std::nullopt;
}

void set_times(Chunk& chunk) {
  if (chunk.messages.empty()) {
    return;
  }
  const auto [first, last] = std::ranges::minmax_element(chunk.messages, {}, &Message::log_time_ns);
  chunk.start_time_ns = first->log_time_ns;
  chunk.end_time_ns = last->log_time_ns;
}

/// The state of scan_data_section().
class Scanner {
 public:
  explicit Scanner(std::size_t start) { section_.end = start; }

  /// Handles one record. @return false: stop here
  bool take(const Record& record) {
    if (record.is(Opcode::data_end) && is_consistent(record)) {
      section_.ended = true;
      return false;
    }
    const auto error = take_in(record);
    if (error) {
      section_.error = error;
      return false;
    }
    section_.end = record.end();
    return true;
  }

  /// Handles an open chunk. @return false: stop here
  bool take_open_chunk(std::size_t offset, ByteView records) {
    auto chunk = read_chunk_records(records);
    if (!chunk) {
      section_.error = shifted(chunk.error(), offset + chunk_start_size);
      return false;
    }
    section_.end = offset + chunk_start_size + records.size();
    add(std::move(*chunk), offset, section_.end, true);
    return true;
  }

  enum class Skipped : std::uint8_t { chunk, end_of_chunk, other };

  /// Continues at `next` and lists the bytes before it as damaged.
  void skip_to(std::size_t next, Skipped what) {
    const WireError truncated{WireErrorReason::truncated, section_.end, "record"};
    section_.damaged.push_back({{section_.end, next - section_.end, section_.error.value_or(truncated)},
                                {},
                                what != Skipped::other});
    section_.error.reset();
    section_.end = next;
    behind_damage_ = behind_damage_ || what == Skipped::chunk;
  }

  std::size_t end() const { return section_.end; }
  bool ended() const { return section_.ended; }
  DataSection done() && { return std::move(section_); }

 private:
  std::optional<WireError> take_in(const Record& record) {
    if (record.is(Opcode::chunk)) {
      return take_chunk(record);
    }
    if (record.is(Opcode::message_index)) {
      return take_message_index(record);
    }
    if ((record.is(Opcode::schema) || record.is(Opcode::channel)) && !is_consistent(record)) {
      return WireError{WireErrorReason::bad_length, record.offset + 1,
                       "length"};  // a wrong length would hide the next records
    }
    if (record.is(Opcode::schema)) {
      return put(read_schema(record));
    }
    if (record.is(Opcode::channel)) {
      return put(read_channel(record));
    }
    // An opcode of zero comes from a part of the disk that was never written.
    if (record.is(Opcode::message) || record.is(Opcode::header) || record.is(Opcode::footer) ||
        record.is(Opcode::data_end) || record.opcode == 0 || looks_like_chunk(record.content)) {
      return WireError{WireErrorReason::bad_value, record.offset, "opcode"};
    }
    return std::nullopt;
  }

  template <class Value>
  std::optional<WireError> put(Result<Value, WireError> value) {
    if (!value) {
      return value.error();
    }
    add_once(section_.summary, std::move(*value));
    return std::nullopt;
  }

  std::optional<WireError> take_chunk(const Record& record) {
    auto chunk = read_chunk(record);
    if (!chunk) {
      return chunk.error();
    }
    if (!looks_like_chunk(record.content)) {
      return WireError{WireErrorReason::bad_length, record.offset + 1, "chunk.length"};
    }
    add(std::move(*chunk), record.offset, record.end(), false);
    return std::nullopt;
  }

  void add(Chunk chunk, std::size_t begin, std::size_t end, bool open) {
    add_contents(chunk, section_.summary);
    ChunkIndex& index = section_.summary.chunks.emplace_back();
    index.start_time_ns = chunk.start_time_ns;
    index.end_time_ns = chunk.end_time_ns;
    index.offset = begin;
    index.length = end - begin;
    index.records_size = chunk.records_size;
    index.stored_size = chunk.stored_size;
    index.compression = chunk.compression;
    behind_damage_ = false;
    section_.last_chunk_end = end;
    section_.last_chunk_open = open;
    section_.last_indexes = std::move(chunk.indexes);
  }

  std::optional<WireError> take_message_index(const Record& record) {
    const auto index = read_message_index(record.content);
    if (!index || (section_.summary.chunks.empty() && !behind_damage_)) {
      return WireError{WireErrorReason::bad_value, record.offset, "message_index"};
    }
    const auto [channel_id, messages] = *index;
    if (behind_damage_) {  // this is the index of a skipped chunk
      section_.damaged.back().lost_messages[channel_id] += messages;
      return std::nullopt;
    }
    ChunkIndex& chunk = section_.summary.chunks.back();
    chunk.message_index_offsets[channel_id] = record.offset;
    chunk.message_index_length += record.end() - record.offset;
    return std::nullopt;
  }

  DataSection section_;
  bool behind_damage_ = false;  ///< the last chunk was skipped
};

}  // namespace

Result<Chunk, WireError> read_chunk(const Record& record) {
  ByteReader reader{record.content};
  reader.skip(16, "chunk.times");
  const std::size_t size_offset = reader.offset();
  const std::uint64_t records_size = reader.u64le("chunk.uncompressed_size");
  const std::size_t crc_offset = reader.offset();
  const std::uint32_t crc = reader.u32le("chunk.uncompressed_crc");
  const std::size_t compression_offset = reader.offset();
  const std::string compression = read_string(reader, "chunk.compression");
  const std::uint64_t stored_size = reader.u64le("chunk.records");
  const std::size_t records_offset = reader.offset();
  const ByteView stored = reader.bytes(static_cast<std::size_t>(stored_size), "chunk.records");
  ByteView records = stored;
  std::shared_ptr<Bytes> storage;
  if (compression == zstd_name) {
    if (auto unpacked = decompress_zstd(stored, records_size)) {
      storage = std::make_shared<Bytes>(std::move(*unpacked));
      records = *storage;
    } else {
      reader.fail_at(records_offset, WireErrorReason::bad_value, "chunk.records");
    }
  } else if (!compression.empty()) {
    reader.fail_at(compression_offset, WireErrorReason::bad_value, "chunk.compression");
  } else if (records_size != stored_size) {
    reader.fail_at(size_offset, WireErrorReason::bad_length, "chunk.uncompressed_size");
  }
  if (reader.ok() && crc != no_crc && crc != crc32(records)) {
    reader.fail_at(crc_offset, WireErrorReason::bad_value, "chunk.uncompressed_crc");
  }
  if (!reader.ok()) {
    return shifted(*reader.error(), record.content_offset());
  }
  auto chunk = read_chunk_records(records);
  if (!chunk) {
    return shifted(chunk.error(), record.content_offset() + records_offset);
  }
  if (crc == no_crc && chunk->has_unknown_records) {  // without a CRC, unknown records count as damage
    return WireError{WireErrorReason::bad_value, record.content_offset() + records_offset, "chunk.records"};
  }
  chunk->storage = std::move(storage);
  chunk->compression = compression;
  chunk->stored_size = stored_size;
  return chunk;
}

Result<Chunk, WireError> read_chunk_records(ByteView records) {
  Chunk chunk;
  chunk.records = records;
  chunk.records_size = chunk.stored_size = records.size();
  for (std::size_t offset = 0; offset < records.size();) {
    const auto inner = record_at(records, offset);
    if (!inner) {
      return WireError{WireErrorReason::bad_length, offset, "chunk.records"};
    }
    if (const auto error = take(*inner, chunk)) {
      return *error;
    }
    offset = inner->end();
  }
  set_times(chunk);
  return chunk;
}

std::optional<ByteView> open_chunk_records(ByteView file, std::size_t offset) {
  if (offset > file.size() || file.size() - offset < chunk_start_size) {
    return std::nullopt;
  }
  ByteReader reader{file.subspan(offset)};
  const std::uint8_t opcode = reader.u8("chunk.opcode");
  reader.skip(8 + 8 + 8 + 8, "chunk.length_and_times");
  const std::uint32_t crc = reader.u32le("chunk.uncompressed_crc");
  const std::uint32_t compression_size = reader.u32le("chunk.compression");
  if (opcode != static_cast<std::uint8_t>(Opcode::chunk) || crc != no_crc || compression_size != 0) {
    return std::nullopt;
  }
  const std::size_t begin = offset + chunk_start_size;
  std::size_t end = begin;
  for (auto record = record_at(file, end);
       record && (record->is(Opcode::schema) || record->is(Opcode::channel) || record->is(Opcode::message));
       record = record_at(file, end)) {
    end = record->end();
  }
  return end > begin ? std::optional(file.subspan(begin, end - begin)) : std::nullopt;
}

void add_contents(const Chunk& chunk, Summary& summary) {
  for (const Schema& schema : chunk.schemas) {
    add_once(summary, schema);
  }
  for (const Channel& channel : chunk.channels) {
    add_once(summary, channel);
  }
  for (const auto& [channel_id, entries] : chunk.indexes) {
    summary.message_counts[channel_id] += entries.size();
  }
}

std::map<std::uint16_t, std::uint64_t> indexed_messages(ByteView file, const ChunkIndex& index) {
  std::map<std::uint16_t, std::uint64_t> messages;
  for (const auto& [channel_id, offset] : index.message_index_offsets) {
    const auto record = record_at(file, static_cast<std::size_t>(offset));
    const auto read =
        record && record->is(Opcode::message_index) ? read_message_index(record->content) : std::nullopt;
    if (read && read->first == channel_id) {
      messages.emplace(*read);
    }
  }
  return messages;
}

Result<DataSection, WireError> scan_data_section(ByteView file, OnDamage on_damage) {
  if (file.size() < magic.size()) {
    return WireError{WireErrorReason::truncated, file.size(), "magic"};
  }
  if (!begins_as_mcap(file)) {
    return WireError{WireErrorReason::bad_value, 0, "magic"};
  }
  auto record = record_at(file, magic.size());
  bool is_header = record && record->is(Opcode::header);
  if (!is_header && on_damage == OnDamage::stop) {
    return WireError{record ? WireErrorReason::bad_value : WireErrorReason::truncated, magic.size(),
                     "header"};
  }
  if (is_header && on_damage == OnDamage::skip) {
    is_header = is_consistent(*record);  // the length of the header may be damaged
  }
  Scanner scanner{is_header ? record->end() : magic.size()};
  while (true) {
    bool goes_on = false;
    if (const auto records = open_chunk_records(file, scanner.end())) {
      const auto whole = record_at(file, scanner.end());
      goes_on = scanner.take_open_chunk(scanner.end(), *records);
      if (on_damage == OnDamage::skip && goes_on && whole && whole->end() > scanner.end()) {
        scanner.skip_to(whole->end(),
                        Scanner::Skipped::end_of_chunk);  // one of its records has a wrong type or length
      }
    } else {
      record = record_at(file, scanner.end());
      goes_on = record && scanner.take(*record);
    }
    if (!goes_on) {
      const bool skips = on_damage == OnDamage::skip && !scanner.ended() && scanner.end() < file.size();
      const auto next = skips ? next_readable(file, scanner.end()) : std::nullopt;
      if (!next) {
        return std::move(scanner).done();
      }
      scanner.skip_to(*next,
                      was_chunk(file, scanner.end()) ? Scanner::Skipped::chunk : Scanner::Skipped::other);
    }
  }
}

}  // namespace sonard::mcap
