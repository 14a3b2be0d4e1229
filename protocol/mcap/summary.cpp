// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/summary.hpp"

#include <algorithm>

#include "protocol/common/byte_writer.hpp"

namespace sonard::mcap {
namespace {

void append_statistics(Bytes& out, const Summary& summary) {
  const RecordScope record{out, Opcode::statistics};
  ByteWriter writer{out};
  writer.u64le(summary.message_count());
  writer.u16le(static_cast<std::uint16_t>(summary.schemas.size()));
  writer.u32le(static_cast<std::uint32_t>(summary.channels.size()));
  writer.u32le(0);  // attachments
  writer.u32le(0);  // metadata records
  writer.u32le(static_cast<std::uint32_t>(summary.chunks.size()));
  writer.u64le(summary.start_time_ns());
  writer.u64le(summary.end_time_ns());
  writer.u32le(static_cast<std::uint32_t>(summary.message_counts.size() * 10));
  for (const auto& [channel_id, count] : summary.message_counts) {
    writer.u16le(channel_id);
    writer.u64le(count);
  }
}

/// Reads only the counts from the statistics, because the chunk indexes contain the rest.
Result<std::map<std::uint16_t, std::uint64_t>, WireError> read_message_counts(const Record& record) {
  constexpr std::size_t before_counts = 8 + 2 + 4 * 4 + 2 * 8;
  ByteReader reader{record.content};
  reader.skip(before_counts, "statistics");
  ByteReader entries{reader.bytes(reader.u32le("statistics.channel_message_counts"), "statistics.map")};
  std::map<std::uint16_t, std::uint64_t> counts;
  while (entries.remaining() >= 10) {
    const std::uint16_t channel_id = entries.u16le("statistics.map");
    counts[channel_id] = entries.u64le("statistics.map");
  }
  if (!reader.ok()) {
    return shifted(*reader.error(), record.content_offset());
  }
  return counts;
}

/// Writes the groups of the summary, and collects their summary offset records.
class GroupWriter {
 public:
  GroupWriter(Bytes& out, std::uint64_t file_offset) : out_(out), file_offset_(file_offset) {}

  template <class Append>
  void group(Opcode opcode, Append append_records) {
    const std::size_t start = out_.size();
    append_records();
    if (out_.size() == start) {
      return;
    }
    const RecordScope record{offsets_, Opcode::summary_offset};
    ByteWriter writer{offsets_};
    writer.u8(static_cast<std::uint8_t>(opcode));
    writer.u64le(file_offset_ + start);
    writer.u64le(out_.size() - start);
  }

  const Bytes& offsets() const { return offsets_; }

 private:
  Bytes& out_;
  std::uint64_t file_offset_;
  Bytes offsets_;
};

template <class Value>
void append_all(Bytes& out, const std::vector<Value>& values) {
  for (const Value& value : values) {
    append(out, value);
  }
}

/// Adds one record of the summary section; ignores other records.
std::optional<WireError> take(const Record& record, Summary& summary) {
  const auto put = [](auto result, auto&& use) -> std::optional<WireError> {
    if (!result) {
      return result.error();
    }
    use(std::move(*result));
    return std::nullopt;
  };
  if (record.is(Opcode::schema)) {
    return put(read_schema(record), [&](Schema schema) { add_once(summary, std::move(schema)); });
  }
  if (record.is(Opcode::channel)) {
    return put(read_channel(record), [&](Channel channel) { add_once(summary, std::move(channel)); });
  }
  if (record.is(Opcode::chunk_index)) {
    return put(read_chunk_index(record),
               [&](ChunkIndex index) { summary.chunks.push_back(std::move(index)); });
  }
  if (record.is(Opcode::statistics)) {
    return put(read_message_counts(record), [&](auto counts) { summary.message_counts = std::move(counts); });
  }
  return std::nullopt;
}

/// Checks that chunks follow each other. With overlapping chunks a reader could read equal bytes for ever.
std::optional<WireError> check_chunks(const Summary& summary, std::uint64_t data_section_limit) {
  std::uint64_t end = 0;
  for (const ChunkIndex& chunk : summary.chunks) {
    if (chunk.offset < end || chunk.offset > data_section_limit ||
        chunk.length > data_section_limit - chunk.offset) {
      return WireError{WireErrorReason::bad_value, static_cast<std::size_t>(chunk.offset),
                       "chunk_index.chunk_start_offset"};
    }
    end = chunk.offset + chunk.length;
  }
  return std::nullopt;
}

struct FoundFooter {
  Footer values;
  std::size_t offset = 0;
};

Result<FoundFooter, WireError> find_footer(ByteView file) {
  constexpr std::size_t end_size = footer_record_size + magic.size();
  if (file.size() < magic.size() + end_size || !std::ranges::equal(file.last(magic.size()), magic)) {
    return WireError{WireErrorReason::truncated, file.size(), "magic"};
  }
  const std::size_t offset = file.size() - end_size;
  const auto record = record_at(file, offset);
  if (!record || !record->is(Opcode::footer) || record->content.size() != 20) {
    return WireError{WireErrorReason::bad_value, offset, "footer"};
  }
  const auto footer = read_footer(*record);
  if (!footer) {
    return footer.error();
  }
  return FoundFooter{*footer, offset};
}

}  // namespace

std::uint64_t Summary::message_count() const {
  std::uint64_t sum = 0;
  for (const auto& [channel_id, count] : message_counts) {
    sum += count;
  }
  return sum;
}

std::uint64_t Summary::start_time_ns() const {
  // A chunk with channels but without messages has no times.
  const auto has_messages = [](const ChunkIndex& chunk) { return chunk.end_time_ns != 0; };
  std::uint64_t start = 0;
  bool found = false;
  for (const ChunkIndex& chunk : chunks) {
    if (has_messages(chunk)) {
      start = found ? std::min(start, chunk.start_time_ns) : chunk.start_time_ns;
      found = true;
    }
  }
  return start;
}

std::uint64_t Summary::end_time_ns() const {
  std::uint64_t end = 0;
  for (const ChunkIndex& chunk : chunks) {
    end = std::max(end, chunk.end_time_ns);
  }
  return end;
}

const Channel* Summary::channel(std::uint16_t id) const {
  const auto found = std::ranges::find(channels, id, &Channel::id);
  return found == channels.end() ? nullptr : &*found;
}

const Schema* Summary::schema(std::uint16_t id) const {
  const auto found = std::ranges::find(schemas, id, &Schema::id);
  return found == schemas.end() ? nullptr : &*found;
}

void add_once(Summary& summary, Schema schema) {
  if (schema.id != 0 && summary.schema(schema.id) == nullptr) {
    summary.schemas.push_back(std::move(schema));
  }
}

void add_once(Summary& summary, Channel channel) {
  if (summary.channel(channel.id) == nullptr) {
    summary.channels.push_back(std::move(channel));
  }
}

Bytes make_end(const Summary& summary, std::uint64_t offset, std::uint32_t data_crc) {
  Bytes out;
  {
    const RecordScope record{out, Opcode::data_end};
    ByteWriter{out}.u32le(data_crc);
  }
  const std::size_t summary_start = out.size();
  GroupWriter groups{out, offset};
  groups.group(Opcode::schema, [&] { append_all(out, summary.schemas); });
  groups.group(Opcode::channel, [&] { append_all(out, summary.channels); });
  groups.group(Opcode::statistics, [&] { append_statistics(out, summary); });
  groups.group(Opcode::chunk_index, [&] { append_all(out, summary.chunks); });
  const std::size_t offsets_start = out.size();
  out.insert(out.end(), groups.offsets().begin(), groups.offsets().end());

  ByteWriter writer{out};
  writer.u8(static_cast<std::uint8_t>(Opcode::footer));
  writer.u64le(20);
  writer.u64le(offset + summary_start);
  writer.u64le(offset + offsets_start);
  // The checksum covers the summary and the footer up to here.
  writer.u32le(crc32(ByteView{out}.subspan(summary_start)));
  writer.bytes(magic);
  return out;
}

Result<Summary, WireError> read_summary(ByteView file) {
  const auto footer = find_footer(file);
  if (!footer) {
    return footer.error();
  }
  const std::uint64_t start = footer->values.summary_start;
  if (start < magic.size() || start > footer->offset) {
    return WireError{WireErrorReason::bad_value, footer->offset, "footer.summary_start"};
  }
  const ByteView checked = file.subspan(start, footer->offset + record_prefix_size + 16 - start);
  if (footer->values.summary_crc != 0 && footer->values.summary_crc != crc32(checked)) {
    return WireError{WireErrorReason::bad_value, footer->offset, "footer.summary_crc"};
  }
  Summary summary;
  for (std::size_t offset = start; offset < footer->offset;) {
    const auto record = record_at(file.first(footer->offset), offset);
    if (!record) {
      return WireError{WireErrorReason::bad_length, offset, "summary"};
    }
    if (const auto error = take(*record, summary)) {
      return *error;
    }
    offset = record->end();
  }
  if (const auto error = check_chunks(summary, start)) {
    return *error;
  }
  return summary;
}

}  // namespace sonard::mcap
