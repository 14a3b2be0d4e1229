#include "server/recording/mcap_log.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "protocol/gemini/bearings.hpp"
#include "protocol/log/log_messages.hpp"
#include "protocol/micron/codec.hpp"
#include "protocol/pose/pose_message.hpp"
#include "server/config/addresses.hpp"
#include "server/recording/log_names.hpp"
#include "server/recording/served_pixels.hpp"

namespace sonard::server {
namespace {

constexpr double gemini_frequency_hz = 723'380.0;  // docs/protocols/gemini.md 9
constexpr double micron_frequency_hz = 700'000.0;  // docs/configuration.md, water
constexpr double micron_full_gain_db = 80.0;       // docs/protocols/micron.md 3

void set(pose::Pose& message, const render::Pose& value) {
  const glm::dvec3& p = value.position_m;
  const glm::dquat& q = value.orientation;
  pose::write(pose::Transform{{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}}, message);
}

std::string text(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

log::SonarImage to_message(const GeminiPingServed& ping, const std::string& head, std::int64_t transmit_ns) {
  const gemini::PingHead& said = ping.served.ping.head();
  log::SonarImage image;
  image.set_head(head);
  image.set_device_id(said.header.sonar_id);
  image.set_ping_number(ping.served.ping_number);
  image.set_transmit_time_ns(transmit_ns);
  image.set_range_lines(static_cast<std::uint32_t>(said.line_count()));
  image.set_beams(said.beams);
  image.set_pixels(text(served_pixels(ping.served.ping)));
  for (const double bearing_rad : gemini::bearings_rad(said.beams)) {
    image.add_bearings_rad(-bearing_rad);  // the wire counts to starboard
  }
  image.set_metres_per_line(said.sound_speed_mps() / (2.0 * gemini::line_rate_hz) *
                            (1 << said.compression_log2()));
  image.set_sound_speed_mps(said.sound_speed_mps());
  image.set_gain_percent(ping.gain_percent);
  image.set_frequency_hz(gemini_frequency_hz);
  set(*image.mutable_t_world_vehicle(), ping.poses->T_world_vehicle);
  set(*image.mutable_t_world_sonar(), ping.poses->T_world_sonar);
  return image;
}

log::ScanLine to_message(const MicronLineSent& sent, const HeadToRecord& head, std::int64_t transmit_ns) {
  log::ScanLine line;
  line.set_head(head.name);
  line.set_device_id(head.device_id);
  line.set_line_number(sent.line.ping_number);
  line.set_transmit_time_ns(transmit_ns);
  line.set_bearing_rad(-sent.job.bearing_rad);  // the device counts to starboard
  line.set_bins(text(sent.line.bins));
  line.set_bits_per_bin(sent.line.line.eight_bit() ? 8 : 4);
  line.set_wire_line(
      text(micron::encode(micron::Report{sent.line.line}, static_cast<std::uint8_t>(head.device_id))));
  line.set_metres_per_bin(sent.job.bin_length_m);
  line.set_sound_speed_mps(sent.job.sound_speed_mps);
  line.set_gain_percent(100.0 * sent.job.gain_db / micron_full_gain_db);
  line.set_frequency_hz(micron_frequency_hz);
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

McapLog::McapLog(const LogSetting& setting) : Log(setting), writer_("sonard " SONARD_VERSION, chunk_bytes) {}

void McapLog::write(const RecordingEvent& event) {
  if (!file().failed()) {
    std::visit([&](const auto& what) { add(event.head, event.time, what); }, event.what);
  }
}

void McapLog::add(int head, TimePoint time, const GeminiPingServed& ping) {
  const std::int64_t transmit_ns = setting().unix_ns(ping.transmit_time);
  add_message("/" + name(head) + "/image", time, transmit_ns, to_message(ping, name(head), transmit_ns));
  image_waits_ = true;
}

void McapLog::add(int head, TimePoint time, const MicronLineSent& line) {
  const std::int64_t transmit_ns = setting().unix_ns(line.job.transmit_time);
  add_message("/" + name(head) + "/line", time, transmit_ns,
              to_message(line, setting().heads[static_cast<std::size_t>(head)], transmit_ns));
  image_waits_ = true;
}

void McapLog::add(int, TimePoint time, const PingPosed& pose) {
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

void McapLog::add(int head, TimePoint time, const WirePassed& wire) {
  const std::string topic = "/" + name(head) + "/wire";
  for (const WirePiece& piece : wire.pieces) {
    log::WireBytes message;
    message.set_head(name(head));
    message.set_direction(wire.to_client ? log::WireBytes::DIRECTION_TO_CLIENT
                                         : log::WireBytes::DIRECTION_FROM_CLIENT);
    message.set_transport(to_message(wire.transport));
    message.set_peer(wire.transport == WireTransport::pty ? wire.pty : endpoint_text(piece.client));
    message.set_data(std::string(piece.bytes.begin(), piece.bytes.end()));
    add_message(topic, time, setting().unix_ns(time), message);
  }
}

template <class Message>
void McapLog::add_message(const std::string& topic, TimePoint time, std::int64_t publish_ns,
                          const Message& message) {
  if (!file().begun()) {
    flushed_at_ = chunk_begun_at_ = time;
    file().begin(mcap_path(setting().config.directory, setting().stem));
  }
  writer_.add_message(channel<Message>(topic), static_cast<std::uint64_t>(setting().unix_ns(time)),
                      static_cast<std::uint64_t>(publish_ns), log::encode(message));
}

template <class Message>
std::uint16_t McapLog::channel(const std::string& topic) {
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

void McapLog::flush(TimePoint now) {
  if (!file().begun()) {
    return;  // what the writer has, the beginning of the file, waits for it
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

void McapLog::write_taken() {
  const mcap::Piece piece = writer_.take();
  file().append(piece.append);
  file().overwrite(piece.rewrite_offset, piece.rewrite);
}

void McapLog::close() {
  if (file().begun() && !file().failed()) {
    writer_.finish();
    write_taken();
  }
  file().end();
}

}  // namespace sonard::server
