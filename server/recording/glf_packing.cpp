// SPDX-License-Identifier: Apache-2.0
#include "server/recording/glf_packing.hpp"

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "protocol/glf/dat_index.hpp"
#include "protocol/glf/headers.hpp"
#include "protocol/glf/log_config.hpp"
#include "server/logs/mapped_file.hpp"
#include "server/recording/log_names.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;

glf::LogConfig config_of(const glf::DatIndex& index) {
  std::set<std::uint16_t> ids;
  for (const glf::RecordEntry& record : index.records) {
    ids.insert(record.origin.device_id);
  }
  // Not the time of packing, which may be days later, after a crash.
  return {"sonard " SONARD_VERSION,
          index.records.front().origin.time_s,
          index.records.back().origin.time_s,
          {ids.begin(), ids.end()}};
}

}  // namespace

bool GlfPacking::step() {
  if (!std::exchange(begun_, true)) {
    return begin();
  }
  return copied_ < dat_size_ ? copy_slice() : finish();
}

bool GlfPacking::begin() {
  stem_ = stem_of_dat(dat_path_);
  if (!close_dat()) {
    return false;
  }
  dat_.open(dat_path_, std::ios::binary);
  std::error_code error;
  const fs::path directory = dat_path_.parent_path();
  fs::remove(unfinished_glf_path(directory, stem_), error);
  glf_ = AppendFile::create(unfinished_glf_path(directory, stem_), error);
  // A placeholder: the CRC in the head is known only at the end, but its size is fixed.
  return good(error) && good(glf_.append(packer().head()));
}

// Reads the archive's metadata from the .dat, and ends the .dat.
bool GlfPacking::close_dat() {
  glf::DatIndex index;
  {
    const MappedFile dat(dat_path_);
    if (!good(dat.error())) {
      return false;
    }
    index = glf::index_dat(glf::PiecewiseBytes(dat.bytes()), OnDamage::skip);
  }
  std::error_code error;
  if (index.records.empty()) {
    fs::remove(dat_path_, error);
    return false;
  }
  const glf::LogConfig config = config_of(index);
  config_xml_ = glf::config_xml(config);
  closed_ = glf::civil_time(config.close_time_s);
  dat_size_ = index.whole_size + glf::dat_terminator.size();
  if (dat_size_ > glf::max_dat_size) {
    return give_up("it is too long for readers of this format");
  }
  if (index.closed) {
    return true;
  }
  AppendFile dat = AppendFile::open(dat_path_, error);
  return good(error) && good(dat.truncate(index.whole_size)) && good(dat.append(glf::dat_terminator));
}

glf::Packer GlfPacking::packer() const {
  return {stem_, config_xml_, {dat_size_, crc_.value()}, closed_};
}

bool GlfPacking::copy_slice() {
  std::vector<std::uint8_t> packed;
  std::vector<std::uint8_t> block;
  const std::uint64_t end = std::min(dat_size_, copied_ + slice_bytes);
  while (copied_ < end) {
    block.resize(static_cast<std::size_t>(std::min<std::uint64_t>(glf::pack_block_size, end - copied_)));
    if (!dat_.read(reinterpret_cast<char*>(block.data()), static_cast<std::streamsize>(block.size()))) {
      return give_up("it cannot be read");
    }
    crc_.add(block);
    const auto header = glf::Packer::block_header(block.size());
    packed.insert(packed.end(), header.begin(), header.end());
    packed.insert(packed.end(), block.begin(), block.end());
    copied_ += block.size();
  }
  return good(glf_.append(packed)) && (sync_ == RecordingSync::never || good(glf_.sync()));
}

bool GlfPacking::finish() {
  const fs::path directory = dat_path_.parent_path();
  if (!good(glf_.append(packer().tail())) || !good(glf_.overwrite(0, packer().head())) ||
      (sync_ != RecordingSync::never && !good(glf_.sync()))) {
    return false;
  }
  glf_.close();
  std::error_code error;
  fs::rename(unfinished_glf_path(directory, stem_), glf_path(directory, stem_), error);
  if (!good(error)) {
    return false;
  }
  if (sync_ != RecordingSync::never) {
    sync_directory(directory);
  }
  fs::remove(dat_path_, error);
  spdlog::info("recording: packed {}", glf_path(directory, stem_).string());
  return false;
}

bool GlfPacking::good(const std::error_code& error) {
  return !error || give_up(error.message());
}

bool GlfPacking::give_up(const std::string& why) {
  glf_.close();
  std::error_code ignored;
  fs::remove(unfinished_glf_path(dat_path_.parent_path(), stem_), ignored);
  spdlog::error("recording: cannot pack {}: {}; kept unpacked", dat_path_.string(), why);
  return false;
}

}  // namespace sonard::server
