// SPDX-License-Identifier: Apache-2.0
// Reads MCAP files: what is in one, and its messages in the order of their log times.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <queue>
#include <set>
#include <vector>

#include "protocol/mcap/data_section.hpp"

namespace sonard::mcap {

/// A message in a compressed chunk.
struct MessagePlace {
  std::uint64_t chunk_offset = 0;  ///< in the file
  std::size_t offset = 0;          ///< of its data in the records of the chunk
  std::size_t size = 0;
};

/// Goes through the messages of a file, earliest log time first, those of equal times in the order of the
/// file. Takes a chunk apart when the first of its messages is due, and checks its CRC then. A chunk that
/// cannot be read costs its own messages and no others. Views the file.
class MessageCursor {
 public:
  /// nullopt at the end. What is in it is valid until the next call.
  std::optional<Message> next();
  /// Where the message that came last is in its chunk; nullopt: its data are a view of the file, which stays.
  std::optional<MessagePlace> place() const;
  /// Chunks that could not be read so far.
  const std::vector<DamagedChunk>& damaged() const { return damaged_; }

 private:
  friend class Reader;
  MessageCursor(ByteView file, std::vector<ChunkIndex> chunks, std::set<std::uint16_t> channels);

  struct Due {
    Message message;
    std::uint64_t chunk_offset = 0;
    std::size_t position = 0;              ///< of the data in the records of the chunk
    std::shared_ptr<const Bytes> storage;  ///< null: the data view the file
  };
  struct Later {
    bool operator()(const Due& a, const Due& b) const;
  };

  void open_due_chunks();
  std::optional<WireError> open(const ChunkIndex& index);

  ByteView file_;
  std::vector<ChunkIndex> chunks_;  ///< by start time
  std::size_t next_chunk_ = 0;
  std::set<std::uint16_t> channels_;  ///< empty: all
  std::priority_queue<Due, std::vector<Due>, Later> due_;
  Due last_;  ///< what next() gave
  std::vector<DamagedChunk> damaged_;
};

/// A file in memory, or mapped into it. A file that was finished is read by its summary. A file without a
/// readable summary is scanned once, and damaged parts of it are skipped. Chunks may be compressed with
/// Zstandard; attachments, metadata and unknown records are skipped. Views the file; threads may share it.
class Reader {
 public:
  /// An error when it does not begin as an MCAP file.
  static Result<Reader, WireError> open(ByteView file);

  const Summary& summary() const { return summary_; }
  /// The writer finished the file.
  bool finished() const { return finished_; }
  /// The writer finished the file, and the summary at its end cannot be read.
  bool lacks_summary() const { return lacks_summary_; }
  /// Why the scan ended before the file did.
  const std::optional<WireError>& stopped_by() const { return stopped_by_; }
  /// Bytes at the end of a file that was not finished: a record that was being written, or that is damaged.
  std::size_t tail_size() const { return tail_size_; }
  /// Parts that the scan skipped. A file that has a summary is not scanned: MessageCursor::damaged().
  const std::vector<DamagedChunk>& damaged() const { return damaged_; }

  /// @param channels only their messages; empty: all
  MessageCursor messages(std::set<std::uint16_t> channels = {}) const;
  /// Unpacks the chunk once more. nullopt when that cannot be read.
  std::optional<Bytes> data_at(const MessagePlace& place) const;

 private:
  Reader(ByteView file, Summary summary) : file_(file), summary_(std::move(summary)) {}

  ByteView file_;
  Summary summary_;
  bool finished_ = true;
  bool lacks_summary_ = false;
  std::size_t tail_size_ = 0;
  std::vector<DamagedChunk> damaged_;
  std::optional<WireError> stopped_by_;
};

}  // namespace sonard::mcap
