// The part of the loader that reads a head of type `gemini_720i`.
#pragma once

#include "server/config/head_section.hpp"

namespace sonard::server {

GeminiHeadConfig read_gemini_head(YamlSection& section, const HeadContext& context,
                                  std::vector<ConfigWarning>& warnings);

}  // namespace sonard::server
