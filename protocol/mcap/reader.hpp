// SPDX-License-Identifier: Apache-2.0
// Reads MCAP files: their summary, and their messages in the order of log times.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <queue>
#include <set>
#include <vector>

#include "protocol/mcap/data_section.hpp"

namespace sonard::mcap {

/// Position of a message in a compressed chunk.
struct MessagePlace {
  std::uint64_t chunk_offset = 0;  ///< of the chunk in the file
  std::size_t offset = 0;          ///< of the message data in the records of the chunk
  std::size_t size = 0;
};

/// Iterates over the messages of a file by log time; messages with equal times in the order of the file.
/// Reads a chunk and checks its CRC when its first message is due. An unreadable chunk loses only its own
/// messages. Views the file.
class MessageCursor {
 public:
  /// The next message; nullopt at the end. Its data are valid until the next call.
  std::optional<Message> next();
  /// Position of the last message in its chunk; nullopt if its data view the file and so stay valid.
  std::optional<MessagePlace> place() const;
  /// Unreadable chunks so far.
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
  Due last_;  ///< returned by next()
  std::vector<DamagedChunk> damaged_;
};

/// A file in memory or mapped into memory. Uses the summary of a finished file. Scans a file without a
/// readable summary, or without chunk indexes in it, once and skips its damaged parts. Chunks may be
/// compressed with Zstandard; attachments, metadata and unknown records are skipped. Views the file; threads
/// may share it.
class Reader {
 public:
  /// Opens a file; an error if it does not begin as an MCAP file and holds no chunk.
  static Result<Reader, WireError> open(ByteView file);

  const Summary& summary() const { return summary_; }
  /// True if the writer finished the file.
  bool finished() const { return finished_; }
  /// True if the writer finished the file, but the summary at its end is unreadable.
  bool lacks_summary() const { return lacks_summary_; }
  /// Why the scan ended before the end of the file; nullopt if it did not.
  const std::optional<WireError>& stopped_by() const { return stopped_by_; }
  /// Bytes at the end of an unfinished file: an incomplete or damaged record.
  std::size_t tail_size() const { return tail_size_; }
  /// Parts that the scan skipped, and a damaged start. A file with a summary is not scanned; see also
  /// MessageCursor::damaged().
  const std::vector<DamagedChunk>& damaged() const { return damaged_; }

  /// @param channels return only messages of these channels; empty: all
  MessageCursor messages(std::set<std::uint16_t> channels = {}) const;
  /// Data of a message; unpacks its chunk again. nullopt if the chunk is unreadable.
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
