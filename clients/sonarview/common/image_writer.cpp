// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/image_writer.hpp"

#include <fmt/format.h>

#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "renderer/picture/picture_file.hpp"

namespace sonard::client {
namespace {

constexpr int png_level = 3;
constexpr std::size_t most_waiting = 64;  // calls of write(); about 20 MB of ordinary pings

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
    fresh_.clear();
  }
  changed_.notify_one();
}

void ImageWriter::refresh(std::vector<Picture> pictures) {
  {
    const std::lock_guard lock(mutex_);
    fresh_ = std::move(pictures);
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
    changed_.wait(lock, [this] { return finishing_ || !queue_.empty() || !fresh_.empty(); });
    const bool counted = !queue_.empty();
    if (!counted && fresh_.empty()) {
      return;
    }
    std::vector<Picture> pictures;
    if (counted) {
      pictures = std::move(queue_.front());
      queue_.pop_front();
    } else {
      pictures = std::exchange(fresh_, {});
    }
    lock.unlock();
    for (const Picture& picture : pictures) {
      written_ += save(picture) && counted ? 1 : 0;
    }
    lock.lock();
  }
}

bool ImageWriter::save(const Picture& picture) {
  const std::filesystem::path path = folder_ / picture.file;
  const std::filesystem::path part = folder_ / (".part-" + picture.file);
  bool saved = false;
  std::error_code error;
  try {
    const std::string png = picture::png_file(picture.draw(), png_level);
    std::ofstream out(part, std::ios::binary);
    saved = out.write(png.data(), static_cast<std::streamsize>(png.size())).flush().good();
  } catch (const std::exception&) {
    saved = false;  // usually out of memory; finish() reports it
  }
  if (saved) {
    std::filesystem::rename(part, path, error);
    saved = !error;
  }
  if (!saved) {
    std::filesystem::remove(part, error);
    if (error_.empty()) {
      error_ = "cannot write " + path.string();
    }
  }
  return saved;
}

}  // namespace sonard::client
