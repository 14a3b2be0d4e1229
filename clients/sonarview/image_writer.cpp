#include "clients/sonarview/image_writer.hpp"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "protocol/gemini/bearings.hpp"

namespace sonard::client {
namespace {

constexpr std::size_t most_waiting = 64;  // 20 MB of usual pings

/// The samples in an OpenCV matrix that views them.
cv::Mat polar_of(const gemini::ReceivedPing& ping) {
  // OpenCV has no matrix of constant data; this one is only read.
  const bool eight_bit = !ping.samples.u8.empty();
  const void* data = eight_bit ? static_cast<const void*>(ping.samples.u8.data())
                               : static_cast<const void*>(ping.samples.u16.data());
  return {ping.lines, ping.head.beams, eight_bit ? CV_8UC1 : CV_16UC1, const_cast<void*>(data)};
}

std::string caption_of(const gemini::ReceivedPing& ping, double range_m) {
  return fmt::format("Gemini 720i  #{}   ping {}   {:.3f} s   {:.1f} m{}", ping.head.header.sonar_id,
                     ping.head.ping_id & 0xFF, static_cast<double>(ping.head.transmit_time_us) * 1e-6,
                     range_m, ping.complete() ? "" : fmt::format("   {} lines lost", ping.lines_lost));
}

}  // namespace

ImageWriter::ImageWriter(Settings settings) : settings_(std::move(settings)) {
  std::error_code error;
  std::filesystem::create_directories(settings_.folder, error);
  if (error) {
    throw std::runtime_error(
        fmt::format("cannot make the folder {}: {}", settings_.folder.string(), error.message()));
  }
  thread_ = std::thread([this] { run(); });
}

ImageWriter::~ImageWriter() {
  finish();
}

void ImageWriter::write(gemini::ReceivedPing ping, std::string name) {
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() == most_waiting) {
      queue_.pop_front();
      ++skipped_;
    }
    queue_.push_back({std::move(ping), std::move(name)});
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
    const Waiting waiting = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    draw(waiting);
    lock.lock();
  }
}

void ImageWriter::draw(const Waiting& waiting) {
  const gemini::ReceivedPing& ping = waiting.ping;
  FanShape shape;
  shape.bearings_rad = gemini::bearings_rad(ping.head.beams);
  shape.lines = ping.lines;
  shape.line_step_m =
      settings_.sound_speed_mps / (2.0 * gemini::line_rate_hz) * (1 << ping.head.compression_log2());
  if (!fan_ || fan_->geometry().shape() != shape) {
    fan_.emplace(shape, settings_.look);
  }
  const cv::Mat polar = polar_of(ping);
  cv::Mat eight_bit = polar;
  if (polar.type() != CV_8UC1) {
    polar.convertTo(eight_bit, CV_8UC1, 1.0 / 257.0);
  }
  save(fmt::format("fan-{}.png", waiting.name), fan_->draw(eight_bit, caption_of(ping, shape.range_m())));
  save(fmt::format("polar-{}.png", waiting.name), raw_polar_image(polar));
}

void ImageWriter::save(const std::string& file, const cv::Mat& image) {
  const std::string path = (settings_.folder / file).string();
  bool saved = false;
  try {
    saved = cv::imwrite(path, image, {cv::IMWRITE_PNG_COMPRESSION, 3});
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
