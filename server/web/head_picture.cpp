// SPDX-License-Identifier: Apache-2.0
#include "server/web/head_picture.hpp"

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

#include "renderer/picture/picture_file.hpp"
#include "server/web/foxglove_time.hpp"
#include "server/web/json.hpp"

namespace sonard::server {
namespace {

std::string base64(const std::string& bytes) {
  using namespace boost::archive::iterators;
  using Digits = base64_from_binary<transform_width<std::string::const_iterator, 6, 8>>;
  std::string text(Digits(bytes.begin()), Digits(bytes.end()));
  return text.append((4 - text.size() % 4) % 4, '=');
}

}  // namespace

std::shared_ptr<const std::string> HeadPicture::newest(const Pings& pings, const std::string& head,
                                                       TimePoint now, std::chrono::nanoseconds interval) {
  const std::shared_ptr<const ShownPing>& ping = pings.back();
  if (drawn_ && (drawn_ == ping || now - drawn_at_ < interval)) {
    return text_;
  }
  if (ping->record.settings.beams == 1) {
    for (const std::shared_ptr<const ShownPing>& line : pings) {
      picture_.keep(line->record);
    }
  }
  drawn_ = ping;
  drawn_at_ = now;
  text_ = nullptr;
  if (const cv::Mat drawn = picture_.draw(ping->record); !drawn.empty()) {
    text_ = std::make_shared<const std::string>(text_of({{"timestamp", foxglove_time(ping->time)},
                                                         {"frame_id", head},
                                                         {"data", base64(picture::png_file(drawn, 1))},
                                                         {"format", "png"}}));
  }
  return text_;
}

}  // namespace sonard::server
