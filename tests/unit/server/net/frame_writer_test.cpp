// SPDX-License-Identifier: Apache-2.0
// Writes frames into a stream that accepts a limited number of bytes.
#include "server/net/frame_writer.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using Bytes = std::vector<std::uint8_t>;
using boost::system::error_code;

struct NarrowStream {
  enum Wait { wait_write };

  std::size_t room = 0;
  bool gone = false;  ///< the other end has closed the connection
  Bytes taken;
  int writes = 0;
  std::function<void(const error_code&)> when_writable;

  std::size_t write_some(const boost::asio::const_buffer& buffer, error_code& error) {
    ++writes;
    if (gone) {
      error = make_error_code(boost::system::errc::broken_pipe);
      return 0;
    }
    const std::size_t length = std::min(room, buffer.size());
    error = length == 0 ? make_error_code(boost::system::errc::operation_would_block) : error_code();
    const auto* bytes = static_cast<const std::uint8_t*>(buffer.data());
    taken.insert(taken.end(), bytes, bytes + length);
    room -= length;
    return length;
  }
  void async_wait(Wait, std::function<void(const error_code&)> handler) {
    EXPECT_FALSE(when_writable) << "waits twice";
    when_writable = std::move(handler);
  }
  void gain_room(std::size_t bytes) {
    room += bytes;
    if (when_writable) {
      std::exchange(when_writable, nullptr)({});
    }
  }
};

struct FrameWriterTest : testing::Test {
  NarrowStream stream;
  FrameWriter<NarrowStream> writer{stream};
  std::shared_ptr<int> owner = std::make_shared<int>();
  const Bytes abcd{'a', 'b', 'c', 'd'};
  const Bytes xyz{'x', 'y', 'z'};
};

TEST_F(FrameWriterTest, WritesAFrameWithOneCall) {
  stream.room = 100;
  EXPECT_EQ(writer.send(abcd, owner), FrameFate::sent);
  EXPECT_EQ(stream.taken, abcd);
  EXPECT_EQ(stream.writes, 1);
  EXPECT_FALSE(stream.when_writable);
}

TEST_F(FrameWriterTest, DropsAFrameOfWhichNothingFits) {
  EXPECT_EQ(writer.send(abcd, owner), FrameFate::no_room);
  stream.gain_room(100);
  EXPECT_EQ(writer.send(xyz, owner), FrameFate::sent);
  EXPECT_EQ(stream.taken, xyz) << "what was dropped does not come later";
}

TEST_F(FrameWriterTest, FinishesWhatItHasBegunAndDropsWhatComesMeanwhile) {
  for (std::size_t first = 1; first < abcd.size(); ++first) {
    stream = {};
    stream.room = first;
    EXPECT_EQ(writer.send(abcd, owner), FrameFate::sent);
    EXPECT_EQ(writer.send(xyz, owner), FrameFate::no_room);
    while (stream.when_writable) {
      stream.gain_room(1);
    }
    EXPECT_EQ(stream.taken, abcd) << first;
    stream.room = 100;
    EXPECT_EQ(writer.send(xyz, owner), FrameFate::sent);
    EXPECT_EQ(stream.taken.size(), abcd.size() + xyz.size());
  }
}

TEST_F(FrameWriterTest, AReaderThatIsGoneIsNoSlowReader) {
  stream.gone = true;
  EXPECT_EQ(writer.send(abcd, owner), FrameFate::no_reader);
}

TEST_F(FrameWriterTest, ForgetsTheRestWhenToldTo) {
  stream.room = 2;
  EXPECT_EQ(writer.send(abcd, owner), FrameFate::sent);
  writer.clear();
  stream.gain_room(100);
  EXPECT_EQ(writer.send(xyz, owner), FrameFate::sent);
  EXPECT_EQ(stream.taken, (Bytes{'a', 'b', 'x', 'y', 'z'}));
}

TEST_F(FrameWriterTest, WaitsOnceHoweverOftenItBeginsAnew) {
  for (int i = 0; i < 3; ++i) {
    stream.room = 1;
    EXPECT_EQ(writer.send(abcd, owner), FrameFate::sent);
    writer.clear();
  }
  stream.room = 1;
  EXPECT_EQ(writer.send(xyz, owner), FrameFate::sent);
  stream.gain_room(100);
  EXPECT_EQ(stream.taken, (Bytes{'a', 'a', 'a', 'x', 'y', 'z'}));
}

TEST_F(FrameWriterTest, KeepsItsOwnerOnlyWhileItWaits) {
  stream.room = 2;
  EXPECT_EQ(writer.send(abcd, owner), FrameFate::sent);
  EXPECT_EQ(owner.use_count(), 2);
  stream.gain_room(100);
  EXPECT_EQ(owner.use_count(), 1);
}

}  // namespace
}  // namespace sonard::server
