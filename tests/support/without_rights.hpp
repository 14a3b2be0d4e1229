// SPDX-License-Identifier: Apache-2.0
// Runs a test without root's rights, because file modes do not restrict root.
#pragma once

#include <unistd.h>

#include <exception>
#include <stdexcept>

namespace sonard::test {

/// During its lifetime, a root process is the user nobody. Create and delete files outside of it.
class WithoutRights {
 public:
  WithoutRights() {
    if (was_root_ && seteuid(nobody) != 0) {
      throw std::runtime_error("cannot give up the rights of root");
    }
  }
  ~WithoutRights() {
    if (was_root_ && seteuid(0) != 0) {
      std::terminate();  // other tests need the rights
    }
  }
  WithoutRights(const WithoutRights&) = delete;
  WithoutRights& operator=(const WithoutRights&) = delete;

 private:
  static constexpr uid_t nobody = 65534;
  bool was_root_ = geteuid() == 0;
};

}  // namespace sonard::test
