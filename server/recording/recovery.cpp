// SPDX-License-Identifier: Apache-2.0
#include "server/recording/recovery.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>

#include <spdlog/spdlog.h>

#include "protocol/glf/dat_index.hpp"
#include "protocol/glf/log_view.hpp"
#include "protocol/mcap/data_section.hpp"
#include "protocol/mcap/recovery.hpp"
#include "protocol/pcapng/blocks.hpp"
#include "server/logs/mapped_file.hpp"
#include "server/recording/append_file.hpp"
#include "server/recording/log_names.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;

/// Repair of a file.
struct Mending {
  std::uint64_t keep_size = 0;
  std::vector<std::uint8_t> end;  ///< appended after keep_size; may repeat whole records that were there
  std::uint64_t lost_size = 0;    ///< bytes of a partly written record, which are lost
  bool damaged = false;           ///< the bytes after keep_size are more than a partly written record
};

bool copy_front(const fs::path& from, const fs::path& to, std::uint64_t size, std::error_code& error) {
  const MappedFile whole(from);
  AppendFile front = AppendFile::create(to, error);
  if (!error) {
    error = front.append(whole.bytes().first(static_cast<std::size_t>(size)));
  }
  return !error;
}

fs::path free_damaged_path(const fs::path& path) {
  fs::path damaged = path.string() + ".damaged";
  std::error_code ignored;
  for (int number = 2; fs::exists(damaged, ignored); ++number) {
    damaged = path.string() + ".damaged-" + std::to_string(number);
  }
  return damaged;
}

void keep_as_damaged(const fs::path& path, std::uint64_t whole_size) {
  const fs::path damaged = free_damaged_path(path);
  std::error_code error;
  fs::rename(path, damaged, error);
  if (!error && whole_size > 0) {
    copy_front(damaged, path, whole_size, error);
  }
  if (error) {
    spdlog::error("recording: cannot recover {}: {}", path.string(), error.message());
    return;
  }
  spdlog::warn("recording: {} is damaged after byte {}, kept as {}", path.string(), whole_size,
               damaged.string());
}

void tell_recovered(const fs::path& path, std::uint64_t lost_size) {
  if (lost_size == 0) {
    spdlog::info("recording: recovered {}: nothing is lost", path.string());
  } else {
    spdlog::info(
        "recording: recovered {}: all whole records are kept; {} bytes of an incomplete record are lost",
        path.string(), lost_size);
  }
}

void mend(const fs::path& path, const Mending& mending) {
  if (mending.damaged) {
    keep_as_damaged(path, mending.keep_size);
    if (mending.keep_size == 0) {
      return;
    }
  }
  std::error_code error;
  AppendFile file = AppendFile::open(path, error);
  if (!error) {
    error = file.truncate(mending.keep_size);
  }
  if (!error) {
    error = file.append(mending.end);
  }
  if (error) {
    spdlog::error("recording: cannot recover {}: {}", path.string(), error.message());
    return;
  }
  file.sync();
  if (!mending.damaged) {
    tell_recovered(path, mending.lost_size);
  }
}

std::optional<Mending> mending_of_mcap(std::span<const std::uint8_t> file) {
  if (mcap::read_summary(file)) {
    return std::nullopt;
  }
  const auto recovery = mcap::recover(file);
  if (!recovery) {
    return Mending{0, {}, 0, true};
  }
  const auto section = mcap::scan_data_section(file);
  return Mending{recovery->keep_size, recovery->end, recovery->lost_size, section && section->error};
}

// Every block ends with its length, so the last length shows whether the file ends with a whole block.
bool ends_with_a_block(std::span<const std::uint8_t> file) {
  if (file.size() < 12) {
    return false;
  }
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    length |= std::uint64_t{file[file.size() - 4 + i]} << (8 * i);
  }
  if (length > file.size()) {
    return false;
  }
  const auto block = pcapng::block_at(file, file.size() - static_cast<std::size_t>(length));
  return block && *block && (*block)->end() == file.size() &&
         ((*block)->type == static_cast<std::uint32_t>(pcapng::BlockType::enhanced_packet) ||
          (*block)->type == static_cast<std::uint32_t>(pcapng::BlockType::interface_description));
}

std::optional<Mending> mending_of_pcapng(std::span<const std::uint8_t> file) {
  if (ends_with_a_block(file)) {
    return std::nullopt;
  }
  const auto recovery = pcapng::recover(file);
  if (!recovery) {
    return Mending{0, {}, 0, true};
  }
  if (recovery->keep_size == file.size()) {
    return std::nullopt;
  }
  // Damaged if block_at() returns an error, not just the end: the bytes are not a block.
  return Mending{recovery->keep_size,
                 {},
                 file.size() - recovery->keep_size,
                 !pcapng::block_at(file, recovery->keep_size)};
}

// True if the .glf of a .dat is complete and only the removal of the .dat is missing.
bool is_packed(const fs::path& dat, const glf::DatIndex& index) {
  const MappedFile archive(glf_path(dat.parent_path(), stem_of_dat(dat)));
  const auto packed = glf::LogView::open(archive.bytes());
  return !archive.bytes().empty() && packed && packed->index().closed &&
         packed->index().whole_size == index.whole_size;
}

bool begins_like_a_record(const fs::path& dat) {
  const MappedFile file(dat);
  return !file.bytes().empty() && file.bytes().front() == '*';
}

/// Returns true if the .dat must be packed. Packing removes a .dat without a whole record.
bool recover_dat(const fs::path& path) {
  glf::DatIndex index;
  {
    const MappedFile file(path);
    index = glf::index_dat(glf::PiecewiseBytes(file.bytes()));
  }
  if (is_packed(path, index)) {
    std::error_code ignored;
    fs::remove(path, ignored);
    spdlog::info("recording: removed {}, which was already packed", path.string());
    return false;
  }
  const bool cut = !index.tail_error || index.tail_error->reason == WireErrorReason::truncated;
  if (!cut || (index.records.empty() && !begins_like_a_record(path))) {
    keep_as_damaged(path, index.whole_size);
  } else {
    tell_recovered(path, index.tail_size);
  }
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void recover_file(const fs::path& path, std::vector<fs::path>& dats) {
  std::error_code ignored;
  const std::string extension = path.extension();
  const bool ours = extension == ".mcap" || extension == ".pcapng" || !stem_of_dat(path).empty();
  if (ours && fs::file_size(path, ignored) == 0) {
    fs::remove(path, ignored);
    spdlog::info("recording: removed {}, which is empty", path.string());
    return;
  }
  if (const MappedFile file(path); ours && file.error()) {  // not damaged: it cannot be read
    spdlog::warn(
        "recording: cannot read {}: {}. The log stays as it is; to recover it, give the user that "
        "runs sonard the right to read and write it",
        path.string(), file.error().message());
    return;
  }
  if (!stem_of_dat(path).empty()) {
    if (recover_dat(path)) {
      dats.push_back(path);
    }
    return;
  }
  std::optional<Mending> mending;
  if (extension == ".mcap") {
    mending = mending_of_mcap(MappedFile(path).bytes());
  } else if (extension == ".pcapng") {
    mending = mending_of_pcapng(MappedFile(path).bytes());
  }
  if (mending) {
    mend(path, *mending);
  }
}

}  // namespace

std::vector<fs::path> recover_logs(const fs::path& directory) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<fs::path> dats;
  for (const fs::path& path : files) {
    if (path.string().ends_with(".glf.part")) {
      fs::remove(path, error);  // its .dat still exists
    } else if (fs::is_regular_file(path, error)) {
      recover_file(path, dats);
    }
  }
  return dats;
}

}  // namespace sonard::server
