// SPDX-License-Identifier: Apache-2.0
// What `sonarview compare` compares: pictures, and samples that sonard and sonarview write to files.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace sonard::client {

/// Reads one side of a comparison.
///
///     FILE.png          a picture, PNG or JPEG by its contents; colours as brightness
///     FILE.npy          a ping of sonard's `dump`
///     FILE.csv#NUMBER   the ping of that number of such a dump, by its index
///     FILE.jsonl#TURN   a turn of a scanning head, by `sonarview --raw`
///     FILE.glf#IMAGE    an image of such a log, or of a FILE.dat, counted from 0
///
/// Samples come out as in sonarview's polar pictures: a column for each beam or step, range upwards.
/// @return CV_64FC1, black 0, full scale 255 whatever the number of bits
/// @throws std::runtime_error in one line that names the source
cv::Mat load_frame(const std::string& source);

}  // namespace sonard::client
