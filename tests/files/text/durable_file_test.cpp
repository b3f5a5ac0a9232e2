// A file that survives a power cut: what is synced, and in which order.
#include "files/text/text_file.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstdio>
#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace {
/// Operations requested from the disk, in order; null: not recorded.
std::vector<std::string>* asked = nullptr;  // NOLINT
int sync_error = 0;                         // NOLINT: error of syncing a file

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

std::string nameOf(int fd) {
  char name[4096];
  const ssize_t length =
      ::readlink(("/proc/self/fd/" + std::to_string(fd)).c_str(), name, sizeof name);
  return length < 0 ? "" : std::string(name, static_cast<std::size_t>(length));
}
}  // namespace

// A program's symbols are found before those of the C library.
extern "C" int fsync(int fd) {
  static const auto kReal = real<int (*)(int)>("fsync");
  if (asked != nullptr) {
    struct stat about {};
    (void)::fstat(fd, &about);
    const bool folder = S_ISDIR(about.st_mode);
    asked->push_back(folder ? "sync folder " + nameOf(fd)
                            : "sync file of " + std::to_string(about.st_size));
    if (!folder && sync_error != 0) return errno = sync_error, -1;
  }
  return kReal(fd);
}
extern "C" int rename(const char* from, const char* to) {
  static const auto kReal = real<int (*)(const char*, const char*)>("rename");
  if (asked != nullptr) asked->push_back("rename to " + std::string(to));
  return kReal(from, to);
}

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Records disk operations during its lifetime.
struct Listening {
  explicit Listening(int error = 0) {
    sync_error = error;
    asked = &said;
  }
  ~Listening() { asked = nullptr; }
  std::vector<std::string> said;
};

class DurableFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directory(place); }
  [[nodiscard]] long files() const {
    return std::distance(fs::directory_iterator(place), fs::directory_iterator());
  }
  Folder folder;
  const std::string place = fs::canonical(folder.path()).string() + "/new";
  const std::string path = place + "/limits.toml";
};

// A rename may reach the disk before the bytes of its file, and an entry of a folder before the
// folder.
TEST_F(DurableFile, WrittenFile_IsSyncedBeforeItsRenameAndItsFoldersAfter) {
  ASSERT_EQ(writeDurably(path, "effort_limit = 20"), 0);
  Listening disk;
  ASSERT_EQ(writeDurably(path, "effort_limit = 4"), 0);
  const std::vector<std::string> expected = {
      "sync file of 16", "rename to " + path, "sync folder " + place,
      "sync folder " + fs::path(place).parent_path().string()};
  EXPECT_EQ(disk.said, expected);
  EXPECT_EQ(contents(path), "effort_limit = 4");
  EXPECT_EQ(files(), 1);
}

TEST_F(DurableFile, NewName_IsTakenOnlyOnce) {
  std::string first, second, third;
  ASSERT_EQ(takeNewName(place + "/run", ".h5", first), 0);
  fs::create_symlink(place + "/nowhere", place + "/run-2.h5");
  ASSERT_EQ(takeNewName(place + "/run", ".h5", second), 0);
  EXPECT_EQ(first, place + "/run.h5");
  EXPECT_EQ(second, place + "/run-3.h5") << "a link is a name that is taken";
  EXPECT_FALSE(fs::exists(place + "/nowhere"));
  EXPECT_EQ(takeNewName(place + "/missing/run", ".h5", third), ENOENT);
  EXPECT_NE(randomName(), randomName());
}

TEST_F(DurableFile, FileWrittenByAnother_IsSyncedBeforeItsRename) {
  std::ofstream(place + "/part") << "12345";
  Listening disk;
  ASSERT_EQ(renameDurably(place + "/part", path), 0);
  ASSERT_EQ(disk.said.size(), 4U);
  EXPECT_EQ(disk.said[0], "sync file of 5");
  EXPECT_EQ(disk.said[1], "rename to " + path);
  EXPECT_EQ(contents(path), "12345");
}

TEST_F(DurableFile, FileThatCannotBeSynced_KeepsTheOldOneAndReportsTheError) {
  ASSERT_EQ(writeDurably(path, "old"), 0);
  for (const int error : {EIO, ENOSPC, EDQUOT}) {
    const Listening disk(error);
    EXPECT_EQ(writeDurably(path, "new"), error);
  }
  EXPECT_EQ(contents(path), "old");
  EXPECT_EQ(files(), 1);
  EXPECT_EQ(writeDurably(place + "/no/folder", "new"), ENOENT);
}

TEST_F(DurableFile, FileInPlaceOfALink_KeepsTheLinksTarget) {
  std::ofstream(place + "/other") << "other's";
  fs::create_symlink(place + "/other", path);
  ASSERT_EQ(writeDurably(path, "mine"), 0);
  EXPECT_EQ(contents(place + "/other"), "other's");
  EXPECT_FALSE(fs::is_symlink(path));
  EXPECT_EQ(contents(path), "mine");
}

}  // namespace
}  // namespace wholehand::test
