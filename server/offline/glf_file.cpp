// SPDX-License-Identifier: Apache-2.0
#include "server/offline/glf_file.hpp"

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include "protocol/glf/codec.hpp"
#include "protocol/glf/headers.hpp"
#include "protocol/glf/log_config.hpp"
#include "protocol/glf/log_time.hpp"
#include "protocol/glf/packer.hpp"

namespace sonard::server {
namespace {

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

GlfFile::GlfFile(const OutputFolder& folder, std::string app_name, std::uint64_t most_dat_size)
    : folder_(folder), app_name_(std::move(app_name)), most_dat_size_(most_dat_size) {}

GlfFile::~GlfFile() = default;

void GlfFile::add(const glf::ImageRecord& image) {
  const std::vector<std::uint8_t> record = glf::encode(image);
  if (dat_ && size_ + record.size() + glf::dat_terminator.size() > most_dat_size_) {
    finish();
  }
  if (!dat_) {
    dat_ = std::make_unique<PartFile>(folder_.path());
    size_ = 0;
    crc_ = {};
    first_time_s_ = image.origin.time_s;
    device_id_ = image.origin.device_id;
  }
  dat_->write(as_text(record));
  crc_.add(record);
  size_ += record.size();
  last_time_s_ = image.origin.time_s;
}

std::vector<std::string> GlfFile::close() {
  if (dat_) {
    finish();
  }
  std::vector<std::string> names;
  for (const Packed& log : packed_) {
    names.push_back(log.name);
  }
  while (!packed_.empty()) {
    packed_.back().file->publish(packed_.back().name);
    packed_.pop_back();
  }
  return names;
}

void GlfFile::finish() {
  dat_->write(as_text(glf::dat_terminator));
  crc_.add(glf::dat_terminator);
  size_ += glf::dat_terminator.size();
  const std::string stamp = glf::log_stamp(first_time_s_);
  const glf::Packer packer(stamp, glf::config_xml({app_name_, first_time_s_, last_time_s_, {device_id_}}),
                           {size_, crc_.value()}, glf::civil_time(last_time_s_));
  auto log = std::make_unique<PartFile>(folder_.path());
  log->write(as_text(packer.head()));
  for (std::uint64_t offset = 0; offset < size_; offset += glf::pack_block_size) {
    const std::string block = dat_->read(
        offset, static_cast<std::size_t>(std::min<std::uint64_t>(glf::pack_block_size, size_ - offset)));
    log->write(as_text(glf::Packer::block_header(block.size())));
    log->write(block);
  }
  log->write(as_text(packer.tail()));
  packed_.push_back({glf::log_name(stamp), std::move(log)});
  dat_.reset();
}

}  // namespace sonard::server
