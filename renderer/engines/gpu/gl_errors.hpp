// SPDX-License-Identifier: Apache-2.0
// What OpenGL complains of. The context is current.
#pragma once

#include <string>

namespace sonard::render {

/// Complaints since they were taken last.
struct GlErrors {
  bool out_of_memory = false;
  unsigned other = 0;  ///< the last one that is not that; 0: none

  bool any() const { return out_of_memory || other != 0; }
  /// "OpenGL error 1282 while binning".
  std::string text(const std::string& doing) const;
};
GlErrors take_gl_errors();

/// @throws RendererError when there is a complaint.
void check_gl_errors(const std::string& doing);

}  // namespace sonard::render
