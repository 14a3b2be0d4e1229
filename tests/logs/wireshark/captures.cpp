// SPDX-License-Identifier: Apache-2.0
#include "tests/logs/wireshark/captures.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "clients/wireshark/field_tables.hpp"
#include "tests/support/message_fields.hpp"
#include "tests/support/run_process.hpp"

namespace sonard::testing {
namespace {

constexpr pcapng::Endpoint client{0x0A'3D'13'05, 52'900};
constexpr pcapng::Endpoint head{0x0A'3D'13'C8, 52'901};

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// A file that is deleted at the end of the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const pcapng::Bytes& bytes)
      : path_(std::filesystem::temp_directory_path() / ("sonard-" + std::to_string(getpid()) + ".pcapng")) {
    std::ofstream{path_, std::ios::binary}.write(reinterpret_cast<const char*>(bytes.data()),
                                                 static_cast<std::streamsize>(bytes.size()));
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::vector<std::string> tshark_command(const std::string& path, const std::vector<std::string>& fields,
                                        const std::vector<std::string>& options) {
  const std::string front = "lua_script:" SONARD_SOURCE_DIR "/clients/wireshark/sonard_";
  std::vector<std::string> command{"tshark", "-n",          "-r", path,           "-T", "fields",
                                   "-E",     "separator=|", "-E", "occurrence=a", "-E", "aggregator=,"};
  for (const wireshark::FieldTables& tables : wireshark::device_field_tables()) {
    std::string script = front;
    script.append(tables.device).append(".lua");
    command.insert(command.end(), {"-X", script});
  }
  for (const char* protocol : {"ip", "udp", "tcp"}) {
    command.insert(command.end(), {"-o", std::string{protocol} + ".check_checksum:TRUE"});
  }
  for (const std::string& field : fields) {
    command.insert(command.end(), {"-e", field});
  }
  command.insert(command.end(), options.begin(), options.end());
  return command;
}

/// All messages in one direction, one after another.
Bytes stream_of(const std::string& device, bool from_head) {
  Bytes all;
  for (const Message& message : messages_of(device)) {
    if (message.from_head == from_head) {
      all.insert(all.end(), message.bytes.begin(), message.bytes.end());
    }
  }
  return all;
}

void append(std::vector<pcapng::Bytes>& packets, const std::vector<pcapng::Bytes>& more) {
  packets.insert(packets.end(), more.begin(), more.end());
}

}  // namespace

std::vector<Row> dissect(const std::vector<pcapng::Bytes>& packets, const std::vector<std::string>& fields,
                         const std::vector<std::string>& options, std::chrono::nanoseconds apart) {
  pcapng::Writer writer{"sonard tests"};
  const std::uint32_t interface = writer.add_interface("lab");
  std::uint64_t time_ns = 1'700'000'000'000'000'001;
  for (const pcapng::Bytes& packet : packets) {
    writer.add_packet(interface, time_ns, packet);
    time_ns += static_cast<std::uint64_t>(apart.count());
  }
  const TemporaryFile file{writer.take()};
  const test::ProcessResult result =
      test::run_process(tshark_command(file.path(), fields, options), std::chrono::seconds{20});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err.find("Lua"), std::string::npos) << result.err;

  std::vector<Row> rows;
  std::istringstream lines{result.out};
  for (std::string line; std::getline(lines, line);) {
    const auto values = split(line, '|');
    EXPECT_EQ(values.size(), fields.size()) << line;
    Row& row = rows.emplace_back();
    for (std::size_t i = 0; i < fields.size() && i < values.size(); ++i) {
      row[fields[i]] = values[i];
    }
  }
  EXPECT_EQ(rows.size(), packets.size());
  rows.resize(packets.size());
  return rows;
}

pcapng::Bytes to_head(pcapng::ByteView payload) {
  return pcapng::udp_packet({client.address, 52'901}, head, payload);
}

pcapng::Bytes from_head(pcapng::ByteView payload) {
  return pcapng::udp_packet(head, client, payload);
}

std::vector<pcapng::ByteView> pieces_of(pcapng::ByteView bytes, std::size_t piece) {
  std::vector<pcapng::ByteView> pieces;
  for (std::size_t begin = 0; begin < bytes.size(); begin += piece) {
    pieces.push_back(bytes.subspan(begin, std::min(piece, bytes.size() - begin)));
  }
  return pieces;
}

std::vector<pcapng::Bytes> pieces_over_tcp(const std::string& device, pcapng::TcpConversation line,
                                           std::size_t piece) {
  std::vector<pcapng::Bytes> packets = line.open();
  const Bytes commands = stream_of(device, false);
  const Bytes reports = stream_of(device, true);
  for (const pcapng::ByteView bytes : pieces_of(commands, piece)) {
    append(packets, line.from_client(bytes));
  }
  for (const pcapng::ByteView bytes : pieces_of(reports, piece)) {
    append(packets, line.from_server(bytes));
  }
  append(packets, line.close());
  return packets;
}

std::vector<pcapng::Bytes> pieces_over_udp(const std::string& device, pcapng::Endpoint client,
                                           pcapng::Endpoint head, std::size_t piece) {
  std::vector<pcapng::Bytes> packets;
  const Bytes commands = stream_of(device, false);
  const Bytes reports = stream_of(device, true);
  for (const pcapng::ByteView bytes : pieces_of(commands, piece)) {
    packets.push_back(pcapng::udp_packet(client, head, bytes));
  }
  for (const pcapng::ByteView bytes : pieces_of(reports, piece)) {
    packets.push_back(pcapng::udp_packet(head, client, bytes));
  }
  return packets;
}

std::string names_in_pieces(const std::string& device) {
  std::string names;
  for (const bool from_head : {false, true}) {
    for (const Message& message : messages_of(device)) {
      names += message.from_head == from_head ? message.message + "," : "";
    }
  }
  return names;
}

Row found_in(const std::vector<pcapng::Bytes>& packets, const std::vector<std::string>& fields,
             const std::vector<std::string>& options) {
  Row all;
  for (const Row& row : dissect(packets, fields, options)) {
    for (const auto& [field, value] : row) {
      if (!value.empty()) {
        all[field] += value + ",";
      }
    }
  }
  return all;
}

}  // namespace sonard::testing
