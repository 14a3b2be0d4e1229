// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/log_view.hpp"

#include <algorithm>
#include <utility>

#include "protocol/glf/deflate.hpp"
#include "protocol/glf/headers.hpp"
#include "protocol/glf/zip_entries.hpp"

namespace sonard::glf {
namespace {

constexpr std::uint8_t archive_start = 'P';

const ZipEntry* find_suffix(const std::vector<ZipEntry>& entries, std::string_view suffix) {
  const auto found =
      std::ranges::find_if(entries, [&](const ZipEntry& e) { return e.name.ends_with(suffix); });
  return found == entries.end() ? nullptr : &*found;
}

/// False if the first byte belongs to neither a record nor the terminator: a length in the local header is
/// wrong.
bool begins_as_dat(const PiecewiseBytes& dat) {
  std::uint8_t first = record_id;
  dat.copy(0, std::span{&first, std::min<std::size_t>(dat.size(), 1)});
  return first == record_id || first == dat_terminator.front();
}

/// Converts offsets in a record to offsets in the .dat.
template <class Record>
Result<Record, WireError> placed(Result<Record, WireError> decoded, const RecordEntry& entry) {
  if (decoded) {
    return decoded;
  }
  WireError error = decoded.error();
  error.offset += entry.offset;
  return error;
}

}  // namespace

Result<LogView, WireError> LogView::open(std::span<const std::uint8_t> file,
                                         std::uint64_t max_unpacked_size) {
  if (!file.empty() && file.front() == archive_start) {
    return open_archive(file, max_unpacked_size);
  }
  LogView log;
  log.dat_ = PiecewiseBytes{file};
  if (!begins_as_dat(log.dat_)) {
    return WireError{WireErrorReason::bad_value, 0, "file"};
  }
  log.index_ = index_dat(log.dat_, OnDamage::skip);
  return log;
}

Result<LogView, WireError> LogView::open_archive(std::span<const std::uint8_t> archive,
                                                 std::uint64_t max_unpacked_size) {
  const auto entries = zip_entries(archive);
  if (!entries) {
    return entries.error();
  }
  LogView log;
  if (const ZipEntry* config = find_suffix(*entries, ".cfg")) {
    const auto text = unpacked(*config, max_unpacked_size);
    if (!text) {
      return text.error();
    }
    log.config_xml_.assign(text->begin(), text->end());
  }
  const ZipEntry* dat = find_suffix(*entries, ".dat");
  if (dat == nullptr) {
    return WireError{WireErrorReason::bad_value, archive.size(), "dat_entry"};
  }
  if (auto pieces = stored_pieces(*dat)) {
    if (!begins_as_dat(*pieces)) {
      return WireError{WireErrorReason::bad_value, dat->offset, "entry_data"};
    }
    log.dat_ = std::move(*pieces);
    log.dat_crc_ = dat->crc;
  } else {
    auto content = unpacked(*dat, max_unpacked_size);
    if (!content) {
      return content.error();
    }
    log.unpacked_ = std::move(*content);
    log.dat_ = PiecewiseBytes{log.unpacked_};
  }
  log.index_ = index_dat(log.dat_, OnDamage::skip);
  return log;
}

std::optional<LogView> LogView::open_damaged(std::span<const std::uint8_t> file,
                                             std::uint64_t max_unpacked_size) {
  LogView log;
  auto dat = damaged_dat(file, max_unpacked_size);
  if (!dat) {
    log.dat_ = PiecewiseBytes{file};
  } else if (dat->unpacked.empty()) {
    log.unread_size_ = dat->unread_size;
    log.dat_ = std::move(dat->pieces);
  } else {
    log.unpacked_ = std::move(dat->unpacked);
    log.dat_ = PiecewiseBytes{log.unpacked_};
  }
  log.index_ = index_dat(log.dat_, OnDamage::skip);
  return dat || !log.index_.records.empty() ? std::optional(std::move(log)) : std::nullopt;
}

bool LogView::matches_checksum() const {
  if (!dat_crc_) {
    return true;
  }
  Crc32 crc;
  dat_.for_each_piece([&](std::span<const std::uint8_t> piece) { crc.add(piece); });
  return crc.value() == *dat_crc_;
}

Result<ImageRecord, WireError> LogView::image(const RecordEntry& entry) const {
  return placed(decode_image(record_bytes(entry)), entry);
}

Result<StatusRecord, WireError> LogView::status(const RecordEntry& entry) const {
  return placed(decode_status(record_bytes(entry)), entry);
}

std::vector<std::uint8_t> LogView::record_bytes(const RecordEntry& entry) const {
  std::vector<std::uint8_t> bytes(entry.size);
  dat_.copy(entry.offset, bytes);
  return bytes;
}

}  // namespace sonard::glf
