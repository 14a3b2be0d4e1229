// SPDX-License-Identifier: Apache-2.0
#include "server/offline/progress.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::seconds;

TEST(ProgressText, TellsRateAndTimeLeft) {
  EXPECT_EQ(progress_text({300, 0, 120, seconds(60)}), "120 of 300 frames, 40 %, 2.0 per second, 1:30 left");
}

TEST(ProgressText, FramesThatWereThereDoNotCountForTheRate) {
  EXPECT_EQ(progress_text({300, 200, 10, seconds(10)}), "210 of 300 frames, 70 %, 1.0 per second, 1:30 left");
}

TEST(ProgressText, HoursAreWrittenWhereThereAreSome) {
  EXPECT_EQ(progress_text({7300, 0, 100, seconds(100)}),
            "100 of 7300 frames, 1 %, 1.0 per second, 2:00:00 left");
}

TEST(ProgressText, SaysNothingOfWhatItCannotKnow) {
  EXPECT_EQ(progress_text({3, 0, 0, seconds(0)}), "0 of 3 frames, 0 %");
  EXPECT_EQ(progress_text({0, 0, 0, seconds(0)}), "0 of 0 frames, 100 %");
}

TEST(ProgressText, SaysWhatIsThereAtTheStartAndWhenInterrupted) {
  EXPECT_EQ(found_text(300, 40), "40 of 300 frames exist; 260 to render");
  EXPECT_EQ(interrupted_text({300, 40, 2, seconds(5)}),
            "interrupted: 42 of 300 frames exist; run the same command again to render the rest");
}

}  // namespace
}  // namespace sonard::server
