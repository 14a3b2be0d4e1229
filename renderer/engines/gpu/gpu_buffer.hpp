// SPDX-License-Identifier: Apache-2.0
// Buffers of the GPU for compute shaders.
#pragma once

#include <cstddef>
#include <vector>

#include <fmt/format.h>
#include <osg/GLExtensions>

#include "renderer/errors.hpp"

namespace sonard::render {

/// Its context must be current when it is made, used and deleted.
class GpuBuffer {
 public:
  explicit GpuBuffer(osg::GLExtensions& gl) : gl_(gl) { gl_.glGenBuffers(1, &name_); }
  ~GpuBuffer() { gl_.glDeleteBuffers(1, &name_); }
  GpuBuffer(const GpuBuffer&) = delete;
  GpuBuffer& operator=(const GpuBuffer&) = delete;

  template <class T>
  void fill(const std::vector<T>& values, GLenum usage = GL_STATIC_DRAW) {
    select();
    bytes_ = values.size() * sizeof(T);
    gl_.glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes_), values.data(), usage);
  }
  /// Replaces a smaller buffer by `bytes` zeros. @throws RequestError as allocate()
  void hold(std::size_t bytes) {
    if (bytes_ < bytes) {
      allocate(bytes, GL_DYNAMIC_COPY);
      clear(bytes);
    }
  }
  /// Replaces the buffer by one of `bytes` with any contents.
  /// @throws RequestError if shaders cannot read so many in one buffer
  void allocate(std::size_t bytes, GLenum usage = GL_STATIC_DRAW) {
    GLint most = 0;  // at least 128 MiB
    glGetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    if (bytes > static_cast<std::size_t>(most)) {
      throw RequestError(fmt::format(
          "this GPU has buffers of at most {} bytes, and a ping needs {}: choose engine: cpu", most, bytes));
    }
    select();
    bytes_ = bytes;
    gl_.glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, usage);
  }
  /// Overwrites a part.
  template <class T>
  void write(const std::vector<T>& values, std::size_t first_byte = 0) {
    select();
    gl_.glBufferSubData(GL_SHADER_STORAGE_BUFFER, static_cast<GLintptr>(first_byte),
                        static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data());
  }
  /// Sets the first `bytes` to 0.
  void clear(std::size_t bytes) {
    // OpenSceneGraph does not load this function.
    using ClearBufferSubData =
        void(GL_APIENTRY*)(GLenum, GLenum, GLintptr, GLsizeiptr, GLenum, GLenum, const void*);
    static const auto clear =
        reinterpret_cast<ClearBufferSubData>(osg::getGLExtensionFuncPtr("glClearBufferSubData"));
    select();
    clear(GL_SHADER_STORAGE_BUFFER, GL_R8UI, 0, static_cast<GLsizeiptr>(bytes), GL_RED_INTEGER,
          GL_UNSIGNED_BYTE, nullptr);
  }
  std::size_t bytes() const { return bytes_; }
  GLuint name() const { return name_; }

 private:
  void select() const { gl_.glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_); }

  osg::GLExtensions& gl_;
  GLuint name_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace sonard::render
