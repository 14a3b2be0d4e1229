// SPDX-License-Identifier: Apache-2.0
// A .glf of many pings, made in one run.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/glf/deflate.hpp"
#include "protocol/glf/records.hpp"
#include "server/offline/output_folder.hpp"

namespace sonard::server {

/// Collects records in a hidden .dat, which close() packs. The same records give the same bytes: all times in
/// the file come from its records. If a .dat becomes too large for readers, another log begins. Logs get
/// their names at the end, the first log last: if it exists, all exist.
class GlfFile {
 public:
  /// Bytes of a .dat at which the next log begins; readers use 31-bit sizes (protocol/glf/README.md 1.1).
  static constexpr std::uint64_t usual_most_dat_size = 1'000'000'000;

  /// @param app_name of the writer, including its version
  GlfFile(const OutputFolder& folder, std::string app_name,
          std::uint64_t most_dat_size = usual_most_dat_size);
  ~GlfFile();

  /// @throws Error
  void add(const glf::ImageRecord& image);
  /// @return the names of the logs. @throws Error
  std::vector<std::string> close();

 private:
  void finish();

  const OutputFolder& folder_;
  std::string app_name_;
  std::uint64_t most_dat_size_;
  std::unique_ptr<PartFile> dat_;  ///< null: no records yet
  std::uint64_t size_ = 0;
  glf::Crc32 crc_;
  double first_time_s_ = 0.0;
  double last_time_s_ = 0.0;
  std::uint16_t device_id_ = 0;
  struct Packed {
    std::string name;
    std::unique_ptr<PartFile> file;
  };
  std::vector<Packed> packed_;
};

}  // namespace sonard::server
