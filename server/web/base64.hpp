// SPDX-License-Identifier: Apache-2.0
// Bytes as text in messages of JSON.
#pragma once

#include <string>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

namespace sonard::server {

inline std::string base64(const std::string& bytes) {
  using namespace boost::archive::iterators;
  using Digits = base64_from_binary<transform_width<std::string::const_iterator, 6, 8>>;
  std::string text(Digits(bytes.begin()), Digits(bytes.end()));
  return text.append((4 - text.size() % 4) % 4, '=');
}

}  // namespace sonard::server
