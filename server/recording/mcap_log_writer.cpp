// SPDX-License-Identifier: Apache-2.0
#include "server/recording/mcap_log_writer.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "protocol/log/log_messages.hpp"
#include "protocol/pose/pose_message.hpp"
#include "renderer/picture/picture_file.hpp"
#include "server/recording/foxglove_messages.hpp"
#include "server/recording/log_names.hpp"

namespace sonard::server {
namespace {

void set(pose::Pose& message, const render::Pose& value) {
  const glm::dvec3& p = value.position_m;
  const glm::dquat& q = value.orientation;
  pose::write(pose::Transform{{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}}, message);
}

std::string text(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

log::SonarImage image_message(const PingSent& sent, const HeadToRecord& head, std::int64_t transmit_ns) {
  const PingRecord& ping = sent.ping;
  log::SonarImage image;
  image.set_head(head.name);
  image.set_type(head.type);
  image.set_device_id(head.device_id);
  image.set_ping_number(ping.number);
  image.set_transmit_time_ns(transmit_ns);
  image.set_range_lines(static_cast<std::uint32_t>(ping.settings.bins));
  image.set_beams(static_cast<std::uint32_t>(ping.settings.beams));
  image.set_pixels(text(ping.samples));
  for (const double bearing_rad : ping.bearings_rad) {
    image.add_bearings_rad(log::bearing_for_log(bearing_rad));
  }
  image.set_wire_head(text(ping.wire));
  image.set_amplitude_exponent(ping.settings.amplitude_exponent);
  image.set_metres_per_line(ping.settings.bin_m);
  image.set_sound_speed_mps(ping.settings.sound_speed_mps);
  image.set_gain_percent(ping.settings.gain_percent);
  image.set_frequency_hz(ping.settings.frequency_hz);
  set(*image.mutable_t_world_vehicle(), sent.poses->T_world_vehicle);
  set(*image.mutable_t_world_sonar(), sent.poses->T_world_sonar);
  return image;
}

log::ScanLine line_message(const PingSent& sent, const HeadToRecord& head, std::int64_t transmit_ns) {
  const PingRecord& ping = sent.ping;
  log::ScanLine line;
  line.set_head(head.name);
  line.set_type(head.type);
  line.set_device_id(head.device_id);
  line.set_line_number(ping.number);
  line.set_transmit_time_ns(transmit_ns);
  line.set_bearing_rad(log::bearing_for_log(ping.bearings_rad.front()));
  line.set_bins(text(ping.samples));
  line.set_bits_per_bin(static_cast<std::uint32_t>(ping.bits_per_bin));
  line.set_wire_line(text(ping.wire));
  line.set_metres_per_bin(ping.settings.bin_m);
  line.set_sound_speed_mps(ping.settings.sound_speed_mps);
  line.set_gain_percent(ping.settings.gain_percent);
  line.set_frequency_hz(ping.settings.frequency_hz);
  set(*line.mutable_t_world_vehicle(), sent.poses->T_world_vehicle);
  set(*line.mutable_t_world_sonar(), sent.poses->T_world_sonar);
  return line;
}

log::WireBytes::Transport to_message(WireTransport transport) {
  switch (transport) {
    case WireTransport::udp:
      return log::WireBytes::TRANSPORT_UDP;
    case WireTransport::tcp:
      return log::WireBytes::TRANSPORT_TCP;
    case WireTransport::pty:
      break;
  }
  return log::WireBytes::TRANSPORT_SERIAL;
}

}  // namespace

McapLogWriter::McapLogWriter(const LogSetting& setting)
    : LogWriter(setting),
      writer_("sonard " SONARD_VERSION, chunk_bytes,
              setting.config.mcap_zstd ? mcap::Compression::zstd : mcap::Compression::none) {}

void McapLogWriter::write(const RecordingEvent& event) {
  if (!file().failed()) {
    std::visit([&](const auto& what) { add(event.head, event.time, what); }, event.what);
  }
}

void McapLogWriter::add(int head, TimePoint time, const PingSent& sent) {
  const std::int64_t transmit_ns = setting().unix_ns(sent.ping.transmit_time);
  const std::string topic = "/" + head_of(head).name;
  if (sent.ping.settings.beams > 1) {
    add_message(topic + "/image", time, transmit_ns, image_message(sent, head_of(head), transmit_ns));
  } else {
    add_message(topic + "/line", time, transmit_ns, line_message(sent, head_of(head), transmit_ns));
  }
  if (setting().config.mcap_foxglove) {
    add_for_foxglove(head, time, sent);
  }
  image_waits_ = true;
}

void McapLogWriter::add_for_foxglove(int head, TimePoint time, const PingSent& sent) {
  const std::int64_t transmit_ns = setting().unix_ns(sent.ping.transmit_time);
  const std::string& name = head_of(head).name;
  const std::string topic = "/" + name;
  add_message(topic + "/transform", time, transmit_ns,
              foxglove_transform(sent.poses->T_world_sonar, name, transmit_ns));
  add_message(topic + "/echoes", time, transmit_ns, foxglove_echoes(sent.ping, name, transmit_ns));
  PingPicture& picture = pictures_[head];
  if (sent.ping.settings.beams == 1) {
    picture.keep(sent.ping);
    const auto [drawn, is_first] = drawn_at_.try_emplace(head, time);
    if (!is_first && time - drawn->second < sweep_picture_interval) {
      return;
    }
    drawn->second = time;
  }
  if (const cv::Mat drawn = picture.draw(sent.ping); !drawn.empty()) {
    add_message(topic + "/picture", time, transmit_ns,
                foxglove_image(picture::jpeg_file(drawn, 80), name, transmit_ns));
  }
}

void McapLogWriter::add(int, TimePoint time, const PingPosed& pose) {
  log::PoseUsed used;
  const std::int64_t transmit_ns = setting().unix_ns(pose.poses->time);
  used.set_time_ns(transmit_ns);
  set(*used.mutable_t_world_vehicle(), pose.poses->T_world_vehicle);
  for (const PosedBody& body : pose.poses->bodies) {
    pose::BodyPose& message = *used.add_bodies();
    message.set_name(body.name);
    set(*message.mutable_pose(), body.T_world_body);
  }
  add_message("/pose", time, transmit_ns, used);
}

void McapLogWriter::add(int head, TimePoint time, const WirePassed& wire) {
  if (!setting().config.mcap_wire_bytes) {
    return;
  }
  const std::string topic = "/" + head_of(head).name + "/wire";
  for (const WirePiece& piece : wire.pieces) {
    log::WireBytes message;
    message.set_head(head_of(head).name);
    message.set_direction(wire.to_client ? log::WireBytes::DIRECTION_TO_CLIENT
                                         : log::WireBytes::DIRECTION_FROM_CLIENT);
    message.set_transport(to_message(wire.transport));
    message.set_peer(wire.transport == WireTransport::pty ? wire.pty : endpoint_text(piece.client));
    message.set_data(std::string(piece.bytes.begin(), piece.bytes.end()));
    add_message(topic, time, setting().unix_ns(time), message);
  }
}

template <class Message>
void McapLogWriter::add_message(const std::string& topic, TimePoint time, std::int64_t publish_ns,
                                const Message& message) {
  if (!file().begun()) {
    flushed_at_ = chunk_begun_at_ = time;
    file().begin(mcap_path(setting().config.directory, setting().stem));
  }
  writer_.add_message(channel<Message>(topic), static_cast<std::uint64_t>(setting().unix_ns(time)),
                      static_cast<std::uint64_t>(publish_ns), log::encode(message));
}

template <class Message>
std::uint16_t McapLogWriter::channel(const std::string& topic) {
  if (const auto known = channels_.find(topic); known != channels_.end()) {
    return known->second;
  }
  const auto& type = *Message::descriptor();
  const auto schema = schemas_.find(type.full_name());
  const std::uint16_t schema_id =
      schema != schemas_.end()
          ? schema->second
          : schemas_
                .emplace(type.full_name(),
                         writer_.add_schema(type.full_name(), log::encoding_name, log::schema_data(type)))
                .first->second;
  return channels_.emplace(topic, writer_.add_channel(schema_id, topic, log::encoding_name)).first->second;
}

void McapLogWriter::flush(TimePoint now) {
  if (!file().begun()) {
    return;  // the writer's data, the start of the file, waits for begin()
  }
  if (now - chunk_begun_at_ >= longest_chunk) {
    writer_.end_chunk();
    chunk_begun_at_ = now;
  }
  if (image_waits_ || now - flushed_at_ >= longest_wait) {
    writer_.flush();
    image_waits_ = false;
    flushed_at_ = now;
  }
  write_taken();
}

void McapLogWriter::write_taken() {
  writer_.take().apply_to(file());
}

void McapLogWriter::close() {
  if (file().begun() && !file().failed()) {
    writer_.finish();
    write_taken();
  }
  file().end();
}

}  // namespace sonard::server
