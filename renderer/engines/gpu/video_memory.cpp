// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/video_memory.hpp"

#include <cassert>

#include <fmt/format.h>

#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

void VideoMemory::Item::remove() {
  if (memory_ != nullptr) {
    memory_->release(*this);
  }
}

void VideoMemory::hold(const std::vector<Item*>& items) {
  ++holds_;
  std::uint64_t needed_bytes = 0;
  std::vector<Item*> missing;
  std::uint64_t missing_bytes = 0;
  for (Item* item : items) {
    if (item->last_hold_ == holds_) {
      continue;  // listed for another view too
    }
    item->last_hold_ = holds_;
    needed_bytes += item->bytes_;
    if (item->memory_ == nullptr) {
      missing.push_back(item);
      missing_bytes += item->bytes_;
    } else {
      items_.splice(items_.begin(), items_, item->place_);
    }
  }
  if (needed_bytes > bound_bytes_) {
    throw RequestError(fmt::format(
        "the part of this world that a sonar sees takes {} bytes of video memory, and gpu.memory_mib "
        "allows {} ({} MiB): raise it, or choose engine: cpu",
        needed_bytes, bound_bytes_, bound_bytes_ >> 20));
  }
  // Items of this call are at the front and fit, so the loop ends before them.
  while (bytes_ + missing_bytes > bound_bytes_) {
    assert(items_.back()->last_hold_ != holds_);
    release(*items_.back());
  }
  for (Item* item : missing) {
    item->upload(state_);
    items_.push_front(item);
    item->place_ = items_.begin();
    item->memory_ = this;
    bytes_ += item->bytes_;
  }
  bytes_uploaded_ += missing_bytes;
  if (!missing.empty()) {
    check_upload();
  }
}

void VideoMemory::check_upload() const {
  const GlErrors errors = take_gl_errors();
  if (errors.out_of_memory) {
    throw RendererError(
        fmt::format("the GPU has less video memory than gpu.memory_mib allows: {} bytes of the "
                    "world do not fit; lower it, or choose engine: cpu",
                    bytes_));
  }
  if (errors.any()) {
    throw RendererError(errors.text("uploading the world"));
  }
}

void VideoMemory::release(Item& item) {
  item.release(state_);
  items_.erase(item.place_);
  item.memory_ = nullptr;
  bytes_ -= item.bytes_;
}

void VideoMemory::release_all() {
  while (!items_.empty()) {
    release(*items_.back());
  }
}

void VideoMemory::forget_all() {
  for (Item* item : items_) {
    item->memory_ = nullptr;
  }
  items_.clear();
  bytes_ = 0;
}

}  // namespace sonard::render
