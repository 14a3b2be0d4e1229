// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/headers.hpp"

#include "protocol/glf/layout.hpp"

namespace sonard::glf {

static_assert(layout_is_contiguous<Layout<CiHeader>>(0) && layout_is_contiguous<Layout<ImageHeader>>(0));

CiHeader read_ci_header(ByteReader& reader) {
  const std::size_t start = reader.offset();
  CiHeader header;
  read_fields<Layout<CiHeader>>(reader, header);
  if (header.id != record_id) {
    reader.fail_at(start, WireErrorReason::bad_value, "id");
  }
  return header;
}

ImageHeader read_image_header(ByteReader& reader) {
  const std::size_t start = reader.offset();
  ImageHeader header;
  read_fields<Layout<ImageHeader>>(reader, header);
  if (header.version == image_version) {
    header.packing = static_cast<Packing>(reader.u16le("compression_type"));
  }
  header.data_size = reader.u32le("data_size");
  if (header.version != image_version && header.data_size == header.pixels()) {
    header.packing = Packing::raw;
  }
  if (header.tag != image_tag) {
    reader.fail_at(start + 2, WireErrorReason::bad_value, "record_tag");
  }
  if (header.end_line < header.first_line) {
    reader.fail_at(start + 10, WireErrorReason::bad_value, "end_range");
  }
  if (header.end_beam < header.first_beam) {
    reader.fail_at(start + 20, WireErrorReason::bad_value, "end_bearing");
  }
  return header;
}

}  // namespace sonard::glf
