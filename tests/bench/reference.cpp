#include "tests/bench/reference.hpp"

#include <yaml-cpp/yaml.h>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <regex>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/bench/plane_quadrature.hpp"

namespace sonard::bench {

static_assert(std::endian::native == std::endian::little, "read_npy() takes the bytes as they are");

namespace {

constexpr std::array<char, 8> npy_magic{'\x93', 'N', 'U', 'M', 'P', 'Y', 1, 0};

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw std::runtime_error(file.string() + ": " + reason);
}

/// The Python dictionary that describes the array.
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
  image.intensity.resize(static_cast<std::size_t>(image.beams) * static_cast<std::size_t>(image.lines));
  std::vector<char> bytes(image.intensity.size() * sizeof(float));
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    refuse(file, "ends before its last value");
  }
  std::memcpy(image.intensity.data(), bytes.data(), bytes.size());
  return image;
}

render::EchoImage plane_image(const test::Scene& scene) {
  const std::vector<double>& edges = scene.settings.aperture.beam_edges_rad;
  const render::RangeLines& range = scene.settings.range;
  render::EchoImage image{scene.settings.aperture.beam_count(), range.count, {}};
  image.intensity.resize(static_cast<std::size_t>(image.beams) * static_cast<std::size_t>(image.lines));
  std::atomic<int> next_beam{0};
  const auto fill_beams = [&] {
    for (int beam = next_beam++; beam < image.beams; beam = next_beam++) {
      const auto b = static_cast<std::size_t>(beam);
      for (int k = 0; k < image.lines; ++k) {
        const double from_m = std::max(1e-9, k * range.step_m);
        const double echo =
            plane_beam_echo(*scene.plane, edges[b + 1], edges[b], from_m, (k + 1) * range.step_m);
        image.intensity[b * static_cast<std::size_t>(image.lines) + static_cast<std::size_t>(k)] =
            static_cast<float>(test::scene_lambert_mu * echo);
      }
    }
  };
  std::vector<std::jthread> helpers;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) {
    helpers.emplace_back(fill_beams);
  }
  fill_beams();
  helpers.clear();  // joins: the image is complete
  return image;
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
      reference.image.lines != scene.settings.range.count) {
    refuse(file, "not of the size that the scene has: render it again");
  }
  std::filesystem::path description = file;
  description.replace_extension(".json");
  if (std::filesystem::exists(description)) {
    const YAML::Node error = YAML::LoadFile(description.string())["error_rms"];  // JSON is YAML
    if (error) {
      reference.error_rms = error.as<double>();
    }
  }
  return reference;
}

}  // namespace sonard::bench
