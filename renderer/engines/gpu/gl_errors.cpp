// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gl_errors.hpp"

#include <fmt/format.h>
#include <osg/GL>

#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

/// @return an error since the last call, before all others GL_OUT_OF_MEMORY; GL_NO_ERROR: none
GLenum take_gl_error() {
  constexpr int most = 16;  // a lost context may report errors without end
  GLenum taken = GL_NO_ERROR;
  for (int i = 0; i < most; ++i) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) {
      break;
    }
    taken = taken == GL_OUT_OF_MEMORY ? taken : error;
  }
  return taken;
}

void throw_if(GLenum error, const std::string& doing) {
  if (error != GL_NO_ERROR) {
    throw RendererError(fmt::format("OpenGL error {} while {}", error, doing));
  }
}

}  // namespace

void check_gl_errors(const std::string& doing) {
  throw_if(take_gl_error(), doing);
}

void check_video_memory(std::uint64_t needed_bytes, std::uint64_t bound_bytes) {
  if (needed_bytes > bound_bytes) {
    throw RequestError(fmt::format(
        "the part of this world that a sonar sees takes {} bytes of video memory, and gpu.memory_mib "
        "allows {} ({} MiB): raise it, or choose engine: cpu",
        needed_bytes, bound_bytes, bound_bytes >> 20U));
  }
}

void check_upload(std::uint64_t bytes) {
  const GLenum error = take_gl_error();
  if (error == GL_OUT_OF_MEMORY) {
    throw RendererError(
        fmt::format("the GPU has less video memory than gpu.memory_mib allows: {} bytes of the "
                    "world do not fit; lower it, or choose engine: cpu",
                    bytes));
  }
  throw_if(error, "uploading the world");
}

}  // namespace sonard::render
