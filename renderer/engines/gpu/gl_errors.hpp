// SPDX-License-Identifier: Apache-2.0
// Errors reported by OpenGL, and the bound of video memory. The context must be current.
#pragma once

#include <cstdint>
#include <string>

namespace sonard::render {

/// @throws RendererError if OpenGL has reported an error
void check_gl_errors(const std::string& doing);

/// Before an upload. @param needed_bytes of the world by a ping
/// @throws RequestError if they exceed the bound, which is gpu.memory_mib
void check_video_memory(std::uint64_t needed_bytes, std::uint64_t bound_bytes);

/// After an upload. @param bytes of the world in video memory
/// @throws RendererError if OpenGL has reported an error
void check_upload(std::uint64_t bytes);

}  // namespace sonard::render
