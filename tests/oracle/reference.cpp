// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/reference.hpp"

#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include "tests/oracle/sha256.hpp"

namespace sonard::oracle {

namespace {

static_assert(std::endian::native == std::endian::little, "images are stored as they lie in memory");

constexpr std::size_t npy_alignment = 64;
constexpr std::string_view npy_magic("\x93NUMPY\x01\x00", 8);

/// Header of a .npy file, up to the data.
std::string npy_header(int beams, int lines) {
  std::string text =
      fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}", beams, lines);
  const std::size_t prefix = npy_magic.size() + 2;
  const std::size_t unpadded = prefix + text.size() + 1;
  text.append((npy_alignment - unpadded % npy_alignment) % npy_alignment, ' ');
  text += '\n';
  std::string header(npy_magic);
  header += static_cast<char>(text.size() & 0xff);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

std::string npy_file(const Reference& reference) {
  std::string bytes = npy_header(reference.beams, reference.lines);
  const std::size_t header = bytes.size();
  bytes.resize(header + reference.echo.size() * sizeof(float));
  std::memcpy(bytes.data() + header, reference.echo.data(), reference.echo.size() * sizeof(float));
  return bytes;
}

std::string sha256(const std::string& bytes) {
  Sha256 hash;
  hash.add(std::as_bytes(std::span(bytes)));
  return hash.hex_digest();
}

std::string json_error(const RelativeError& error) {
  return fmt::format(R"({{"rms": {:.3g}, "max": {:.3g}}})", error.rms, error.max);
}

std::string json_file(const Reference& r, const std::string& image_sha256) {
  return fmt::format(R"({{
  "scene": "{}",
  "scene_sha256": "{}",
  "image_sha256": "{}",
  "method": "slices",
  "beams": {},
  "lines": {},
  "slices": {},
  "error_rms": {:.3g},
  "error_max": {:.3g},
  "ray_check_stride": {},
  "ray_check": {},
  "ray_error": {},
  "line_centre": {},
  "command": "{}"
}}
)",
                     r.scene, r.scene_sha256, image_sha256, r.beams, r.lines, r.slices, r.error.rms,
                     r.error.max, r.ray_check_stride, json_error(r.ray_check), json_error(r.ray_error),
                     json_error(r.line_centre), r.command);
}

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    throw std::runtime_error("cannot write " + path.string());
  }
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error("cannot read " + path.string());
  }
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

RelativeError read_error(const YAML::Node& node) {
  return {node["rms"].as<double>(), node["max"].as<double>()};
}

}  // namespace

void write_reference(const std::filesystem::path& folder, const Reference& reference) {
  const std::string image = npy_file(reference);
  write_file(folder / (reference.scene + ".npy"), image);
  write_file(folder / (reference.scene + ".json"), json_file(reference, sha256(image)));
}

Reference read_reference(const std::filesystem::path& folder, const std::string& scene) {
  const std::string image = read_file(folder / (scene + ".npy"));
  const std::string json = read_file(folder / (scene + ".json"));
  Reference reference;
  try {
    const YAML::Node node = YAML::Load(json);  // YAML includes JSON
    if (node["image_sha256"].as<std::string>() != sha256(image)) {
      throw std::runtime_error("the image is not the one the .json belongs to");
    }
    reference.scene = node["scene"].as<std::string>();
    reference.scene_sha256 = node["scene_sha256"].as<std::string>();
    reference.beams = node["beams"].as<int>();
    reference.lines = node["lines"].as<int>();
    reference.slices = node["slices"].as<std::uint64_t>();
    reference.error = {node["error_rms"].as<double>(), node["error_max"].as<double>()};
    reference.ray_check_stride = node["ray_check_stride"].as<int>();
    reference.ray_check = read_error(node["ray_check"]);
    reference.ray_error = read_error(node["ray_error"]);
    reference.line_centre = read_error(node["line_centre"]);
    reference.command = node["command"].as<std::string>();
  } catch (const std::exception& problem) {
    throw std::runtime_error(fmt::format("{}: {}", (folder / (scene + ".json")).string(), problem.what()));
  }
  const std::string header = npy_header(reference.beams, reference.lines);
  const std::size_t count =
      static_cast<std::size_t>(reference.beams) * static_cast<std::size_t>(reference.lines);
  if (image.compare(0, header.size(), header) != 0 || image.size() != header.size() + count * sizeof(float)) {
    throw std::runtime_error((folder / (scene + ".npy")).string() + ": not the image its .json describes");
  }
  reference.echo.resize(count);
  std::memcpy(reference.echo.data(), image.data() + header.size(), count * sizeof(float));
  return reference;
}

}  // namespace sonard::oracle
