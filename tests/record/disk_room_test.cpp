#include "record/disk_reserve.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wholehand {
namespace {

// 300 bytes per tick and 4 MB in addition: 31 MB are 90,000 ticks, 90 s at 1 kHz.
TEST(RoomForRecording, LessThanTheRunNeeds_IsReportedWithItsDuration) {
  EXPECT_EQ(roomSentence("out/a.h5", 31'000'000, 1e-3, 91.0),
            "the disk has room for about 90 s of recording (31 MB free): out/a.h5");
  EXPECT_EQ(roomSentence("out/a.h5", 31'000'000, 1e-3, 89.0), "");
  EXPECT_EQ(roomSentence("out/a.h5", 31'000'000, 0.5e-3, 89.0),
            "the disk has room for about 45 s of recording (31 MB free): out/a.h5");
}

TEST(RoomForRecording, RunWithoutEnd_IsReportedBelowHalfAnHour) {
  EXPECT_EQ(roomSentence("a.h5", 543'000'000, 1e-3, 0.0),
            "the disk has room for about 30 min of recording (543 MB free): a.h5");
  EXPECT_EQ(roomSentence("a.h5", 545'000'000, 1e-3, 0.0), "");
  EXPECT_EQ(roomSentence("a.h5", 0, 1e-3, 0.0),
            "the disk has room for about 0 s of recording (0 MB free): a.h5");
}

TEST(RoomForRecording, FolderNotYetCreated_UsesTheDiskItWillBeOn) {
  const test::Folder folder;
  const std::string path = folder.file("new/deep/a.h5");
  EXPECT_TRUE(test::contains(roomNotice(path, 1e-3, 1e15), "MB free): " + path));
  EXPECT_EQ(roomNotice("/proc/1/a.h5", 1e-3, 1e-9), "");
}

}  // namespace
}  // namespace wholehand
