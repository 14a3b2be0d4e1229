// SPDX-License-Identifier: Apache-2.0
#include "server/offline/output_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace sonard::server {
namespace {

constexpr const char* manifest_name = "run.json";
constexpr const char* part_prefix = ".part-";
constexpr const char* lock_name = ".part-lock";
constexpr mode_t file_mode = 0644;  // mkstemp creates files that only the owner can read

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& doing) {
  throw output_error(path, "cannot " + doing + ": " + std::generic_category().message(errno));
}

bool is_part(const std::string& name) {
  return name.starts_with(part_prefix);
}

bool is_frame_or_log(const std::string& name) {
  return name.starts_with("ping_") || name.starts_with("scan_") || name.starts_with("log_");
}

/// Members of a manifest by path: "settings.range_m".
std::map<std::string, std::string> members_of(const std::string& manifest) {
  std::map<std::string, std::string> members;
  const auto json = nlohmann::json::parse(manifest, nullptr, false);
  if (json.is_object()) {
    const auto flat = json.flatten();  // items() refers to it
    for (const auto& [path, value] : flat.items()) {
      if (path.empty()) {
        continue;  // an empty object
      }
      std::string name = path.substr(1);
      std::ranges::replace(name, '/', '.');
      members[name] = value.dump();
    }
  }
  return members;
}

std::string difference(const std::string& name, const std::string& before, const std::string& now) {
  constexpr std::string_view file = "_crc32";
  if (const std::size_t end = name.find(file); end != std::string::npos) {
    const std::string body = name.substr(end + file.size());  // ".NAME" of a body's trajectory
    return name.substr(0, end) + body + " is a different file, or was changed";
  }
  const auto text = [](const std::string& value) { return value.empty() ? std::string("not set") : value; };
  return fmt::format("{} was {} and now is {}", name, text(before), text(now));
}

/// The first differences of two manifests.
std::string differences(const std::string& before, const std::string& now) {
  constexpr std::size_t most = 5;
  const auto was = members_of(before);
  const auto is = members_of(now);
  if (was.empty()) {
    return "its run.json cannot be read";
  }
  std::set<std::string> names;
  for (const auto* members : {&was, &is}) {
    for (const auto& [name, value] : *members) {
      names.insert(name);
    }
  }
  const auto value_in = [](const auto& members, const std::string& name) {
    const auto found = members.find(name);
    return found == members.end() ? std::string() : found->second;
  };
  std::vector<std::string> found;
  for (const std::string& name : names) {
    if (value_in(was, name) != value_in(is, name)) {
      found.push_back(difference(name, value_in(was, name), value_in(is, name)));
    }
  }
  const std::size_t more = found.size() > most ? found.size() - most : 0;
  found.resize(found.size() - more);
  return fmt::format("{}{}", fmt::join(found, "; "), more > 0 ? fmt::format("; and {} more", more) : "");
}

}  // namespace

Error output_error(const std::filesystem::path& path, const std::string& what) {
  return {ErrorKind::output, path.string() + ": " + what};
}

PartFile::PartFile(const std::filesystem::path& folder) : folder_(folder) {
  std::string name = (folder / (std::string(part_prefix) + "XXXXXX")).string();
  file_ = mkstemp(name.data());
  if (file_ < 0) {
    fail(folder, "create a file in it");
  }
  path_ = name;
  fchmod(file_, file_mode);
}

PartFile::~PartFile() {
  close(file_);
  if (!path_.empty()) {
    unlink(path_.c_str());
  }
}

void PartFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written < 0) {
      fail(folder_, "write a file in it");
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

std::string PartFile::read(std::uint64_t offset, std::size_t size) const {
  std::string bytes(size, '\0');
  const ssize_t got = pread(file_, bytes.data(), size, static_cast<off_t>(offset));
  if (got < 0) {
    fail(folder_, "read a file in it");
  }
  bytes.resize(static_cast<std::size_t>(got));
  return bytes;
}

// Data is on the disk, or on the file server, before the file gets its name: a failing machine leaves no file
// that only looks whole.
void PartFile::publish(const std::string& name) {
  if (fsync(file_) != 0) {
    fail(folder_, "write a file in it");
  }
  if (rename(path_.c_str(), (folder_ / name).c_str()) != 0) {
    fail(folder_ / name, "create it");
  }
  path_.clear();
}

OutputFolder::OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    throw output_error(folder_, "cannot create the folder: " + error.message());
  }
}

bool OutputFolder::has(const std::string& name) const {
  return access((folder_ / name).c_str(), F_OK) == 0;
}

void OutputFolder::write(const std::string& name, std::string_view bytes) const {
  PartFile part(folder_);
  part.write(bytes);
  part.publish(name);
}

std::string OutputFolder::read(const std::string& name) const {
  std::ifstream file(folder_ / name, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) {
    throw output_error(folder_ / name, "cannot be read");
  }
  return bytes;
}

void OutputFolder::remove(const std::string& name) const {
  if (unlink((folder_ / name).c_str()) != 0 && errno != ENOENT) {
    fail(folder_ / name, "remove it");
  }
}

std::optional<std::string> OutputFolder::manifest() const {
  return has(manifest_name) ? std::optional(read(manifest_name)) : std::nullopt;
}

void OutputFolder::claim(const std::string& manifest, bool overwrite) const {
  if (has(manifest_name)) {
    const std::string before = read(manifest_name);
    if (before == manifest) {
      return;
    }
    if (!overwrite) {
      throw output_error(folder_ / manifest_name,
                         fmt::format("the folder contains another run: {} (expected the same settings and "
                                     "files, another folder, or --overwrite)",
                                     differences(before, manifest)));
    }
  } else if (!overwrite && !names_of(is_frame_or_log).empty()) {
    throw output_error(folder_,
                       fmt::format("the folder contains frames or logs, but no {} of their run (expected "
                                   "an empty folder, another folder, or --overwrite)",
                                   manifest_name));
  }
  if (overwrite) {
    remove_if(is_frame_or_log);
  }
  write(manifest_name, manifest);
}

void OutputFolder::remove_parts() const {
  remove_if(is_part);
}

std::vector<std::string> OutputFolder::names_of(bool (*wanted)(const std::string& name)) const {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    if (const std::string name = entry.path().filename().string(); wanted(name)) {
      names.push_back(name);
    }
  }
  if (error) {
    throw output_error(folder_, "cannot be listed: " + error.message());
  }
  return names;
}

void OutputFolder::remove_if(bool (*unwanted)(const std::string& name)) const {
  for (const std::string& name : names_of(unwanted)) {
    remove(name);
  }
}

// Locks a file that is open for writing, not the folder: NFS does not pass locks of folders to other
// machines. If the file was removed as a part while this process waited, it tries again.
OutputFolder::Lock::Lock(const OutputFolder& folder) {
  const std::filesystem::path path = folder.path() / lock_name;
  do {
    close_file();
    file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, file_mode);
    if (file_ < 0) {
      fail(folder.path(), "create a file in it");
    }
    while (flock(file_, LOCK_EX) != 0) {
      if (errno != EINTR) {
        const int error = errno;
        close_file();
        errno = error;
        fail(folder.path(), "lock it");
      }
    }
  } while (!names(path));
}

OutputFolder::Lock::~Lock() {
  close_file();
}

bool OutputFolder::Lock::names(const std::filesystem::path& path) const {
  struct stat named {
  }, locked{};
  return stat(path.c_str(), &named) == 0 && fstat(file_, &locked) == 0 && named.st_dev == locked.st_dev &&
         named.st_ino == locked.st_ino;
}

void OutputFolder::Lock::close_file() {
  if (file_ >= 0) {
    close(file_);
    file_ = -1;
  }
}

}  // namespace sonard::server
