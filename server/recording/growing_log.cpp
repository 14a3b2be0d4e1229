// SPDX-License-Identifier: Apache-2.0
#include "server/recording/growing_log.hpp"

#include <spdlog/spdlog.h>

namespace sonard::server {

void GrowingLog::begin(const std::filesystem::path& path, Lines lines) {
  lines_ = lines;
  begun_ = true;
  std::error_code error;
  file_ = AppendFile::create(path, error);
  if (error) {
    fail(error);
    return;
  }
  if (lines_ == Lines::all) {
    spdlog::info("recording: writes {}", path.string());
  }
}

void GrowingLog::append(std::span<const std::uint8_t> piece) {
  if (!file_.is_open() || piece.empty()) {
    return;
  }
  if (const std::error_code error = file_.append(piece)) {
    fail(error);
  }
}

void GrowingLog::overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  if (!file_.is_open() || bytes.empty()) {
    return;
  }
  if (const std::error_code error = file_.overwrite(offset, bytes)) {
    fail(error);
  }
}

void GrowingLog::truncate(std::uint64_t size) {
  if (!file_.is_open()) {
    return;
  }
  if (const std::error_code error = file_.truncate(size)) {
    fail(error);
  }
}

void GrowingLog::sync() {
  if (!file_.is_open()) {
    return;
  }
  if (const std::error_code error = file_.sync()) {
    fail(error);
  }
}

void GrowingLog::end() {
  if (sync_ != RecordingSync::never) {
    sync();
  }
  file_.close();
}

void GrowingLog::fail(const std::error_code& error) {
  failed_ = true;
  error_ = error;
  file_.close();
  if (lines_ == Lines::all) {
    spdlog::error("recording: cannot write {}: {}; this log ends here, serving continues",
                  file_.path().string(), error.message());
  }
}

}  // namespace sonard::server
