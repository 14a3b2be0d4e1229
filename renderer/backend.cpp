// SPDX-License-Identifier: Apache-2.0
#include "renderer/backend.hpp"

namespace sonard::render {

std::string_view name_of(Backend backend) {
  switch (backend) {
    case Backend::automatic:
      return "auto";
    case Backend::raster:
      return "raster";
    case Backend::ray:
      break;
  }
  return "ray";
}

}  // namespace sonard::render
