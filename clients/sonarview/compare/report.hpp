// SPDX-License-Identifier: Apache-2.0
// `sonarview compare`: compares two images, prints a table and writes a JSON file.
#pragma once

#include <string>

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/compare/options.hpp"
#include "clients/sonarview/compare/similarity.hpp"

namespace sonard::client {

/// The table, one measure per line: name, value, score in [0, 1], score of identical images. A missing value
/// is "-".
std::string table_of(const Similarity& similarity);

/// The measures as a JSON object: {"a": ..., "b": ..., "width": ..., "height": ..., "measures": [{"name":
/// "mse", "value": ..., "unit": ..., "score": ..., "identical": ...}, ...]}. A missing value is null.
std::string json_of(const Similarity& similarity, const CompareOptions& options, int width, int height);

/// @throws std::runtime_error that names an unreadable source, differing sizes, or an unwritable file
ExitStatus compare(const CompareOptions& options);

}  // namespace sonard::client
