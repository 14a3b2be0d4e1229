// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap/recovery.hpp"

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

}  // namespace

Result<Recovery, WireError> recover(ByteView file) {
  Recovery recovery;
  if (auto summary = read_summary(file)) {
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
