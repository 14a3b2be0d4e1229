// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/reader.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace sonard::mcap {

// ---- MessageCursor

MessageCursor::MessageCursor(ByteView file, std::vector<ChunkIndex> chunks, std::set<std::uint16_t> channels)
    : file_(file), chunks_(std::move(chunks)), channels_(std::move(channels)) {
  std::ranges::stable_sort(chunks_, {}, &ChunkIndex::start_time_ns);
}

bool MessageCursor::Later::operator()(const Due& a, const Due& b) const {
  return std::tie(a.message.log_time_ns, a.chunk_offset, a.position) >
         std::tie(b.message.log_time_ns, b.chunk_offset, b.position);
}

std::optional<Message> MessageCursor::next() {
  open_due_chunks();
  if (due_.empty()) {
    return std::nullopt;
  }
  last_ = due_.top();
  due_.pop();
  return last_.message;
}

std::optional<MessagePlace> MessageCursor::place() const {
  if (!last_.storage) {
    return std::nullopt;
  }
  return MessagePlace{last_.chunk_offset, last_.position, last_.message.data.size()};
}

/// Opens chunks until no further chunk can hold an earlier message than the pending ones.
void MessageCursor::open_due_chunks() {
  while (next_chunk_ < chunks_.size() &&
         (due_.empty() || chunks_[next_chunk_].start_time_ns <= due_.top().message.log_time_ns)) {
    const ChunkIndex& index = chunks_[next_chunk_++];
    if (const auto error = open(index)) {
      damaged_.push_back({{index.offset, index.length, *error}, indexed_messages(file_, index)});
    }
  }
}

/// Reads a chunk. @return an error if it is unreadable
std::optional<WireError> MessageCursor::open(const ChunkIndex& index) {
  const auto offset = static_cast<std::size_t>(index.offset);
  const auto record = record_at(file_, offset);
  const auto open_records = open_chunk_records(file_, offset);
  const bool closed = record && record->is(Opcode::chunk) && record->end() - offset == index.length;
  const bool open = open_records && chunk_start_size + open_records->size() == index.length;
  if (!closed && !open) {
    return WireError{WireErrorReason::bad_value, offset, "chunk_index.chunk_start_offset"};
  }
  const auto chunk = open ? read_chunk_records(*open_records) : read_chunk(*record);
  if (!chunk) {
    return chunk.error();
  }
  // A message before the stated start would break the order of messages, so reject the chunk.
  if (chunk->start_time_ns < index.start_time_ns) {
    return WireError{WireErrorReason::bad_value, offset, "chunk_index.message_start_time"};
  }
  for (const Message& message : chunk->messages) {
    if (channels_.empty() || channels_.contains(message.channel_id)) {
      due_.push({message, index.offset, static_cast<std::size_t>(message.data.data() - chunk->records.data()),
                 chunk->storage});
    }
  }
  return std::nullopt;
}

// ---- Reader

namespace {

/// True if every chunk is where the summary says. Bytes that are missing or too many at the start move them.
bool leads_to_chunks(const Summary& summary, ByteView file) {
  return std::ranges::all_of(summary.chunks, [&](const ChunkIndex& chunk) {
    const auto record = record_at(file, static_cast<std::size_t>(chunk.offset));
    return record && record->is(Opcode::chunk) && record->end() - record->offset == chunk.length;
  });
}

}  // namespace

Result<Reader, WireError> Reader::open(ByteView file) {
  const auto start = damaged_start(file);
  auto summary = read_summary(file);
  const bool lists_no_chunk = summary && summary->chunks.empty();  // of an empty file, or without indexes
  if (summary && !lists_no_chunk && (!start || leads_to_chunks(*summary, file))) {
    Reader reader{file, std::move(*summary)};
    if (start) {
      reader.damaged_.push_back(*start);
      reader.damaged_.back().holds = Holds::no_message;  // MessageCursor lists lost chunks
    }
    return reader;
  }
  auto section = scan_data_section(file, OnDamage::skip);
  if (!section) {
    return section.error();
  }
  Reader reader{file,
                std::move(lists_no_chunk && section->summary.chunks.empty() ? *summary : section->summary)};
  reader.finished_ = section->ended;
  reader.lacks_summary_ = section->ended && !lists_no_chunk;
  reader.tail_size_ = section->ended ? 0 : file.size() - section->end;
  reader.stopped_by_ = section->error;
  reader.damaged_ = std::move(section->damaged);
  return reader;
}

MessageCursor Reader::messages(std::set<std::uint16_t> channels) const {
  return {file_, summary_.chunks, std::move(channels)};
}

std::optional<Bytes> Reader::data_at(const MessagePlace& place) const {
  const auto record = record_at(file_, static_cast<std::size_t>(place.chunk_offset));
  if (!record || !record->is(Opcode::chunk)) {
    return std::nullopt;
  }
  const auto chunk = read_chunk(*record);
  if (!chunk || chunk->records.size() < place.offset || chunk->records.size() - place.offset < place.size) {
    return std::nullopt;
  }
  const ByteView data = chunk->records.subspan(place.offset, place.size);
  return Bytes(data.begin(), data.end());
}

}  // namespace sonard::mcap
