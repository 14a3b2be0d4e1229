// SPDX-License-Identifier: Apache-2.0
#include "protocol/log/log_messages.hpp"

#include <google/protobuf/descriptor.pb.h>

#include <set>

namespace sonard::log {
namespace {

using google::protobuf::FileDescriptor;
using google::protobuf::FileDescriptorSet;

void add_file(const FileDescriptor& file, FileDescriptorSet& set, std::set<const FileDescriptor*>& added) {
  if (!added.insert(&file).second) {
    return;
  }
  for (int i = 0; i < file.dependency_count(); ++i) {
    add_file(*file.dependency(i), set, added);
  }
  file.CopyTo(set.add_file());
}

}  // namespace

std::vector<std::uint8_t> schema_data(const google::protobuf::Descriptor& message) {
  FileDescriptorSet set;
  std::set<const FileDescriptor*> added;
  add_file(*message.file(), set, added);
  return encode(set);
}

std::vector<std::uint8_t> encode(const google::protobuf::MessageLite& message) {
  keep_protobuf_quiet();
  std::vector<std::uint8_t> bytes(message.ByteSizeLong());
  message.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

std::optional<std::string> problem_of(const SonarImage& image) {
  const std::uint64_t pixels = std::uint64_t{image.range_lines()} * image.beams();
  if (image.pixels().size() != pixels) {
    return std::to_string(image.range_lines()) + " lines of " + std::to_string(image.beams()) +
           " beams have " + std::to_string(image.pixels().size()) + " pixels";
  }
  if (static_cast<std::uint64_t>(image.bearings_rad_size()) != image.beams()) {
    return std::to_string(image.beams()) + " beams have " + std::to_string(image.bearings_rad_size()) +
           " bearings";
  }
  return std::nullopt;
}

}  // namespace sonard::log
