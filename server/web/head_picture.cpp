// SPDX-License-Identifier: Apache-2.0
#include "server/web/head_picture.hpp"

#include <utility>

#include "renderer/picture/picture_file.hpp"
#include "server/web/base64.hpp"
#include "server/web/foxglove_time.hpp"
#include "server/web/json.hpp"

namespace sonard::server {
bool HeadPicture::begin(const std::shared_ptr<const ShownPing>& newest, TimePoint now,
                        std::chrono::nanoseconds interval) {
  if (under_way_ || (begun_ && (begun_ == newest || now - begun_at_ < interval))) {
    return false;
  }
  begun_ = newest;
  begun_at_ = now;
  under_way_ = true;
  return true;
}

Text HeadPicture::draw(const Pings& pings, const std::string& head) {
  const std::shared_ptr<const ShownPing>& ping = pings.back();
  if (ping->record.settings.beams == 1) {
    for (const std::shared_ptr<const ShownPing>& line : pings) {
      picture_.keep(line->record);
    }
  }
  const cv::Mat drawn = picture_.draw(ping->record);
  if (drawn.empty()) {
    return nullptr;
  }
  return std::make_shared<const std::string>(text_of({{"timestamp", foxglove_time(ping->time)},
                                                      {"frame_id", head},
                                                      {"data", base64(picture::png_file(drawn, 1))},
                                                      {"format", "png"}}));
}

void HeadPicture::drawn(Text picture) {
  under_way_ = false;
  text_ = std::move(picture);
}

}  // namespace sonard::server
