// SPDX-License-Identifier: Apache-2.0
// The inputs of `sonarview compare`: pictures, and files of samples that sonard and sonarview write.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace sonard::client {

/// Reads one side of a comparison.
///
///     FILE.png          a picture, PNG or JPEG by its contents; colours become brightness
///     FILE.npy          a ping of sonard's `dump`
///     FILE.csv#NUMBER   the ping with this number in the index of a dump
///     FILE.jsonl#TURN   a turn of a scanning head, written by `sonarview --raw`
///     FILE.glf#IMAGE    an image of a .glf log, or of a FILE.dat, counted from 0
///
/// Samples are arranged as in sonarview's polar pictures: a column for each beam or step, range upwards.
/// @return CV_64FC1, black 0, full scale 255 for any number of bits
/// @throws std::runtime_error with one line that names the source
cv::Mat load_frame(const std::string& source);

}  // namespace sonard::client
