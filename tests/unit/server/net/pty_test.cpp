// SPDX-License-Identifier: Apache-2.0
// A serial line as a pseudo terminal: clients that open and close the tty, and the symbolic link to it.
#include <termios.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/net/pty_port.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/server/net/link_fixture.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class PtyLink : public LinkTest {
 protected:
  PtyLink() { open({{}, {}, {{}}, 0}); }

  /// Runs until the link has detected that a client opened the slave.
  bool run_until_occupied() {
    return run_until([&] { return link_->connected(); });
  }
};

Bytes all_bytes() {
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] = static_cast<std::uint8_t>(i);
  }
  return all;
}

TEST_F(PtyLink, PassesEveryByteBothWaysUnchangedAndWithoutEcho) {
  EXPECT_THAT(link_->addresses().pty.at(0), StartsWith("/dev/pts/"));
  Client client = tty_client();
  client.write(all_bytes());
  EXPECT_TRUE(run_until_heard(all_bytes()));
  link_->send(all_bytes());
  EXPECT_TRUE(run_until_hears(client, all_bytes())) << "and nothing before: an echo would be there by now";
  EXPECT_EQ(link_->counters().ports.connections, 1U);
}

TEST_F(PtyLink, EachFrameArrivesInOnePiece) {
  Client client = tty_client();
  ASSERT_TRUE(run_until_occupied());
  for (const std::size_t size : {22U, 264U, 445U, 1545U}) {
    const Bytes frame = numbered_frame(1, size);
    link_->send(frame);
    ASSERT_TRUE(run_until([&] { return client.readable() == size; }));
    EXPECT_EQ(client.read_once(), frame);
  }
}

TEST_F(PtyLink, ClientsMayCloseAtAnyByte) {
  for (std::size_t cut = 0; cut <= send_version.size(); ++cut) {
    heard_.clear();
    left_.clear();
    Client client = tty_client();
    const Bytes part(send_version.begin(), send_version.begin() + static_cast<std::ptrdiff_t>(cut));
    client.write(part);
    ASSERT_TRUE(run_until_heard(part));
    ASSERT_TRUE(run_until_occupied());
    client.close();
    ASSERT_TRUE(run_until_left(1)) << cut;
    EXPECT_THAT(left_, ElementsAre("pty " + link_->addresses().pty.at(0)));
    EXPECT_FALSE(link_->connected());
  }
  heard_.clear();
  Client next = tty_client();
  next.write(send_version);
  EXPECT_TRUE(run_until_heard(send_version));
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(next, alive));
}

TEST_F(PtyLink, HearsWhoWroteAndClosedBeforeItLooked) {
  Client client = tty_client();
  client.write(send_version);
  client.close();
  ASSERT_TRUE(run_until_left(1));
  EXPECT_EQ(heard_, send_version);
  EXPECT_EQ(link_->counters().ports.connections, 1U);
}

TEST_F(PtyLink, WhatNobodyHearsIsNeverSentLater) {
  link_->send(numbered_frame(0, 50));
  EXPECT_EQ(link_->counters().frames_unheard, 1U);
  Client first = tty_client();
  ASSERT_TRUE(run_until_occupied());
  link_->send(numbered_frame(1, 50));
  ASSERT_TRUE(run_until([&] { return first.readable() == 50; }));
  first.close();  // without reading it
  ASSERT_TRUE(run_until_left(1));
  Client second = tty_client();
  ASSERT_TRUE(run_until_occupied());
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(second, alive));
}

TEST_F(PtyLink, AFullTerminalOfOneClientIsEmptyForTheNext) {
  Client first = tty_client();
  ASSERT_TRUE(run_until_occupied());
  while (link_->counters().ports.frames_dropped == 0) {
    link_->send(numbered_frame(0, 1545));
  }
  first.close();
  ASSERT_TRUE(run_until_left(1));
  Client second = tty_client();
  ASSERT_TRUE(run_until_occupied());
  link_->send(alive);
  EXPECT_TRUE(run_until_hears(second, alive)) << "nor is there the rest of a frame";
}

TEST_F(PtyLink, WhoDoesNotReadLosesWholeFrames) {
  constexpr std::size_t size = 445;
  constexpr int frames = 200;
  Client slow = tty_client();
  ASSERT_TRUE(run_until_occupied());
  for (int i = 0; i < frames; ++i) {
    link_->send(numbered_frame(i, size));
  }
  const std::uint64_t dropped = link_->counters().ports.frames_dropped;
  EXPECT_GT(dropped, 0U);
  const std::size_t expected = frames - dropped;
  ASSERT_TRUE(run_until([&] { return slow.heard().size() >= expected * size; }));
  EXPECT_EQ(frame_numbers(slow.heard(), size).size(), expected);
  link_->send(numbered_frame(frames, size));
  ASSERT_TRUE(run_until([&] { return slow.heard().size() == (expected + 1) * size; }));
  EXPECT_EQ(frame_numbers(slow.heard(), size).back(), frames);
}

TEST_F(PtyLink, IsRawAgainAfterAClientThatSetItOtherwise) {
  Client first = tty_client();
  termios cooked{};
  ASSERT_EQ(tcgetattr(first.fd(), &cooked), 0);
  cooked.c_lflag |= ECHO | ICANON | ISIG;
  cooked.c_iflag |= ICRNL | IXON;
  cooked.c_oflag |= OPOST | ONLCR;
  ASSERT_EQ(tcsetattr(first.fd(), TCSANOW, &cooked), 0);
  ASSERT_TRUE(run_until_occupied());
  first.close();
  ASSERT_TRUE(run_until_left(1));

  Client second = tty_client();
  second.write(all_bytes());
  EXPECT_TRUE(run_until_heard(all_bytes()));
  link_->send(all_bytes());
  EXPECT_TRUE(run_until_hears(second, all_bytes()));
}

TEST_F(PtyLink, SeveralMayHaveItOpen) {
  Client one = tty_client();
  ASSERT_TRUE(run_until_occupied());
  {
    Client two = tty_client();
    two.write(Bytes{2});
    ASSERT_TRUE(run_until_heard({2}));
  }
  one.write(Bytes{1});
  ASSERT_TRUE(run_until_heard({2, 1}));
  EXPECT_THAT(left_, IsEmpty()) << "the first still has it open";
  one.close();
  EXPECT_TRUE(run_until_left(1));
}

TEST_F(PtyLink, ServesAHundredClientsOneAfterTheOther) {
  for (std::size_t i = 1; i <= 100; ++i) {
    Client client = tty_client();
    client.write(send_version);
    ASSERT_TRUE(run_until([&] { return heard_.size() == i * send_version.size(); })) << i;
    link_->send(alive);
    ASSERT_TRUE(run_until_hears(client, alive)) << i;
    client.close();
    ASSERT_TRUE(run_until_left(i));
  }
  EXPECT_EQ(link_->counters().ports.connections, 100U);
}

class PtyLinkName : public LinkTest {
 protected:
  void open_named() { open({{}, {}, {{link_name_}}, 0}); }
  /// The error message of opening; empty if it succeeds.
  std::string complaint() {
    try {
      open_named();
    } catch (const SocketError& error) {
      return error.what();
    }
    return "";
  }

  const test::TemporaryFolder folder_;
  fs::path link_name_ = folder_.path() / "micron";
};

TEST_F(PtyLinkName, LeadsToTheSlaveUntilItStops) {
  open_named();
  const std::string slave = link_->addresses().pty.at(0);
  EXPECT_EQ(fs::read_symlink(link_name_), slave);
  EXPECT_THAT(link_->descriptions(), ElementsAre("pty " + slave + " linked to by " + link_name_.string()));
  Client client = Client::tty(link_name_.string());
  client.write(send_version);
  EXPECT_TRUE(run_until_heard(send_version));
  link_->stop();
  EXPECT_FALSE(fs::exists(fs::symlink_status(link_name_)));
}

TEST_F(PtyLinkName, ReplacesOneThatACrashLeftBehind) {
  fs::create_symlink("/dev/pts/987654", link_name_);
  open_named();
  EXPECT_EQ(fs::read_symlink(link_name_), link_->addresses().pty.at(0));
}

TEST_F(PtyLinkName, SparesAFile) {
  std::ofstream(link_name_) << "precious";
  EXPECT_THAT(complaint(),
              "cannot create the link " + link_name_.string() +
                  ": the path exists and is not a link to a pseudo terminal, so sonard does not replace it");
  ASSERT_TRUE(fs::is_regular_file(fs::symlink_status(link_name_)));
  std::ostringstream content;
  content << std::ifstream(link_name_).rdbuf();
  EXPECT_EQ(content.str(), "precious");
}

TEST_F(PtyLinkName, SparesAFolderAndOtherLinks) {
  fs::create_directory(link_name_);
  EXPECT_THAT(complaint(), HasSubstr("does not replace it"));
  fs::remove(link_name_);
  for (const char* target : {"/dev/null", "/nowhere/at/all", "pts/3"}) {
    fs::create_symlink(target, link_name_);
    EXPECT_THAT(complaint(), HasSubstr(link_name_.string() + ": the path exists")) << target;
    EXPECT_EQ(fs::read_symlink(link_name_), target);
    fs::remove(link_name_);
  }
}

TEST_F(PtyLinkName, NamesThePathThatCannotBeMade) {
  link_name_ = folder_.path() / "no" / "such" / "folder";
  EXPECT_THAT(complaint(),
              testing::AllOf(StartsWith("cannot create the link " + link_name_.string() + " to /dev/"),
                             HasSubstr("No such file or directory")));
}

TEST_F(PtyLinkName, SaysWhichOfSeveralLinksCannotBeMade) {
  const fs::path missing = folder_.path() / "no" / "such" / "folder";
  try {
    open({{}, {}, {{link_name_}, {missing}}, 0});
    FAIL() << "it was made";
  } catch (const PtyLinkError& error) {
    EXPECT_EQ(error.item, 1U);
  }
}

TEST_F(PtyLinkName, LeavesAloneWhatSomebodyElseHasPutThere) {
  open_named();
  fs::remove(link_name_);
  fs::create_symlink("/dev/pts/987654", link_name_);
  link_->stop();
  EXPECT_EQ(fs::read_symlink(link_name_), "/dev/pts/987654");
}

TEST_F(PtyLinkName, IsGoneWhenAnotherPortCannotBeOpened) {
  const fs::path bad = folder_.path() / "missing" / "name";
  EXPECT_THROW(open({{}, {}, {{link_name_}, {bad}}, 0}), SocketError);
  EXPECT_FALSE(fs::exists(fs::symlink_status(link_name_)));
}

}  // namespace
}  // namespace sonard::server
