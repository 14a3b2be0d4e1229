// SPDX-License-Identifier: Apache-2.0
// What may be handed to a foreign file reader: an existing local file of a known kind, nothing else.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace sonard::render {

/// @param what "mesh" or "image", for the message.
/// @throws WorldError naming the file when it is no absolute path of an existing regular file or its
/// extension (letter case ignored) is not one of `extensions`, which the message then lists.
void require_local_file(const std::filesystem::path& file, std::span<const std::string_view> extensions,
                        std::string_view what);

/// @throws WorldError naming the file and the system's reason, if this process may not read it.
void require_readable(const std::filesystem::path& file);

/// Processor time that reading the file may take: the plugins need about 0.05 s for a megabyte, and on some
/// damaged files they never end.
unsigned int reading_limit_s(const std::filesystem::path& file);

/// Up to `limit` bytes from the start of a file.
std::string head_of(const std::filesystem::path& file, std::size_t limit);

/// Extension in lower case without the dot.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace sonard::render
