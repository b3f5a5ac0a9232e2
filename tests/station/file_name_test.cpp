#include "station/file_name.hpp"

#include "core/printable.hpp"
#include "station/session_files.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using test::Folder;

TEST(FileNamePart, WhatSomeFileSystemRefuses_BecomesAHyphen) {
  EXPECT_EQ(fileNamePart("p-014"), "p-014");
  EXPECT_EQ(fileNamePart("../../etc/passwd"), "etc-passwd");
  EXPECT_EQ(fileNamePart(R"(a\b:c*d?e"f<g>h|i j.k)"), "a-b-c-d-e-f-g-h-i-j-k");
  EXPECT_EQ(fileNamePart("con."), "con");
  EXPECT_EQ(fileNamePart(""), "");
  EXPECT_EQ(fileNamePart("///..."), "");
}

TEST(FileNamePart, LettersOfAnyScript_Stay) {
  EXPECT_EQ(fileNamePart("Übung für Zoé"), "Übung-für-Zoé");
  EXPECT_EQ(fileNamePart("تمرين اليد"), "تمرين-اليد");
  // A mark that turns the direction of writing, and bytes that are no UTF-8, do not.
  EXPECT_EQ(fileNamePart("a\u202Eb\xFF"), "a-u-202e-b-xff");
}

TEST(FileNamePart, LongNames_AreCutBetweenCharacters) {
  EXPECT_EQ(fileNamePart(std::string(10'000, 'a')), std::string(60, 'a'));
  std::string arabic;
  while (arabic.size() < 10'000) arabic += "ت";  // two bytes
  const std::string cut = fileNamePart("x" + arabic);
  EXPECT_EQ(cut.size(), 59U);  // 1 + 29 · 2
  EXPECT_TRUE(isPrintable(cut));
}

TEST(SessionFiles, Name_SaysTimePersonExerciseAndLevel) {
  const Folder folder;
  const SessionFiles files(folder.path());
  const std::string name = fs::path(files.nameNew("p-014", "cocktail-bar", 2)).filename().string();
  EXPECT_EQ(name.substr(15), "-p-014-cocktail-bar-level-2.h5") << name;
  EXPECT_EQ(name.find_first_not_of("0123456789-"), 16U) << name;
  const std::string nobody = fs::path(files.nameNew("", "", 1)).filename().string();
  EXPECT_EQ(nobody.substr(15), "-scene-level-1.h5") << nobody;
}

// Whatever second it is: the first name is taken until the clock has moved on.
TEST(SessionFiles, NamesThatAreTaken_AreNotGivenAgain) {
  const Folder folder;
  const SessionFiles files(folder.path());
  const std::string long_name(10'000, 'a');
  for (int i = 0; i < 20; ++i) {
    const std::string path = files.nameNew(long_name, long_name, 1);
    ASSERT_FALSE(fs::exists(path)) << path;
    EXPECT_LT(fs::path(path).filename().string().size(), 200U);  // with ".part", below 255
    std::ofstream(path) << "taken";
    ASSERT_TRUE(fs::exists(path));
  }
  EXPECT_EQ(files.list("").size(), 20U);
}

// Asked for by --record: in a folder of its own.
TEST(SessionFiles, RecordingElsewhere_IsListedAndFoundWhileItIsWritten) {
  const Folder folder, other;
  const SessionFiles files(folder.path());
  const std::string kept = folder.path() + "/kept.h5", mine = other.path() + "/mine.h5";
  std::ofstream(kept) << "kept";
  std::ofstream(mine) << "mine!";
  const auto listed = files.list(mine);
  ASSERT_EQ(listed.size(), 2U);
  EXPECT_EQ(listed[0].name, "mine.h5");
  EXPECT_TRUE(listed[0].being_written);
  EXPECT_EQ(listed[0].bytes, 5U);
  EXPECT_FALSE(listed[1].being_written);
  EXPECT_EQ(files.path("mine.h5", mine), mine);
  EXPECT_EQ(files.path("mine.h5", ""), "") << "of what is over";
  EXPECT_EQ(files.path("../mine.h5", mine), "");
  EXPECT_EQ(files.path("kept.h5", mine), kept);
  // The one in the folder has the name.
  std::ofstream(folder.path() + "/mine.h5") << "older";
  EXPECT_EQ(files.path("mine.h5", mine), folder.path() + "/mine.h5");
  EXPECT_EQ(files.list(mine).size(), 2U);
  EXPECT_TRUE(files.list(kept).back().being_written || files.list(kept).front().being_written);
}

}  // namespace
}  // namespace wholehand
