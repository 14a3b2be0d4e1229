// SPDX-License-Identifier: Apache-2.0
// A log with given bytes, as a file that the destructor deletes.
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include <unistd.h>

namespace sonard::test {

class TemporaryLog {
 public:
  TemporaryLog(const std::string& suffix, std::span<const std::uint8_t> bytes)
      : path_(std::filesystem::temp_directory_path() /
              ("sonard-log-" + std::to_string(getpid()) + "-" + std::to_string(next_++) + suffix)) {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  ~TemporaryLog() { std::filesystem::remove(path_); }
  TemporaryLog(const TemporaryLog&) = delete;
  TemporaryLog& operator=(const TemporaryLog&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  inline static int next_ = 0;
  std::filesystem::path path_;
};

}  // namespace sonard::test
