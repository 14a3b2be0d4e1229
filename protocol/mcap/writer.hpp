// SPDX-License-Identifier: Apache-2.0
// Writes an MCAP file as a sequence of changes to the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/mcap/data_section.hpp"

namespace sonard::mcap {

/// Changes to the file. In the order of apply_to(), a program that is killed between two changes loses
/// nothing that was in the file.
struct Piece {
  Bytes append;  ///< whole records; may be empty
  /// Replaces bytes of an earlier piece in the file; empty: no change.
  Bytes rewrite;
  std::uint64_t rewrite_offset = 0;
  /// New size of the file before `append`, because a closed chunk became shorter.
  std::optional<std::uint64_t> cut_at{};

  /// @param file must have append(bytes), overwrite(offset, bytes) and truncate(size)
  template <class File>
  void apply_to(File& file) const {
    if (!cut_at) {
      file.append(append);
    }
    file.overwrite(rewrite_offset, rewrite);
    if (cut_at) {
      file.truncate(*cut_at);
      file.append(append);
    }
  }
};

/// Compression of closed chunks.
enum class Compression { none, zstd };

/// Collects messages in a chunk. take() returns full chunks with their message indexes, and at the end the
/// summary. After flush(), take() also returns the current part of the open chunk: its front states the
/// current length and is overwritten when the chunk grows. An open chunk has no CRC (0), unlike a closed one.
///
/// If a program that applies each piece is killed, it loses only unflushed messages and the piece in
/// progress, with compression also a chunk that it was closing. recover() finishes the file. Schemas and
/// channels are in the chunk that was open when they were added, so the file is readable without a summary.
/// They are repeated after that chunk: if it is damaged, the next chunks stay readable. Not thread-safe;
/// holds one chunk and the bytes that have not been taken.
class Writer {
 public:
  /// @param library name of the writing program, for readers of the file: "sonard 0.1.0"
  /// @param chunk_bytes size at which a chunk is closed; with 1 every message has its own chunk
  /// @param compression compression of chunks
  Writer(std::string_view library, std::size_t chunk_bytes, Compression compression = Compression::none);

  /// @return the id. At most 65535 schemas and 65535 channels may be added.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, ByteView data);
  std::uint16_t add_channel(std::uint16_t schema_id, std::string_view topic,
                            std::string_view message_encoding,
                            std::map<std::string, std::string> metadata = {});

  /// Adds a message to an added channel, before finish(). Times are nanoseconds since the Unix epoch; log
  /// times may go back.
  void add_message(std::uint16_t channel_id, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                   ByteView data);

  /// Adds the current part of the open chunk to the next piece, so that take() returns all messages.
  void flush();
  /// Closes the open chunk before it is full, so that take() returns all messages. No effect if it is empty.
  void end_chunk();
  /// Closes the open chunk and writes the end of the file. Nothing may be added afterwards.
  void finish();

  /// The changes since the last call.
  Piece take();

  /// Size of the file, with the bytes that have not been taken.
  std::uint64_t file_size() const { return taken_size_ + pending_.size(); }
  const Summary& summary() const { return summary_; }

 private:
  void put_chunk_start(std::uint32_t crc);
  Bytes closed_chunk(ChunkIndex& chunk) const;
  void put_closed_chunk(const Bytes& record);
  void repeat_definitions(Bytes& out);

  std::size_t chunk_bytes_;
  Compression compression_;
  Summary summary_;  ///< of the open chunk only schemas, channels and counts
  std::map<std::uint16_t, std::uint32_t> sequences_;
  std::size_t repeated_schemas_ = 0;
  std::size_t repeated_channels_ = 0;

  Bytes records_;  ///< of the open chunk
  MessageIndexes indexes_;
  std::uint64_t start_time_ns_ = 0;
  std::uint64_t end_time_ns_ = 0;
  std::optional<std::uint64_t> open_at_;  ///< offset of the open chunk in the file; nullopt: not flushed
  std::size_t flushed_size_ = 0;          ///< flushed part of records_

  Bytes pending_;
  Bytes rewrite_;  ///< for a chunk that begins in bytes already taken
  std::uint64_t rewrite_offset_ = 0;
  std::optional<std::uint64_t> cut_at_;
  std::uint64_t taken_size_ = 0;
  std::uint32_t data_crc_ = 0;
};

/// Appends all bytes of a chunk before its records: opcode, length and header.
void append_chunk_start(Bytes& out, const ChunkIndex& chunk, std::uint32_t crc);

/// Appends the message index records of one chunk and stores their positions in `chunk`; `file_offset` is the
/// offset in the file of the front of `out`.
void append_message_indexes(Bytes& out, std::uint64_t file_offset, const MessageIndexes& indexes,
                            ChunkIndex& chunk);

}  // namespace sonard::mcap
