// Small shell scripts replace the process that makes reports. It is called as `program report
// RECORDING --out FOLDER`.
#include "station/reports.hpp"
#include "support/folder.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <sys/resource.h>
#include <thread>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct ReportChildTest : testing::Test {
  std::string script(const std::string& text) const {
    std::string path = folder.path() + "/program";
    std::ofstream(path) << "#!/bin/sh\n" << text << "\n";
    fs::permissions(path, fs::perms::owner_all);
    return path;
  }
  std::string read(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(folder.path() + "/" + name).rdbuf();
    return text.str();
  }
  const Folder folder;
};

TEST_F(ReportChildTest, Report_RunsWithLowDiskPriorityAndReportsItsOutcome) {
  ReportChild reports(
      script("sleep 0.3; ionice > \"$4/disk\"; nice > \"$4/nice\"; echo $1 $2 > \"$4/words\""));
  const auto made = reports.make("a.h5", folder.path());
  ASSERT_TRUE(made) << format(made.errors());
  EXPECT_EQ(read("disk"), "idle\n");
  // A user waits for the report: with nice 19, a machine with eight busy programs delays it for
  // minutes.
  EXPECT_EQ(read("nice"), std::to_string(::getpriority(PRIO_PROCESS, 0)) + "\n");
  EXPECT_EQ(read("words"), "report a.h5\n");
  ReportChild fails(script("exit 2"));
  EXPECT_FALSE(fails.make("a.h5", folder.path()));
  ReportChild not_whole(script("exit 1"));  // exit code 1: the report is made but incomplete
  EXPECT_TRUE(not_whole.make("a.h5", folder.path()));
}

TEST_F(ReportChildTest, ReportThatTakesTooLong_IsEnded) {
  seesRealTime();
  std::string id;
  // On a busy machine a child of the lowest priority may not even start within its time.
  for (auto longest = 700ms; id.empty() && longest < 60s; longest *= 4) {
    ReportChild reports(script("echo $$ > \"$4/id\"; exec sleep 120"), longest);
    const auto began = Clock::now();
    const auto made = reports.make("a.h5", folder.path());
    EXPECT_LT(Clock::now() - began, longest + 30s);
    ASSERT_FALSE(made);
    EXPECT_NE(format(made.errors()).find("in time"), std::string::npos);
    id = read("id");
  }
  ASSERT_FALSE(id.empty());
  id.pop_back();
  EXPECT_FALSE(fs::exists("/proc/" + id)) << "it is gone, and nobody has to wait for it";
}

TEST_F(ReportChildTest, ReportRunningAtTheProgramsEnd_IsEndedAndNoOtherBegins) {
  ReportChild reports(script("exec sleep 60"));
  const auto began = Clock::now();
  std::thread ending([&] {
    std::this_thread::sleep_for(200ms);
    reports.end();
  });
  EXPECT_FALSE(reports.make("a.h5", folder.path()));
  ending.join();
  EXPECT_FALSE(reports.make("a.h5", folder.path()));
  EXPECT_LT(Clock::now() - began, 30s);
}

}  // namespace
}  // namespace wholehand::test
