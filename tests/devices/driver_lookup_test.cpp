#include "devices/plugin/plugin_driver.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

class DriverLookup : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_.path();
    for (const char* file :
         {"beside/frame.so", "beside/notes.txt", "installed/frame.so", "installed/moteus.so"}) {
      fs::create_directories((folder_ / file).parent_path());
      std::ofstream(folder_ / file) << "x";
    }
    folders_ = {(folder_ / "beside").string(), (folder_ / "none").string(),
                (folder_ / "installed").string()};
  }

  Folder temporary_;
  fs::path folder_;
  std::vector<std::string> folders_;
};

TEST_F(DriverLookup, Name_IsFoundInTheFirstFolderThatHasIt) {
  EXPECT_EQ(orThrow(findDriver("frame", folders_)), (folder_ / "beside/frame.so").string());
  EXPECT_EQ(orThrow(findDriver("moteus", folders_)), (folder_ / "installed/moteus.so").string());
}

TEST_F(DriverLookup, PathOrFile_IsUsedUnchanged) {
  EXPECT_EQ(orThrow(findDriver("/a/b", folders_)), "/a/b");
  EXPECT_EQ(orThrow(findDriver("./frame", folders_)), "./frame");
  EXPECT_EQ(orThrow(findDriver("frame.so", folders_)), "./frame.so")
      << "in the working directory, not where libraries of the system are";
}

TEST_F(DriverLookup, UnknownName_IsRefusedWithTheExistingNames) {
  const auto path = findDriver("fram", folders_);
  ASSERT_FALSE(path);
  const std::string said = format(path.errors());
  EXPECT_TRUE(contains(said, "--driver = fram: is no driver"));
  EXPECT_TRUE(contains(said, "give one of frame, moteus, or the path"));
  EXPECT_FALSE(findDriver("", folders_));
  EXPECT_FALSE(findDriver("notes", folders_));
}

TEST_F(DriverLookup, NoFolders_AreReported) {
  const auto path = findDriver("frame", {});
  EXPECT_TRUE(refusedWith(path, "none ship"));
}

}  // namespace
}  // namespace wholehand::test
