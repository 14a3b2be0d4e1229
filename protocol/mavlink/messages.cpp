// SPDX-License-Identifier: Apache-2.0
#include "protocol/mavlink/messages.hpp"

#include <algorithm>
#include <tuple>

#include "protocol/common/layout.hpp"

namespace sonard::mavlink {
namespace {

// On the wire the fields of a definition are sorted by the size of their type, longest first (MAVLink guide,
// "Packet Serialization", field reordering).
template <class Message>
struct Layout;

template <>
struct Layout<Attitude> : WholeLayout<28> {
  static constexpr std::tuple fields{Field{0, "time_boot_ms", &Attitude::time_boot_ms},
                                     Field{4, "roll", &Attitude::roll},
                                     Field{8, "pitch", &Attitude::pitch},
                                     Field{12, "yaw", &Attitude::yaw},
                                     Field{16, "rollspeed", &Attitude::rollspeed},
                                     Field{20, "pitchspeed", &Attitude::pitchspeed},
                                     Field{24, "yawspeed", &Attitude::yawspeed}};
};

template <>
struct Layout<AttitudeQuaternion> : WholeLayout<32> {
  using A = AttitudeQuaternion;
  static constexpr std::tuple fields{Field{0, "time_boot_ms", &A::time_boot_ms},
                                     Field{4, "q1", &A::q1},
                                     Field{8, "q2", &A::q2},
                                     Field{12, "q3", &A::q3},
                                     Field{16, "q4", &A::q4},
                                     Field{20, "rollspeed", &A::rollspeed},
                                     Field{24, "pitchspeed", &A::pitchspeed},
                                     Field{28, "yawspeed", &A::yawspeed}};
};

template <>
struct Layout<LocalPositionNed> : WholeLayout<28> {
  using P = LocalPositionNed;
  static constexpr std::tuple fields{Field{0, "time_boot_ms", &P::time_boot_ms},
                                     Field{4, "x", &P::x},
                                     Field{8, "y", &P::y},
                                     Field{12, "z", &P::z},
                                     Field{16, "vx", &P::vx},
                                     Field{20, "vy", &P::vy},
                                     Field{24, "vz", &P::vz}};
};

template <>
struct Layout<GlobalPositionInt> : WholeLayout<28> {
  using G = GlobalPositionInt;
  static constexpr std::tuple fields{Field{0, "time_boot_ms", &G::time_boot_ms},
                                     Field{4, "lat", &G::lat},
                                     Field{8, "lon", &G::lon},
                                     Field{12, "alt", &G::alt},
                                     Field{16, "relative_alt", &G::relative_alt},
                                     Field{20, "vx", &G::vx},
                                     Field{22, "vy", &G::vy},
                                     Field{24, "vz", &G::vz},
                                     Spare<2>{26}};  // hdg
};

template <>
struct Layout<Odometry> : WholeLayout<230> {
  using O = Odometry;
  static constexpr std::tuple fields{Field{0, "time_usec", &O::time_usec},
                                     Field{8, "x", &O::x},
                                     Field{12, "y", &O::y},
                                     Field{16, "z", &O::z},
                                     Field{20, "q", &O::q},
                                     Field{36, "vx", &O::vx},
                                     Field{40, "vy", &O::vy},
                                     Field{44, "vz", &O::vz},
                                     Field{48, "rollspeed", &O::rollspeed},
                                     Field{52, "pitchspeed", &O::pitchspeed},
                                     Field{56, "yawspeed", &O::yawspeed},
                                     Spare<168>{60},  // pose_covariance, velocity_covariance
                                     Field{228, "frame_id", &O::frame_id},
                                     Field{229, "child_frame_id", &O::child_frame_id}};
};

template <class Content, MessageId id>
Result<Message, WireError> read(const Frame& frame) {
  using Table = Layout<Content>;
  static_assert(layout_is_contiguous<Table>(0));
  static_assert(kind_of(static_cast<std::uint32_t>(id))->base_size == Table::size);
  if (frame.version == 1 && frame.payload.size() < Table::size) {
    return WireError{WireErrorReason::bad_length, frame.payload.size(), "payload"};
  }
  std::array<std::uint8_t, Table::size> whole{};
  std::ranges::copy(frame.payload.first(std::min(frame.payload.size(), Table::size)), whole.begin());
  ByteReader reader(whole);
  Content content;
  read_fields<Table>(reader, content);
  return Message{content};
}

}  // namespace

Result<Message, WireError> decode(const Frame& frame) {
  switch (static_cast<MessageId>(frame.message_id)) {
    case MessageId::attitude:
      return read<Attitude, MessageId::attitude>(frame);
    case MessageId::attitude_quaternion:
      return read<AttitudeQuaternion, MessageId::attitude_quaternion>(frame);
    case MessageId::local_position_ned:
      return read<LocalPositionNed, MessageId::local_position_ned>(frame);
    case MessageId::global_position_int:
      return read<GlobalPositionInt, MessageId::global_position_int>(frame);
    case MessageId::odometry:
      return read<Odometry, MessageId::odometry>(frame);
    case MessageId::heartbeat:
      break;
  }
  return Message{};
}

}  // namespace sonard::mavlink
