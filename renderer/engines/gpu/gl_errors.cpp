// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gl_errors.hpp"

#include <fmt/format.h>
#include <osg/GL>

#include "renderer/errors.hpp"

namespace sonard::render {

std::string GlErrors::text(const std::string& doing) const {
  return fmt::format("OpenGL error {} while {}", other != 0 || !out_of_memory ? other : GL_OUT_OF_MEMORY,
                     doing);
}

GlErrors take_gl_errors() {
  constexpr int most = 16;  // a lost context may report errors without end
  GlErrors errors;
  for (int i = 0; i < most; ++i) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) {
      break;
    }
    if (error == GL_OUT_OF_MEMORY) {
      errors.out_of_memory = true;
    } else {
      errors.other = error;
    }
  }
  return errors;
}

void check_gl_errors(const std::string& doing) {
  if (const GlErrors errors = take_gl_errors(); errors.any()) {
    throw RendererError(errors.text(doing));
  }
}

}  // namespace sonard::render
