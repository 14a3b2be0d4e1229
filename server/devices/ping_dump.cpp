// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping_dump.hpp"

#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <boost/crc.hpp>

#include "protocol/npy/npy_file.hpp"

namespace sonard::server {
namespace {

npy::Table table_of(const render::PingSamples& samples) {
  const render::DirectionEchoes& directions = samples.directions;
  npy::Table table{samples.bins, samples.beams, samples.u8, samples.u16, directions.range_m};
  if (!directions.range_m.empty()) {
    table.rows = 2 * directions.rows;
    table.columns = directions.columns;
    table.f32.insert(table.f32.end(), directions.intensity.begin(), directions.intensity.end());
  }
  return table;
}

}  // namespace

std::uint32_t samples_crc32(const render::PingSamples& samples) {
  boost::crc_32_type crc;
  crc.process_bytes(samples.u8.data(), samples.u8.size());
  for (const std::uint16_t sample : samples.u16) {
    crc.process_byte(static_cast<unsigned char>(sample >> 8));
    crc.process_byte(static_cast<unsigned char>(sample & 0xFF));
  }
  for (const std::vector<float>* plane : {&samples.directions.range_m, &samples.directions.intensity}) {
    crc.process_bytes(plane->data(), plane->size() * sizeof(float));
  }
  return crc.checksum();
}

PingDump::PingDump(std::filesystem::path folder, std::string head)
    : folder_(std::move(folder)), head_(std::move(head)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  const std::filesystem::path index = folder_ / (head_ + ".csv");
  index_.open(index, std::ios::trunc);
  if (error || !index_) {
    throw std::runtime_error(fmt::format("cannot write {}", index.string()));
  }
  index_ << "number,id,transmit_us,lines,beams,crc32,pose_ns\n" << std::flush;
}

void PingDump::write(const PosedPing& ping, const render::PingSamples& samples) {
  const std::uint64_t number = ping.request.ping_number;
  const std::filesystem::path path = folder_ / fmt::format("{}-{:08}.npy", head_, number);
  std::ofstream file(path, std::ios::binary);
  const npy::Table table = table_of(samples);
  file << npy::encode(table);
  file.close();
  index_ << fmt::format("{},{},{},{},{},{:08x},{}\n", number, number % 256, ping.transmit_us, table.rows,
                        table.columns, samples_crc32(samples), ping.poses->stamp_ns)
         << std::flush;
  if ((!file || !index_) && !failed_) {
    failed_ = true;
    spdlog::error("head={}: cannot write {}; the dump lacks this ping and may lack later ones", head_,
                  path.string());
  }
}

}  // namespace sonard::server
