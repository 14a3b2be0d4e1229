// SPDX-License-Identifier: Apache-2.0
// The messages of a Gemini 720i as values, both directions, one struct per message.
// Source: protocol/gemini/README.md, section numbers beside each struct. Members keep the device's own
// integers and units, so that decode and encode lose nothing; member functions and helpers convert them.
// Spare fields are written as zero and skipped on reading.
// "Client" is the computer that commands the head; "head" is the sonar. Multi-byte integers are
// little-endian.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace sonard::gemini {

inline constexpr std::uint16_t client_port = 52900;  ///< everything from the head goes to this UDP port (1.1)
inline constexpr std::uint16_t head_port = 52901;    ///< every command goes to this UDP port (1.1)

inline constexpr std::size_t header_size = 8;
inline constexpr std::size_t max_datagram_size = 1472;  ///< no fragmentation at MTU 1500 (1.1)
inline constexpr std::size_t flash_page_size = 1024;

inline constexpr int beam_count = 256;            ///< in every 720i ping
inline constexpr int channel_count = 96;          ///< receive elements
inline constexpr double line_rate_hz = 90422.0;   ///< native range lines per second (6.7)
inline constexpr double carrier_hz = 723'380.0;   ///< of the sound (9)
inline constexpr std::uint16_t min_sonar_id = 2;  ///< 0 is "not set", 1 is reserved for production (1.4)

enum class MessageType : std::uint8_t {
  status_request = 0x20,
  ping_config = 0x21,
  flash_write = 0x22,
  flash_read = 0x23,
  info_block_write = 0x24,
  info_block_read = 0x25,
  serial_transmit = 0x2A,
  reboot = 0x2B,
  test_result_request = 0x2C,
  production_test = 0x2D,
  power_on_self_test = 0x2E,
  abort_production_test = 0x2F,
  retry_request = 0x30,
  network_config = 0x31,
  mdio_commands = 0x32,
  tx_drive_test = 0x33,
  gpo_write = 0x34,
  gpio_read = 0x35,
  diagnostic_request = 0x36,
  going_offline = 0xC8,

  status = 0x40,
  ping_head = 0x41,
  ping_line = 0x42,
  ping_tail = 0x43,
  flash_result = 0x44,
  flash_readback = 0x45,
  velocimeter_data = 0x47,
  serial_data = 0x48,
  acknowledge = 0x49,
  test_result = 0x4A,
  mdio_acknowledge = 0x4B,
  gpi_data = 0x4C,
  diagnostic = 0x4D,
};

/// Bytes 0..7 of every message without the type, which the struct implies (2). A head accepts any values
/// except in sonar_id.
struct Header {
  std::uint16_t sonar_id = 0;        ///< ID of the addressed or sending head
  std::uint8_t version = 1;          ///< of the data link
  std::uint16_t packet_latency = 0;  ///< never implemented; 0
  std::uint8_t destination = 0;      ///< sub-device; later clients send 2
  std::uint8_t source = 0;           ///< sub-device; later clients send 1, a 720i sends 0

  bool operator==(const Header&) const = default;
};

/// Octets in the order of the text form, most significant first; the order on the wire is reversed.
struct MacAddress {
  std::array<std::uint8_t, 6> octets{};

  bool operator==(const MacAddress&) const = default;
};

/// A message of an unknown type. Receivers must ignore it (3.1).
struct Unknown {
  Header header{};
  std::uint8_t type = 0;

  bool operator==(const Unknown&) const = default;
};

// ---- Client -> head

/// 0x20, 8 bytes: stay-alive. Answered by Acknowledge (3.2).
struct StatusRequest {
  static constexpr MessageType type = MessageType::status_request;
  Header header{};

  bool operator==(const StatusRequest&) const = default;
};

enum class RunMode : std::uint8_t {
  single = 0,            ///< one ping now
  continuous = 1,        ///< pings every PingConfig::interping_us, start to start
  external_trigger = 2,  ///< one ping per edge of the TTL input
  reserved = 3,
};

enum class DataType : std::uint8_t {
  beam_magnitude = 0,
  beam_iq = 1,
  channel_iq = 2,
  channel_samples = 3,
};

/// Bits of PingConfig::ext_mode and PingHead::ext_mode (5).
namespace ext_bits {
inline constexpr std::uint16_t data_type_mask = 0x0003;
inline constexpr std::uint16_t eight_bit = 0x0004;  ///< magnitudes only; clear: 16 bit
inline constexpr std::uint16_t focus_mask = 0x0018;
inline constexpr std::uint16_t velocimeter_each_ping = 0x0100;
inline constexpr std::uint16_t ping_out_of_water = 0x0200;
inline constexpr std::uint16_t velocimeter_once = 0x0400;
inline constexpr std::uint16_t scope_data = 0x1000;
inline constexpr std::uint16_t no_time_delay_beamforming = 0x2000;
}  // namespace ext_bits

/// Native lines per sent line as a power of two: bits 2..0; 5..7 count as 0 (6.1).
int compression_log2(std::uint16_t range_compression);

/// 0x21, 68 bytes: settings of the receiver, and the command to ping (5). A new one replaces the last.
/// Defaults are from the early client library.
struct PingConfig {
  static constexpr MessageType type = MessageType::ping_config;
  Header header{};
  std::array<std::uint16_t, 4> idents{};  ///< unused by the head
  std::uint16_t run_mode = 0;             ///< bits 1..0 RunMode; bit 15 trigger edge: 0 rising, 1 falling
  std::uint16_t ext_mode = ext_bits::eight_bit;
  std::uint16_t start_range = 0;  ///< ignored by the head
  std::uint16_t end_range = 33;   ///< native range lines to acquire
  std::uint32_t interping_us = 200'000;
  std::uint16_t tx_length = 4;           ///< pulse, carrier cycles, 0..255; 0: listen without transmitting
  std::uint16_t tx_angle = 0;            ///< not implemented
  std::uint16_t main_gain = 1000;        ///< bits 15..14 base gain in steps of 5.5 dB; 13..0 variable gain
  std::uint16_t absorption = 0;          ///< 12 bits, units undocumented
  std::uint32_t software_gain = 0xFF00;  ///< scale undocumented
  std::uint16_t spreading = 250;         ///< carries the percent gain of later clients (5)
  std::uint16_t auto_gain = 0;           ///< not implemented in the head
  std::uint16_t filter_bank = 0;         ///< receive bandwidth (3 + n) * 10 kHz, n = 0..7
  std::uint16_t shade_bank = 1;          ///< 0 none; 1..7 = 15..45 dB in steps of 5 dB
  std::uint16_t sound_speed = 15'000;    ///< 0.1 m/s
  std::uint16_t velocimeter_mode = 1;    ///< bit 0: 1 use sound_speed, 0 use the head's velocimeter
  std::uint16_t range_compression = 0;  ///< bits 2..0: compression_log2; bit 8: peak (a 720i always averages)
  std::uint16_t rle_threshold = 0;      ///< see rle_threshold_applied
  std::uint16_t sample_channel = 0;     ///< 0..95, for DataType::channel_samples
  std::uint16_t velocimeter_gain = 0;   ///< ignored
  std::uint8_t velocimeter_tx_length = 1;  ///< cycles
  std::uint8_t tx_mark = 29;               ///< transmitter mark time
  std::uint16_t image_mode = 0;
  std::uint8_t power_management = 1;
  std::uint8_t software_gain_ramp = 0;
  std::uint8_t velocimeter_tx_period = 30;
  std::uint8_t velocimeter_tx_mark = 17;

  RunMode mode() const { return static_cast<RunMode>(run_mode & 3); }
  DataType data_type() const { return static_cast<DataType>(ext_mode & ext_bits::data_type_mask); }
  /// True if samples have one byte: bit 2 is set and the data are magnitudes.
  bool eight_bit() const;
  bool pings_out_of_water() const { return (ext_mode & ext_bits::ping_out_of_water) != 0; }
  bool uses_configured_sound_speed() const { return (velocimeter_mode & 1) != 0; }
  double sound_speed_mps() const { return sound_speed * 0.1; }
  int compression_log2() const { return gemini::compression_log2(range_compression); }
  /// Number of lines that the head sends: floor(end_range / 2^compression_log2).
  int line_count() const { return end_range >> compression_log2(); }
  /// Threshold that the head applies: 0 if off or if samples are not 8-bit magnitudes. 1 and 2 act as 3;
  /// values above 255 act as 255.
  std::uint8_t rle_threshold_applied() const;

  bool operator==(const PingConfig&) const = default;
};

/// 0x22, 1040 bytes (3.7). Answered by FlashResult, then FlashReadback if `read_back()`.
struct FlashWrite {
  static constexpr MessageType type = MessageType::flash_write;
  Header header{};
  std::uint32_t address = 0;  ///< multiple of flash_page_size
  std::uint16_t flags = 0;    ///< bit 0: read back
  std::array<std::uint8_t, flash_page_size> data{};

  bool read_back() const { return (flags & 1) != 0; }

  bool operator==(const FlashWrite&) const = default;
};

/// 0x23, 12 bytes (3.7). Answered by FlashReadback.
struct FlashRead {
  static constexpr MessageType type = MessageType::flash_read;
  Header header{};
  std::uint32_t address = 0;

  bool operator==(const FlashRead&) const = default;
};

/// Bank 0, production only (3.7).
struct IdentityBlock {
  std::uint32_t sonar_id = 0;
  std::uint32_t transducer = 1;  ///< 1 = 723 kHz, 0 = 868 kHz

  bool operator==(const IdentityBlock&) const = default;
};

/// Bank 1, production only (3.7).
struct VelocimeterBlock {
  std::uint32_t m_coefficient = 0;
  std::int32_t c_coefficient = 0;

  bool operator==(const VelocimeterBlock&) const = default;
};

/// Bank 2, programmable by users. Takes effect at the next reboot (3.7).
struct AddressBlock {
  std::uint32_t alternate_ip = 0;  ///< first octet most significant
  std::uint32_t subnet_mask = 0;   ///< first octet most significant

  bool operator==(const AddressBlock&) const = default;
};

/// 0x24, 28 bytes for bank 0, 152 for banks 1 and 2 (3.7). Answered by FlashResult. The decoder drops the 128
/// filler bytes of the long form, which are uninitialised memory of the sender.
struct InfoBlockWrite {
  static constexpr MessageType type = MessageType::info_block_write;
  Header header{};
  std::uint16_t flags = 0;
  std::variant<IdentityBlock, VelocimeterBlock, AddressBlock> block{};  ///< its index is the bank number

  bool operator==(const InfoBlockWrite&) const = default;
};

/// 0x25, 12 bytes (3.7). Answered by FlashReadback.
struct InfoBlockRead {
  static constexpr MessageType type = MessageType::info_block_read;
  Header header{};
  std::uint32_t bank = 0;  ///< 0..2

  bool operator==(const InfoBlockRead&) const = default;
};

/// 0x2A, 9 + n bytes: bytes for the serial port of the head (3.8). No answer.
struct SerialTransmit {
  static constexpr MessageType type = MessageType::serial_transmit;
  Header header{};
  std::vector<std::uint8_t> data{};  ///< at most 255 bytes; encode() drops the rest

  bool operator==(const SerialTransmit&) const = default;
};

/// 0x2B, 12 bytes (3.9). No answer: the head reboots.
struct Reboot {
  static constexpr MessageType type = MessageType::reboot;
  Header header{};
  std::uint8_t control = 1;  ///< 1 = reboot into the main image, 2 = stay in the boot loader

  bool operator==(const Reboot&) const = default;
};

/// 0x2C, 12 bytes (3.10). Answered by TestResult.
struct TestResultRequest {
  static constexpr MessageType type = MessageType::test_result_request;
  Header header{};

  bool operator==(const TestResultRequest&) const = default;
};

/// 0x2D, 24 bytes, 20 from 32-bit clients (3.10). No answer until TestResultRequest.
struct ProductionTest {
  static constexpr MessageType type = MessageType::production_test;
  Header header{};
  std::uint64_t seed = 0;  ///< bit 63: use this seed
  std::uint8_t flags = 0;  ///< bit 0: run

  bool operator==(const ProductionTest&) const = default;
};

/// 0x2E, 12 bytes (3.10). No answer until TestResultRequest.
struct PowerOnSelfTest {
  static constexpr MessageType type = MessageType::power_on_self_test;
  Header header{};

  bool operator==(const PowerOnSelfTest&) const = default;
};

/// 0x2F, 12 bytes (3.10). No answer.
struct AbortProductionTest {
  static constexpr MessageType type = MessageType::abort_production_test;
  Header header{};

  bool operator==(const AbortProductionTest&) const = default;
};

enum class RetryKind : std::uint16_t { head = 0, lines = 1, tail = 2 };

/// 0x30, 16 bytes: requests parts of the last ping again (3.5, 7).
struct RetryRequest {
  static constexpr MessageType type = MessageType::retry_request;
  Header header{};
  RetryKind kind = RetryKind::head;  ///< may be any value on the wire; a head ignores unknown ones
  std::uint16_t first_line = 0;      ///< 0-based, for RetryKind::lines
  std::uint16_t line_count = 1;      ///< 0 counts as 1

  bool operator==(const RetryRequest&) const = default;
};

/// 0x31, 22 bytes, 20 from early clients (3.6). No answer.
struct NetworkConfig {
  static constexpr MessageType type = MessageType::network_config;
  Header header{};
  std::uint8_t ethernet_ifg = 15;      ///< inter-frame gap, clock cycles
  std::uint8_t vdsl_ifg = 15;          ///< inter-frame gap, clock cycles
  std::uint8_t advertise_gigabit = 0;  ///< 0 or 1
  std::uint8_t rate_adaption = 0;      ///< VDSL retraining, bits in 3.6
  std::uint16_t baud_divisor = 1302;   ///< of the serial port; 1302 = 9600 baud
  std::uint16_t serial_poll_us = 50'000;
  std::uint16_t inter_packet_gap = 0;  ///< minimum time between ping datagrams, units of 8 ns
  std::uint16_t serial_routing = 0;
  std::optional<std::uint16_t>
      extension;  ///< only in the 22-byte form, meaning unknown; later clients send 10000

  bool operator==(const NetworkConfig&) const = default;
};

/// 0x32, 10 + 2 n bytes: a script of register writes for the modem (3.11). Answered by MdioAcknowledge.
struct MdioCommands {
  static constexpr MessageType type = MessageType::mdio_commands;
  Header header{};
  std::vector<std::uint16_t> words;  ///< at most 731 to fit into a datagram; encode() drops the rest

  bool operator==(const MdioCommands&) const = default;
};

/// 0x33, 12 bytes (3.11).
struct TxDriveTest {
  static constexpr MessageType type = MessageType::tx_drive_test;
  Header header{};
  std::uint16_t drive = 0;

  bool operator==(const TxDriveTest&) const = default;
};

/// 0x34, 12 bytes (3.11).
struct GpoWrite {
  static constexpr MessageType type = MessageType::gpo_write;
  Header header{};
  std::uint16_t outputs = 0;  ///< bit 0: the output

  bool operator==(const GpoWrite&) const = default;
};

/// 0x35, 12 bytes (3.11). Answered by GpiData.
struct GpioRead {
  static constexpr MessageType type = MessageType::gpio_read;
  Header header{};

  bool operator==(const GpioRead&) const = default;
};

/// 0x36, 12 bytes (3.11). Answered by Diagnostic; later clients repeat it until answered.
struct DiagnosticRequest {
  static constexpr MessageType type = MessageType::diagnostic_request;
  Header header{};

  bool operator==(const DiagnosticRequest&) const = default;
};

/// 0xC8, 10 bytes: the client stops listening and the head must stop pinging (8.2). No answer.
struct GoingOffline {
  static constexpr MessageType type = MessageType::going_offline;
  Header header{};

  bool operator==(const GoingOffline&) const = default;
};

// ---- Head -> client

/// Code of a board temperature in Status: bit 15 present, bits 9..0 two's complement in 0.25 degC (3.3).
/// Clamps to -128 .. +127.75; rounds to the nearest step. The code of a missing sensor is 0.
std::uint16_t temperature_code(double celsius);
/// Inverse of temperature_code; nullopt if bit 15 is clear.
std::optional<double> temperature_celsius(std::uint16_t code);
/// Code of the FPGA's die temperature: code * 503.975 / 1024 - 273.15 degC, rounded, clamped to 10 bits
/// (3.3).
std::uint16_t die_temperature_code(double celsius);
double die_temperature_celsius(std::uint16_t code);

/// Bits of Status::shutdown_status (3.3).
namespace shutdown_bits {
inline constexpr std::uint16_t over_temperature = 0x0001;
inline constexpr std::uint16_t out_of_water_stop = 0x0002;  ///< out of the water, so the head does not ping
inline constexpr std::uint16_t out_of_water = 0x0004;
}  // namespace shutdown_bits

/// Values of Status::link_type (3.3).
namespace link_bits {
inline constexpr std::uint16_t vdsl = 0x0001;
inline constexpr std::uint16_t ethernet_10 = 0x0002;
inline constexpr std::uint16_t ethernet_100 = 0x0004;
}  // namespace link_bits

/// 0x40, 110 bytes: identity and health of the head, sent once a second, also for discovery (3.3, 1.3).
/// Defaults describe a healthy 720i on 100 Mbit/s Ethernet; the head sets sonar_id and the addresses.
struct Status {
  static constexpr MessageType type = MessageType::status;
  Header header{};
  std::uint16_t firmware_version = 0x0119;
  std::uint16_t sonar_id = 0;           ///< equals header.sonar_id
  std::uint32_t fixed_ip = 0x0A3D13C8;  ///< first octet most significant
  std::uint32_t alternate_ip = 0;       ///< must be non-zero and reachable, or later clients send nothing
  std::uint32_t surface_ip = 0;         ///< address of the connected client; 0: not connected
  std::uint16_t flags = 0;              ///< high byte: product code, 0 = 720i
  std::uint16_t vcc_int = 341;          ///< raw monitor code, 1.0 V
  std::uint16_t vcc_aux = 853;          ///< raw monitor code, 2.5 V
  std::uint16_t dc_voltage = 2400;      ///< taken as 0.01 V
  std::uint16_t die_temperature = 0;    ///< die_temperature_code
  std::uint16_t dip_switches = 0;       ///< a 720i has no DIP switches
  std::uint16_t vga1a_temperature = 0;  ///< temperature_code, like all further temperatures
  std::uint16_t vga1b_temperature = 0;
  std::uint16_t vga2a_temperature = 0;
  std::uint16_t vga2b_temperature = 0;
  std::uint16_t psu1_temperature = 0;
  std::uint16_t psu2_temperature = 0;
  std::uint64_t clock_us = 0;              ///< head clock, microseconds since boot
  std::uint16_t transducer = 1;            ///< 1 = 723 kHz, 0 = 868 kHz
  std::uint32_t subnet_mask = 0xFFFFFF00;  ///< must equal the mask of the client's interface
  std::uint16_t tx1_temperature = 0;
  std::uint16_t tx2_temperature = 0;
  std::uint16_t tx3_temperature = 0;
  std::uint32_t boot_status = 0x00000105;        ///< (value & 0x1FF) == 1 means "boot loader"
  std::uint16_t shutdown_status = 0;             ///< bits of namespace shutdown_bits
  std::uint16_t die_shutdown_temperature = 0;    ///< die_temperature_code
  std::uint16_t vga1a_shutdown_temperature = 0;  ///< temperature_code, like all further temperatures
  std::uint16_t vga1b_shutdown_temperature = 0;
  std::uint16_t vga2a_shutdown_temperature = 0;
  std::uint16_t vga2b_shutdown_temperature = 0;
  std::uint16_t psu1_shutdown_temperature = 0;
  std::uint16_t psu2_shutdown_temperature = 0;
  std::uint16_t tx1_shutdown_temperature = 0;
  std::uint16_t tx2_shutdown_temperature = 0;
  std::uint16_t tx3_shutdown_temperature = 0;
  std::uint16_t link_type = link_bits::ethernet_100;
  std::uint16_t vdsl_downstream1 = 0;  ///< low byte constellation, high byte symbol rate; 0 on Ethernet
  std::uint16_t vdsl_downstream2 = 0;
  MacAddress mac{};
  std::uint16_t vdsl_upstream1 = 0;
  std::uint16_t vdsl_upstream2 = 0;

  std::uint8_t product_code() const { return static_cast<std::uint8_t>(flags >> 8); }
  bool out_of_water() const { return (shutdown_status & shutdown_bits::out_of_water) != 0; }

  bool operator==(const Status&) const = default;
};

/// Bit of PingHead::sound_speed_used: the speed is from the ping configuration.
inline constexpr std::uint16_t sound_speed_from_config = 0x8000;

/// 0x41, 48 bytes; 46 and 47 are accepted (6.2).
struct PingHead {
  static constexpr MessageType type = MessageType::ping_head;
  Header header{};
  std::uint16_t ping_id = 0;           ///< 0..255; later clients discard other values (6.3)
  std::uint16_t ext_mode = 0;          ///< copied from the configuration
  std::uint64_t transmit_time_us = 0;  ///< head clock
  std::uint16_t start_range = 0;
  std::uint16_t end_range = 0;  ///< native lines, as in the configuration but limited by plan_ping()
  std::uint32_t line_time = 0;  ///< not implemented; 0
  std::uint16_t beams = beam_count;
  std::uint16_t channels = channel_count;
  std::uint8_t sample_channel = 0;
  std::uint8_t base_gain = 0;           ///< bits 15..14 of the main gain, 0..3
  std::uint16_t velocimeter_speed = 0;  ///< 0.1 m/s; a head never sends 0
  std::uint16_t velocimeter_echo_time = 0;
  std::uint16_t velocimeter_readings = 1;
  std::uint16_t tx_angle = 0;
  std::uint16_t sound_speed_used = 0;  ///< bits 14..0 in 0.1 m/s; bit 15: sound_speed_from_config
  std::uint8_t rle_threshold = 0;      ///< as applied by the head: 0, or 3..255
  std::uint8_t range_compression = 0;  ///< as applied by the head: 0..4
  std::uint8_t decimation = 0;         ///< 0 on a 720i; absent in 46-byte messages

  bool eight_bit() const { return (ext_mode & ext_bits::eight_bit) != 0; }
  int compression_log2() const { return gemini::compression_log2(range_compression); }
  /// Number of lines that follow: floor((end_range - start_range) / 2^compression_log2), at least 0 (6.1).
  int line_count() const;
  double sound_speed_mps() const { return (sound_speed_used & 0x7FFF) * 0.1; }

  bool operator==(const PingHead&) const = default;
};

inline constexpr std::uint16_t resent_line = 0x8000;  ///< bit of PingLine::line_id
inline constexpr std::uint16_t last_line = 0x0040;    ///< bit of PingLine::line_info

/// PingLine::line_info: number of 32-bit words, last-line flag, low bits of the ext mode (6.4).
/// `data_bytes` must be a multiple of 4, at most 2044.
constexpr std::uint16_t make_line_info(std::size_t data_bytes, bool last, std::uint16_t ext_mode) {
  return static_cast<std::uint16_t>((data_bytes / 4) << 7 | (last ? last_line : 0U) | (ext_mode & 0x3FU));
}

/// 0x42, 16 + data bytes: all beams at one range, port to starboard (6.4).
struct PingLine {
  static constexpr MessageType type = MessageType::ping_line;
  Header header{};
  std::uint8_t gain = 0;        ///< not implemented; 0
  std::uint8_t ping_id = 0;     ///< low byte of PingHead::ping_id
  std::uint16_t line_id = 0;    ///< bits 14..0 line number, counted after compression; bit 15 resent_line
  std::uint16_t scale = 0;      ///< software gain of this line, scale undocumented
  std::uint16_t line_info = 0;  ///< see make_line_info()
  /// Samples or their run-length coded form. After decode_report() it views the datagram; for encode() it
  /// views the caller's bytes. Its length must be 4 * word_count().
  std::span<const std::uint8_t> data{};

  int line_number() const { return line_id & 0x7FFF; }
  bool resent() const { return (line_id & resent_line) != 0; }
  bool last() const { return (line_info & last_line) != 0; }
  std::size_t word_count() const { return line_info >> 7; }

  bool operator==(const PingLine& other) const;  ///< compares the viewed bytes of `data`
};

inline constexpr std::uint8_t resent_tail = 0x80;  ///< bit of PingTail::flags

/// 0x43, 12 bytes (6.9).
struct PingTail {
  static constexpr MessageType type = MessageType::ping_tail;
  Header header{};
  std::uint8_t ping_id = 0;  ///< low byte of PingHead::ping_id
  std::uint8_t flags = 0;    ///< bit 7: resent_tail

  bool resent() const { return (flags & resent_tail) != 0; }

  bool operator==(const PingTail&) const = default;
};

/// 0x44, 16 bytes (3.7).
struct FlashResult {
  static constexpr MessageType type = MessageType::flash_result;
  Header header{};
  std::uint32_t address = 0;
  std::uint16_t result = 0x8000;  ///< bit 15: ready; all other bits clear: success

  bool success() const { return (result & 0x7FFF) == 0; }

  bool operator==(const FlashResult&) const = default;
};

/// FlashReadback::address in the answer to InfoBlockRead of bank 0, 1, 2 (3.7).
inline constexpr std::array<std::uint32_t, 3> info_block_addresses{0x3E0000, 0x7C0000, 0x7E0000};

/// 0x45, 1040 bytes (3.7).
struct FlashReadback {
  static constexpr MessageType type = MessageType::flash_readback;
  Header header{};
  std::uint32_t address = 0;
  std::array<std::uint8_t, flash_page_size> data{};

  bool operator==(const FlashReadback&) const = default;
};

/// 0x47, 1036 bytes, contents undocumented (3.12). A simulated head never sends it.
struct VelocimeterData {
  static constexpr MessageType type = MessageType::velocimeter_data;
  Header header{};
  std::uint16_t block_count = 0;
  std::array<std::uint8_t, 1024> data{};

  bool operator==(const VelocimeterData&) const = default;
};

/// One byte received at the serial port of the head.
struct SerialByte {
  std::uint64_t time_us = 0;  ///< head clock; the wire carries the low 56 bits
  std::uint8_t value = 0;

  bool operator==(const SerialByte&) const = default;
};

/// 0x48, 8 + 8 n bytes (3.8).
struct SerialData {
  static constexpr MessageType type = MessageType::serial_data;
  Header header{};
  std::vector<SerialByte> bytes{};

  bool operator==(const SerialData&) const = default;
};

/// 0x49, 24 bytes: answer to StatusRequest (3.13).
struct Acknowledge {
  static constexpr MessageType type = MessageType::acknowledge;
  Header header{};
  std::uint64_t receipt_us = 0;  ///< head clock at the arrival of the request
  std::uint64_t reply_us = 0;    ///< head clock at the sending of this message

  bool operator==(const Acknowledge&) const = default;
};

/// 0x4A, 54 bytes (3.10). Defaults: a healthy head.
struct TestResult {
  static constexpr MessageType type = MessageType::test_result;
  Header header{};
  std::array<std::uint16_t, 4> marks{0xA000, 0xA001, 0xA002, 0xA003};
  std::uint32_t sram0_result = 0x10000000;
  std::uint32_t sram1_result = 0x10000000;
  std::uint16_t flash_post_result = 0x1000;
  std::uint64_t flash_production_result = 0;
  std::uint32_t first_error_address = 0xFFFFFFFF;  ///< 0xFFFFFFFF: none
  std::uint64_t seed_written = 0;
  std::uint64_t seed_used = 0;

  bool operator==(const TestResult&) const = default;
};

/// 0x4B, 10 bytes (3.11).
struct MdioAcknowledge {
  static constexpr MessageType type = MessageType::mdio_acknowledge;
  Header header{};
  std::uint16_t result = 0;

  bool operator==(const MdioAcknowledge&) const = default;
};

/// 0x4C, 10 bytes (3.11).
struct GpiData {
  static constexpr MessageType type = MessageType::gpi_data;
  Header header{};
  std::uint16_t inputs = 0;

  bool operator==(const GpiData&) const = default;
};

/// 0x4D, 18 bytes: identities of the boards; any values are valid (3.11).
struct Diagnostic {
  static constexpr MessageType type = MessageType::diagnostic;
  Header header{};
  std::uint16_t rx1_board = 1;
  std::uint16_t rx2_board = 2;
  std::uint16_t fpga_board = 3;
  std::uint16_t psu_board = 4;
  std::uint16_t tx_board = 5;

  bool operator==(const Diagnostic&) const = default;
};

/// All messages from a client.
using Command = std::variant<StatusRequest, PingConfig, FlashWrite, FlashRead, InfoBlockWrite, InfoBlockRead,
                             SerialTransmit, Reboot, TestResultRequest, ProductionTest, PowerOnSelfTest,
                             AbortProductionTest, RetryRequest, NetworkConfig, MdioCommands, TxDriveTest,
                             GpoWrite, GpioRead, DiagnosticRequest, GoingOffline, Unknown>;

/// All messages from a head.
using Report =
    std::variant<Status, PingHead, PingLine, PingTail, FlashResult, FlashReadback, VelocimeterData,
                 SerialData, Acknowledge, TestResult, MdioAcknowledge, GpiData, Diagnostic, Unknown>;

}  // namespace sonard::gemini
