// SPDX-License-Identifier: Apache-2.0
// The folder that frames go into, shared by processes and by runs that were interrupted.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sonard::server {

/// A file or folder cannot be made, written or read, or belongs to another run. what() is one line that
/// begins with the path.
struct OutputError : std::runtime_error {
  OutputError(const std::filesystem::path& path, const std::string& what)
      : std::runtime_error(path.string() + ": " + what) {}
};

/// A file with a name of its own, which takes its real name when it is whole. Without publish() it goes.
class PartFile {
 public:
  /// Made in `folder`. @throws OutputError
  explicit PartFile(const std::filesystem::path& folder);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// @throws OutputError, also where the disk is full
  void write(std::string_view bytes);
  /// Reads what was written, from `offset` on, up to `size` bytes of it.
  std::string read(std::uint64_t offset, std::size_t size) const;
  /// Forces its bytes to the disk; then it replaces whatever has that name, at once. @throws OutputError
  void publish(const std::string& name);

 private:
  std::filesystem::path folder_;
  std::filesystem::path path_;  ///< empty once published
  int file_ = -1;
};

/// What is in the folder under its real name is whole. Any number of processes use a folder, and any number
/// of threads write() into it; all else of an object is for one thread.
class OutputFolder {
 public:
  /// Makes the folder. @throws OutputError
  explicit OutputFolder(std::filesystem::path folder);

  const std::filesystem::path& path() const { return folder_; }
  bool has(const std::string& name) const;
  /// @throws OutputError
  void write(const std::string& name, std::string_view bytes) const;
  /// @throws OutputError
  std::string read(const std::string& name) const;
  void remove(const std::string& name) const;

  /// Of the run whose folder it is; nullopt: of none yet. @throws OutputError
  std::optional<std::string> manifest() const;
  /// Makes the folder that of a run, which `manifest` describes to the last byte; it becomes the file
  /// run.json. An existing one must be equal, or with `overwrite` all frames and logs are removed. The caller
  /// holds the lock.
  /// @throws OutputError where it says something else
  void claim(const std::string& manifest, bool overwrite) const;

  /// While it exists no other process has one, on this machine or another that shares the folder; the end of
  /// a process ends it too. Its file in the folder is a part: remove_parts() removes it.
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
  /// Removes the parts of files left by processes that were killed. Only while no other process writes.
  void remove_parts() const;

 private:
  void remove_if(bool (*unwanted)(const std::string& name)) const;

  std::filesystem::path folder_;
};

}  // namespace sonard::server
