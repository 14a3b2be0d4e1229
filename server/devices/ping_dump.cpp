#include "server/devices/ping_dump.hpp"

#include <array>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <boost/crc.hpp>

namespace sonard::server {
namespace {

// NumPy's file format 1.0: magic, version, length of the header, a Python literal padded to a multiple of 64.
std::string npy_header(const char* dtype, int lines, int beams) {
  std::string dictionary =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}", dtype, lines, beams);
  constexpr std::size_t preamble = 10;
  const std::size_t unpadded = preamble + dictionary.size() + 1;
  dictionary.append((64 - unpadded % 64) % 64, ' ');
  dictionary.push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  header.push_back(static_cast<char>(dictionary.size() & 0xFF));
  header.push_back(static_cast<char>(dictionary.size() >> 8));
  return header + dictionary;
}

template <class Sample>
void write_samples(std::ofstream& file, const std::vector<Sample>& samples) {
  file.write(reinterpret_cast<const char*>(samples.data()),
             static_cast<std::streamsize>(samples.size() * sizeof(Sample)));
}

}  // namespace

std::uint32_t samples_crc32(const render::PingSamples& samples) {
  boost::crc_32_type crc;
  crc.process_bytes(samples.u8.data(), samples.u8.size());
  for (const std::uint16_t sample : samples.u16) {
    crc.process_byte(static_cast<unsigned char>(sample >> 8));
    crc.process_byte(static_cast<unsigned char>(sample & 0xFF));
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
  index_ << "number,id,transmit_us,lines,beams,crc32\n" << std::flush;
}

void PingDump::write(const RenderJob& job, const render::PingSamples& samples) {
  const std::uint64_t number = job.request.ping_number;
  const std::filesystem::path path = folder_ / fmt::format("{}-{:08}.npy", head_, number);
  std::ofstream file(path, std::ios::binary);
  file << npy_header(samples.u16.empty() ? "|u1" : "<u2", samples.lines, samples.beams);
  write_samples(file, samples.u8);
  write_samples(file, samples.u16);
  file.close();
  index_ << fmt::format("{},{},{},{},{},{:08x}\n", number, number % 256, job.transmit_us, samples.lines,
                        samples.beams, samples_crc32(samples))
         << std::flush;
  if ((!file || !index_) && !failed_) {
    failed_ = true;
    spdlog::error("head={} cannot write {}; pings are missing in the dump from here on", head_,
                  path.string());
  }
}

}  // namespace sonard::server
