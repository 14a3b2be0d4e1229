// SPDX-License-Identifier: Apache-2.0
// Texts that take long to make; the drawing thread makes them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace sonard::server {

using Text = std::shared_ptr<const std::string>;
/// Runs `make` on the drawing thread and then `take` on the page's thread; `take` gets null if `make` has
/// thrown.
using Draw = std::function<void(std::function<Text()> make, std::function<void(Text)> take)>;

/// A text that is made once for all who request it. Belongs to the page's thread.
class SharedText : public std::enable_shared_from_this<SharedText> {
 public:
  /// Calls `take` with the text, at once or when it is made; with null if it cannot be made. The next call
  /// then tries again.
  void get(const Draw& draw, std::function<Text()> make, std::function<void(Text)> take) {
    if (text_) {
      take(text_);
      return;
    }
    waiting_.push_back(std::move(take));
    if (waiting_.size() == 1) {
      draw(std::move(make), [self = shared_from_this()](Text text) {
        self->text_ = std::move(text);
        for (const auto& waiting : std::exchange(self->waiting_, {})) {
          waiting(self->text_);
        }
      });
    }
  }

  /// Drops all waiting calls.
  void close() { waiting_.clear(); }

 private:
  Text text_;
  std::vector<std::function<void(Text)>> waiting_;
};

}  // namespace sonard::server
