// SPDX-License-Identifier: Apache-2.0
// Keeps Protobuf from printing to stderr. For codecs only, because it includes Protobuf.
#pragma once

#include <google/protobuf/stubs/logging.h>

namespace sonard {

/// Protobuf prints a line for each text that is not UTF-8, so a peer could fill a disk. Codecs return an
/// error instead, which the programs count and log. Call it before each use of Protobuf; any thread.
inline void keep_protobuf_quiet() {
  [[maybe_unused]] static const auto before = google::protobuf::SetLogHandler(nullptr);
}

}  // namespace sonard
