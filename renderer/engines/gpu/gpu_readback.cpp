// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_readback.hpp"

namespace sonard::render {

namespace {

constexpr GLuint64 a_second_ns = 1'000'000'000;
constexpr int longest_wait_s = 60;  // for a slow software OpenGL; a lost card never answers

// OpenSceneGraph does not load this function.
using CopyBufferSubData = void(GL_APIENTRY*)(GLenum, GLenum, GLintptr, GLintptr, GLsizeiptr);

}  // namespace

GpuReadback::GpuReadback(osg::GLExtensions& gl) : gl_(gl) {
  gl_.glGenBuffers(1, &name_);
}

GpuReadback::~GpuReadback() {
  if (done_ != nullptr) {
    gl_.glDeleteSync(done_);
  }
  gl_.glDeleteBuffers(1, &name_);
}

void GpuReadback::ask(const std::vector<Part>& parts) {
  static const auto copy =
      reinterpret_cast<CopyBufferSubData>(osg::getGLExtensionFuncPtr("glCopyBufferSubData"));
  bytes_ = 0;
  for (const Part& part : parts) {
    bytes_ += part.bytes;
  }
  gl_.glBindBuffer(GL_COPY_WRITE_BUFFER, name_);
  if (room_ < bytes_) {
    gl_.glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes_), nullptr, GL_STREAM_READ);
    room_ = bytes_;
  }
  std::size_t at = 0;
  for (const Part& part : parts) {
    gl_.glBindBuffer(GL_COPY_READ_BUFFER, part.buffer.name());
    copy(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, static_cast<GLintptr>(at),
         static_cast<GLsizeiptr>(part.bytes));
    at += part.bytes;
  }
  gl_.glBindBuffer(GL_COPY_WRITE_BUFFER, 0);
  if (done_ != nullptr) {
    gl_.glDeleteSync(done_);
  }
  done_ = gl_.glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

bool GpuReadback::wait(const std::function<void(std::span<const std::byte>)>& take) {
  GLenum state = GL_TIMEOUT_EXPIRED;
  for (int s = 0; done_ != nullptr && state == GL_TIMEOUT_EXPIRED && s < longest_wait_s; ++s) {
    state = gl_.glClientWaitSync(done_, GL_SYNC_FLUSH_COMMANDS_BIT, a_second_ns);
  }
  if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED) {
    return false;
  }
  gl_.glBindBuffer(GL_COPY_WRITE_BUFFER, name_);
  const void* bytes =
      gl_.glMapBufferRange(GL_COPY_WRITE_BUFFER, 0, static_cast<GLsizeiptr>(bytes_), GL_MAP_READ_BIT);
  if (bytes != nullptr) {
    take({static_cast<const std::byte*>(bytes), bytes_});
    gl_.glUnmapBuffer(GL_COPY_WRITE_BUFFER);
  }
  gl_.glBindBuffer(GL_COPY_WRITE_BUFFER, 0);
  return bytes != nullptr;
}

}  // namespace sonard::render
