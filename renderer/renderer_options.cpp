// SPDX-License-Identifier: Apache-2.0
#include "renderer/renderer_options.hpp"

namespace sonard::render {

std::string_view name_of(EngineKind engine) {
  switch (engine) {
    case EngineKind::automatic:
      return "auto";
    case EngineKind::gpu:
      return "gpu";
    case EngineKind::cpu:
      break;
  }
  return "cpu";
}

}  // namespace sonard::render
