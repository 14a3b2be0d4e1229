// SPDX-License-Identifier: Apache-2.0
// Errors reported by OpenGL. The context must be current.
#pragma once

#include <string>

namespace sonard::render {

/// Errors since the last take_gl_errors().
struct GlErrors {
  bool out_of_memory = false;
  unsigned other = 0;  ///< the last other error; 0: no other error

  bool any() const { return out_of_memory || other != 0; }
  /// "OpenGL error 1282 while binning".
  std::string text(const std::string& doing) const;
};
GlErrors take_gl_errors();

/// @throws RendererError if there is an error
void check_gl_errors(const std::string& doing);

}  // namespace sonard::render
