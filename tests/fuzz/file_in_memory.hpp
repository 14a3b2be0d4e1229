// SPDX-License-Identifier: Apache-2.0
// A file whose content changes with each input, for readers that need a path.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/fuzz/require.hpp"

namespace sonard::fuzz {

/// The file is in its own folder, in memory if the machine has /dev/shm.
class FileInMemory {
 public:
  /// @param suffix of its name, by which readers know the format
  explicit FileInMemory(const std::string& suffix) {
    std::string folder =
        std::string(access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp") + "/sonard-fuzz-XXXXXX";
    require(mkdtemp(folder.data()) != nullptr, "this machine has a folder for temporary files");
    folder_ = folder;
    path_ = folder_ / ("input" + suffix);
  }
  ~FileInMemory() { std::filesystem::remove_all(folder_); }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;

  /// Replaces the content.
  void hold(const std::uint8_t* data, std::size_t size) const {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    file.close();
    require(file.good(), "the input can be written");
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path folder_, path_;
};

}  // namespace sonard::fuzz
