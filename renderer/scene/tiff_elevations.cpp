// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/tiff_elevations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <tiffio.h>
#include <glm/gtc/packing.hpp>

#include "renderer/scene/geotiff.hpp"

namespace sonard::render {
namespace {

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

std::string& last_complaint() {
  static std::string text;
  return text;
}

[[gnu::format(printf, 2, 0)]] void keep_complaint(const char*, const char* format, va_list arguments) {
  std::array<char, 300> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  last_complaint() = text.data();
}

template <typename T>
T tag(const Tiff& tiff, ttag_t number) {
  T value = 0;
  TIFFGetFieldDefaulted(tiff.get(), number, &value);
  return value;
}

template <typename T>
float value_of(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<float>(value);
}

float half_of(const std::uint8_t* bytes) {
  std::uint16_t value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return glm::unpackHalf1x16(value);
}

using SampleReader = float (*)(const std::uint8_t*);

/// @throws std::runtime_error
SampleReader sample_reader(unsigned int format, unsigned int bits) {
  switch (format << 8U | bits) {
    case SAMPLEFORMAT_UINT << 8U | 8U:
    case SAMPLEFORMAT_VOID << 8U | 8U:
      return value_of<std::uint8_t>;
    case SAMPLEFORMAT_UINT << 8U | 16U:
    case SAMPLEFORMAT_VOID << 8U | 16U:
      return value_of<std::uint16_t>;
    case SAMPLEFORMAT_UINT << 8U | 32U:
      return value_of<std::uint32_t>;
    case SAMPLEFORMAT_UINT << 8U | 64U:
      return value_of<std::uint64_t>;
    case SAMPLEFORMAT_INT << 8U | 8U:
      return value_of<std::int8_t>;
    case SAMPLEFORMAT_INT << 8U | 16U:
      return value_of<std::int16_t>;
    case SAMPLEFORMAT_INT << 8U | 32U:
      return value_of<std::int32_t>;
    case SAMPLEFORMAT_INT << 8U | 64U:
      return value_of<std::int64_t>;
    case SAMPLEFORMAT_IEEEFP << 8U | 16U:
      return half_of;
    case SAMPLEFORMAT_IEEEFP << 8U | 32U:
      return value_of<float>;
    case SAMPLEFORMAT_IEEEFP << 8U | 64U:
      return value_of<double>;
    default:
      throw std::runtime_error(
          fmt::format("samples of {} bits of format {} (expected integers of 8, 16, 32 or 64 bits or reals "
                      "of 16, 32 or 64)",
                      bits, format));
  }
}

class Raster {
 public:
  Raster(const Tiff& tiff, std::uint64_t file_bytes, bool may_be_sparse)
      : tiff_(tiff), file_bytes_(file_bytes), may_be_sparse_(may_be_sparse) {
    const auto bits = tag<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE);
    sample_ = sample_reader(tag<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT), bits);
    const bool is_interleaved = tag<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG) == PLANARCONFIG_CONTIG;
    pixel_bytes_ = bits / 8U * (is_interleaved ? tag<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL) : 1U);
    width_px_ = tag<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH);
    height_px_ = tag<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH);
    is_tiled_ = TIFFIsTiled(tiff.get()) != 0;
    block_width_px_ = is_tiled_ ? tag<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH) : width_px_;
    block_height_px_ = is_tiled_ ? tag<std::uint32_t>(tiff, TIFFTAG_TILELENGTH)
                                 : std::min(tag<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP), height_px_);
    if (block_width_px_ == 0 || block_height_px_ == 0) {
      throw std::runtime_error("its strips or tiles have no size");
    }
  }

  std::vector<float> read() {
    std::vector<float> values(std::size_t{width_px_} * height_px_, NAN);
    for (std::uint32_t top = 0; top < height_px_; top += block_height_px_) {
      for (std::uint32_t left = 0; left < width_px_; left += block_width_px_) {
        const std::uint32_t rows =
            is_tiled_ ? block_height_px_ : std::min(block_height_px_, height_px_ - top);
        const std::uint32_t block =
            is_tiled_ ? TIFFComputeTile(tiff_.get(), left, top, 0, 0) : TIFFComputeStrip(tiff_.get(), top, 0);
        if (load(block, rows)) {
          copy(left, top, rows, values);
        }
      }
    }
    return values;
  }

 private:
  /// @return false if a sparse file lacks the block
  /// @throws std::runtime_error
  bool load(std::uint32_t block, std::uint32_t rows) {
    const std::uint64_t offset = TIFFGetStrileOffset(tiff_.get(), block);
    const std::uint64_t size = TIFFGetStrileByteCount(tiff_.get(), block);
    const char* const kind = is_tiled_ ? "tile" : "strip";
    if (offset == 0 && size == 0 && may_be_sparse_) {
      return false;
    }
    if (offset == 0 || size == 0 || offset > file_bytes_ || size > file_bytes_ - offset) {
      throw std::runtime_error(fmt::format("the file is cut short: {} {} is bytes {} to {}, the file has {}",
                                           kind, block, offset, offset + size, file_bytes_));
    }
    const std::size_t wanted = std::size_t{rows} * block_width_px_ * pixel_bytes_;
    bytes_.resize(wanted);
    const auto length = static_cast<tmsize_t>(wanted);
    const tmsize_t got = is_tiled_ ? TIFFReadEncodedTile(tiff_.get(), block, bytes_.data(), length)
                                   : TIFFReadEncodedStrip(tiff_.get(), block, bytes_.data(), length);
    if (got != length) {
      throw std::runtime_error(
          fmt::format("{} {} is damaged or cut short: {}", kind, block,
                      got < 0 ? last_complaint() : fmt::format("{} bytes of {} are there", got, length)));
    }
    return true;
  }

  void copy(std::uint32_t left, std::uint32_t top, std::uint32_t rows, std::vector<float>& values) const {
    const std::uint32_t last_row = std::min(rows, height_px_ - top);
    const std::uint32_t columns = std::min(block_width_px_, width_px_ - left);
    for (std::uint32_t row = 0; row < last_row; ++row) {
      const std::uint8_t* from = bytes_.data() + std::size_t{row} * block_width_px_ * pixel_bytes_;
      float* const to = values.data() + std::size_t{height_px_ - 1 - top - row} * width_px_ + left;
      for (std::uint32_t column = 0; column < columns; ++column, from += pixel_bytes_) {
        to[column] = sample_(from);
      }
    }
  }

  const Tiff& tiff_;
  std::uint64_t file_bytes_;
  bool may_be_sparse_;
  SampleReader sample_ = nullptr;
  std::uint32_t width_px_ = 0, height_px_ = 0, block_width_px_ = 0, block_height_px_ = 0;
  std::size_t pixel_bytes_ = 0;
  bool is_tiled_ = false;
  std::vector<std::uint8_t> bytes_;  ///< of one strip or tile
};

}  // namespace

TiffElevations read_tiff_elevations(const std::filesystem::path& file, int most_px) {
  const GeoTiffTags tags = read_geotiff_tags(file);
  TIFFSetWarningHandler(nullptr);
  TIFFSetErrorHandler(keep_complaint);
  const Tiff tiff(TIFFOpen(file.c_str(), "r"), &TIFFClose);
  if (!tiff) {
    throw std::runtime_error(
        fmt::format("it is not a TIFF, or its directory is damaged: {}", last_complaint()));
  }
  const auto width_px = tag<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH);
  const auto height_px = tag<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH);
  const auto most = static_cast<std::uint32_t>(most_px);
  if (width_px > most || height_px > most) {
    throw std::runtime_error(
        fmt::format("{} x {} pixels is more than {} a side", width_px, height_px, most_px));
  }
  std::vector<float> value_m =
      Raster(tiff, std::filesystem::file_size(file), tags.no_data.has_value()).read();
  std::ranges::replace(value_m, static_cast<float>(tags.no_data.value_or(NAN)), NAN);
  return {static_cast<int>(width_px), static_cast<int>(height_px), std::move(value_m)};
}

}  // namespace sonard::render
