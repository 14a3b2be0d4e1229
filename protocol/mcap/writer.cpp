// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/writer.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "protocol/common/byte_writer.hpp"
#include "protocol/mcap/compression.hpp"

namespace sonard::mcap {
namespace {

/// Ids start from 1, because schema id 0 in a Channel means that it has no schema.
template <class Value>
std::uint16_t next_id(const std::vector<Value>& values) {
  assert(values.size() < 65'535);
  return static_cast<std::uint16_t>(values.size() + 1);
}

}  // namespace

Writer::Writer(std::string_view library, std::size_t chunk_bytes, Compression compression)
    : chunk_bytes_(chunk_bytes), compression_(compression) {
  pending_.assign(magic.begin(), magic.end());
  append_header(pending_, "", library);
  data_crc_ = crc32(pending_);
}

std::uint16_t Writer::add_schema(std::string_view name, std::string_view encoding, ByteView data) {
  const Schema& schema = summary_.schemas.emplace_back(Schema{
      next_id(summary_.schemas), std::string{name}, std::string{encoding}, Bytes{data.begin(), data.end()}});
  append(records_, schema);
  return schema.id;
}

std::uint16_t Writer::add_channel(std::uint16_t schema_id, std::string_view topic,
                                  std::string_view message_encoding,
                                  std::map<std::string, std::string> metadata) {
  const Channel& channel =
      summary_.channels.emplace_back(Channel{next_id(summary_.channels), schema_id, std::string{topic},
                                             std::string{message_encoding}, std::move(metadata)});
  append(records_, channel);
  return channel.id;
}

void Writer::add_message(std::uint16_t channel_id, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                         ByteView data) {
  assert(summary_.channel(channel_id) != nullptr);
  start_time_ns_ = indexes_.empty() ? log_time_ns : std::min(start_time_ns_, log_time_ns);
  end_time_ns_ = std::max(end_time_ns_, log_time_ns);
  indexes_[channel_id].push_back({log_time_ns, records_.size()});
  append(records_, Message{channel_id, sequences_[channel_id]++, log_time_ns, publish_time_ns, data});
  ++summary_.message_counts[channel_id];
  if (records_.size() >= chunk_bytes_) {
    end_chunk();
  }
}

void Writer::flush() {
  if (flushed_size_ == records_.size()) {
    return;
  }
  if (!open_at_) {
    open_at_ = file_size();
    pending_.resize(pending_.size() + chunk_start_size);
  }
  pending_.insert(pending_.end(), records_.begin() + static_cast<std::ptrdiff_t>(flushed_size_),
                  records_.end());
  flushed_size_ = records_.size();
  put_chunk_start(no_crc);
}

/// Writes the front of the open chunk into pending_ if the chunk begins there, else into rewrite_.
void Writer::put_chunk_start(std::uint32_t crc) {
  ChunkIndex chunk;
  chunk.start_time_ns = start_time_ns_;
  chunk.end_time_ns = end_time_ns_;
  chunk.records_size = chunk.stored_size = records_.size();
  Bytes start;
  append_chunk_start(start, chunk, crc);
  if (*open_at_ >= taken_size_) {
    std::ranges::copy(start, pending_.begin() + static_cast<std::ptrdiff_t>(*open_at_ - taken_size_));
  } else {
    rewrite_ = start;
    rewrite_offset_ = *open_at_;
  }
}

void Writer::end_chunk() {
  if (records_.empty()) {
    return;
  }
  flush();
  ChunkIndex& chunk = summary_.chunks.emplace_back();
  chunk.start_time_ns = start_time_ns_;
  chunk.end_time_ns = end_time_ns_;
  chunk.offset = *open_at_;
  const Bytes record = closed_chunk(chunk);
  chunk.length = record.size();
  put_closed_chunk(record);

  Bytes behind;
  append_message_indexes(behind, file_size(), indexes_, chunk);
  repeat_definitions(behind);
  pending_.insert(pending_.end(), behind.begin(), behind.end());
  data_crc_ = crc32(behind, crc32(record, data_crc_));
  records_.clear();
  indexes_.clear();
  start_time_ns_ = 0;
  end_time_ns_ = 0;
  open_at_.reset();
  flushed_size_ = 0;
}

/// Repeats the schemas and channels of the closed chunk.
void Writer::repeat_definitions(Bytes& out) {
  for (; repeated_schemas_ < summary_.schemas.size(); ++repeated_schemas_) {
    append(out, summary_.schemas[repeated_schemas_]);
  }
  for (; repeated_channels_ < summary_.channels.size(); ++repeated_channels_) {
    append(out, summary_.channels[repeated_channels_]);
  }
}

/// The whole record of the chunk, compressed if that makes it shorter.
Bytes Writer::closed_chunk(ChunkIndex& chunk) const {
  chunk.records_size = chunk.stored_size = records_.size();
  ByteView stored = records_;
  Bytes packed;
  if (compression_ == Compression::zstd) {
    packed = compress_zstd(records_);
    if (!packed.empty() && packed.size() + zstd_name.size() < records_.size()) {
      stored = packed;
      chunk.stored_size = packed.size();
      chunk.compression = zstd_name;
    }
  }
  Bytes record;
  append_chunk_start(record, chunk, crc32(records_));
  record.insert(record.end(), stored.begin(), stored.end());
  return record;
}

/// Replaces the open chunk, parts of which may be in the file and in pending_.
void Writer::put_closed_chunk(const Bytes& record) {
  if (*open_at_ >= taken_size_) {
    pending_.resize(static_cast<std::size_t>(*open_at_ - taken_size_));
    pending_.insert(pending_.end(), record.begin(), record.end());
  } else if (record.size() == chunk_start_size + records_.size()) {
    rewrite_.assign(record.begin(), record.begin() + chunk_start_size);  // the records do not change
    rewrite_offset_ = *open_at_;
  } else {
    const auto in_file = static_cast<std::size_t>(taken_size_ - *open_at_);
    const auto end = record.begin() + static_cast<std::ptrdiff_t>(std::min(in_file, record.size()));
    rewrite_.assign(record.begin(), end);
    rewrite_offset_ = *open_at_;
    cut_at_ = taken_size_ = *open_at_ + rewrite_.size();
    pending_.assign(end, record.end());
  }
}

void Writer::finish() {
  end_chunk();
  const Bytes end = make_end(summary_, file_size(), data_crc_);
  pending_.insert(pending_.end(), end.begin(), end.end());
}

Piece Writer::take() {
  taken_size_ += pending_.size();
  return {std::exchange(pending_, {}), std::exchange(rewrite_, {}), rewrite_offset_,
          std::exchange(cut_at_, std::nullopt)};
}

void append_chunk_start(Bytes& out, const ChunkIndex& chunk, std::uint32_t crc) {
  ByteWriter writer{out};
  writer.u8(static_cast<std::uint8_t>(Opcode::chunk));
  writer.u64le(chunk_start_size - record_prefix_size + chunk.compression.size() + chunk.stored_size);
  writer.u64le(chunk.start_time_ns);
  writer.u64le(chunk.end_time_ns);
  writer.u64le(chunk.records_size);
  writer.u32le(crc);
  writer.u32le(static_cast<std::uint32_t>(chunk.compression.size()));
  out.insert(out.end(), chunk.compression.begin(), chunk.compression.end());
  writer.u64le(chunk.stored_size);
}

void append_message_indexes(Bytes& out, std::uint64_t file_offset, const MessageIndexes& indexes,
                            ChunkIndex& chunk) {
  const std::size_t start = out.size();
  for (const auto& [channel_id, entries] : indexes) {
    chunk.message_index_offsets[channel_id] = file_offset + out.size();
    append_message_index(out, channel_id, entries);
  }
  chunk.message_index_length = out.size() - start;
}

}  // namespace sonard::mcap
