// SPDX-License-Identifier: Apache-2.0
// What of the world lies in video memory, and the bound that it keeps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <vector>

#include <osg/State>

namespace sonard::render {

/// Uploads what is about to be drawn and releases what was not drawn for the longest time, so that no more
/// bytes lie in video memory than the bound allows. The context is current in every call but where it says
/// otherwise.
class VideoMemory {
 public:
  /// What is uploaded and released as a whole: a chunk of a mesh, a normal map. It is in one VideoMemory or
  /// in none.
  class Item {
   public:
    Item(const Item&) = delete;
    Item& operator=(const Item&) = delete;

    /// As many as OpenGL is given; what a driver adds to each is not known.
    std::uint64_t bytes() const { return bytes_; }

   protected:
    explicit Item(std::uint64_t bytes) : bytes_(bytes) {}
    /// @pre not in video memory: see remove().
    virtual ~Item() = default;
    /// For the destructors of items that may go before their VideoMemory does.
    void remove();

   private:
    friend class VideoMemory;

    virtual void upload(osg::State& state) = 0;
    virtual void release(osg::State& state) = 0;

    const std::uint64_t bytes_;
    VideoMemory* memory_ = nullptr;  ///< null: not in video memory
    std::list<Item*>::iterator place_;
    std::uint64_t last_hold_ = 0;  ///< number of the call of hold() that wanted it last
  };

  /// @param state of the context; outlives this.
  VideoMemory(osg::State& state, std::uint64_t bound_bytes) : state_(state), bound_bytes_(bound_bytes) {}
  VideoMemory(const VideoMemory&) = delete;
  VideoMemory& operator=(const VideoMemory&) = delete;

  /// Afterwards all of these are in video memory. An item may be listed more than once.
  /// @throws RequestError when they do not fit, however much else is released; nothing is uploaded or
  /// released then.
  /// @throws RendererError when OpenGL has no room for them.
  void hold(const std::vector<Item*>& items);

  void release_all();
  /// Without OpenGL, when the context is lost and all that was in it with it.
  void forget_all();

  /// In use now.
  std::uint64_t bytes() const { return bytes_; }
  /// Uploaded so far, what was uploaded again included.
  std::uint64_t bytes_uploaded() const { return bytes_uploaded_; }

 private:
  void release(Item& item);
  void check_upload() const;

  osg::State& state_;
  const std::uint64_t bound_bytes_;
  std::list<Item*> items_;  ///< the last drawn first
  std::uint64_t bytes_ = 0;
  std::uint64_t bytes_uploaded_ = 0;
  std::uint64_t holds_ = 0;
};

}  // namespace sonard::render
