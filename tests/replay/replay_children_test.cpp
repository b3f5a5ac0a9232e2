// Small shell scripts replace the processes that read recordings. Each is called as `program replay
// RECORDING --answer`. tests/apps tests the real program.
#include "replay/replay_children.hpp"

#include "support/contains.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <thread>
#include <vector>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Script that answers each request with its process id in eight characters, after the answer's
/// header (src/replay/replay_children.hpp): "WRA1", status 200, JSON, eight bytes.
constexpr const char* kSaysItsId =
    "while read -r words; do echo \"$$ $2 $words\" >> \"$(dirname \"$0\")/asked\"\n"
    "printf 'WRA1\\310\\000\\001\\000\\010\\000\\000\\000\\000\\000\\000\\000%8d' $$; done";

struct ReplayChildrenTest : testing::Test {
  ReplayChildren::Options playing(const std::string& text) const {
    std::string path = folder.path() + "/program";
    std::ofstream(path) << "#!/bin/sh\n" << text << "\n";
    fs::permissions(path, fs::perms::owner_all);
    return {.program = path};
  }
  std::string recording(const std::string& name) const {
    std::ofstream(folder.file(name)) << "recording";
    return folder.file(name);
  }
  std::string asked() const {
    std::stringstream text;
    text << std::ifstream(folder.file("asked")).rdbuf();
    return text.str();
  }
  const Folder folder;
};

constexpr const char* kState = "states?tick=0&count=1&step=1";
constexpr const char* kSeries = "series?from_s=0&to_s=1&columns=1";

TEST_F(ReplayChildrenTest, OneRecording_HasOneProcessForStatesAndOneForPlots) {
  ReplayChildren children(playing(kSaysItsId));
  const std::string path = recording("a.h5");
  const ReplayAnswer first = children.answer(path, "about");
  EXPECT_EQ(first.status, 200);
  EXPECT_EQ(first.content_type, "application/json");
  EXPECT_EQ(first.body.size(), 8U);
  EXPECT_EQ(children.answer(path, kState).body, first.body);
  EXPECT_EQ(children.answer(path, "scene").body, first.body);
  const std::string plots = children.answer(path, kSeries).body;
  EXPECT_NE(plots, first.body) << "a state waits for no plot";
  EXPECT_EQ(children.answer(path, kSeries).body, plots);
  EXPECT_NE(asked().find(path + " " + kState), std::string::npos) << asked();
}

TEST_F(ReplayChildrenTest, TokenInTheQuery_IsNotPassedOn) {
  ReplayChildren children(playing(kSaysItsId));
  (void)children.answer(recording("a.h5"), "states?tick=0&count=1&step=1&token=0123456789abcdef");
  EXPECT_EQ(asked().find("token"), std::string::npos) << asked();
}

TEST_F(ReplayChildrenTest, ProcessesBeyondTheLimit_EndTheOneAskedLongestAgo) {
  auto options = playing(kSaysItsId);
  options.most = 2;
  ReplayChildren children(options);
  const std::string a = recording("a.h5"), b = recording("b.h5"), c = recording("c.h5");
  const std::string of_a = children.answer(a, kState).body;
  const std::string of_b = children.answer(b, kState).body;
  EXPECT_EQ(children.answer(a, kState).body, of_a);
  (void)children.answer(c, kState);  // ends the process of b
  EXPECT_EQ(children.answer(a, kState).body, of_a);
  EXPECT_NE(children.answer(b, kState).body, of_b);
}

TEST_F(ReplayChildrenTest, ManyRequestsAtOnce_AreAllAnswered) {
  auto options = playing(kSaysItsId);
  options.most = 2;  // processes are ended while others ask
  ReplayChildren children(options);
  const std::string paths[] = {recording("a.h5"), recording("b.h5"), recording("c.h5")};
  std::vector<std::thread> pages;
  std::atomic<int> answered{0};
  for (int page = 0; page < 4; ++page) {
    pages.emplace_back([&, page] {
      for (int i = 0; i < 10; ++i) {
        const ReplayAnswer answer =
            children.answer(paths[(page + i) % 3], i % 4 == 0 ? kSeries : kState);
        if (answer.status == 200 && answer.body.size() == 8U) ++answered;
      }
    });
  }
  for (std::thread& page : pages) page.join();
  EXPECT_EQ(answered, 40);
}

TEST_F(ReplayChildrenTest, ChangedFile_IsReadAgainAtTheNextAbout) {
  ReplayChildren children(playing(kSaysItsId));
  const std::string path = recording("a.h5");
  const std::string before = children.answer(path, "about").body;
  EXPECT_EQ(children.answer(path, "about").body, before);
  std::ofstream(path, std::ios::app) << "more";
  EXPECT_EQ(children.answer(path, kState).body, before) << "what is looked at stays as it was";
  const std::string after = children.answer(path, "about").body;
  EXPECT_NE(after, before);
  EXPECT_EQ(children.answer(path, kState).body, after);
}

TEST_F(ReplayChildrenTest, CrashOfTheReader_IsReportedAndTheNextRequestStartsANewOne) {
  ReplayChildren children(playing("read -r words; kill -SEGV $$"));
  for (int i = 0; i < 2; ++i) {
    const ReplayAnswer answer = children.answer(recording("a.h5"), "about");
    EXPECT_EQ(answer.status, 422);
    EXPECT_TRUE(contains(answer.body, "a.h5: is damaged: it ended the program that read it"));
  }
}

TEST_F(ReplayChildrenTest, MalformedAnswerOfTheReader_IsAnError) {
  for (const char* text : {"read -r words; kill -TERM $$",  // ended from outside
                           "exit 0", "read -r words; echo hello, this is no answer at all",
                           "read -r words; printf WRA1"}) {
    ReplayChildren children(playing(text));
    const ReplayAnswer answer = children.answer(recording("a.h5"), "about");
    EXPECT_EQ(answer.status, 503) << text;
    EXPECT_TRUE(contains(answer.body, "error")) << text;
  }
}

TEST_F(ReplayChildrenTest, HangingReader_IsEnded) {
  auto options = playing("read -r words; exec sleep 600");
  options.patience = 300ms;
  ReplayChildren children(options);
  const ReplayAnswer answer = children.answer(recording("a.h5"), "about");
  EXPECT_EQ(answer.status, 503);
  EXPECT_TRUE(contains(answer.body, "in time"));
}

TEST_F(ReplayChildrenTest, EndOfTheProgram_EndsWaitingRequests) {
  ReplayChildren children(playing("touch \"$(dirname \"$0\")/begun\"; exec sleep 600"));
  const std::string path = recording("a.h5");
  auto waiting = std::async(std::launch::async, [&] { return children.answer(path, "about"); });
  while (!fs::exists(folder.file("begun"))) std::this_thread::sleep_for(1ms);
  children.end();
  EXPECT_EQ(waiting.get().status, 503);
  EXPECT_EQ(children.answer(path, "about").status, 503);
}

TEST_F(ReplayChildrenTest, BadRequests_StartNoProcess) {
  ReplayChildren children(playing(kSaysItsId));
  const std::string path = recording("a.h5");
  EXPECT_EQ(children.answer(path, "series?from_s=0&to_s=3600&columns=9").status, 400);
  EXPECT_EQ(children.answer(path, "everything").status, 404);
  EXPECT_EQ(asked(), "");
}

TEST_F(ReplayChildrenTest, ReadersWhileALoopRuns_HaveTheProgramsPriority) {
  ReplayChildren children(
      playing("sleep 0.3; nice > \"$(dirname \"$0\")/asked\"; " + std::string(kSaysItsId)));
  (void)children.answer(recording("a.h5"), "about");
  const std::string own = std::to_string(::getpriority(PRIO_PROCESS, 0)) + "\n";
  EXPECT_EQ(asked().substr(0, own.size()), own) << "somebody waits for what they read";
}

}  // namespace
}  // namespace wholehand::test
