// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/server/config/events_reference.hpp"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "server/devices/device_type.hpp"
#include "server/devices/types/types.hpp"
#include "server/net/serial_transport.hpp"
#include "server/net/tcp_transport.hpp"
#include "server/net/udp_transport.hpp"

namespace sonard::server {
namespace {

std::string_view shown_text(Counter::Shown shown) {
  switch (shown) {
    case Counter::Shown::often:
      return "rates";
    case Counter::Shown::warns:
      return "warning";
    case Counter::Shown::once:
      return "once";
    case Counter::Shown::at_end:
      break;
  }
  return "end";
}

/// A counter, and the transports that have it, or none for a counter of a device.
struct EventRow {
  Counter counter;
  std::string transports;
};

std::string table_of(std::string_view title, std::string_view first_column,
                     const std::vector<EventRow>& rows) {
  std::string text =
      fmt::format("\n### {}\n| {} | meaning | fault | log |\n|---|---|---|---|\n", title, first_column);
  for (const auto& [counter, transports] : rows) {
    if (counter.meaning.empty()) {
      throw std::runtime_error("counter without a meaning: " + counter.name);
    }
    text += fmt::format("| `{}`{} | {} |{}| {} |\n", counter.name, transports, counter.meaning,
                        counter.fault == Counter::Fault::of_client ? " **yes** " : " ",
                        shown_text(counter.shown));
  }
  return text;
}

std::vector<EventRow> rows_of_device(const DeviceType& type) {
  std::vector<EventRow> rows;
  for (const Counter& counter : type.counters()) {
    rows.push_back({counter, ""});
  }
  return rows;
}

/// Adds the counters of a transport; a row with the same name and meaning gets its name.
void add_transport(std::string_view name, const std::vector<Counter>& counters, std::vector<EventRow>& rows) {
  for (const Counter& counter : counters) {
    const auto known = std::ranges::find_if(rows, [&](const EventRow& row) {
      return row.counter.name == counter.name && row.counter.meaning == counter.meaning;
    });
    if (known == rows.end()) {
      rows.push_back({counter, fmt::format(" ({})", name)});
    } else {
      known->transports.insert(known->transports.size() - 1, fmt::format(", {}", name));
    }
  }
}

/// Counters of both directions have the same meanings, so one direction is enough.
std::vector<Counter> udp_with_link() {
  std::vector<Counter> counters = udp_counters({}, 0);
  for (const Counter& counter : link_counters({}, /*to_client=*/true)) {
    counters.push_back(counter);
  }
  return counters;
}

}  // namespace

std::string events_reference() {
  std::string text;
  for (const HeadType* type : head_types()) {
    text += table_of(type->title(), "event", rows_of_device(checked_cast<DeviceType>(type)));
  }
  std::vector<EventRow> rows;
  add_transport("UDP", udp_with_link(), rows);
  add_transport("TCP", tcp_counters({}), rows);
  add_transport("serial", serial_counters({}), rows);
  return text + table_of("Transports", "event (transport)", rows);
}

}  // namespace sonard::server
