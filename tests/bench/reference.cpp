// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/reference.hpp"

#include <yaml-cpp/yaml.h>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <regex>
#include <stdexcept>
#include <string>

#include "tests/bench/plane_quadrature.hpp"
#include "tests/support/beam_images.hpp"

namespace sonard::bench {

static_assert(std::endian::native == std::endian::little, "read_npy() takes the bytes as they are");

namespace {

constexpr std::array<char, 8> npy_magic{'\x93', 'N', 'U', 'M', 'P', 'Y', 1, 0};

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw std::runtime_error(file.string() + ": " + reason);
}

/// Reads the Python dictionary that describes the array.
std::string npy_header(std::ifstream& stream, const std::filesystem::path& file) {
  std::array<char, 10> start{};
  if (!stream.read(start.data(), start.size()) ||
      !std::equal(npy_magic.begin(), npy_magic.end(), start.begin())) {
    refuse(file, "not a NumPy file of version 1.0");
  }
  const auto byte = [&](std::size_t i) {
    return static_cast<unsigned>(static_cast<unsigned char>(start[i]));
  };
  std::string header(byte(8) | byte(9) << 8, ' ');
  if (!stream.read(header.data(), static_cast<std::streamsize>(header.size()))) {
    refuse(file, "ends inside its header");
  }
  return header;
}

}  // namespace

render::EchoImage read_npy(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    refuse(file, "cannot be opened");
  }
  const std::string header = npy_header(stream, file);
  std::smatch shape;
  if (header.find("'<f4'") == std::string::npos || header.find("False") == std::string::npos ||
      !std::regex_search(header, shape, std::regex(R"(\((\d{1,5}), (\d{1,5})\))"))) {
    refuse(file, "expected little-endian float32 in C order with two dimensions");
  }
  render::EchoImage image{std::stoi(shape[1]), std::stoi(shape[2]), {}};
  image.intensity.resize(static_cast<std::size_t>(image.beams) * static_cast<std::size_t>(image.bins));
  std::vector<char> bytes(image.intensity.size() * sizeof(float));
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    refuse(file, "ends before its last value");
  }
  std::memcpy(image.intensity.data(), bytes.data(), bytes.size());
  return image;
}

render::EchoImage plane_image(const test::Scene& scene) {
  return test::image_of_beams(scene.settings, [&](double from, double to, double r1, double r2) {
    return test::scene_lambert_mu * plane_beam_echo(*scene.plane, from, to, r1, r2);
  });
}

std::optional<Reference> find_reference(const test::Scene& scene, const std::filesystem::path& folder) {
  if (scene.plane) {
    return Reference{plane_image(scene), true, std::nullopt};
  }
  const std::filesystem::path file = folder / (scene.name + ".npy");
  if (!std::filesystem::exists(file)) {
    return std::nullopt;
  }
  Reference reference{read_npy(file), false, std::nullopt};
  if (reference.image.beams != scene.settings.aperture.beam_count() ||
      reference.image.bins != scene.settings.range.count) {
    refuse(file, "not of the size that the scene has: render it again");
  }
  std::filesystem::path description = file;
  description.replace_extension(".json");
  if (std::filesystem::exists(description)) {
    const YAML::Node error = YAML::LoadFile(description.string())["error_rms"];  // YAML includes JSON
    if (error) {
      reference.error_rms = error.as<double>();
    }
  }
  return reference;
}

}  // namespace sonard::bench
