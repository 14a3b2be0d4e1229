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
/// file. Takes a chunk apart when the first of its messages is due, and checks its CRC then. Views the file.
class MessageCursor {
 public:
  /// nullopt at the end, and where a chunk cannot be read: error() tells them apart.
  /// What is in it is valid until the next call.
  std::optional<Message> next();
  /// Where the message that came last is in its chunk; nullopt: its data are a view of the file, which stays.
  std::optional<MessagePlace> place() const;
  const std::optional<WireError>& error() const { return error_; }

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

  bool open_due_chunks();
  bool open(const ChunkIndex& index);

  ByteView file_;
  std::vector<ChunkIndex> chunks_;  ///< by start time
  std::size_t next_chunk_ = 0;
  std::set<std::uint16_t> channels_;  ///< empty: all
  std::priority_queue<Due, std::vector<Due>, Later> due_;
  Due last_;  ///< what next() gave
  std::optional<WireError> error_;
};

/// A file in memory, or mapped into it. A file that was finished is read by its summary; one that was not is
/// gone through once, and has what recover() would keep. Chunks may be compressed with
/// Zstandard; attachments, metadata and unknown records are skipped. Views the file; threads may share it.
class Reader {
 public:
  /// An error when it does not begin as an MCAP file.
  static Result<Reader, WireError> open(ByteView file);

  const Summary& summary() const { return summary_; }
  /// The file ends as one that was finished does.
  bool finished() const { return finished_; }
  /// Why it has nothing beyond some place, when a record there cannot be read or is compressed.
  const std::optional<WireError>& stopped_by() const { return stopped_by_; }

  /// @param channels only their messages; empty: all
  MessageCursor messages(std::set<std::uint16_t> channels = {}) const;
  /// Unpacks the chunk once more. nullopt when that cannot be read.
  std::optional<Bytes> data_at(const MessagePlace& place) const;

 private:
  Reader(ByteView file, Summary summary) : file_(file), summary_(std::move(summary)) {}

  ByteView file_;
  Summary summary_;
  bool finished_ = true;
  std::optional<WireError> stopped_by_;
};

}  // namespace sonard::mcap
