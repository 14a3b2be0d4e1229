// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture/picture_file.hpp"

#include <fmt/format.h>
#include <png.h>
#include <turbojpeg.h>
#include <zlib.h>

#include <csetjmp>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace sonard::picture {
namespace {

using Turbo = std::unique_ptr<std::remove_pointer_t<tjhandle>, int (*)(tjhandle)>;

int png_colour_type(const cv::Mat& picture) {
  switch (picture.type()) {
    case CV_8UC1:
      return PNG_COLOR_TYPE_GRAY;
    case CV_8UC3:
      return PNG_COLOR_TYPE_RGB;
    case CV_8UC4:
      return PNG_COLOR_TYPE_RGBA;
    default:
      throw std::invalid_argument(fmt::format("cannot encode a picture of type {}", picture.type()));
  }
}

void append(png_structp png, png_bytep bytes, std::size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), size);
}

/// Owns no object with a destructor, because libpng leaves it by longjmp(); `file` is the caller's.
bool write_png(const cv::Mat& picture, int colour_type, int level, std::string& file) {
  png_structp png = png_create_write_struct(
      PNG_LIBPNG_VER_STRING, nullptr, [](png_structp failed, png_const_charp) { png_longjmp(failed, 1); },
      [](png_structp, png_const_charp) {});
  if (png == nullptr) {
    return false;
  }
  png_infop info = png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &file, append, nullptr);
  png_set_compression_level(png, level);
  png_set_compression_mem_level(png, MAX_MEM_LEVEL);
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture.cols), static_cast<png_uint_32>(picture.rows), 8,
               colour_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  png_set_bgr(png);
  for (int row = 0; row < picture.rows; ++row) {
    png_write_row(png, picture.ptr(row));
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

std::string png_file(const cv::Mat& picture, int level) {
  std::string file;
  if (!write_png(picture, png_colour_type(picture), level, file)) {
    throw std::runtime_error(fmt::format("cannot encode {} x {} pixels as PNG", picture.cols, picture.rows));
  }
  return file;
}

std::string jpeg_file(const cv::Mat& picture, int quality) {
  const Turbo turbo(tjInitCompress(), tjDestroy);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): the library's type
  const int failed =
      tjCompress2(turbo.get(), picture.data, picture.cols, static_cast<int>(picture.step[0]), picture.rows,
                  TJPF_BGR, &bytes, &size, TJSAMP_420, quality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owned(bytes, tjFree);
  if (failed != 0) {
    throw std::runtime_error(fmt::format("cannot encode {} x {} pixels as JPEG: {}", picture.cols,
                                         picture.rows, tjGetErrorStr2(turbo.get())));
  }
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace sonard::picture
