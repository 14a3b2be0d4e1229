// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/image_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <osg/Image>
#include <osgDB/Options>
#include <osgDB/Registry>

#include "renderer/scene/blob.hpp"
#include "renderer/scene/complete_file.hpp"
#include "renderer/scene/isolated.hpp"
#include "renderer/scene/local_file.hpp"
#include "renderer/scene/osg_plugin.hpp"
#include "renderer/scene/tiff_elevations.hpp"

namespace sonard::render {
namespace {

constexpr std::array<std::string_view, 10> image_extensions{"png", "jpg", "jpeg", "tif", "tiff",
                                                            "bmp", "tga", "pgm",  "ppm", "pnm"};
constexpr int max_side_px = 16384;

/// All channels as 16 bits, row 0 at the bottom.
struct Pixels {
  int width_px = 0;
  int height_px = 0;
  int channels = 0;
  std::vector<std::uint16_t> value;
};

std::uint16_t sample(const osg::Image& image, const unsigned char* row, int index) {
  if (image.getDataType() == GL_UNSIGNED_BYTE) {
    return static_cast<std::uint16_t>(row[index] * 257);
  }
  std::uint16_t value = 0;
  std::memcpy(&value, row + 2 * static_cast<std::ptrdiff_t>(index), sizeof value);
  return value;
}

std::string packed(int width_px, int height_px, int channels, const std::vector<std::uint16_t>& value) {
  BlobWriter writer;
  writer.put(static_cast<std::uint64_t>(width_px));
  writer.put(static_cast<std::uint64_t>(height_px));
  writer.put(static_cast<std::uint64_t>(channels));
  writer.put(value);
  return writer.take();
}

/// Runs inside run_isolated().
std::string decode(const std::filesystem::path& file) {
  require_complete(file);
  const osg::ref_ptr<osgDB::Options> options = new osgDB::Options;
  osgDB::ReaderWriter::ReadResult result = osgDB::Registry::instance()->readImage(file.string(), options);
  const osg::ref_ptr<osg::Image> image = result.getImage();
  if (!image || image->data() == nullptr) {
    throw std::runtime_error("the image is damaged or of another format");
  }
  const GLenum type = image->getDataType();
  if ((type != GL_UNSIGNED_BYTE && type != GL_UNSIGNED_SHORT) || image->isCompressed() || image->r() != 1) {
    throw std::runtime_error("expected a picture of 8 or 16 bits per channel");
  }
  if (image->s() > max_side_px || image->t() > max_side_px) {
    throw std::runtime_error(
        fmt::format("{} x {} pixels is more than {} a side", image->s(), image->t(), max_side_px));
  }
  const auto channels = static_cast<int>(osg::Image::computeNumComponents(image->getPixelFormat()));
  const bool blue_first = image->getPixelFormat() == GL_BGR || image->getPixelFormat() == GL_BGRA;
  std::vector<std::uint16_t> value;
  value.reserve(static_cast<std::size_t>(image->s()) * static_cast<std::size_t>(image->t() * channels));
  for (int y = 0; y < image->t(); ++y) {
    const bool top_first = image->getOrigin() == osg::Image::TOP_LEFT;
    const unsigned char* row = image->data(0, static_cast<unsigned int>(top_first ? image->t() - 1 - y : y));
    for (int x = 0; x < image->s(); ++x) {
      for (int c = 0; c < channels; ++c) {
        value.push_back(sample(*image, row, x * channels + (blue_first && c < 3 ? 2 - c : c)));
      }
    }
  }
  return packed(image->s(), image->t(), channels, value);
}

/// Runs inside run_isolated().
std::string decode_elevations(const std::filesystem::path& file) {
  const TiffElevations elevations = read_tiff_elevations(file, max_side_px);
  const GeoTiffTags tags = read_geotiff_tags(file);
  BlobWriter writer;
  writer.put(static_cast<std::uint64_t>(elevations.width_px));
  writer.put(static_cast<std::uint64_t>(elevations.height_px));
  writer.put(elevations.value_m);
  writer.put(
      std::vector<Georeference>(tags.georeference ? 1 : 0, tags.georeference.value_or(Georeference())));
  writer.put(tags.problem);
  return writer.take();
}

/// Runs `decoder` on the file in a child process, and returns the result of `unpack`.
template <typename Unpack>
auto read_isolated(const std::filesystem::path& file, std::string (*decoder)(const std::filesystem::path&),
                   const Unpack& unpack) {
  require_local_file(file, image_extensions, "image");
  try {
    const IsolatedResult result = run_isolated([&] { return decoder(file); }, reader_jail(file, {file}),
                                               [&] { load_osg_plugin(file); });
    BlobReader reader(result.bytes);
    return unpack(reader);
  } catch (const std::runtime_error& error) {
    throw WorldError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

void check_size(int width_px, int height_px, std::size_t values, int channels) {
  if (width_px < 1 || height_px < 1 || channels < 1 ||
      values != static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) *
                    static_cast<std::size_t>(channels)) {
    throw std::runtime_error("the reader returned a damaged result");
  }
}

Pixels load_pixels(const std::filesystem::path& file) {
  return read_isolated(file, decode, [](BlobReader& reader) {
    Pixels pixels;
    pixels.width_px = static_cast<int>(reader.get_number());
    pixels.height_px = static_cast<int>(reader.get_number());
    pixels.channels = static_cast<int>(reader.get_number());
    pixels.value = reader.get_vector<std::uint16_t>();
    check_size(pixels.width_px, pixels.height_px, pixels.value.size(), pixels.channels);
    return pixels;
  });
}

/// Converts elevations to 16 bits, and marks unknown ones as holes.
void set_elevations(ElevationMap& map, const std::vector<float>& elevation_m) {
  float low = INFINITY, high = -INFINITY;
  for (const float h : elevation_m) {
    if (std::isinf(h)) {
      throw std::runtime_error("some elevations are not finite");
    }
    if (std::isnan(h)) {
      ++map.holes_px;
    } else {
      low = std::min(low, h);
      high = std::max(high, h);
    }
  }
  if (map.holes_px == elevation_m.size()) {
    throw std::runtime_error("no pixel has an elevation");
  }
  map.lowest_m = static_cast<double>(low);
  map.highest_m = static_cast<double>(high);
  const double span_m = std::max(1e-9, map.highest_m - map.lowest_m);
  map.picture.value.reserve(elevation_m.size());
  for (const float h : elevation_m) {
    map.picture.value.push_back(std::isnan(h)
                                    ? 0
                                    : static_cast<std::uint16_t>(std::lround(
                                          65535 * (static_cast<double>(h) - map.lowest_m) / span_m)));
  }
  if (map.holes_px > 0) {
    map.picture.hole.reserve(elevation_m.size());
    for (const float h : elevation_m) {
      map.picture.hole.push_back(std::isnan(h));
    }
  }
}

}  // namespace

GreyImage load_grey_image(const std::filesystem::path& file) {
  const Pixels pixels = load_pixels(file);
  GreyImage image{pixels.width_px, pixels.height_px, {}};
  const auto step = static_cast<std::size_t>(pixels.channels);
  image.value.reserve(pixels.value.size() / step);
  for (std::size_t i = 0; i < pixels.value.size(); i += step) {
    image.value.push_back(pixels.value[i]);
  }
  return image;
}

bool is_elevation_map(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return extension == "tif" || extension == "tiff";
}

ElevationMap load_elevation_map(const std::filesystem::path& file) {
  return read_isolated(file, decode_elevations, [](BlobReader& reader) {
    ElevationMap map;
    map.picture.width_px = static_cast<int>(reader.get_number());
    map.picture.height_px = static_cast<int>(reader.get_number());
    const auto elevation_m = reader.get_vector<float>();
    check_size(map.picture.width_px, map.picture.height_px, elevation_m.size(), 1);
    set_elevations(map, elevation_m);
    if (const auto known = reader.get_vector<Georeference>(); !known.empty()) {
      map.georeference = known.front();
    }
    map.no_georeference_because = reader.get_string();
    return map;
  });
}

NormalMap load_normal_map(const std::filesystem::path& file) {
  const Pixels pixels = load_pixels(file);
  if (pixels.channels < 3) {
    throw WorldError(
        fmt::format("{}: a normal map needs 3 channels, this image has {}", file.string(), pixels.channels));
  }
  NormalMap map{pixels.width_px, pixels.height_px, {}};
  const auto step = static_cast<std::size_t>(pixels.channels);
  map.rgb.reserve(pixels.value.size() / step * 3);
  for (std::size_t i = 0; i < pixels.value.size(); i += step) {
    for (std::size_t c = 0; c < 3; ++c) {
      map.rgb.push_back(static_cast<std::uint8_t>((pixels.value[i + c] + 128) / 257));
    }
  }
  return map;
}

}  // namespace sonard::render
