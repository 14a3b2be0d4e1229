// SPDX-License-Identifier: Apache-2.0
// decode(encode(x)) == x for random values, and encode(decode(bytes)) == bytes for random bytes.
#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/layout.hpp"
#include "tests/unit/protocol/gemini/codec/fixture.hpp"

namespace sonard::gemini::testing {
namespace {

constexpr int rounds = 500;

class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}

  std::uint64_t bits() { return generator_(); }
  std::size_t below(std::size_t limit) { return generator_() % limit; }

  template <class Value>
  void fill(Value& value) {
    value = static_cast<Value>(bits());
  }
  template <class Element, std::size_t N>
  void fill(std::array<Element, N>& values) {
    for (auto& value : values) {
      fill(value);
    }
  }
  template <class Value>
  void fill(std::optional<Value>& value) {
    value.reset();
    if (bits() % 2 == 0) {
      fill(value.emplace());
    }
  }
  void fill(MacAddress& mac) { fill(mac.octets); }
  void fill(Header& header) {
    fill(header.sonar_id);
    fill(header.version);
    fill(header.packet_latency);
    fill(header.destination);
    fill(header.source);
  }
  template <class Value>
  void fill(std::vector<Value>& values, std::size_t size) {
    values.resize(size);
    for (auto& value : values) {
      fill(value);
    }
  }
  void fill(SerialByte& byte) {
    byte.time_us = bits() >> 8;
    fill(byte.value);
  }

  /// Fills every member that the layout table names.
  template <HasLayout Message>
  void fill_fields(Message& message) {
    std::apply([&](const auto&... field) { (fill_field(message, field), ...); }, Layout<Message>::fields);
  }

 private:
  template <class Message, class Member>
  void fill_field(Message& message, const Field<Message, Member>& field) {
    fill(message.*field.member);
  }
  template <class Message, std::size_t Size>
  void fill_field(Message&, const Spare<Size>&) {}

  std::mt19937_64 generator_;
};

template <HasLayout Message>
void fill_body(Random& random, Message& message, Bytes&) {
  random.fill_fields(message);
}
void fill_body(Random& random, PingLine& message, Bytes& storage) {
  random.fill_fields(message);
  random.fill(storage, 4 * random.below(300));
  message.line_info =
      make_line_info(storage.size(), random.below(2) == 0, static_cast<std::uint16_t>(random.bits()));
  message.data = storage;
}
void fill_body(Random& random, SerialTransmit& message, Bytes&) {
  random.fill(message.data, random.below(256));
}
void fill_body(Random& random, MdioCommands& message, Bytes&) {
  random.fill(message.words, random.below(732));
}
void fill_body(Random& random, SerialData& message, Bytes&) {
  random.fill(message.bytes, random.below(100));
}
void fill_body(Random& random, InfoBlockWrite& message, Bytes&) {
  random.fill(message.flags);
  switch (random.below(3)) {
    case 0:
      message.block =
          IdentityBlock{static_cast<std::uint32_t>(random.bits()), static_cast<std::uint32_t>(random.bits())};
      break;
    case 1:
      message.block = VelocimeterBlock{static_cast<std::uint32_t>(random.bits()),
                                       static_cast<std::int32_t>(random.bits())};
      break;
    default:
      message.block =
          AddressBlock{static_cast<std::uint32_t>(random.bits()), static_cast<std::uint32_t>(random.bits())};
  }
}

Result<Command, WireError> decode_any(const Command&, const Bytes& bytes) {
  return decode_command(bytes);
}
Result<Report, WireError> decode_any(const Report&, const Bytes& bytes) {
  return decode_report(bytes);
}

template <class Variant, class Message>
void round_trip() {
  Random random{static_cast<std::uint64_t>(Message::type) + 1000};
  for (int round = 0; round < rounds; ++round) {
    Bytes storage;
    Message message;
    random.fill(message.header);
    fill_body(random, message, storage);
    const Variant sent{message};
    const Bytes bytes = encode(sent);
    EXPECT_LE(bytes.size(), max_datagram_size);
    const auto received = decode_any(sent, bytes);
    ASSERT_TRUE(received) << static_cast<int>(Message::type) << ": " << to_string(received.error());
    ASSERT_TRUE(*received == sent) << static_cast<int>(Message::type) << " round " << round;
  }
}

template <class Variant, class... Messages>
void round_trip_all(const std::variant<Messages...>*) {
  const auto one = []<class Message>(const Message*) {
    if constexpr (!std::is_same_v<Message, Unknown>) {
      round_trip<Variant, Message>();
    }
  };
  (one(static_cast<const Messages*>(nullptr)), ...);
}

TEST(RoundTrip, EveryCommand) {
  round_trip_all<Command>(static_cast<const Command*>(nullptr));
}

TEST(RoundTrip, EveryReport) {
  round_trip_all<Report>(static_cast<const Report*>(nullptr));
}

/// If random bytes decode, encoding the result again gives a datagram with the same meaning.
TEST(RoundTrip, RandomBytesOfEveryType) {
  Random random{77};
  int understood = 0;
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes;
    random.fill(bytes, 8 + random.below(1100));
    bytes[0] = static_cast<std::uint8_t>(0x20 + random.below(0x30));
    if (const auto command = decode_command(bytes)) {
      const Bytes again = encode(*command);
      const auto back = decode_command(again);
      ASSERT_TRUE(back && *back == *command) << int{bytes[0]};
      ++understood;
    }
    if (const auto report = decode_report(bytes)) {
      const Bytes again = encode(*report);
      const auto back = decode_report(again);
      ASSERT_TRUE(back && *back == *report) << int{bytes[0]};
      ++understood;
    }
  }
  EXPECT_GT(understood, 10'000) << "too few to mean anything";
}

TEST(RoundTrip, UnknownKeepsTypeAndHeader) {
  const Command unknown = Unknown{Header{.sonar_id = 601, .version = 2}, 0xCB};
  const auto back = decode_command(encode(unknown));
  ASSERT_TRUE(back);
  EXPECT_TRUE(*back == unknown);
}

TEST(RoundTrip, OversizedVariablePartsAreCutToWhatFits) {
  SerialTransmit serial;
  serial.data.assign(300, 0x55);
  EXPECT_EQ(encode(serial).size(), 9U + 255U);
  MdioCommands mdio;
  mdio.words.assign(5000, 0x53);
  const Bytes bytes = encode(mdio);
  EXPECT_LE(bytes.size(), max_datagram_size);
  EXPECT_TRUE(decode_command(bytes));
}

}  // namespace
}  // namespace sonard::gemini::testing
