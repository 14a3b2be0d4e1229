// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/packer.hpp"

#include <span>
#include <stdexcept>
#include <utility>

#include "protocol/common/byte_writer.hpp"
#include "protocol/glf/deflate.hpp"
#include "protocol/glf/zip.hpp"

namespace sonard::glf {
namespace {

static_assert(layout_is_contiguous<zip::Layout<zip::Entry>>(0) &&
              layout_is_contiguous<zip::Layout<zip::LocalHeader>>(0) &&
              layout_is_contiguous<zip::Layout<zip::CentralHeader>>(0) &&
              layout_is_contiguous<zip::Layout<zip::EndRecord>>(0));

/// The final, empty block of a stream of stored blocks.
constexpr std::array<std::uint8_t, 5> final_block{0x01, 0x00, 0x00, 0xFF, 0xFF};

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::uint32_t crc_of(const std::string& text) {
  Crc32 crc;
  crc.add(bytes_of(text));
  return crc.value();
}

/// Size of `size` bytes in stored blocks. It is always larger, so readers detect that nothing is compressed.
std::uint32_t stored_size(std::uint32_t size) {
  const std::size_t blocks = (size + pack_block_size - 1) / pack_block_size + 1;
  return static_cast<std::uint32_t>(size + blocks * zip::block_header_size);
}

zip::Entry entry_of(const std::string& name, std::uint32_t size, std::uint32_t crc, const CivilTime& time) {
  const unsigned date = (static_cast<unsigned>(time.year) - 1980U) << 9U | time.month << 5U | time.day;
  const unsigned clock = time.hour << 11U | time.minute << 5U | time.second / 2U;
  return {.dos_time = static_cast<std::uint16_t>(clock),
          .dos_date = static_cast<std::uint16_t>(date),
          .crc = crc,
          .compressed_size = stored_size(size),
          .size = size,
          .name_size = static_cast<std::uint16_t>(name.size())};
}

}  // namespace

Packer::Packer(const std::string& stamp, std::string config_xml, const DatSummary& dat,
               const CivilTime& closed)
    : config_xml_(std::move(config_xml)), closed_(closed) {
  if (config_xml_.empty() || config_xml_.size() > pack_block_size) {
    throw std::invalid_argument("the .cfg of a log must fit one block");
  }
  if (dat.size > max_dat_size) {
    throw std::invalid_argument("the .dat is too large to be packed");
  }
  const auto config_size = static_cast<std::uint32_t>(config_xml_.size());
  files_[0] = {.name = config_name(stamp), .size = config_size, .crc = crc_of(config_xml_)};
  files_[1] = {.name = dat_name(stamp),
               .size = static_cast<std::uint32_t>(dat.size),
               .crc = dat.crc,
               .local_offset = static_cast<std::uint32_t>(zip::Layout<zip::LocalHeader>::size +
                                                          files_[0].name.size() + stored_size(config_size))};
}

std::vector<std::uint8_t> Packer::head() const {
  std::vector<std::uint8_t> out;
  ByteWriter writer{out};
  const auto write_local_header = [&](const File& file) {
    const zip::LocalHeader header{.entry = entry_of(file.name, file.size, file.crc, closed_)};
    write_fields<zip::Layout<zip::LocalHeader>>(writer, header);
    writer.bytes(bytes_of(file.name));
  };
  write_local_header(files_[0]);
  writer.bytes(block_header(config_xml_.size()));
  writer.bytes(bytes_of(config_xml_));
  writer.bytes(final_block);
  write_local_header(files_[1]);
  return out;
}

std::array<std::uint8_t, 5> Packer::block_header(std::size_t size) {
  const auto low = static_cast<std::uint8_t>(size);
  const auto high = static_cast<std::uint8_t>(size >> 8);
  return {0x00, low, high, static_cast<std::uint8_t>(~low), static_cast<std::uint8_t>(~high)};
}

std::vector<std::uint8_t> Packer::tail() const {
  std::vector<std::uint8_t> out;
  ByteWriter writer{out};
  writer.bytes(final_block);
  const std::size_t directory_start = writer.offset();
  for (const File& file : files_) {
    const zip::CentralHeader header{.entry = entry_of(file.name, file.size, file.crc, closed_),
                                    .local_offset = file.local_offset};
    write_fields<zip::Layout<zip::CentralHeader>>(writer, header);
    writer.bytes(bytes_of(file.name));
  }
  const File& dat = files_.back();
  const zip::EndRecord end{
      .entries_here = 2,
      .entries = 2,
      .directory_size = static_cast<std::uint32_t>(writer.offset() - directory_start),
      .directory_offset = static_cast<std::uint32_t>(dat.local_offset + zip::Layout<zip::LocalHeader>::size +
                                                     dat.name.size() + stored_size(dat.size))};
  write_fields<zip::Layout<zip::EndRecord>>(writer, end);
  return out;
}

}  // namespace sonard::glf
