// SPDX-License-Identifier: Apache-2.0
// Any bytes as a stream of JSON objects and as serial lines of a DVL, in both directions.
// Promises: a stream gives the same objects however it is cut; a decoded report is stable under encode and
// decode; settings that are applied are in range.
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "protocol/dvl_a50/client.hpp"
#include "protocol/dvl_a50/codec.hpp"
#include "protocol/dvl_a50/http.hpp"
#include "protocol/dvl_a50/sentences.hpp"
#include "protocol/dvl_a50/utc.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace sonard::dvl_a50;
using sonard::fuzz::require;

std::vector<std::string> objects_of(std::span<const std::uint8_t> stream, std::size_t piece) {
  JsonStream input;
  std::vector<std::string> objects;
  for (std::size_t begin = 0; begin < stream.size(); begin += piece) {
    input.append(stream.subspan(begin, std::min(piece, stream.size() - begin)));
    while (auto object = input.next()) {
      objects.push_back(*std::move(object));
    }
  }
  return objects;
}

void check_object(const std::string& object) {
  require(object.starts_with('{') && object.ends_with('}'), "an object has its braces");
  const auto json = parse_json(object);
  if (!json) {
    return;
  }
  if (const auto report = decode_velocity(*json)) {
    const auto again = parse_json(encode(*report, "json_v3"));
    require(again && decode_velocity(*again) == report, "a velocity report is stable");
    require(!velocity_sentence(*report).empty(), "it has a sentence");
  }
  if (const auto report = decode_position(*json)) {
    const auto again = parse_json(encode(*report, "json_v3"));
    require(again && decode_position(*again) == report, "a position report is stable");
  }
  Settings settings;
  if (const auto* const members = json->as<Json::Members>()) {
    const auto wrong = apply(*members, Release::v2_7_2, settings);
    require(wrong ? settings == Settings{} : !wrong_setting(settings, Release::v2_7_2),
            "settings are applied whole and in range");
  }
}

void check_line(const std::string& line) {
  if (const auto command = parse_command(line)) {
    Settings settings;
    apply(command->options, settings);
  }
  if (const auto time_us = parse_rfc3339(line)) {
    require(parse_rfc3339(rfc3339(*time_us)) == time_us || *time_us < -62'000'000'000'000'000,
            "a time is stable");
  }
  requested_path(line);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span stream{data, size};
  const std::vector<std::string> objects = objects_of(stream, size + 1);
  require(objects == objects_of(stream, 1) && objects == objects_of(stream, 7), "cuts change nothing");
  for (const std::string& object : objects) {
    check_object(object);
  }
  Client client;
  client.on_bytes(stream);
  require(client.take().size() <= objects.size(), "a report is an object");
  check_line({stream.begin(), stream.end()});
  return 0;
}
