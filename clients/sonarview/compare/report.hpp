// SPDX-License-Identifier: Apache-2.0
// `sonarview compare`: two images go in, a table and a file come out.
#pragma once

#include <string>

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/compare/options.hpp"
#include "clients/sonarview/compare/similarity.hpp"

namespace sonard::client {

/// The measures one below the other: name, value, score in [0, 1] and what identical images have; "-" where
/// there is none.
std::string table_of(const Similarity& similarity);

/// The measures as a JSON object: {"a": ..., "b": ..., "width": ..., "height": ..., "measures": [{"name":
/// "mse", "value":
/// ..., "unit": ..., "score": ..., "identical": ...}, ...]}, null where there is none.
std::string json_of(const Similarity& similarity, const CompareOptions& options, int width, int height);

/// @throws std::runtime_error naming a source that cannot be read, sizes that differ, a file that cannot be
/// written
ExitStatus compare(const CompareOptions& options);

}  // namespace sonard::client
