#include "loop/core/printable.hpp"
#include "station/session_files.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using test::Folder;

TEST(FileNamePart, CharactersThatAFileSystemRefuses_BecomeHyphens) {
  EXPECT_EQ(fileNamePart("p-014"), "p-014");
  EXPECT_EQ(fileNamePart("../../etc/passwd"), "etc-passwd");
  EXPECT_EQ(fileNamePart(R"(a\b:c*d?e"f<g>h|i j.k)"), "a-b-c-d-e-f-g-h-i-j-k");
  EXPECT_EQ(fileNamePart("con."), "con");
  EXPECT_EQ(fileNamePart(""), "");
  EXPECT_EQ(fileNamePart("///..."), "");
}

TEST(FileNamePart, LettersOfAnyScript_AreKept) {
  EXPECT_EQ(fileNamePart("Übung für Zoé"), "Übung-für-Zoé");
  EXPECT_EQ(fileNamePart("تمرين اليد"), "تمرين-اليد");
  // A mark that changes the writing direction and bytes that are not UTF-8 are replaced.
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
  const std::string name = fs::path(*files.nameNew("p-014", "cocktail-bar", 2)).filename().string();
  EXPECT_EQ(name.substr(15), "-p-014-cocktail-bar-level-2.h5") << name;
  EXPECT_EQ(name.find_first_not_of("0123456789-"), 16U) << name;
  const std::string nobody = fs::path(*files.nameNew("", "", 1)).filename().string();
  EXPECT_EQ(nobody.substr(15), "-scene-level-1.h5") << nobody;
}

// The names must be unique in any second, even if the clock is set meanwhile.
TEST(SessionFiles, TakenNames_AreNotGivenAgain) {
  const Folder folder;
  auto time = std::chrono::system_clock::now();
  const SessionFiles files(folder.path(), [&time] { return time; });
  const std::string long_name(10'000, 'a');
  std::set<std::string> given;
  for (int i = 0; i < 40; ++i) {
    time += i % 4 == 3 ? std::chrono::seconds(-2) : std::chrono::seconds(i % 2);
    const auto path = files.nameNew(long_name, long_name, 1);
    ASSERT_TRUE(path) << format(path.errors());
    EXPECT_TRUE(given.insert(*path).second) << *path;
    EXPECT_LT(fs::path(*path).filename().string().size(), 200U);  // with ".part", below 255
    EXPECT_EQ(fs::file_size(*path), 0U);
  }
  EXPECT_TRUE(files.list("").empty()) << "a taken name is no recording yet";
  for (const std::string& path : given) std::ofstream(path) << "recorded";
  EXPECT_EQ(files.list("").size(), 40U);
  for (const std::string& path : given) files.giveBack(path);
  EXPECT_EQ(files.list("").size(), 40U) << "what was recorded is not given back";
}

// Eight processes ask for names at the same moment, like programs that are started together.
TEST(SessionFiles, EightProgramsAtOnce_GetDifferentNames) {
  constexpr int kPrograms = 8, kNames = 25;
  const Folder folder;
  const auto time = std::chrono::system_clock::now();  // the same for all processes
  std::array<int, 2> gate{}, names{};
  ASSERT_EQ(::pipe(gate.data()), 0);
  ASSERT_EQ(::pipe(names.data()), 0);
  for (int i = 0; i < kPrograms; ++i) {
    if (::fork() != 0) continue;
    ::close(gate[1]);
    char begin = 0;
    (void)!::read(gate[0], &begin, 1);  // blocks until the parent closes the pipe
    const SessionFiles files(folder.path() + "/recordings", [time] { return time; });
    for (int n = 0; n < kNames; ++n) {
      const auto path = files.nameNew("", "bar", 1);
      const std::string line = (path ? *path : "refused") + "\n";
      (void)!::write(names[1], line.data(), line.size());
    }
    ::_exit(0);
  }
  ::close(gate[0]);
  ::close(gate[1]);
  ::close(names[1]);
  std::string all;
  std::array<char, 4096> piece{};
  for (ssize_t n = 0; (n = ::read(names[0], piece.data(), piece.size())) > 0;) {
    all.append(piece.data(), static_cast<std::size_t>(n));
  }
  ::close(names[0]);
  for (int i = 0; i < kPrograms; ++i) ::wait(nullptr);
  std::set<std::string> different;
  std::istringstream lines(all);
  for (std::string line; std::getline(lines, line);) different.insert(line);
  EXPECT_EQ(different.count("refused"), 0U);
  EXPECT_EQ(different.size(), std::size_t{kPrograms * kNames});
}

// Two cases: a file in place of the folder, and a missing folder that cannot be created.
TEST(SessionFiles, UnwritableFolder_IsNamedInTheError) {
  const Folder folder;
  std::ofstream(folder.path() + "/file") << "in the way";
  for (const char* name : {"/file", "/file/recordings"}) {
    const SessionFiles files(folder.path() + name);
    const auto path = files.nameNew("", "", 1);
    ASSERT_FALSE(path);
    EXPECT_NE(format(path.errors()).find(folder.path() + name), std::string::npos);
    EXPECT_NE(format(path.errors()).find("takes no new recording"), std::string::npos);
  }
}

// An existing link or pipe counts as a taken name; nothing is written through it.
TEST(SessionFiles, LinkOfTheSameName_IsNotFollowed) {
  const Folder folder;
  const auto time = std::chrono::system_clock::now();
  const SessionFiles files(folder.path(), [time] { return time; });
  const std::string first = *files.nameNew("", "", 1);
  fs::remove(first);
  const std::string target = folder.path() + "/elsewhere.h5";
  fs::create_symlink(target, first);
  const auto second = files.nameNew("", "", 1);
  ASSERT_TRUE(second);
  EXPECT_NE(*second, first);
  EXPECT_FALSE(fs::exists(target));
}

// The option --record names a file in another folder.
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
  // A file in the recordings folder takes precedence over one elsewhere.
  std::ofstream(folder.path() + "/mine.h5") << "older";
  EXPECT_EQ(files.path("mine.h5", mine), folder.path() + "/mine.h5");
  EXPECT_EQ(files.list(mine).size(), 2U);
  EXPECT_TRUE(files.list(kept).back().being_written || files.list(kept).front().being_written);
}

}  // namespace
}  // namespace wholehand
