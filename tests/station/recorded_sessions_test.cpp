// Every session with a person in it has a recording from its first tick; the others leave none.
#include "record/recording.hpp"
#include "station/session_files.hpp"
#include "station/station_bench.hpp"
#include "support/seed.hpp"

#include <set>
#include <vector>

namespace wholehand::test {
namespace {

/// Tick counts of one session.
struct SessionTicks {
  std::uint64_t ticks = 0, by_person = 0;
};

class Demonstration : public Bar {
 protected:
  void begin() {
    StationConfig config = barConfig();
    config.rehearse = false;
    config.now = [this] { return Clock::now() + std::chrono::seconds(ahead_s_); };
    change(config);
    load(config);
    station_->addSink([this](const TickRecord& record) {
      while (late_ && record.moved_by == Mover::kPerson &&
             station_->status().run_state == RunState::kRendering) {
        waits_ = true;
        std::this_thread::sleep_for(1ms);
      }
      const std::lock_guard lock(seen_mutex_);
      if (record.tick == 0 || seen_.empty()) seen_.emplace_back();
      ++seen_.back().ticks;
      if (record.moved_by == Mover::kPerson) ++seen_.back().by_person;
    });
    run(true);
    ASSERT_TRUE(rendersOn());
  }
  virtual void change(StationConfig& /*config*/) {}

  OrderReply steer(Steering by) { return ask(orders::Steer{by}); }
  /// Takes the steering for a person as soon as the station accepts it.
  bool joins() {
    return becomes([this] { return steer(Steering::kPerson).accepted; });
  }
  /// Waits for a session newer than `since`, which the program begins without an order.
  bool isRenewed(std::uint32_t since) {
    return becomes([&] {
      const LoopStatus status = station_->status();
      return status.session > since && status.run_state == RunState::kRendering;
    });
  }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    std::error_code none;
    for (fs::directory_iterator it(folder_ + "/recordings", none), end; !none && it != end; ++it) {
      if (it->path().extension() == ".h5") names.push_back(it->path().string());
    }
    return names;
  }
  std::vector<SessionTicks> seen() {
    const std::lock_guard lock(seen_mutex_);
    return seen_;
  }
  /// Number of sessions with a person that have no recording of all their ticks. Call it after the
  /// end.
  int unrecorded() {
    std::multiset<std::uint64_t> recorded;
    for (const std::string& file : files()) {
      auto recording = RecordingReader::open(file);
      EXPECT_TRUE(recording) << file << format(recording.errors());
      if (!recording) continue;
      TickRecord first;
      EXPECT_TRUE((*recording)->read(0, first));
      EXPECT_EQ(first.tick, 0U) << "from its first tick: " << file;
      recorded.insert((*recording)->size());
    }
    int missing = 0;
    for (const SessionTicks& session : seen()) {
      if (session.by_person == 0) continue;
      const auto found = recorded.find(session.ticks);
      if (found == recorded.end()) {
        ++missing;
      } else {
        recorded.erase(found);
      }
    }
    return missing;
  }

  std::atomic<int> ahead_s_{0};
  /// If set, records of a person reach the sink only after their session ended, as on a slow
  /// machine.
  std::atomic<bool> late_{false};
  std::atomic<bool> waits_{false};
  std::mutex seen_mutex_;
  std::vector<SessionTicks> seen_;
};

TEST_F(Demonstration, SessionThatSomebodyJoins_IsRecordedFromItsFirstTick) {
  begin();
  EXPECT_NE(station_->scene()->recording, "") << "the screen says that it is recorded";
  ASSERT_TRUE(joins());
  ASSERT_TRUE(rendersOn());
  quit();
  EXPECT_EQ(files().size(), 1U);
  EXPECT_EQ(unrecorded(), 0);
}

TEST_F(Demonstration, SessionThatNobodyJoins_LeavesNoRecording) {
  begin();
  ASSERT_EQ(files().size(), 1U) << "it is recorded all the same";
  const StationOutcome& outcome = quit();
  EXPECT_TRUE(fs::is_empty(folder_ + "/recordings"));
  ASSERT_TRUE(outcome.last);
  EXPECT_EQ(outcome.last->record, "");
}

TEST_F(Demonstration, SessionThatNobodyJoins_IsRenewedEveryTenMinutes) {
  begin();
  const std::uint32_t endings = station_->status().endings;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t session = station_->status().session;
    ahead_s_ += 590;
    EXPECT_TRUE(rendersOn());
    EXPECT_EQ(station_->status().session, session) << kAlways << "not before its time";
    ahead_s_ += 11;
    ASSERT_TRUE(isRenewed(session));
    EXPECT_TRUE(rendersOn());
    // File names contain the second: a session that begins in the same second as the removed one
    // takes its name.
    const std::string recording = folder_ + "/recordings/" + station_->scene()->recording;
    EXPECT_EQ(files(), std::vector<std::string>{recording}) << "the recording of nobody is removed";
  }
  EXPECT_EQ(station_->status().endings, endings) << "no ending that a person must see";
  EXPECT_EQ(quit().sessions, 1U) << "nobody's sessions are not counted";
  EXPECT_TRUE(fs::is_empty(folder_ + "/recordings"));
}

TEST_F(Demonstration, SessionJoinedJustBeforeItsRenewal_IsNotRenewed) {
  begin();
  ahead_s_ += 599;
  ASSERT_TRUE(joins());
  const std::uint32_t session = station_->status().session;
  ahead_s_ += 3600;
  std::this_thread::sleep_for(300ms);
  EXPECT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().session, session) << kAlways;
  EXPECT_EQ(station_->status().steering, Steering::kPerson);
  quit();
  EXPECT_EQ(seen().size(), 1U);
  EXPECT_EQ(unrecorded(), 0);
}

// The person steers both the old session, which fades, and the new one, which is being built.
TEST_F(Demonstration, PersonJoiningDuringARenewal_SteersTheNextSessionAndBothAreRecorded) {
  begin();
  const std::uint32_t session = station_->status().session;
  ahead_s_ += 601;
  ASSERT_TRUE(becomes([this] { return station_->status().run_state != RunState::kRendering; }));
  ASSERT_TRUE(joins());
  ASSERT_TRUE(isRenewed(session));
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().steering, Steering::kPerson);
  quit();
  EXPECT_GT(seen().back().by_person, 0U);
  EXPECT_EQ(unrecorded(), 0);
}

TEST_F(Demonstration, SessionThatEverybodyLeft_IsRenewedAndKeepsItsRecording) {
  begin();
  ASSERT_TRUE(joins());
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(steer(Steering::kVirtualPatient).accepted);
  const std::uint32_t session = station_->status().session;
  ASSERT_TRUE(ask(orders::Unattended{}).accepted);
  ASSERT_TRUE(isRenewed(session));
  EXPECT_EQ(files().size(), 2U);
  EXPECT_EQ(quit().sessions, 2U);
  EXPECT_EQ(files().size(), 1U) << "the second one was nobody's";
  EXPECT_EQ(unrecorded(), 0);
}

// A late record of a person belongs to the session that ends, not to the next one.
TEST_F(Demonstration, LateRecordsOfAPersonWhoLeft_DoNotCountForTheNextSession) {
  begin();
  ASSERT_TRUE(joins());
  ASSERT_TRUE(rendersOn());
  late_ = true;
  ASSERT_TRUE(becomes([this] { return waits_.load(); }));
  std::this_thread::sleep_for(50ms);  // more records of the person queue up behind it
  ASSERT_TRUE(steer(Steering::kVirtualPatient).accepted);
  const std::uint32_t session = station_->status().session;
  ASSERT_TRUE(ask(orders::Unattended{}).accepted);
  ASSERT_TRUE(isRenewed(session));
  quit();
  EXPECT_EQ(files().size(), 1U) << "the second one was nobody's";
  EXPECT_EQ(unrecorded(), 0);
}

// The console took the controls; the person has sent no order yet.
TEST_F(Demonstration, ControlsTaken_KeepTheRecordingAndPreventTheRenewal) {
  begin();
  const std::uint32_t session = station_->status().session;
  ASSERT_TRUE(ask(orders::UnattendedEnds{}).accepted);
  ahead_s_ += 601;
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(station_->status().session, session) << kAlways;
  quit();
  EXPECT_EQ(files().size(), 1U);
}

// A client takes the controls while the old session ends and sends nothing; it belongs to the new
// session.
TEST_F(Demonstration, ControlsTakenDuringARenewal_KeepTheNextRecording) {
  begin();
  const std::uint32_t session = station_->status().session;
  ahead_s_ += 601;
  ASSERT_TRUE(becomes([this] { return station_->status().run_state != RunState::kRendering; }));
  ASSERT_TRUE(ask(orders::UnattendedEnds{}).accepted);
  ASSERT_TRUE(isRenewed(session));
  ahead_s_ += 601;
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(station_->status().session, session + 1) << kAlways << "it is somebody's";
  quit();
  EXPECT_GE(files().size(), 1U);
}

TEST_F(Demonstration, StopDuringARenewal_StaysStopped) {
  begin();
  ahead_s_ += 601;
  ASSERT_TRUE(becomes([this] { return station_->status().run_state != RunState::kRendering; }));
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  std::this_thread::sleep_for(1500ms);
  const RunState now = station_->status().run_state;
  if (now == RunState::kStopping) EXPECT_TRUE(becomes(RunState::kStopped));
  EXPECT_NE(station_->status().run_state, RunState::kRendering) << kAlways;
  EXPECT_EQ(files().size(), 1U) << "somebody was there";
}

// The program continues without a disk and notifies clients.
class WithoutAFolder : public Demonstration {
  void change(StationConfig& config) override {
    std::ofstream(folder_ + "/recordings") << "a file where the folder should be";
    config.recordings_folder = folder_ + "/recordings";
  }
};
TEST_F(WithoutAFolder, Demonstration_RunsAndReportsThatNothingIsRecorded) {
  begin();
  EXPECT_TRUE(logContains("what follows is not recorded: " + folder_ + "/recordings: "));
  EXPECT_EQ(station_->scene()->recording, "");
  EXPECT_EQ(station_->status().recording_bytes, 0U);
  EXPECT_TRUE(joins());
}

// A cached report of an earlier recording with the same name must not be shown.
TEST_F(Demonstration, RecordingWithAReusedName_GetsItsOwnReport) {
  StationConfig config = barConfig();
  int made = 0;
  config.make_report = [&made](const std::string& recording, const std::string& folder) {
    ++made;
    fs::create_directories(folder);
    fs::copy_file(recording, folder + "/index.html", fs::copy_options::overwrite_existing);
    return Expected<Done>(Done{});
  };
  load(config);
  fs::create_directories(folder_ + "/recordings");
  const std::string path = folder_ + "/recordings/a.h5";
  std::string why;
  const auto report = [&] {
    std::ifstream in(station_->reportFolder("a.h5", why) + "/index.html");
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  std::ofstream(path) << "first";
  EXPECT_EQ(report(), "first") << why;
  EXPECT_EQ(report(), "first");
  EXPECT_EQ(made, 1) << "made once";
  const auto time = fs::last_write_time(path);
  std::ofstream(folder_ + "/recordings/b") << "other";  // the same size and the same time
  fs::last_write_time(folder_ + "/recordings/b", time);
  fs::rename(folder_ + "/recordings/b", path);
  EXPECT_EQ(report(), "other") << why;
  EXPECT_EQ(made, 2);
}

// Joins, loads, stops, arms and the passing of time are random. In half of the scripts only time
// passes at first, so that the program renews the session.
TEST_F(Demonstration, RandomScripts_LeaveNoSessionOfAPersonUnrecorded) {
  auto random = seededRandom(3501);
  const int scripts = fullCounts() ? 20 : 4;
  for (int script = 0; script < scripts; ++script) {
    ahead_s_ = 0;
    begin();
    if (script == 0) EXPECT_TRUE(joins() && rendersOn()) << "one script has a person in any case";
    const int alone = script % 2 == 0 ? 0 : 3 + static_cast<int>(random() % 3);
    for (int step = 0; step < 8; ++step) {
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 600));
      if (step < alone) {
        ahead_s_ += 350;
        continue;
      }
      switch (random() % 8) {
        case 0:
        case 1:
          (void)steer(Steering::kPerson);  // refused if nothing is armed
          break;
        case 2:
          (void)steer(Steering::kVirtualPatient);
          break;
        case 3:
          (void)ask(orders::Unattended{});
          break;
        case 4:
          (void)ask(orders::LoadExercise{.level = 1 + static_cast<int>(random() % 2)});
          break;
        case 5:
          (void)ask(kStops[random() % 2]);
          break;
        default:
          ahead_s_ += 350;
      }
      if (random() % 3 == 0) (void)ask(orders::Arm{});
    }
    quit();
  }
  int persons = 0;
  for (const SessionTicks& session : seen()) persons += session.by_person > 0 ? 1 : 0;
  const int missing = unrecorded();
  std::printf("figure: of %zu sessions a person was in %d; without recording: %d\n", seen().size(),
              persons, missing);
  EXPECT_GT(persons, 0);
  EXPECT_EQ(missing, 0);
}

}  // namespace
}  // namespace wholehand::test
