#include "clinic/backup.hpp"
#include "clinic_bench.hpp"
#include "support/seed.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <tuple>

namespace wholehand::clinic {
namespace {
namespace fs = std::filesystem;

constexpr std::int64_t kHour_us = 3600 * kSecond_us;

std::size_t backupsOf(const Bench& b) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(b.options.backups)) {
    if (entry.path().extension() == ".db") ++count;
  }
  return count;
}

/// Ten backups that the clock after a jump of years takes for old ones.
void makeBackups(Bench& b) {
  for (int i = 0; i < 10; ++i) {
    const std::string path = b.options.backups + fmt::format("/clinic-{}.db", i);
    ASSERT_TRUE(backUp(b.options.folder, path, b.clock.now).ok());
    const timespec when{b.clock.now / kSecond_us - i * 86'400, 0}, times[2] = {when, when};
    ASSERT_EQ(::utimensat(AT_FDCWD, path.c_str(), times, 0), 0);
  }
}

enum class At { kNothingOpen, kOpenVisit, kUnfinishedVisit, kHidden };

class Clocks : public testing::TestWithParam<std::tuple<std::int64_t, At, bool>> {};

TEST_P(Clocks, Jump_LosesAndDoublesNothing) {
  const auto [jump_us, at, restarts] = GetParam();
  const auto index = static_cast<std::size_t>(at) * 2 + static_cast<std::size_t>(restarts) +
                     static_cast<std::size_t>(jump_us / kHour_us + 30'000) * 3;
  if (test::leftOutUnderASanitizer(index)) return;
  Bench b;
  const std::int64_t id = b.addPatient("P-001");
  std::int64_t visit = at == At::kNothingOpen ? 0 : b.beginVisit(id);
  const auto orders = b.station.orders.size();
  if (at == At::kUnfinishedVisit) {
    b.post(fmt::format("/api/visits/{}/finish", visit), {{"state", "unfinished"}});
  }
  makeBackups(b);
  const std::string notes = visit == 0 ? fmt::format("/api/patients/{}/notes", id)
                                       : fmt::format("/api/visits/{}/notes", visit);
  if (at == At::kHidden) b.post("/api/hide");
  const Json note = {{"text", "cue given"}, {"at_us", b.clock.now}};
  const Json said = b.ask("POST", notes, note, "page-1");
  ASSERT_EQ(b.status, 200) << said;
  b.clock.now += jump_us;
  if (restarts) b.restart(at != At::kHidden);
  if (restarts && at == At::kHidden) {
    b.restart();
  }
  // Something else is written, so that what is old would be deleted; then the page asks again.
  b.post(at == At::kHidden ? "/api/show" : "/api/restored/done", {{"pin", "1234"}});
  for (int i = 0; i < 3; ++i) {
    b.clock.pass(kSecond_us);
    b.clinic->lookAtStation();
    b.clinic->backUpIfDue();
  }
  EXPECT_EQ(b.ask("POST", notes, note, "page-1"), said);
  const Json patient = b.get(fmt::format("/api/patients/{}", id));
  const Json& owner = visit == 0 ? patient : patient["visits"][0];
  EXPECT_EQ(owner["notes"].size(), 1U);
  EXPECT_GE(backupsOf(b), restarts && jump_us > 0 ? std::size_t{7} : std::size_t{10});
  // A visit, its limits and Stop wait for nothing.
  EXPECT_EQ(b.station.closed.size(), at == At::kUnfinishedVisit ? 1U : 0U);
  if (visit != 0 && at != At::kUnfinishedVisit) {
    EXPECT_EQ(b.get("/api/state")["visit"], visit);
    EXPECT_EQ(b.station.now.visit, static_cast<std::uint64_t>(visit));
    EXPECT_EQ(b.station.orders.size(), orders);
    b.finish(visit);
    EXPECT_EQ(b.status, 200);
  }
  ASSERT_NE(b.beginVisit(id), 0);
  // A yes ends the wait.
  const bool told = !restarts || jump_us < 0;
  EXPECT_EQ(b.get("/api/patients")["clock_jumped_us"] != 0, told);
  b.post("/api/clock/done");
  EXPECT_EQ(b.get("/api/patients")["clock_jumped_us"], 0);
}

INSTANTIATE_TEST_SUITE_P(All, Clocks,
                         testing::Combine(testing::Values(3 * 365 * kDay_us, -3 * 365 * kDay_us,
                                                          kHour_us, -kHour_us),
                                          testing::Values(At::kNothingOpen, At::kOpenVisit,
                                                          At::kUnfinishedVisit, At::kHidden),
                                          testing::Bool()));

TEST(Clock, TimeThatPasses_IsNoJump) {
  Bench b;
  for (const std::int64_t us : {kSecond_us, kHour_us, 30 * kDay_us}) {
    b.clock.pass(us);
    b.clinic->backUpIfDue();
    b.restart();
    EXPECT_EQ(b.get("/api/patients")["clock_jumped_us"], 0);
  }
}

TEST(Clock, VisitAfterAClockThatWentBackward_IsTheLastOne) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001");
  b.finish(b.beginVisit(id, 1));
  b.clock.now -= 3 * 365 * kDay_us;
  b.finish(b.beginVisit(id, 2));
  EXPECT_EQ(b.get(fmt::format("/api/patients/{}", id))["today"].size(), 2U);
}

TEST(Clock, DeletionsWaitForAYes) {
  Bench b;
  makeBackups(b);
  b.clock.now += 3 * 365 * kDay_us;
  b.clinic->backUpIfDue();
  EXPECT_EQ(backupsOf(b), 11U);
  b.post("/api/clock/done");
  b.clock.pass(kDay_us);
  b.clinic->backUpIfDue();
  EXPECT_EQ(backupsOf(b), 7U);
}

}  // namespace
}  // namespace wholehand::clinic
