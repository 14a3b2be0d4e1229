// SPDX-License-Identifier: Apache-2.0
#include "server/offline/sidecar.hpp"

#include <vector>

#include <fmt/format.h>

#include "server/offline/json_text.hpp"

namespace sonard::server {
namespace {

constexpr double sixteen_to_eight_bits = 1.0 / 257.0;

}  // namespace

void SidecarText::add(const std::string& key, const std::string& json) {
  text_ += fmt::format("{}{}: {}", text_.empty() ? "{\n  " : ",\n  ", json_string(key), json);
}

void SidecarText::add_frame(const FrameFacts& facts) {
  add("frame", std::to_string(facts.number));
  add("head", json_string(facts.head));
  add("type", json_string(facts.type));
  add("stamp_s", fmt::format("{}", static_cast<double>(facts.stamp_ns) / 1e9));
  add("unix_ns", std::to_string(facts.unix_ns));
}

void SidecarText::add_samples(const std::string& name, bool sixteen_bit, const Axis& rows,
                              const Axis& columns) {
  add("picture", json_string(picture_name(name)));
  add("samples", fmt::format("{{\"file\": {}, \"dtype\": \"{}\", \"axes\": [{}, {}], \"shape\": [{}, {}]}}",
                             json_string(npy_name(name)), sixteen_bit ? "<u2" : "|u1", json_string(rows.name),
                             json_string(columns.name), rows.size, columns.size));
}

void SidecarText::add_truth(const std::string& name, const BodyTruth* truth) {
  if (truth == nullptr) {
    add("truth", "null");
    return;
  }
  std::vector<std::string> rows;
  for (const std::string& body : truth->bodies()) {
    rows.push_back(fmt::format("{{\"id\": {}, \"name\": {}}}", rows.size() + 1, json_string(body)));
  }
  add("truth", fmt::format("{{\"file\": {}, \"bodies\": [{}]}}", json_string(bodies_name(name)),
                           fmt::join(rows, ", ")));
}

cv::Mat eight_bit_matrix(const NpyTable& samples) {
  if (samples.u16.empty()) {
    return cv::Mat(samples.rows, samples.columns, CV_8UC1, const_cast<std::uint8_t*>(samples.u8.data()))
        .clone();
  }
  // OpenCV has no matrix of constant data; this one is only read.
  const cv::Mat sixteen(samples.rows, samples.columns, CV_16UC1,
                        const_cast<std::uint16_t*>(samples.u16.data()));
  cv::Mat eight;
  sixteen.convertTo(eight, CV_8UC1, sixteen_to_eight_bits);
  return eight;
}

std::string npy_name(const std::string& name) {
  return name + ".npy";
}
std::string bodies_name(const std::string& name) {
  return name + "_bodies.npy";
}
std::string picture_name(const std::string& name) {
  return name + ".png";
}
std::string sidecar_name(const std::string& name) {
  return name + ".json";
}

}  // namespace sonard::server
