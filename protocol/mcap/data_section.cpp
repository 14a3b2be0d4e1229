// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/data_section.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
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

/// Parts of a record's content: a number of bytes, or bytes after their length in 32 or 64 bits.
constexpr int sized_32 = -4;
constexpr int sized_64 = -8;
using Form = std::initializer_list<int>;

/// True if the content is exactly these parts.
bool consists_of(ByteView content, Form form) {
  ByteReader reader{content};
  for (const int part : form) {
    const std::uint64_t size = part == sized_32   ? reader.u32le("size")
                               : part == sized_64 ? reader.u64le("size")
                                                  : static_cast<std::uint64_t>(part);
    if (size > reader.remaining()) {
      return false;
    }
    reader.skip(static_cast<std::size_t>(size), "part");
  }
  return reader.ok() && reader.remaining() == 0;
}

/// True if the sizes in the front of a chunk match the length of its record, which is no coincidence.
bool looks_like_chunk(ByteView content) {
  return consists_of(content, {28, sized_32, sized_64});
}

/// The content of a message index.
struct MessageIndex {
  std::uint16_t channel_id = 0;
  std::vector<IndexEntry> entries;
};

/// nullopt if the content is not a message index.
std::optional<MessageIndex> read_message_index(ByteView content) {
  constexpr std::size_t entry_size = 16;
  ByteReader reader{content};
  MessageIndex index{.channel_id = reader.u16le("message_index.channel_id"), .entries = {}};
  const std::uint32_t size = reader.u32le("message_index.records");
  if (!reader.ok() || size != reader.remaining() || size % entry_size != 0) {
    return std::nullopt;
  }
  index.entries.resize(size / entry_size);
  for (IndexEntry& entry : index.entries) {
    entry.log_time_ns = reader.u64le("message_index.log_time");
    entry.offset = reader.u64le("message_index.offset");
  }
  return index;
}

/// True if the sizes in the content match its length, for a record of type `opcode`; false for a message,
/// which has no such sizes, and for an unknown type.
bool has_form(ByteView content, Opcode opcode) {
  switch (opcode) {
    case Opcode::chunk:
      return looks_like_chunk(content);
    case Opcode::message_index:
      return consists_of(content, {2, sized_32}) && (content.size() - 6) % 16 == 0;
    case Opcode::header:
    case Opcode::metadata:
      return consists_of(content, {sized_32, sized_32});
    case Opcode::schema:
      return consists_of(content, {2, sized_32, sized_32, sized_32});
    case Opcode::channel:
      return consists_of(content, {4, sized_32, sized_32, sized_32});
    case Opcode::attachment:
      return consists_of(content, {16, sized_32, sized_32, sized_64, 4});
    case Opcode::chunk_index:
      return consists_of(content, {32, sized_32, 8, sized_32, 16});
    case Opcode::statistics:
      return consists_of(content, {42, sized_32});
    case Opcode::summary_offset:
      return content.size() == 17;
    case Opcode::footer:
      return content.size() == 20;
    case Opcode::data_end:
      return content.size() == 4;
    case Opcode::message:
      break;
  }
  return false;
}

bool is_consistent(const Record& record) {
  return has_form(record.content, static_cast<Opcode>(record.opcode));
}

/// True for a type of a later version or of another program.
/// A type of zero comes from a part of the disk that was never written.
bool is_unknown(const Record& record) {
  constexpr std::uint8_t last_known = 0x0F;
  return record.opcode > last_known || record.opcode == 0x0A || record.opcode == 0x0D;
}

bool is_definition(const Record& record) {
  return record.is(Opcode::schema) || record.is(Opcode::channel);
}

/// True if records of the data section begin at `at`. Bytes inside a record rarely look so: records of
/// unknown types and definitions, which are also inside chunks, must lead to another consistent record.
bool leads_on(ByteView file, std::size_t at) {
  constexpr int enough = 64;  // so many whole records in a row are no coincidence
  for (int i = 0; i < enough; ++i) {
    if (at == file.size() || open_chunk_records(file, at)) {
      return true;
    }
    const auto record = record_at(file, at);
    if (!record || !(is_unknown(*record) || is_consistent(*record))) {
      return false;
    }
    if (!is_unknown(*record) && !is_definition(*record)) {
      return true;
    }
    at = record->end();
  }
  return true;
}

constexpr std::array types_without_messages{Opcode::message_index, Opcode::header, Opcode::schema,
                                            Opcode::channel, Opcode::data_end};

/// Whether the content has the form of a record of any type except a chunk.
bool looks_like_no_chunk(ByteView content) {
  return std::ranges::any_of(types_without_messages,
                             [&](Opcode opcode) { return has_form(content, opcode); });
}

bool has_type_without_messages(const Record& record) {
  return std::ranges::find(types_without_messages, static_cast<Opcode>(record.opcode)) !=
         types_without_messages.end();
}

constexpr std::size_t smallest_chunk_size = chunk_start_size + record_prefix_size + 22;  // one message

/// What the skipped bytes from `at` to `next` held. With one wrong bit the type or the length of a record is
/// correct.
Holds held(ByteView file, std::size_t at, std::size_t next) {
  const auto record = record_at(file, at);
  const bool named = file[at] == static_cast<std::uint8_t>(Opcode::chunk);
  if (record ? looks_like_chunk(record->content) || (named && !looks_like_no_chunk(record->content))
             : named) {
    return Holds::chunk;
  }
  const bool is_known = record && record->end() == next && has_type_without_messages(*record);
  return next - at < smallest_chunk_size || is_known ||
                 looks_like_no_chunk(file.subspan(at + record_prefix_size, next - at - record_prefix_size))
             ? Holds::no_message
             : Holds::unknown;
}

/// True if a reader that searches for a record may continue with the one at `at`.
bool is_found(ByteView file, std::size_t at) {
  const auto record = record_at(file, at);
  if (!record || !is_consistent(*record)) {
    return false;
  }
  if (record->is(Opcode::chunk)) {
    return record->content.size() > chunk_start_size - record_prefix_size;  // not empty, as zeros would be
  }
  return has_type_without_messages(*record) && leads_on(file, record->end());
}

/// The offset to continue at after an unreadable record at `from`: its end if the sizes in it match its
/// length and a record follows there, else at the next consistent record.
std::optional<std::size_t> next_readable(ByteView file, std::size_t from) {
  const auto damaged = record_at(file, from);
  if (damaged && (looks_like_chunk(damaged->content) || looks_like_no_chunk(damaged->content)) &&
      leads_on(file, damaged->end())) {
    return damaged->end();
  }
  for (std::size_t at = from + 1; at < file.size(); ++at) {
    if (is_found(file, at)) {
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
  Scanner(ByteView file, std::size_t start) : file_(file) { section_.end = start; }
  /// @param start the damaged bytes before the first record
  Scanner(ByteView file, const DamagedChunk& start) : Scanner(file, start.offset + start.size) {
    section_.damaged.push_back(start);
    behind_damage_ = start.holds != Holds::no_message;
    // The header is the first record; a scan that meets one elsewhere calls it damage.
    if (const auto record = record_at(file_, section_.end); record && record->is(Opcode::header)) {
      section_.end = record->end();
    }
  }

  void scan(OnDamage on_damage) {
    while (take_next() || (on_damage == OnDamage::skip && skip_damage())) {
    }
  }

  DataSection done() && { return std::move(section_); }

 private:
  /// Handles the next record. @return false: this is the end of the data section, or damage
  bool take_next() {
    const auto record = record_at(file_, section_.end);
    if (const auto records = open_chunk_records(file_, section_.end)) {
      return take_open_chunk(*records, record ? record->end() : 0);
    }
    return record && take(*record);
  }

  /// Continues after damage. @return false: this is the end of the data section, or no record follows
  bool skip_damage() {
    if (section_.ended || section_.end >= file_.size()) {
      return false;
    }
    const bool in_open_chunk = end_of_damaged_chunk_ > section_.end;
    const auto next = in_open_chunk && leads_on(file_, end_of_damaged_chunk_)
                          ? std::optional(end_of_damaged_chunk_)
                          : next_readable(file_, section_.end);
    if (next) {
      skip_to(*next, in_open_chunk ? Holds::messages : held(file_, section_.end, *next));
    }
    return next.has_value();
  }

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

  /// @param stated_end where the chunk ends by its length, which may be outdated
  bool take_open_chunk(ByteView records, std::size_t stated_end) {
    const std::size_t offset = section_.end;
    auto chunk = read_chunk_records(records);
    if (!chunk) {
      section_.error = shifted(chunk.error(), offset + chunk_start_size);
      return false;
    }
    section_.end = offset + chunk_start_size + records.size();
    add(std::move(*chunk), offset, section_.end, true);
    end_of_damaged_chunk_ = stated_end;
    if (stated_end > section_.end) {  // one of its records has a wrong type or length
      section_.error = WireError{WireErrorReason::truncated, section_.end, "record"};
    }
    return !section_.error;
  }

  /// Continues at `next` and lists the bytes before it as damaged.
  void skip_to(std::size_t next, Holds holds) {
    const WireError truncated{WireErrorReason::truncated, section_.end, "record"};
    section_.damaged.push_back(
        {{section_.end, next - section_.end, section_.error.value_or(truncated)}, {}, holds});
    section_.error.reset();
    section_.end = next;
    behind_damage_ = behind_damage_ || holds != Holds::no_message;
  }

  std::optional<WireError> take_in(const Record& record) {
    if (record.is(Opcode::chunk)) {
      return take_chunk(record);
    }
    if (record.is(Opcode::message_index)) {
      return take_message_index(record);
    }
    if (record.is(Opcode::message) || record.is(Opcode::header) || record.is(Opcode::footer) ||
        record.is(Opcode::data_end) || record.opcode == 0 || looks_like_chunk(record.content)) {
      return WireError{WireErrorReason::bad_value, record.offset, "opcode"};
    }
    if (is_unknown(record) ? !leads_on(file_, record.end()) : !is_consistent(record)) {
      return WireError{WireErrorReason::bad_length, record.offset + 1,
                       "length"};  // a wrong length would hide the next records
    }
    if (record.is(Opcode::schema)) {
      return put(read_schema(record));
    }
    if (record.is(Opcode::channel)) {
      return put(read_channel(record));
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
    const auto of_last_chunk = section_.last_indexes.find(index->channel_id);
    if (behind_damage_ &&
        (of_last_chunk == section_.last_indexes.end() || of_last_chunk->second != index->entries)) {
      // This is the index of a skipped chunk.
      section_.damaged.back().lost_messages[index->channel_id] += index->entries.size();
      return std::nullopt;
    }
    ChunkIndex& chunk = section_.summary.chunks.back();
    chunk.message_index_offsets[index->channel_id] = record.offset;
    chunk.message_index_length += record.end() - record.offset;
    return std::nullopt;
  }

  ByteView file_;
  DataSection section_;
  std::size_t end_of_damaged_chunk_ = 0;  ///< stated end of an open chunk with a damaged record
  bool behind_damage_ = false;            ///< after the last chunk, bytes were skipped that may be chunks
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
    if (read && read->channel_id == channel_id) {
      messages.emplace(channel_id, read->entries.size());
    }
  }
  return messages;
}

std::optional<DamagedChunk> damaged_start(ByteView file) {
  const bool has_magic = begins_as_mcap(file);
  const auto header = has_magic ? record_at(file, magic.size()) : std::nullopt;
  if (header && header->is(Opcode::header) && is_consistent(*header)) {
    return std::nullopt;
  }
  const std::size_t from = has_magic ? magic.size() : 0;
  for (std::size_t at = from; at < file.size(); ++at) {
    if (is_found(file, at)) {
      const WireError error{WireErrorReason::bad_value, from, has_magic ? "header" : "magic"};
      const bool may_be_chunk = at - from >= smallest_chunk_size;
      return DamagedChunk{{from, at - from, error}, {}, may_be_chunk ? Holds::unknown : Holds::no_message};
    }
  }
  return std::nullopt;
}

namespace {

/// Scans a file without the magic of MCAP, from its first readable record on.
Result<DataSection, WireError> scan_without_magic(ByteView file) {
  const WireError no_mcap{WireErrorReason::bad_value, 0, "magic"};
  const auto start = damaged_start(file);
  if (!start) {
    return no_mcap;
  }
  Scanner scanner{file, *start};
  scanner.scan(OnDamage::skip);
  DataSection section = std::move(scanner).done();
  return section.summary.chunks.empty() ? Result<DataSection, WireError>(no_mcap) : std::move(section);
}

}  // namespace

Result<DataSection, WireError> scan_data_section(ByteView file, OnDamage on_damage) {
  if (file.size() < magic.size()) {
    return WireError{WireErrorReason::truncated, file.size(), "magic"};
  }
  if (!begins_as_mcap(file)) {
    return on_damage == OnDamage::skip ? scan_without_magic(file)
                                       : WireError{WireErrorReason::bad_value, 0, "magic"};
  }
  const auto record = record_at(file, magic.size());
  const bool is_header = record && record->is(Opcode::header) && is_consistent(*record);
  if (!is_header && on_damage == OnDamage::stop) {
    return WireError{record ? WireErrorReason::bad_value : WireErrorReason::truncated, magic.size(),
                     "header"};
  }
  Scanner scanner{file, is_header ? record->end() : magic.size()};
  scanner.scan(on_damage);
  return std::move(scanner).done();
}

}  // namespace sonard::mcap
