// SPDX-License-Identifier: Apache-2.0
// Checks that a third-party file reader gets only existing local files of a known kind.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/reader_jail.hpp"

namespace sonard::render {

/// @param what "mesh" or "image", for the message.
/// @throws WorldError with the file name if it is not an absolute path of an existing regular file, or if its
/// extension (letter case ignored) is not one of `extensions`, which the message then lists.
void require_local_file(const std::filesystem::path& file, std::span<const std::string_view> extensions,
                        std::string_view what);

/// A message with the path and the system's reason, if a folder without rights or a loop of links hides
/// whether the path exists; else empty.
std::string trouble_reaching(const std::filesystem::path& path);

/// @throws WorldError with trouble_reaching(), if there is any.
void require_reachable(const std::filesystem::path& path);

/// @throws WorldError with the file name and the system's reason, if this process may not read it.
void require_readable(const std::filesystem::path& file);

/// The jail for reading a file. The libraries need about 0.05 s per megabyte and 20 bytes of memory per byte
/// of a mesh, and on some damaged files they never end.
/// @param readable the file, or all files that it may name
ReaderJail reader_jail(const std::filesystem::path& file, std::vector<std::filesystem::path> readable);

/// All bytes of a file; empty if it cannot be read.
std::string content_of(const std::filesystem::path& file);

/// Up to `limit` bytes from the start of a file.
std::string head_of(const std::filesystem::path& file, std::size_t limit);

/// Whether `path` is `folder` or below it, by their names alone. Both must be absolute.
bool lies_below(const std::filesystem::path& path, const std::filesystem::path& folder);

/// Extension in lower case without the dot.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace sonard::render
