// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/image_writer.hpp"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace sonard::client {
namespace {

constexpr std::size_t most_waiting = 64;  // 20 MB of usual pings

}  // namespace

ImageWriter::ImageWriter(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    throw std::runtime_error(fmt::format("cannot make the folder {}: {}", folder_.string(), error.message()));
  }
  thread_ = std::thread([this] { run(); });
}

ImageWriter::~ImageWriter() {
  finish();
}

void ImageWriter::write(std::vector<Picture> pictures) {
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() == most_waiting) {
      queue_.pop_front();
      ++skipped_;
    }
    queue_.push_back(std::move(pictures));
  }
  changed_.notify_one();
}

void ImageWriter::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void ImageWriter::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return finishing_ || !queue_.empty(); });
    if (queue_.empty()) {
      return;
    }
    const std::vector<Picture> pictures = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    for (const Picture& picture : pictures) {
      save(picture);
    }
    lock.lock();
  }
}

void ImageWriter::save(const Picture& picture) {
  const std::string path = (folder_ / picture.file).string();
  bool saved = false;
  try {
    saved = cv::imwrite(path, picture.draw(), {cv::IMWRITE_PNG_COMPRESSION, 3});
  } catch (const cv::Exception&) {
    saved = false;  // no encoder, no memory
  }
  if (saved) {
    ++written_;
  } else if (error_.empty()) {
    error_ = "cannot write " + path;
  }
}

}  // namespace sonard::client
