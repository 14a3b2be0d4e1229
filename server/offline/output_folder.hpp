// SPDX-License-Identifier: Apache-2.0
// The folder of the frames, shared by processes and by interrupted runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/error/error.hpp"

namespace sonard::server {

/// A file or folder cannot be created, written or read, or belongs to another run: "PATH: what".
Error output_error(const std::filesystem::path& path, const std::string& what);

/// A file with a temporary name, which gets its final name when it is whole. Deleted without publish().
class PartFile {
 public:
  /// Creates a file in `folder`. @throws Error
  explicit PartFile(const std::filesystem::path& folder);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// @throws Error, also if the disk is full
  void write(std::string_view bytes);
  /// Reads up to `size` bytes that were written, from `offset` on.
  std::string read(std::uint64_t offset, std::size_t size) const;
  /// Forces the file to the disk, then atomically replaces any file of that name. @throws Error
  void publish(const std::string& name);

 private:
  std::filesystem::path folder_;
  std::filesystem::path path_;  ///< empty after publish()
  int file_ = -1;
};

/// Files with a final name are whole. Any number of processes can use a folder, and any number of threads can
/// call write(); all other functions of an object are for one thread.
class OutputFolder {
 public:
  /// Creates the folder. @throws Error
  explicit OutputFolder(std::filesystem::path folder);

  const std::filesystem::path& path() const { return folder_; }
  bool has(const std::string& name) const;
  /// @throws Error
  void write(const std::string& name, std::string_view bytes) const;
  /// @throws Error
  std::string read(const std::string& name) const;
  void remove(const std::string& name) const;

  /// Manifest of the run that owns the folder; nullopt: no run yet. @throws Error
  std::optional<std::string> manifest() const;
  /// Claims the folder for a run with this manifest, written as the file run.json. An existing manifest must
  /// be equal byte for byte, and frames or logs need a manifest; otherwise `overwrite` removes all frames and
  /// logs. The caller holds the lock.
  /// @throws Error if the manifest differs, or is missing beside frames or logs, without `overwrite`
  void claim(const std::string& manifest, bool overwrite) const;

  /// Only one process at a time has a lock, on this machine or another that shares the folder. It ends with
  /// the process. Its file in the folder is a part: remove_parts() removes it.
  class Lock {
   public:
    explicit Lock(const OutputFolder& folder);
    ~Lock();
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    bool names(const std::filesystem::path& path) const;
    void close_file();

    int file_ = -1;
  };
  /// Removes partial files of killed processes. Only call it while no other process writes.
  void remove_parts() const;

 private:
  std::vector<std::string> names_of(bool (*wanted)(const std::string& name)) const;
  void remove_if(bool (*unwanted)(const std::string& name)) const;

  std::filesystem::path folder_;
};

}  // namespace sonard::server
