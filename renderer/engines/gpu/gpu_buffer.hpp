// SPDX-License-Identifier: Apache-2.0
// Memory of the GPU that compute shaders see.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <osg/GLExtensions>

namespace sonard::render {

/// Made, used and deleted while its context is current.
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
  /// If there are not so many bytes, makes as many, of zeros.
  void hold(std::size_t bytes) {
    if (bytes_ < bytes) {
      fill(std::vector<std::uint8_t>(bytes), GL_DYNAMIC_COPY);
    }
  }
  template <class T>
  void write(std::size_t from_byte, const std::vector<T>& values) {
    select();
    gl_.glBufferSubData(GL_SHADER_STORAGE_BUFFER, static_cast<GLintptr>(from_byte),
                        static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data());
  }
  std::size_t bytes() const { return bytes_; }
  /// The next hold() starts over.
  void forget() { bytes_ = 0; }
  void bind(unsigned binding) const { gl_.glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name_); }
  void bind_to_copy() const { gl_.glBindBuffer(GL_COPY_READ_BUFFER, name_); }

 private:
  void select() const { gl_.glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_); }

  osg::GLExtensions& gl_;
  GLuint name_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace sonard::render
