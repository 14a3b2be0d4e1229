// SPDX-License-Identifier: Apache-2.0
// The part of the world in video memory, and its bound.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <vector>

#include <osg/State>

namespace sonard::render {

/// Uploads items before they are drawn and releases the least recently drawn ones, so that video memory stays
/// within the bound. The context must be current in every call, unless stated otherwise.
class VideoMemory {
 public:
  /// A unit of upload and release: a chunk of a mesh, a normal map. It is in one VideoMemory at most.
  class Item {
   public:
    Item(const Item&) = delete;
    Item& operator=(const Item&) = delete;

    /// Bytes given to OpenGL, without the unknown overhead of the driver.
    std::uint64_t bytes() const { return bytes_; }

   protected:
    explicit Item(std::uint64_t bytes) : bytes_(bytes) {}
    /// @pre not in video memory: see remove().
    virtual ~Item() = default;
    /// Removes the item; for destructors of items that may be destroyed before their VideoMemory.
    void remove();

   private:
    friend class VideoMemory;

    virtual void upload(osg::State& state) = 0;
    virtual void release(osg::State& state) = 0;

    const std::uint64_t bytes_;
    VideoMemory* memory_ = nullptr;  ///< null: not in video memory
    std::list<Item*>::iterator place_;
    std::uint64_t last_hold_ = 0;  ///< number of the last hold() with this item
  };

  /// @param state of the context; must outlive this object
  VideoMemory(osg::State& state, std::uint64_t bound_bytes) : state_(state), bound_bytes_(bound_bytes) {}
  VideoMemory(const VideoMemory&) = delete;
  VideoMemory& operator=(const VideoMemory&) = delete;

  /// Puts all of these items into video memory. An item may be listed more than once.
  /// @throws RequestError if they exceed the bound; then nothing is uploaded or released
  /// @throws RendererError if OpenGL has no room for them
  void hold(const std::vector<Item*>& items);

  void release_all();
  /// Releases all items without OpenGL, after the context was lost.
  void forget_all();

  /// Bytes in use.
  std::uint64_t bytes() const { return bytes_; }
  /// Bytes uploaded so far, including repeated uploads.
  std::uint64_t bytes_uploaded() const { return bytes_uploaded_; }

 private:
  void release(Item& item);
  void check_upload() const;

  osg::State& state_;
  const std::uint64_t bound_bytes_;
  std::list<Item*> items_;  ///< last drawn first
  std::uint64_t bytes_ = 0;
  std::uint64_t bytes_uploaded_ = 0;
  std::uint64_t holds_ = 0;
};

}  // namespace sonard::render
