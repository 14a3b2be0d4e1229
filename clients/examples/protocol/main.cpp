// SPDX-License-Identifier: Apache-2.0
// Prints the head of a Gemini's ping. Reads its bytes from standard input as hexadecimal numbers: "41 01 59
// ...".
#include <cstdint>
#include <iostream>
#include <string>
#include <variant>
#include <vector>

#include "protocol/gemini/codec.hpp"

int main() {
  std::vector<std::uint8_t> datagram;
  for (std::string byte; std::cin >> byte;) {
    datagram.push_back(static_cast<std::uint8_t>(std::stoul(byte, nullptr, 16)));
  }

  const auto report = sonard::gemini::decode_report(datagram);
  if (!report) {
    std::cerr << to_string(report.error()) << '\n';
    return 1;
  }
  const auto* head = std::get_if<sonard::gemini::PingHead>(&*report);
  if (head == nullptr) {
    std::cerr << "the packet is not a ping head\n";
    return 1;
  }
  std::cout << "sonar " << head->header.sonar_id << " ping " << head->ping_id << ": " << head->line_count()
            << " range lines of " << head->beams << " beams, " << head->sound_speed_mps() << " m/s\n";
}
