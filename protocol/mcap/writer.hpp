// SPDX-License-Identifier: Apache-2.0
// Writes an MCAP file as a sequence of pieces to append to it.
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

/// Changes to make to the file, in the order of apply_to(): a writer that is killed between two of them has
/// lost nothing that was in the file.
struct Piece {
  Bytes append;  ///< whole records; perhaps none
  /// Takes the place of bytes that are in the file since an earlier piece; empty: of none.
  Bytes rewrite;
  std::uint64_t rewrite_offset = 0;
  /// Where the file then ends, before `append`: a chunk that was open has become shorter.
  std::optional<std::uint64_t> cut_at{};

  /// @param file has append(bytes), overwrite(offset, bytes) and truncate(size)
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

/// What becomes of a chunk when it is closed.
enum class Compression { none, zstd };

/// Messages gather in a chunk; a chunk that is full, its message indexes, and at the end the summary are what
/// take() hands out. With flush() the chunk that is still open is handed out as far as it is: its beginning
/// says how long it is so far, and is written over as it grows. An open chunk has no CRC (0), by which it is
/// told from one that is closed.
///
/// A program that makes the changes of each piece and is killed loses what was not flushed and the piece that
/// was being appended, and with compression the chunk that it was just closing; recover() finishes what is
/// there. Schemas and channels stand in the chunk that was
/// open when they were added, so a file needs no summary to be read. They are repeated behind that chunk: if
/// it is damaged, the chunks that follow stay readable. Not thread-safe; holds one chunk and what has not
/// been taken.
class Writer {
 public:
  /// @param library who writes, for those who look into a file: "sonard 0.1.0"
  /// @param chunk_bytes a chunk of this size or more is closed; 1 puts every message into its own
  /// @param compression of chunks
  Writer(std::string_view library, std::size_t chunk_bytes, Compression compression = Compression::none);

  /// @return the id. At most 65535 of each may be added.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, ByteView data);
  std::uint16_t add_channel(std::uint16_t schema_id, std::string_view topic,
                            std::string_view message_encoding,
                            std::map<std::string, std::string> metadata = {});

  /// Requires a channel that was added, and that finish() was not called. Times are nanoseconds since the
  /// Unix epoch; log times may go back.
  void add_message(std::uint16_t channel_id, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                   ByteView data);

  /// Hands out the open chunk as far as it is, so that take() has all messages.
  void flush();
  /// Closes the open chunk before it is full, so that take() has all messages. Nothing happens when it is
  /// empty.
  void end_chunk();
  /// Closes the open chunk and writes the end of the file. Nothing may be added afterwards.
  void finish();

  /// The changes since the last call.
  Piece take();

  /// With what waits to be taken.
  std::uint64_t file_size() const { return taken_size_ + pending_.size(); }
  const Summary& summary() const { return summary_; }

 private:
  void put_chunk_start(std::uint32_t crc);
  Bytes closed_chunk(ChunkIndex& chunk) const;
  void put_closed_chunk(const Bytes& record);
  void repeat_definitions(Bytes& out);

  std::size_t chunk_bytes_;
  Compression compression_;
  Summary summary_;  ///< without the open chunk, but for schemas, channels and counts
  std::map<std::uint16_t, std::uint32_t> sequences_;
  std::size_t repeated_schemas_ = 0;
  std::size_t repeated_channels_ = 0;

  Bytes records_;  ///< of the open chunk
  MessageIndexes indexes_;
  std::uint64_t start_time_ns_ = 0;
  std::uint64_t end_time_ns_ = 0;
  std::optional<std::uint64_t> open_at_;  ///< where the open chunk begins in the file; nullopt: not in it
  std::size_t flushed_size_ = 0;          ///< of records_, what was handed out

  Bytes pending_;
  Bytes rewrite_;  ///< of the chunk that begins in what was taken
  std::uint64_t rewrite_offset_ = 0;
  std::optional<std::uint64_t> cut_at_;
  std::uint64_t taken_size_ = 0;
  std::uint32_t data_crc_ = 0;
};

/// Appends opcode, length and all of a chunk that stands before its records.
void append_chunk_start(Bytes& out, const ChunkIndex& chunk, std::uint32_t crc);

/// Appends the message index records of one chunk and notes in `chunk` where they stand; `file_offset` is
/// that of the front of `out`.
void append_message_indexes(Bytes& out, std::uint64_t file_offset, const MessageIndexes& indexes,
                            ChunkIndex& chunk);

}  // namespace sonard::mcap
