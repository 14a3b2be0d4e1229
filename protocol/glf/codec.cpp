// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/codec.hpp"

#include <optional>
#include <stdexcept>
#include <utility>

#include "protocol/common/byte_reader.hpp"
#include "protocol/common/byte_writer.hpp"
#include "protocol/glf/deflate.hpp"
#include "protocol/glf/headers.hpp"
#include "protocol/glf/layout.hpp"

namespace sonard::glf {
namespace {

static_assert(layout_is_contiguous<Layout<ImageRecord>>(0) && layout_is_contiguous<Layout<StatusRecord>>(0));

void write_ci_header(ByteWriter& writer, const Origin& origin, RecordType type, std::size_t size) {
  const CiHeader header{.length = static_cast<std::uint32_t>(size),
                        .time_s = origin.time_s,
                        .type = static_cast<std::uint8_t>(type),
                        .device_id = origin.device_id,
                        .node_id = origin.node_id};
  write_fields<Layout<CiHeader>>(writer, header);
}

CiHeader read_header_of(RecordType type, ByteReader& reader) {
  const CiHeader header = read_ci_header(reader);
  if (header.type != static_cast<std::uint8_t>(type)) {
    reader.fail_at(14, WireErrorReason::bad_value, "data_type");
  }
  return header;
}

void require_consistent(const ImageRecord& image) {
  if (image.pixels.size() != std::uint64_t{image.lines} * image.beams || image.pixels.size() > max_pixels) {
    throw std::invalid_argument("an image must have lines * beams pixels, at most max_pixels");
  }
  if (image.bearings_rad.size() != image.beams) {
    throw std::invalid_argument("an image must have one bearing for each beam");
  }
}

std::vector<std::uint8_t> unpacked_pixels(ByteReader& reader, const ImageHeader& header) {
  const std::size_t start = reader.offset();
  const auto data = reader.bytes(header.data_size, "pixels");
  if (header.lines() * header.beams() > max_pixels) {
    reader.fail_at(start, WireErrorReason::bad_length, "pixels");
  }
  if (!reader.ok()) {
    return {};
  }
  switch (header.packing) {
    case Packing::raw:
      if (data.size() != header.pixels()) {
        reader.fail_at(start, WireErrorReason::bad_length, "pixels");
      }
      return {data.begin(), data.end()};
    case Packing::zlib:
      if (auto pixels = inflate_exactly(data, header.pixels(), DeflateForm::zlib)) {
        return std::move(*pixels);
      }
      reader.fail_at(start, WireErrorReason::bad_value, "pixels");
      return {};
  }
  reader.fail_at(start, WireErrorReason::bad_value, "compression_type");
  return {};
}

std::vector<double> read_bearings(ByteReader& reader, std::uint64_t count) {
  if (count > reader.remaining() / sizeof(double)) {
    reader.fail(WireErrorReason::truncated, "bearings");
  }
  std::vector<double> bearings_rad(reader.ok() ? count : 0);
  for (double& bearing_rad : bearings_rad) {
    read_value(reader, "bearings", bearing_rad);
  }
  return bearings_rad;
}

void read_image_end(ByteReader& reader) {
  if (reader.u8("acoustic_zoom") != 0) {
    reader.fail_at(reader.offset() - 1, WireErrorReason::bad_value, "acoustic_zoom");
  }
  if (reader.u16le("end_tag") != image_end_tag) {
    reader.fail_at(reader.offset() - 2, WireErrorReason::bad_value, "end_tag");
  }
}

}  // namespace

std::vector<std::uint8_t> encode(const ImageRecord& image, int zlib_level) {
  require_consistent(image);
  // Raw unless compression makes them shorter: readers take data of the image's size for raw pixels.
  const auto shorter = deflate_shorter(image.pixels, zlib_level);
  const auto& data = shorter ? *shorter : image.pixels;
  const ImageHeader header{.first_line = image.first_line,
                           .end_line = image.first_line + image.lines,
                           .range_compression = image.range_compression,
                           .first_beam = image.first_beam,
                           .end_beam = image.first_beam + image.beams,
                           .packing = shorter ? Packing::zlib : Packing::raw,
                           .data_size = static_cast<std::uint32_t>(data.size())};
  std::vector<std::uint8_t> record;
  const std::size_t size = ci_header_size + image_header_size + header.rest();
  record.reserve(size);
  ByteWriter writer{record};
  write_ci_header(writer, image.origin, RecordType::image, size);
  write_fields<Layout<ImageHeader>>(writer, header);
  write_value(writer, header.packing);
  write_value(writer, header.data_size);
  writer.bytes(data);
  for (const double bearing_rad : image.bearings_rad) {
    write_value(writer, bearing_rad);
  }
  write_fields<Layout<ImageRecord>>(writer, image);
  writer.u8(0);  // no acoustic zoom: both known readers fail if there is one
  writer.u16le(image_end_tag);
  return record;
}

std::vector<std::uint8_t> encode(const StatusRecord& status) {
  std::vector<std::uint8_t> record;
  record.reserve(ci_header_size + status_body_size);
  ByteWriter writer{record};
  write_ci_header(writer, status.origin, RecordType::status, ci_header_size + status_body_size);
  write_fields<Layout<StatusRecord>>(writer, status);
  return record;
}

Result<ImageRecord, WireError> decode_image(std::span<const std::uint8_t> record) {
  ByteReader reader{record};
  ImageRecord image;
  image.origin = read_header_of(RecordType::image, reader).origin();
  const ImageHeader header = read_image_header(reader);
  image.first_line = header.first_line;
  image.lines = static_cast<std::uint32_t>(header.lines());
  image.range_compression = header.range_compression;
  image.first_beam = header.first_beam;
  image.beams = static_cast<std::uint32_t>(header.beams());
  image.pixels = unpacked_pixels(reader, header);
  image.bearings_rad = read_bearings(reader, header.beams());
  read_fields<Layout<ImageRecord>>(reader, image);
  read_image_end(reader);
  if (!reader.ok()) {
    return *reader.error();
  }
  return image;
}

Result<StatusRecord, WireError> decode_status(std::span<const std::uint8_t> record) {
  ByteReader reader{record};
  StatusRecord status;
  status.origin = read_header_of(RecordType::status, reader).origin();
  read_fields<Layout<StatusRecord>>(reader, status);
  if (!reader.ok()) {
    return *reader.error();
  }
  return status;
}

}  // namespace sonard::glf
