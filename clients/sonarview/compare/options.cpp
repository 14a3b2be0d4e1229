// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/options.hpp"

#include <CLI/CLI.hpp>

namespace sonard::client {

CompareArguments::CompareArguments(CLI::App& app) {
  const char* what =
      "First image: a picture, FILE.npy or FILE.csv#PING of sonard's dump, FILE.jsonl#TURN of --raw, "
      "FILE.glf#IMAGE";
  app.add_option("a", options_.a, what)->required();
  app.add_option("b", options_.b, "Second image, of the same size")->required();
  app.add_option("--json", options_.json, "Write the result to this file too")->type_name("FILE");
}

}  // namespace sonard::client
