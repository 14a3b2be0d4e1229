// SPDX-License-Identifier: Apache-2.0
// The command line of the programs in this folder.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/pictures/halves.hpp"

namespace sonard::pictures {

struct PictureProgram {
  std::string name;
  std::string description;
  std::string folder;              ///< default folder of pictures
  std::vector<std::string> names;  ///< of all pictures
  /// Loads the views of these pictures.
  std::function<std::vector<Halves>(const std::vector<std::string>& names)> halves;
};

/// Options: NAMES, --out, --engine, --radius. @return the exit code
int run_picture_program(const PictureProgram& program, int argc, const char* const* argv);

}  // namespace sonard::pictures
