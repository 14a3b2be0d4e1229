// SPDX-License-Identifier: Apache-2.0
#include "tests/logs/wireshark/captures.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "clients/wireshark/field_tables.hpp"
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

}  // namespace sonard::testing
