// Writes an MCAP file as a sequence of pieces to append to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/mcap/data_section.hpp"

namespace sonard::mcap {

/// Messages gather in a chunk; a chunk that is full, its message indexes, and at the end the summary are what
/// take() hands out. Whoever appends each of these pieces to a file loses, when killed, the open chunk and
/// the piece that was being appended; recover() finishes what is there. Schemas and channels stand in the
/// chunk that was open when they were added, so a file needs no summary to be read. Not thread-safe; holds
/// one chunk and what has not been taken.
class Writer {
 public:
  /// @param library who writes, for those who look into a file: "sonard 0.1.0"
  /// @param chunk_bytes a chunk of this size or more is closed; 1 puts every message into its own
  Writer(std::string_view library, std::size_t chunk_bytes);

  /// @return the id. At most 65535 of each may be added.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, ByteView data);
  std::uint16_t add_channel(std::uint16_t schema_id, std::string_view topic,
                            std::string_view message_encoding,
                            std::map<std::string, std::string> metadata = {});

  /// Requires a channel that was added, and that finish() was not called. Times are nanoseconds since the
  /// Unix epoch; log times may go back.
  void add_message(std::uint16_t channel_id, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                   ByteView data);

  /// Closes the open chunk before it is full, so that take() has all messages. Nothing happens when it is
  /// empty.
  void end_chunk();
  /// Closes the open chunk and writes the end of the file. Nothing may be added afterwards.
  void finish();

  /// What is to be appended to the file since the last call: whole records, perhaps none.
  Bytes take();

  /// Of what was handed out and of what waits to be taken.
  std::uint64_t file_size() const { return taken_size_ + pending_.size(); }
  const Summary& summary() const { return summary_; }

 private:
  void add_to_crc(std::size_t pending_start);

  std::size_t chunk_bytes_;
  Summary summary_;  ///< without the open chunk, but for schemas, channels and counts
  std::map<std::uint16_t, std::uint32_t> sequences_;

  Bytes records_;  ///< of the open chunk
  MessageIndexes indexes_;
  std::uint64_t start_time_ns_ = 0;
  std::uint64_t end_time_ns_ = 0;

  Bytes pending_;
  std::uint64_t taken_size_ = 0;
  std::uint32_t data_crc_ = 0;
};

/// Appends the message index records of one chunk and notes in `chunk` where they stand; `file_offset` is
/// that of the front of `out`.
void append_message_indexes(Bytes& out, std::uint64_t file_offset, const MessageIndexes& indexes,
                            ChunkIndex& chunk);

}  // namespace sonard::mcap
