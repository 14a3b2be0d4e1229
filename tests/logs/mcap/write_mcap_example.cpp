// SPDX-License-Identifier: Apache-2.0
// Writes an MCAP file to standard output: twenty pings of two heads with their wire bytes and poses, in
// chunks. "recovered" cuts it in the middle of a chunk and then repairs it. check_mcap.js has the expected
// content.
#include <algorithm>
#include <cstdio>
#include <string_view>

#include "protocol/log/log_messages.hpp"
#include "protocol/mcap/recovery.hpp"
#include "protocol/mcap/writer.hpp"
#include "tests/unit/protocol/mcap/files.hpp"

namespace {

using namespace sonard;

constexpr std::uint64_t start_ns = 1'700'000'000'000'000'000;
constexpr std::uint64_t period_ns = 100'000'000;

void set_pose(pose::Pose& pose, double x, double y, double z) {
  pose.mutable_position_m()->set_x(x);
  pose.mutable_position_m()->set_y(y);
  pose.mutable_position_m()->set_z(z);
  pose.mutable_orientation()->set_w(1);
}

log::SonarImage image_of(std::uint32_t ping) {
  log::SonarImage image;
  image.set_head("bow");
  image.set_device_id(601);
  image.set_ping_number(ping);
  image.set_transmit_time_ns(static_cast<std::int64_t>(start_ns + ping * period_ns));
  image.set_range_lines(4);
  image.set_beams(3);
  for (std::uint32_t i = 0; i < 12; ++i) {
    image.mutable_pixels()->push_back(static_cast<char>(ping * 12 + i));
  }
  for (const double bearing : {0.5, 0.0, -0.5}) {
    image.add_bearings_rad(bearing);
  }
  image.set_metres_per_line(0.0083);
  image.set_sound_speed_mps(1499.2);
  set_pose(*image.mutable_t_world_vehicle(), ping, 2, -3);
  set_pose(*image.mutable_t_world_sonar(), ping + 0.25, 2, -3);
  return image;
}

log::ScanLine line_of(std::uint32_t ping) {
  log::ScanLine line;
  line.set_head("stern");
  line.set_line_number(ping);
  line.set_bearing_rad(0.1 * ping);
  line.set_bins(std::string{"\x01\x02\xFF", 3});
  line.set_metres_per_bin(0.025);
  return line;
}

log::WireBytes wire_of(std::uint32_t ping) {
  log::WireBytes wire;
  wire.set_head("bow");
  wire.set_direction(log::WireBytes::DIRECTION_TO_CLIENT);
  wire.set_transport(log::WireBytes::TRANSPORT_UDP);
  wire.set_peer("192.168.2.10:52900");
  wire.set_data(std::string(ping, 'x'));
  return wire;
}

log::PoseUsed pose_of(std::uint32_t ping) {
  log::PoseUsed used;
  used.set_time_ns(static_cast<std::int64_t>(start_ns + ping * period_ns));
  set_pose(*used.mutable_t_world_vehicle(), ping, 2, -3);
  auto& body = *used.add_bodies();
  body.set_name("door");
  set_pose(*body.mutable_pose(), 0, 0, ping);
  return used;
}

/// @param finished false: without the file's end and with an incomplete last chunk
mcap::Bytes example(bool finished, mcap::Compression compression) {
  mcap::Writer writer{"sonard tests", 1000, compression};
  mcap::testing::FileInMemory file;
  const auto add_channel = [&](const google::protobuf::Descriptor& message, std::string_view topic) {
    const auto schema = writer.add_schema(message.full_name(), log::encoding_name, log::schema_data(message));
    return writer.add_channel(schema, topic, log::encoding_name);
  };
  const auto images = add_channel(*log::SonarImage::descriptor(), "/bow/image");
  const auto lines = add_channel(*log::ScanLine::descriptor(), "/stern/line");
  const auto wire = add_channel(*log::WireBytes::descriptor(), "/bow/wire");
  const auto poses = add_channel(*log::PoseUsed::descriptor(), "/pose");
  for (std::uint32_t ping = 0; ping < 20; ++ping) {
    const std::uint64_t time = start_ns + ping * period_ns;
    writer.add_message(poses, time, time, encode(pose_of(ping)));
    writer.add_message(wire, time + 2, time, encode(wire_of(ping)));
    writer.add_message(images, time + 1, time, encode(image_of(ping)));
    writer.add_message(lines, time + 3, time, encode(line_of(ping)));
    writer.flush();
    writer.take().apply_to(file);
  }
  if (finished) {
    writer.finish();
    writer.take().apply_to(file);
  }
  return file.bytes;
}

/// A file whose writer was killed in the middle of the third chunk from the end, after its repair.
mcap::Bytes recovered(const mcap::Bytes& whole) {
  const auto summary = mcap::read_summary(whole);
  const mcap::ChunkIndex& hit = summary->chunks[summary->chunks.size() - 3];
  mcap::Bytes file{whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(hit.offset + hit.length / 2)};
  const auto recovery = mcap::recover(file);
  file.resize(recovery->keep_size);
  file.insert(file.end(), recovery->end.begin(), recovery->end.end());
  return file;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view kind = argc == 2 ? argv[1] : "";
  if (kind != "finished" && kind != "recovered" && kind != "growing" && kind != "zstd") {
    std::fputs("Usage: write_mcap_example finished|recovered|growing|zstd\n", stderr);
    return 64;
  }
  const mcap::Bytes whole =
      example(kind != "growing", kind == "zstd" ? mcap::Compression::zstd : mcap::Compression::none);
  const mcap::Bytes file = kind == "recovered" ? recovered(whole) : whole;
  return std::fwrite(file.data(), 1, file.size(), stdout) == file.size() ? 0 : 1;
}
