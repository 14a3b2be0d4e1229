// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/geotiff.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <tiffio.h>

#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

// Tags and keys, with the names and numbers of the standard.
constexpr ttag_t model_pixel_scale = 33550, model_tiepoint = 33922, model_transformation = 34264,
                 geo_key_directory = 34735, gdal_nodata = 42113;
constexpr int gt_raster_type = 1025, geodetic_crs = 2048, projected_crs = 3072, vertical_crs = 4096,
              vertical_units = 4099;
constexpr int pixel_is_point = 2, metre = 9001;

/// Geographic systems, and the first and last zone of UTM on their datums. All are treated as WGS 84: ETRS89
/// is within 1 m of it, NAD83 within 2 m.
constexpr std::array<int, 3> geographic_systems{4326, 4258, 4269};
struct UtmZones {
  int first_epsg, first_zone, last_zone;
  bool northern = true;
};
constexpr std::array<UtmZones, 4> utm_zones{
    {{32601, 1, 60}, {32701, 1, 60, false}, {25828, 28, 38}, {26901, 1, 23}}};

struct VerticalDatum {
  int epsg;
  std::string_view name;
  bool downwards = false;
};
constexpr std::array<VerticalDatum, 10> vertical_datums{{{3855, "EGM2008 height"},
                                                         {5773, "EGM96 height"},
                                                         {5703, "NAVD88 height"},
                                                         {5714, "mean sea level height"},
                                                         {5621, "EVRF2007 height"},
                                                         {5701, "ODN height"},
                                                         {5715, "mean sea level depth", true},
                                                         {5861, "lowest astronomical tide depth", true},
                                                         {5866, "mean lower low water depth", true},
                                                         {5831, "instantaneous water level depth", true}}};

const VerticalDatum* find_datum(int epsg) {
  const auto* const found = std::ranges::find(vertical_datums, epsg, &VerticalDatum::epsg);
  return found == vertical_datums.end() ? nullptr : found;
}

const UtmZones* utm_of(int epsg) {
  const auto* const found = std::ranges::find_if(utm_zones, [epsg](const UtmZones& zones) {
    return epsg >= zones.first_epsg && epsg <= zones.first_epsg + zones.last_zone - zones.first_zone;
  });
  return found == utm_zones.end() ? nullptr : found;
}

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

/// The values of a tag without a name in libtiff. How libtiff returns them depends on whether another library
/// in the process has registered the tag.
template <typename T>
std::span<const T> values_of(const Tiff& tiff, ttag_t tag) {
  const TIFFField* const field = TIFFFindField(tiff.get(), tag, TIFF_ANY);
  const T* values = nullptr;
  if (field == nullptr) {
    return {};
  }
  if (TIFFFieldPassCount(field) == 0) {
    if constexpr (std::is_same_v<T, char>) {  // text that ends with a zero
      if (TIFFGetField(tiff.get(), tag, &values) == 1 && values != nullptr) {
        return std::string_view(values);
      }
    }
    return {};
  }
  std::uint32_t count = 0;
  std::uint16_t short_count = 0;
  const bool is_long = TIFFFieldReadCount(field) == TIFF_VARIABLE2;
  const int known = is_long ? TIFFGetField(tiff.get(), tag, &count, &values)
                            : TIFFGetField(tiff.get(), tag, &short_count, &values);
  return known == 1 && values != nullptr ? std::span(values, is_long ? count : short_count)
                                         : std::span<const T>();
}

/// The keys with a 16-bit number as value.
std::map<int, int> keys_of(const Tiff& tiff) {
  const auto directory = values_of<std::uint16_t>(tiff, geo_key_directory);
  std::map<int, int> keys;
  for (std::size_t at = 4; at + 4 <= directory.size(); at += 4) {
    if (directory[at + 1] == 0) {
      keys[directory[at]] = directory[at + 3];
    }
  }
  return keys;
}

/// @throws std::runtime_error with the missing part
Georeference georeference_of(const Tiff& tiff) {
  const std::map<int, int> keys = keys_of(tiff);
  const auto key = [&](int number) {
    const auto found = keys.find(number);
    return found == keys.end() ? 0 : found->second;
  };
  Georeference place;
  place.crs = key(projected_crs) != 0 ? key(projected_crs) : key(geodetic_crs);
  place.vertical_crs = key(vertical_crs);
  if (place.crs == 0) {
    throw std::runtime_error("it has no coordinate system");
  }
  if (!place.is_geographic() && utm_of(place.crs) == nullptr) {
    throw std::runtime_error(
        fmt::format("its coordinate system EPSG:{} is not known (expected EPSG:4326 or UTM, "
                    "such as EPSG:32632): convert it with gdalwarp -t_srs",
                    place.crs));
  }
  if (const int units = key(vertical_units); units != 0 && units != metre) {
    throw std::runtime_error(
        fmt::format("its elevations are in units of EPSG:{} (expected 9001, metres)", units));
  }
  if (const VerticalDatum* const datum = find_datum(place.vertical_crs);
      datum != nullptr && datum->downwards) {
    throw std::runtime_error(
        fmt::format("its values are depths, {}: negate them first", place.vertical_datum()));
  }
  const auto scale = values_of<double>(tiff, model_pixel_scale);
  const auto tie = values_of<double>(tiff, model_tiepoint);
  if (scale.size() < 2 || tie.size() != 6 || !(scale[0] > 0.0) || !(scale[1] > 0.0)) {
    throw std::runtime_error(
        values_of<double>(tiff, model_transformation).empty()
            ? "it has no pixel scale and tie point"
            : "its rows do not run from west to east (expected a pixel scale and one tie point): "
              "convert it with gdalwarp");
  }
  // A tie point is the position of a raster coordinate. The middle of the first pixel is at 0.5 if pixels are
  // areas, else at 0.
  const double middle = key(gt_raster_type) == pixel_is_point ? 0.0 : 0.5;
  place.step = {scale[0], -scale[1]};
  place.first = glm::dvec2(tie[3], tie[4]) + glm::dvec2(middle - tie[0], middle - tie[1]) * place.step;
  if (!std::isfinite(place.first.x) || !std::isfinite(place.first.y) || !std::isfinite(scale[0]) ||
      !std::isfinite(scale[1])) {
    throw std::runtime_error("its tie point is not finite");
  }
  return place;
}

}  // namespace

bool Georeference::is_geographic() const {
  return std::ranges::find(geographic_systems, crs) != geographic_systems.end();
}

GeographicOrigin Georeference::place(double column, double row) const {
  const glm::dvec2 at = first + glm::dvec2(column, row) * step;
  if (is_geographic()) {
    if (std::abs(at.y) > 90.0) {
      throw WorldError(fmt::format("latitude {} is beyond 90 degrees", at.y));
    }
    return {at.y, at.x, 0.0};
  }
  const UtmZones* const zones = utm_of(crs);
  if (zones == nullptr) {
    throw WorldError(fmt::format("EPSG:{} is not a UTM zone", crs));
  }
  return place_of_utm(zones->first_zone + crs - zones->first_epsg, zones->northern, at.x, at.y);
}

std::string Georeference::vertical_datum() const {
  if (vertical_crs == 0) {
    return "an unknown datum";
  }
  const VerticalDatum* const datum = find_datum(vertical_crs);
  return fmt::format("EPSG:{}{}", vertical_crs, datum == nullptr ? "" : fmt::format(" ({})", datum->name));
}

GeoTiffTags read_geotiff_tags(const std::filesystem::path& file) {
  TIFFSetWarningHandler(nullptr);
  TIFFSetErrorHandler(nullptr);
  GeoTiffTags tags;
  const Tiff tiff(TIFFOpen(file.c_str(), "r"), &TIFFClose);
  if (!tiff) {
    return tags;
  }
  if (const auto text = values_of<char>(tiff, gdal_nodata); !text.empty()) {
    const std::string number(text.begin(), std::ranges::find(text, '\0'));
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (end != number.c_str()) {
      tags.no_data = value;
    }
  }
  try {
    tags.georeference = georeference_of(tiff);
  } catch (const std::runtime_error& error) {
    tags.problem = error.what();
  }
  return tags;
}

}  // namespace sonard::render
