// SPDX-License-Identifier: Apache-2.0
// Reads data back from the GPU without waiting for later work.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <osg/GLExtensions>

#include "renderer/engines/gpu/gpu_buffer.hpp"

namespace sonard::render {

/// Copies of buffers at the time of ask(). Its context must be current when it is made, used and deleted.
class GpuReadback {
 public:
  explicit GpuReadback(osg::GLExtensions& gl);
  ~GpuReadback();
  GpuReadback(const GpuReadback&) = delete;
  GpuReadback& operator=(const GpuReadback&) = delete;

  struct Part {
    const GpuBuffer& buffer;
    std::size_t bytes;  ///< from the beginning of the buffer
  };
  /// Lets the GPU copy the parts, one behind the other, after all work given to it so far.
  void ask(const std::vector<Part>& parts);

  /// Waits for the parts and passes their bytes to `take`. Work given to the GPU after ask() continues.
  /// @return false, without a call of `take`, if the context is lost or after a minute
  bool wait(const std::function<void(std::span<const std::byte>)>& take);

 private:
  osg::GLExtensions& gl_;
  GLuint name_ = 0;
  std::size_t room_ = 0, bytes_ = 0;
  GLsync done_ = nullptr;
};

}  // namespace sonard::render
