// SPDX-License-Identifier: Apache-2.0
// The tree of frames that /tf and /tf_static tell of.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "clients/ros1/messages/ros_pose.hpp"

namespace sonard::client {

/// tf2's own buffer, which interpolates along the chain between two frames and remembers 10 s. One thread.
class FrameTree {
 public:
  FrameTree();
  ~FrameTree();

  /// A transform from /tf (false) or /tf_static (true); its numbers are finite, its quaternion has norm 1.
  /// @return true when its stamp was more than 250 ms behind the newest one of the same frame: the clock was
  /// set back (a simulation was reset), and everything from before, but for /tf_static, is forgotten.
  bool insert(const RosPose& transform, bool is_static);

  /// Where `frame` is in `root` at the newest time for which the whole chain between them is known; a stamp
  /// of 0 says that the chain does not change at all.
  struct Lookup {
    std::optional<RosPose> pose;
    std::string problem;  ///< why there is none
  };
  Lookup newest(const std::string& root, const std::string& frame) const;
  /// The same at a time, and the newest where that is not known.
  Lookup at(std::int64_t stamp_ns, const std::string& root, const std::string& frame) const;

  /// Sorted.
  std::vector<std::string> frames() const;

 private:
  struct Buffer;
  std::unique_ptr<Buffer> buffer_;
  std::map<std::string, std::int64_t> newest_ns_;  ///< by child frame
};

}  // namespace sonard::client
