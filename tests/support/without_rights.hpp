// SPDX-License-Identifier: Apache-2.0
// A test without the rights of root, whom no mode of a file stops.
#pragma once

#include <unistd.h>

#include <stdexcept>

namespace sonard::test {

/// While it lives, the process is the user nobody if it was root. Make and remove files outside of its life.
class WithoutRights {
 public:
  WithoutRights() {
    if (was_root_ && seteuid(nobody) != 0) {
      throw std::runtime_error("cannot give up the rights of root");
    }
  }
  ~WithoutRights() {
    if (was_root_) {
      static_cast<void>(seteuid(0));
    }
  }
  WithoutRights(const WithoutRights&) = delete;
  WithoutRights& operator=(const WithoutRights&) = delete;

 private:
  static constexpr uid_t nobody = 65534;
  bool was_root_ = geteuid() == 0;
};

}  // namespace sonard::test
