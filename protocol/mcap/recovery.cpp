// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/recovery.hpp"

#include <string>
#include <utility>

#include "protocol/mcap/writer.hpp"

namespace sonard::mcap {
namespace {

/// Restores the message indexes of the last chunk if some are missing.
void complete_last_indexes(const DataSection& section, Recovery& recovery) {
  if (recovery.summary.chunks.empty()) {
    return;
  }
  ChunkIndex& last = recovery.summary.chunks.back();
  if (last.message_index_offsets.size() == section.last_indexes.size()) {
    return;
  }
  recovery.keep_size = section.last_chunk_end;
  last.message_index_offsets.clear();
  append_message_indexes(recovery.end, recovery.keep_size, section.last_indexes, last);
}

/// Closes the open chunk.
void close_last_chunk(ByteView file, const DataSection& section, Recovery& recovery) {
  ChunkIndex& last = recovery.summary.chunks.back();
  const ByteView records = file.subspan(static_cast<std::size_t>(last.offset) + chunk_start_size,
                                        static_cast<std::size_t>(last.records_size));
  recovery.keep_size = last.offset;
  last.message_index_offsets.clear();
  append_chunk_start(recovery.end, last, crc32(records));
  recovery.end.insert(recovery.end.end(), records.begin(), records.end());
  append_message_indexes(recovery.end, recovery.keep_size, section.last_indexes, last);
}

/// Appends the header of `file`, or an empty one if that is damaged.
void append_header_of(ByteView file, Bytes& out) {
  std::string profile;
  std::string library;
  if (const auto record = record_at(file, magic.size()); record && record->is(Opcode::header)) {
    ByteReader reader{record->content};
    profile = read_string(reader, "header.profile");
    library = read_string(reader, "header.library");
    if (!reader.ok() || reader.remaining() > 0) {
      profile.clear();
      library.clear();
    }
  }
  append_header(out, profile, library);
}

/// The new file: its parts and its size so far.
class Rebuilder {
 public:
  explicit Rebuilder(ByteView file) : file_(file) {
    next_.made.assign(magic.begin(), magic.end());
    append_header_of(file, next_.made);
  }

  void add_definitions(const Summary& summary) {
    for (const Schema& schema : summary.schemas) {
      append(next_.made, schema);
    }
    for (const Channel& channel : summary.channels) {
      append(next_.made, channel);
    }
  }

  /// Adds a chunk and closes it if it is open. @param chunk its index, which then belongs to the new file
  void add(ChunkIndex& chunk) {
    const auto at = static_cast<std::size_t>(chunk.offset);
    const auto records = open_chunk_records(file_, at);
    const bool open = records && chunk_start_size + records->size() == chunk.length;
    const auto contents = open ? read_chunk_records(*records) : read_chunk(*record_at(file_, at));
    if (!contents) {
      return;  // the scan has read it
    }
    chunk.offset = size_ + next_.made.size();
    chunk.message_index_offsets.clear();
    next_.offset = at;
    next_.size = chunk.length;
    if (open) {
      append_chunk_start(next_.made, chunk, crc32(*records));
      next_.offset += chunk_start_size;
      next_.size -= chunk_start_size;
    }
    end_part();
    append_message_indexes(next_.made, size_, contents->indexes, chunk);
  }

  std::vector<RebuiltPart> done(const Summary& summary) && {
    const Bytes end = make_end(summary, size_ + next_.made.size(), crc32(next_.made, crc_));
    next_.made.insert(next_.made.end(), end.begin(), end.end());
    end_part();
    return std::move(parts_);
  }

 private:
  void end_part() {
    size_ += next_.made.size() + next_.size;
    crc_ = crc32(file_.subspan(static_cast<std::size_t>(next_.offset), static_cast<std::size_t>(next_.size)),
                 crc32(next_.made, crc_));
    parts_.push_back(std::move(next_));
    next_ = {};
  }

  ByteView file_;
  RebuiltPart next_;
  std::uint64_t size_ = 0;
  std::uint32_t crc_ = 0;
  std::vector<RebuiltPart> parts_;
};

}  // namespace

Result<Rebuilt, WireError> rebuild(ByteView file) {
  auto section = scan_data_section(file, OnDamage::skip);
  if (!section) {
    return section.error();
  }
  Rebuilt rebuilt{
      .parts = {}, .damaged = std::move(section->damaged), .summary = std::move(section->summary)};
  if (!section->ended && section->end < file.size()) {
    const WireError truncated{WireErrorReason::truncated, section->end, "record"};
    rebuilt.damaged.push_back(
        {{section->end, file.size() - section->end, section->error.value_or(truncated)}, {}, Holds::unknown});
  }
  Rebuilder rebuilder{file};
  rebuilder.add_definitions(rebuilt.summary);
  for (ChunkIndex& chunk : rebuilt.summary.chunks) {
    rebuilder.add(chunk);
  }
  rebuilt.parts = std::move(rebuilder).done(rebuilt.summary);
  return rebuilt;
}

Result<Recovery, WireError> recover(ByteView file) {
  Recovery recovery;
  if (auto summary = read_summary(file); summary && begins_as_mcap(file)) {
    recovery.keep_size = file.size();
    recovery.summary = std::move(*summary);
    return recovery;
  }
  auto section = scan_data_section(file);
  if (!section) {
    return section.error();
  }
  if (section->error && section->error->field == "chunk.compression") {
    return *section->error;  // not damaged, but not written by sonard
  }
  recovery.keep_size = section->end;
  recovery.lost_size = section->ended ? 0 : file.size() - section->end;
  recovery.summary = std::move(section->summary);
  if (section->last_chunk_open) {
    close_last_chunk(file, *section, recovery);
  } else {
    complete_last_indexes(*section, recovery);
  }

  std::uint32_t crc = crc32(file.first(static_cast<std::size_t>(recovery.keep_size)));
  crc = crc32(recovery.end, crc);
  const Bytes end = make_end(recovery.summary, recovery.keep_size + recovery.end.size(), crc);
  recovery.end.insert(recovery.end.end(), end.begin(), end.end());
  return recovery;
}

}  // namespace sonard::mcap
