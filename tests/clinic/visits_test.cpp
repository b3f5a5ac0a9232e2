#include "clinic/text.hpp"
#include "clinic/trials.hpp"
#include "clinic_bench.hpp"
#include "files/device/device_file.hpp"
#include "files/patient/prescription_file.hpp"

#include <algorithm>
#include <map>

namespace wholehand::clinic {
namespace {

/// Answers of `wholehand measures` by file name; a file without an entry counts as damaged.
struct FakeMeasures {
  std::map<std::string, Json> results;
  Measure measure() {
    return [this](const std::string& path, std::string& why) -> std::optional<Json> {
      const auto found = results.find(std::filesystem::path(path).filename().string());
      if (found != results.end()) return found->second;
      why = "is truncated";
      return {};
    };
  }
  static Json of(std::int64_t visit, const std::string& sha256, double score, int ticks = 1000) {
    return {{"measures", 1},
            {"recording",
             {{"sha256", sha256},
              {"ticks", ticks},
              {"duration_s", 60.0},
              {"began_utc", "2026-11-28T12:00:05Z"}}},
            {"hand", "man-p50-left"},
            {"visit", visit},
            {"item", 0},
            {"exercise", "cocktail-bar"},
            {"level", 1},
            {"results", {{{"name", "score"}, {"value", score}, {"unit", ""}}}},
            {"active_s", 120.0},
            {"helped_share", 0.25},
            {"peak_speed_m_s", 0.3},
            {"path_ratio", 1.4},
            {"reach_s", nullptr},
            {"ended_by", "stop"}};
  }
};

void record(const Bench& b, const std::string& name, const std::string& bytes = "h5") {
  std::ofstream(b.options.recordings + "/" + name) << bytes;
}

/// Looks twice, because a file that changed since the last look is still being written.
void look(Bench& b, FakeMeasures& measures) {
  for (int i = 0; i < 2; ++i) {
    b.clinic->lookAtRecordings(measures.measure(), {});
    b.clock.pass(3 * kSecond_us);
  }
}

TEST(Visits, BeginOfAVisit_SendsThePersonsLimitsHandAndItem) {
  Bench b;
  Json body = patientOf("P-001");
  body["parameters"] = {{"effort_limit_arm_n", 5.0}, {"level_ratio", 0.5}};
  body["hands"]["right"] = {{"length_m", 0.171}, {"breadth_m", 0.080}};
  const std::int64_t id = b.post("/api/patients", body)["id"];
  Json plan = planOf(2);
  plan[0]["parameters"]["effort_limit_hand_tip_n"] = 2.0;
  plan[0]["help"] = "full";
  plan[1]["exercise"] = "squeeze-to-level";
  const Json visit =
      b.post(fmt::format("/api/patients/{}/visits", id), {{"side", "right"}, {"plan", plan}});
  ASSERT_EQ(b.status, 200);
  const VisitOrder& order = b.station.orders.at(0);
  EXPECT_EQ(order.visit, visit["id"].get<std::uint64_t>());
  EXPECT_EQ(order.help, "full");
  // The preset gentle (3 N, 6 N), overridden by the person's values, overridden by the item's;
  // level_ratio belongs to another exercise.
  EXPECT_EQ(order.parameters,
            (Parameters{{"effort_limit_arm_n", 5.0}, {"effort_limit_hand_tip_n", 2.0}}));
  EXPECT_EQ(order.hand, "");
  const std::string hand = textOf(b.options.folder + "/hands/" + order.hand_file);
  EXPECT_NE(hand.find("length_m = 0.171\nbreadth_m = 0.08\n"), std::string::npos)
      << hand.substr(0, 300);
  b.post(fmt::format("/api/visits/{}/item", order.visit), {{"item", 1}});
  EXPECT_EQ(b.station.orders.at(1).parameters.at("level_ratio"), 0.5);
  EXPECT_EQ(b.station.orders.at(1).parameters.at("effort_limit_hand_tip_n"), 3.0);
}

/// Limits belong to a hand of the person and go to the station with each item.
TEST(Visits, LimitsOfTheHand_GoToTheStationAsAPrescription) {
  Bench b;
  Json body = patientOf("P-001");
  body["hands"]["right"]["limits"] = {{{"axis", "x"}, {"within_m", {-0.05, 0.06}}},
                                      {{"axis", "finger_flexion"}, {"within_rad", {0.3, 2.5}}}};
  const std::int64_t id = b.post("/api/patients", body)["id"];
  EXPECT_EQ(b.get(fmt::format("/api/patients/{}", id))["hands"], body["hands"]);
  const std::string path_of_visits = fmt::format("/api/patients/{}/visits", id);
  const Json begun = {{"side", "right"}, {"plan", planOf(2)}};
  b.station.reply = {StationReply::Status::kRefused, "is armed; stop first"};
  (void)b.post(path_of_visits, begun);
  EXPECT_TRUE(std::filesystem::is_empty(b.options.folder + "/hands"))
      << "a visit that did not begin leaves no file";
  b.station.reply = {StationReply::Status::kAccepted, ""};
  b.station.orders.clear();
  b.post(path_of_visits, begun);
  ASSERT_EQ(b.status, 200);
  const VisitOrder order = b.station.orders.at(0);
  EXPECT_EQ(order.prescription_file, fmt::format("visit-{}-limits.toml", order.visit));
  const std::string path = b.options.folder + "/hands/" + order.prescription_file;
  const auto device =
      loadDeviceFile(std::string(WHOLEHAND_SOURCE_DIR) + "/config/devices/lambda-pride.toml");
  const auto read = loadPrescriptionFile(path, *device);
  ASSERT_TRUE(read.ok()) << format(read.errors());
  ASSERT_EQ(read->limits.size(), 2U);
  EXPECT_EQ(read->limits[1].upper, 2.5);
  EXPECT_EQ(read->side, Side::kRight);
  EXPECT_EQ(textOf(path).find("Keller"), std::string::npos) << "a file names no person";
  b.post(fmt::format("/api/visits/{}/item", order.visit), {{"item", 1}});
  EXPECT_EQ(b.station.orders.at(1).prescription_file, order.prescription_file);
}

TEST(Visits, FaultyLimits_AreRefusedAtTheirField) {
  Bench b;
  const auto refusedWith = [&](const Json& limits) {
    Json body = patientOf("P-001");
    body["hands"]["right"]["limits"] = limits;
    const Json reply = b.post("/api/patients", body);
    EXPECT_EQ(reply["refused"], "bad_value") << limits;
    return reply.value("field", "");
  };
  const std::string at = "hands.right.limits";
  EXPECT_EQ(refusedWith("none"), at);
  EXPECT_EQ(refusedWith({{{"axis", "x\"\n"}, {"within_m", {0.0, 0.1}}}}), at + ".0.axis");
  EXPECT_EQ(refusedWith({{{"within_m", {0.0, 0.1}}}}), at + ".0.axis");
  EXPECT_EQ(refusedWith({{{"axis", "x"}}}), at + ".0");
  EXPECT_EQ(refusedWith({{{"axis", "x"}, {"within_m", {0.1, 0.0}}}}), at + ".0");
  EXPECT_EQ(refusedWith({{{"axis", "x"}, {"within_m", {0.0}}}}), at + ".0");
  EXPECT_EQ(refusedWith({{{"axis", "x"}, {"within_m", {0.0, "1"}}}}), at + ".0.within_m");
  EXPECT_EQ(refusedWith({{{"axis", "x"}, {"within_m", {0.0, 3.0}}}}), at + ".0.within_m");
  EXPECT_EQ(refusedWith({{{"axis", "x"}, {"within_m", {0.0, 0.1}}},
                         {{"axis", "x"}, {"within_m", {0.0, 0.1}}}}),
            at + ".1.axis");
}

TEST(Visits, ShippedHand_IsUsedIfItsSizeMatches) {
  const auto hands = loadShippedHands(std::string(WHOLEHAND_SOURCE_DIR) + "/config/hands");
  ASSERT_TRUE(hands.ok());
  EXPECT_EQ(shippedHand(*hands, "left", 0.1524, 0.0696), "woman-p05-left");
  EXPECT_EQ(shippedHand(*hands, "left", 0.1526, 0.0696), "");
}

TEST(Visits, EveryOfferedHandSize_GivesAValidHandFile) {
  const test::Folder folder;
  const std::string hands = std::string(WHOLEHAND_SOURCE_DIR) + "/config/hands";
  for (const double length_m : {0.150, 0.1825, 0.215}) {
    for (const double breadth_m : {0.05, 0.085, 0.12}) {
      const auto written =
          writeHandFile(hands, folder.path() + "/v.toml", "v", "left", length_m, breadth_m);
      EXPECT_TRUE(written.ok()) << format(written.ok() ? Diagnostics{} : written.errors());
    }
  }
}

TEST(Visits, Presets_AreWithinTheRangesOfTheShippedExercises) {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config";
  const auto presets = loadPresets(config + "/clinic/presets.toml");
  ASSERT_TRUE(presets.ok()) << format(presets.errors());
  EXPECT_EQ(presets->force.front().id, "gentle");
  for (const ExerciseFacts& exercise : presets->exercises) {
    const std::string file = textOf(config + "/exercises/" + exercise.id + ".toml");
    int levels = 0;
    for (std::size_t at = 0; (at = file.find("\n[[levels]]", at)) != file.npos; ++at) ++levels;
    EXPECT_EQ(exercise.levels, std::max(levels, 1)) << exercise.id;
  }
}

TEST(Visits, RefusedBegin_LeavesNoVisit) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001");
  const std::string path = fmt::format("/api/patients/{}/visits", id);
  const Json body = {{"side", "right"}, {"plan", planOf()}};
  b.station.reply = {StationReply::Status::kRefused, "is armed; stop first"};
  EXPECT_EQ(b.post(path, body)["why"], "is armed; stop first");
  b.station.now.received = false;
  EXPECT_EQ(b.refused(path, body), "station_silent");
  b.station.now.received = true;
  EXPECT_EQ(b.refused(path, {{"side", "left"}, {"plan", planOf()}}),
            "bad_value");  // the person has no plan for the left side
  EXPECT_TRUE(b.get(fmt::format("/api/patients/{}", id))["visits"].empty());
  EXPECT_EQ(b.get("/api/state")["visit"], 0);
  b.station.reply = {StationReply::Status::kAccepted, ""};
  EXPECT_NE(b.beginVisit(id), 0);
}

TEST(Visits, RecordingOfAnUnansweredBegin_IsAssignedToThePatient) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t id = b.addPatient("P-001");
  const Json body = {{"side", "right"}, {"plan", planOf()}};
  const std::string path = fmt::format("/api/patients/{}/visits", id);
  b.station.reply = {StationReply::Status::kSilent, "5 s"};
  EXPECT_EQ(b.refused(path, body), "station_silent");
  EXPECT_EQ(b.get("/api/state")["visit"], 0);
  b.station.reply = {StationReply::Status::kAccepted, ""};
  const VisitOrder late = b.station.orders.back();  // the station obeys late, and somebody trains
  (void)b.station.open(late);
  record(b, "a.h5");
  const auto number = static_cast<std::int64_t>(late.visit);
  measures.results["a.h5"] = FakeMeasures::of(number, "aa", 5.0);
  look(b, measures);
  for (int i = 0; i < 12; ++i, b.clock.pass(kSecond_us)) b.clinic->lookAtStation();
  EXPECT_EQ(b.station.closed, std::vector<std::uint64_t>{late.visit});
  const Json visits = b.get(fmt::format("/api/patients/{}", id))["visits"];
  ASSERT_EQ(visits.size(), 1U);
  EXPECT_EQ(visits[0]["id"], number);
  EXPECT_EQ(visits[0]["state"], "unfinished");
  EXPECT_GE(visits[0]["ended_us"], visits[0]["began_us"]);
  ASSERT_EQ(visits[0]["trials"].size(), 1U);
  EXPECT_EQ(visits[0]["trials"][0]["state"], "measured");
  EXPECT_NE(b.beginVisit(id), 0);  // no visit is open any more
  // A guest's visit is listed among the guests.
  b.finish(static_cast<std::int64_t>(b.station.now.visit));
  b.station.reply = {StationReply::Status::kSilent, "5 s"};
  EXPECT_EQ(b.refused("/api/guest_visits", {{"side", "left"}}), "station_silent");
  EXPECT_EQ(b.get("/api/patients")["guests"].size(), 1U);
}

TEST(Visits, SecondConsole_CannotBeginOrChangeTheVisitOfTheFirst) {
  Bench b;
  const std::int64_t a = b.addPatient("P-001"), other = b.addPatient("P-002");
  b.station.meanwhile = [&] {  // a second console asks while the first order is on its way
    b.station.meanwhile = nullptr;
    EXPECT_EQ(b.refused(fmt::format("/api/patients/{}/visits", other),
                        {{"side", "right"}, {"plan", planOf()}}),
              "busy");
    EXPECT_EQ(b.get("/api/state")["clinic"], "open");  // other requests are answered
  };
  const std::int64_t visit = b.beginVisit(a);
  const Json second =
      b.post(fmt::format("/api/patients/{}/visits", a), {{"side", "right"}, {"plan", planOf()}});
  EXPECT_EQ(b.status, 409);
  EXPECT_EQ(second["now"]["id"], visit);
  b.post("/api/accounts", {{"name", "B. Huber"}, {"colour", "#aa0000"}, {"pin", "5678"}});
  const std::string first = b.token;
  b.token = b.post("/api/sign_in", {{"account", 2}, {"pin", "5678"}})["token"];
  b.finish(visit);
  EXPECT_EQ(b.status, 200);
  b.token = first;
  const Json late = b.post(fmt::format("/api/visits/{}/item", visit), {{"item", 0}});
  EXPECT_EQ(late["refused"], "changed");
  EXPECT_EQ(late["now"]["state"], "done");
  EXPECT_EQ(b.station.orders.size(), 1U);
}

TEST(Visits, LockOrDatabaseLossWhileTheStationIsAsked_IsAnswered) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id, 2);
  const std::string path = fmt::format("/api/visits/{}", visit);
  b.post(path + "/notes", {{"text", "cue given"}});
  b.station.meanwhile = [&] {
    b.station.meanwhile = nullptr;
    EXPECT_EQ(b.refused("/api/lock", Json::object()), "busy");
  };
  const Json next = b.post(path + "/item", {{"item", 1}});
  EXPECT_EQ(b.status, 200);
  EXPECT_EQ(next["notes"][0]["text"], "cue given");
  const auto lose = [&] {
    b.station.meanwhile = nullptr;
    std::filesystem::rename(b.database(), b.database() + ".away");
    EXPECT_EQ(b.refused(path + "/notes", {{"text", "is not kept"}}), "database");
  };
  const auto put_back = [&] { std::filesystem::rename(b.database() + ".away", b.database()); };
  b.station.meanwhile = lose;
  EXPECT_EQ(b.refused(path + "/item", {{"item", 0}}), "database");
  put_back();
  EXPECT_EQ(b.post(path + "/item", {{"item", 0}})["item"], 0);
  b.station.meanwhile = lose;
  b.station.reply = {StationReply::Status::kRefused, "is armed; stop first"};
  EXPECT_EQ(b.refused(path + "/item", {{"item", 1}}), "station");
  put_back();
  b.station.reply = {StationReply::Status::kAccepted, ""};
  b.finish(visit);
  EXPECT_EQ(b.status, 200);
  for (const auto what : {StationReply::Status::kAccepted, StationReply::Status::kSilent}) {
    b.station.now.visit = 0;
    b.station.meanwhile = lose;
    b.station.reply.what = what;
    EXPECT_EQ(b.refused(fmt::format("/api/patients/{}/visits", id),
                        {{"side", "right"}, {"plan", planOf()}}),
              "database");
    put_back();
    b.station.reply = {StationReply::Status::kAccepted, ""};
    const std::int64_t begun = b.get("/api/state")["visit"];
    EXPECT_NE(begun, 0);  // its row was written before the loss
    b.finish(begun);
  }
  b.post("/api/lock");
  EXPECT_EQ(b.status, 200);
  EXPECT_EQ(b.get("/api/state")["clinic"], "locked");
}

TEST(Visits, PainOfZero_IsStored) {
  Bench b;
  const std::int64_t visit = b.beginVisit(b.addPatient("P-001"));
  const std::string path = fmt::format("/api/visits/{}/pain", visit);
  EXPECT_TRUE(b.get("/api/visits/open")["visit"]["pain_before"].is_null());
  EXPECT_EQ(b.post(path, {{"when", "before"}, {"value", 0}})["pain_before"], 0);
  for (const Json& value : {Json(11), Json(-1), Json(2.5), Json("3")}) {
    EXPECT_EQ(b.refused(path, {{"when", "after"}, {"value", value}}), "bad_value");
  }
}

TEST(Visits, VisitAcrossAClockSetBackADay_DoesNotEndBeforeItBegan) {
  Bench b;
  const std::int64_t visit = b.beginVisit(b.addPatient("P-001"));
  b.clock.now -= kDay_us;
  b.clock.offset = 120;  // daylight saving time begins
  const Json done = b.post(fmt::format("/api/visits/{}/finish", visit), {{"state", "done"}});
  EXPECT_GE(done["ended_us"], done["began_us"]);
  EXPECT_EQ(done["offset_min"], 60);
  EXPECT_EQ(isoTime(kNoon_us, -210), "2026-11-28T08:30:00-03:30");
}

TEST(Visits, NotesAndVisitAfterAClockSetBackADay_AreKept) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id);
  const std::string notes = fmt::format("/api/visits/{}/notes", visit);
  b.post(notes, {{"text", "before"}, {"at_us", kNoon_us}});
  b.clock.now -= kDay_us;  // the monotonic clock continues
  b.post(notes, {{"text", "after"}, {"at_us", kNoon_us - kDay_us}});
  EXPECT_EQ(b.status, 200);
  b.post(notes, {{"text", "of the page's clock"}, {"at_us", kNoon_us}});
  EXPECT_EQ(b.status, 200);
  for (int i = 0; i < 12; ++i, b.clock.steady += kSecond_us) b.clinic->lookAtStation();
  EXPECT_EQ(b.get("/api/visits/open")["visit"]["notes"].size(), 3U);
  b.finish(visit);
  b.finish(b.beginVisit(id));
  EXPECT_EQ(b.get(fmt::format("/api/patients/{}", id))["visits"].size(), 2U);
}

TEST(Visits, VisitsAcrossDaylightSaving_StateTheirOwnLocalTime) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001");
  const auto visit_at = [&](const char* utc, int offset_min) {
    b.clock.now = *timeOf(utc);
    b.clock.offset = offset_min;
    b.finish(b.beginVisit(id));
  };
  visit_at("2026-10-25T00:30:00Z", 120);
  visit_at("2026-10-25T01:10:00Z", 60);  // this hour occurs twice on that day
  const std::string csv = b.raw("GET", "/api/export/all.csv", "").body;
  const std::size_t first = csv.find(",2026-10-25T02:30:00+02:00,");
  const std::size_t second = csv.find(",2026-10-25T02:10:00+01:00,");
  ASSERT_NE(second, std::string::npos) << csv;
  EXPECT_LT(first, second);
  const Json visits = b.get(fmt::format("/api/patients/{}", id))["visits"];
  EXPECT_EQ(visits[0]["offset_min"], 60);
  EXPECT_EQ(visits[1]["offset_min"], 120);
  EXPECT_GT(visits[0]["began_us"], visits[1]["began_us"]);
}

TEST(Visits, MistakenVisitsAndPatients_CanBeMovedMergedAndDeleted) {
  Bench b;
  const std::int64_t right = b.addPatient("P-001"), wrong = b.addPatient("P-002");
  const std::int64_t visit = b.beginVisit(wrong);
  b.post(fmt::format("/api/visits/{}/notes", visit), {{"kind", "tired"}, {"text", ""}});
  const std::string move = fmt::format("/api/visits/{}/move", visit);
  EXPECT_EQ(b.refused(move, {{"patient", right}}),
            "visit_open");  // the limits of the wrong person apply
  b.finish(visit);
  b.post(move, {{"patient", right}});
  const Json moved = b.get(fmt::format("/api/patients/{}", right))["visits"];
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_EQ(moved[0]["notes"][0]["kind"], "tired");

  const std::int64_t guest = b.post("/api/guest_visits", {{"side", "left"}})["id"];
  EXPECT_EQ(b.station.orders.back().parameters.at("effort_limit_hand_tip_n"), 3.0);
  EXPECT_EQ(b.station.orders.back().hand, "adult-median-left");
  b.finish(guest);
  EXPECT_EQ(b.get("/api/patients")["guests"][0]["id"], guest);
  EXPECT_EQ(b.post(fmt::format("/api/visits/{}/move", guest), {{"patient", wrong}})["state"],
            "done");
  const std::int64_t second = b.post("/api/guest_visits", {{"side", "left"}})["id"];
  b.finish(second);
  b.ask("DELETE", fmt::format("/api/visits/{}", second));
  EXPECT_EQ(b.status, 200);
  EXPECT_EQ(b.ask("DELETE", fmt::format("/api/visits/{}", visit))["refused"], "changed");

  EXPECT_EQ(b.ask("DELETE", fmt::format("/api/patients/{}", wrong))["refused"],
            "changed");  // refused: has a visit
  const Json merged = b.post(fmt::format("/api/patients/{}/merge", right), {{"from", wrong}});
  EXPECT_EQ(merged["visits"].size(), 2U);
  EXPECT_EQ(b.get(fmt::format("/api/patients/{}", wrong))["refused"], "not_found");
  const std::int64_t mistyped = b.addPatient("P-0003");
  b.ask("DELETE", fmt::format("/api/patients/{}", mistyped));
  EXPECT_EQ(b.status, 200);
  EXPECT_EQ(b.post(fmt::format("/api/patients/{}/no_show", right))["state"], "no_show");
  EXPECT_EQ(b.get("/api/patients")["patients"][0]["visits"],
            2);  // a visit that was missed is not counted
}

TEST(Visits, VisitAfterARestartOfTheStation_IsOfferedAsUnfinishedAndContinues) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id, 2);
  b.station.now.visit = 0;
  b.restart();
  for (int i = 0; i < 12; ++i, b.clock.pass(kSecond_us)) b.clinic->lookAtStation();
  const Json row = b.get("/api/patients")["open"][0];
  EXPECT_EQ(row["state"], "unfinished");
  EXPECT_EQ(row["visit"], visit);
  EXPECT_EQ(b.post(fmt::format("/api/visits/{}/item", visit), {{"item", 1}})["state"], "open");
}

TEST(Visits, UnfinishedVisitThatWasMoved_ContinuesOnlyWithTheRightHand) {
  Bench b;
  Json left = patientOf("P-002"), small = patientOf("P-003");
  left["side"] = "left";
  left["hands"] = {{"left", {{"length_m", 0.1524}, {"breadth_m", 0.0696}}}};
  small["hands"]["right"] = {{"length_m", 0.171}, {"breadth_m", 0.080}};
  const std::int64_t wrong = b.addPatient("P-001"),
                     other_side = b.post("/api/patients", left)["id"],
                     right = b.post("/api/patients", small)["id"];
  const std::int64_t visit = b.beginVisit(wrong);
  const std::string path = fmt::format("/api/visits/{}", visit);
  const std::string first_hand = b.station.orders.back().hand;
  EXPECT_NE(first_hand, "");
  b.station.now.values["effort_limit_arm_n"] = 12.0;
  b.post(path + "/finish", {{"state", "unfinished"}});
  b.post(path + "/move", {{"patient", other_side}});
  EXPECT_EQ(b.post(path + "/item", {{"item", 0}})["field"], "side");
  EXPECT_EQ(b.station.orders.size(), 1U);
  b.post(path + "/move", {{"patient", right}});
  EXPECT_EQ(b.post(path + "/item", {{"item", 0}})["state"], "open");
  const std::string file = b.options.folder + "/hands/" + b.station.orders.back().hand_file;
  EXPECT_EQ(b.station.orders.back().hand, "");
  EXPECT_NE(textOf(file).find("length_m = 0.171\n"), std::string::npos);
  EXPECT_EQ(b.station.orders.back().parameters.at("effort_limit_arm_n"), 6.0);
  EXPECT_EQ(b.get(path)["hand"], b.station.orders.back().hand_file);
  // The hand size is corrected while the visit is unfinished.
  b.post(path + "/finish", {{"state", "unfinished"}});
  Json person = b.get(fmt::format("/api/patients/{}", right));
  person["hands"] = patientOf("")["hands"];
  b.ask("PUT", fmt::format("/api/patients/{}", right), person);
  EXPECT_EQ(b.post(path + "/item", {{"item", 0}})["hand"], first_hand);
  EXPECT_EQ(b.station.orders.back().hand, first_hand);
  EXPECT_EQ(b.station.orders.back().hand_file, "");
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(Visits, StationWithAnUnknownVisit_IsToldToCloseIt) {
  Bench b;
  b.station.now.visit = 77;  // of another clinic, or finished while the station did not answer
  for (int i = 0; i < 12; ++i, b.clock.pass(kSecond_us)) b.clinic->lookAtStation();
  EXPECT_EQ(b.station.closed, std::vector<std::uint64_t>{77});
}

Json personOf(Bench& b, std::int64_t id) {
  return b.get(fmt::format("/api/patients/{}", id));
}

TEST(Settings, SettingsOfAVisit_ApplyToTheNextVisit) {
  Bench b;
  const std::int64_t id = b.addPatient("P-001");  // preset gentle: 3 N, 6 N
  Json plan = planOf(2);
  plan[0]["parameters"] = {{"effort_limit_hand_tip_n", 2.0}, {"damping_full_n", 4.0}};
  const std::string visits = fmt::format("/api/patients/{}/visits", id);
  const std::int64_t first = b.post(visits, {{"side", "right"}, {"plan", plan}})["id"];
  Parameters& now = b.station.now.values;
  now["effort_limit_arm_n"] = 8.0;  // raised by the therapist
  now["damping_full_n"] = 7.0;      // a value of the item
  b.station.now.help = "none";
  b.clinic->lookAtStation();
  b.restart();  // a restart loses no value
  b.post(fmt::format("/api/visits/{}/item", first), {{"item", 1}});
  EXPECT_EQ(b.station.orders.back().parameters.at("effort_limit_arm_n"), 8.0);
  EXPECT_EQ(now["effort_limit_hand_tip_n"],
            2.0);  // the lower limit of the item stays during the visit
  now["level_ratio"] = 1.25;
  now["effort_limit_arm_n"] = 7.0;
  b.station.now.level = 2;
  EXPECT_EQ(personOf(b, id)["parameters"], Json::object());  // unchanged until the visit is closed
  b.finish(first);
  EXPECT_EQ(b.status, 200);
  const Json person = personOf(b, id);
  // The lower limit at the fingertips belongs to the item, not to the person.
  EXPECT_EQ(person["parameters"], (Json{{"effort_limit_arm_n", 7.0}, {"level_ratio", 1.25}}));
  EXPECT_EQ(person["visits"][0]["changed"], person["parameters"]);
  EXPECT_EQ(person["today"][0]["help"], "none");
  EXPECT_EQ(person["today"][0]["parameters"]["damping_full_n"], 7.0);
  EXPECT_EQ(person["today"][1]["level"], 2);
  b.post(visits, {{"side", "right"}, {"plan", person["today"]}});
  ASSERT_EQ(b.status, 200);
  const VisitOrder& next = b.station.orders.back();
  EXPECT_EQ(next.parameters, (Parameters{{"effort_limit_arm_n", 7.0},
                                         {"effort_limit_hand_tip_n", 2.0},
                                         {"damping_full_n", 7.0}}));
  EXPECT_EQ(next.help, "none");
}

TEST(Settings, SettingsOutsideAPersonsVisit_AreNotStored) {
  Bench b;
  const std::int64_t a = b.addPatient("P-001"), other = b.addPatient("P-002");
  b.station.now.values["effort_limit_arm_n"] = 15.0;  // set at the console without a visit
  b.clinic->lookAtStation();
  const std::int64_t visit = b.beginVisit(a);
  EXPECT_EQ(b.station.orders.back().parameters.at("effort_limit_arm_n"), 6.0);
  b.finish(visit);
  b.station.now.values["effort_limit_arm_n"] = 15.0;
  b.clinic->lookAtStation();
  const std::int64_t guest = b.post("/api/guest_visits", {{"side", "right"}})["id"];
  b.station.now.values["effort_limit_arm_n"] = 9.0;
  b.finish(guest);
  b.post(fmt::format("/api/visits/{}/move", guest), {{"patient", other}});
  for (const std::int64_t id : {a, other}) {
    EXPECT_EQ(personOf(b, id)["parameters"], Json::object());
  }
}

TEST(Settings, VisitMovedToAnotherPerson_ReturnsTheFirstPersonsSettingsAndChangesNoOther) {
  Bench b;
  Json body = patientOf("P-001");
  body["parameters"] = {{"effort_limit_arm_n", 5.0}};
  const std::int64_t wrong = b.post("/api/patients", body)["id"], right = b.addPatient("P-002");
  const std::int64_t visit = b.beginVisit(wrong);
  b.station.now.values["effort_limit_arm_n"] = 12.0;
  b.station.now.values["damping_full_n"] = 2.0;
  b.finish(visit);
  EXPECT_EQ(personOf(b, wrong)["parameters"],
            (Json{{"effort_limit_arm_n", 12.0}, {"damping_full_n", 2.0}}));
  b.post(fmt::format("/api/visits/{}/move", visit), {{"patient", right}});
  EXPECT_EQ(personOf(b, wrong)["parameters"], (Json{{"effort_limit_arm_n", 5.0}}));
  EXPECT_EQ(personOf(b, right)["parameters"], Json::object());
}

TEST(Settings, LoweredLimit_CapsThePlanAlsoIfTheStationIsKilled) {
  Bench b;
  Json body = patientOf("P-001");
  body["plan"] = planOf(2);
  body["plan"][0]["parameters"] = {{"effort_limit_arm_n", 6.0}};
  const std::int64_t id = b.post("/api/patients", body)["id"];
  const std::int64_t visit = b.post(fmt::format("/api/patients/{}/visits", id),
                                    {{"side", "right"}, {"plan", body["plan"]}})["id"];
  b.post(fmt::format("/api/visits/{}/item", visit), {{"item", 1}});
  b.station.now.values["effort_limit_arm_n"] = 4.0;
  b.clinic->lookAtStation();
  b.station.now.visit = 0;  // the station was killed
  for (int i = 0; i < 12; ++i, b.clock.pass(kSecond_us)) b.clinic->lookAtStation();
  Json person = personOf(b, id);
  EXPECT_EQ(person["visits"][0]["state"], "unfinished");
  EXPECT_EQ(person["parameters"], (Json{{"effort_limit_arm_n", 4.0}}));
  EXPECT_EQ(person["plan"][0]["parameters"]["effort_limit_arm_n"], 4.0);
  EXPECT_EQ(person["today"][0]["parameters"]["effort_limit_arm_n"], 4.0);
  b.ask("PUT", fmt::format("/api/patients/{}", id), person);
  EXPECT_EQ(b.status, 200);
}

TEST(Settings, LimitLoweredAfterAnUnfinishedVisit_AppliesWhenItContinuesOrEnds) {
  for (const bool goes_on : {true, false}) {
    Bench b;
    Json body = patientOf("P-001");
    body["parameters"] = {{"effort_limit_arm_n", 12.0}, {"damping_full_n", 4.0}};
    const std::int64_t id = b.post("/api/patients", body)["id"], visit = b.beginVisit(id, 2);
    const std::string path = fmt::format("/api/visits/{}", visit);
    b.station.now.values["effort_limit_arm_n"] = 18.0;
    b.station.now.values["damping_full_n"] = 7.0;
    b.post(path + "/finish", {{"state", "unfinished"}});
    Json person = personOf(b, id);
    EXPECT_EQ(person["parameters"], (Json{{"effort_limit_arm_n", 18.0}, {"damping_full_n", 7.0}}));
    person["parameters"]["effort_limit_arm_n"] = 4.0;
    b.ask("PUT", fmt::format("/api/patients/{}", id), person);
    ASSERT_EQ(b.status, 200);
    if (goes_on) {
      const Json now = b.post(path + "/item", {{"item", 0}});
      ASSERT_EQ(b.status, 200) << now;
      EXPECT_EQ(b.station.orders.back().parameters.at("effort_limit_arm_n"), 4.0);
      EXPECT_EQ(now["changed"], (Json{{"damping_full_n", 7.0}}));  // the change that still applies
    }
    b.post(path + "/finish", {{"state", "done"}});
    ASSERT_EQ(b.status, 200);
    EXPECT_EQ(personOf(b, id)["parameters"],
              (Json{{"effort_limit_arm_n", 4.0}, {"damping_full_n", 7.0}}));
    // Moving the visit to another person takes back only the values that are still its own.
    const std::int64_t right = b.addPatient("P-002");
    b.post(path + "/move", {{"patient", right}});
    ASSERT_EQ(b.status, 200);
    EXPECT_EQ(personOf(b, id)["parameters"],
              (Json{{"effort_limit_arm_n", 4.0}, {"damping_full_n", 4.0}}));
  }
}

TEST(Trials, Recording_IsMeasuredOnceAndListedInTheVisit) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id);
  b.station.now.recording = b.options.recordings + "/a.h5";
  b.clinic->lookAtStation();
  EXPECT_EQ(b.get("/api/visits/open")["visit"]["trials"][0]["state"], "waiting");
  b.station.now.recording = "";
  record(b, "a.h5");
  measures.results["a.h5"] = FakeMeasures::of(visit, "aa", 97.0);
  look(b, measures);
  b.finish(visit);
  const Json trial = b.get(fmt::format("/api/patients/{}", id))["visits"][0]["trials"][0];
  EXPECT_EQ(trial["state"], "measured");
  EXPECT_EQ(trial["results"][0]["value"], 97.0);
  EXPECT_EQ(trial["began_us"], kNoon_us + 5 * kSecond_us);
  EXPECT_TRUE(trial["reach_s"].is_null());
  measures.results.clear();  // a second measurement would fail
  b.restart();
  look(b, measures);
  const Json patient = b.get(fmt::format("/api/patients/{}", id));
  EXPECT_EQ(patient["visits"][0]["trials"][0]["state"], "measured");
  ASSERT_EQ(patient["curves"].size(), 2U);
  EXPECT_EQ(patient["curves"][0], (Json{{"name", "active_min"},
                                        {"exercise", ""},
                                        {"unit", "min"},
                                        {"points", {{kNoon_us, 2.0}}}}));
  const std::string csv = b.raw("GET", "/api/export/all.csv", "").body;
  EXPECT_NE(csv.find("a.h5,score,97.0,\r\n"), std::string::npos) << csv;
  EXPECT_EQ(csv.find("Keller"), std::string::npos);
}

// Active, helped and led time are columns of their own. What was broken off is listed with the
// reason, and its measures count.
TEST(Trials, SessionThatWasBrokenOff_IsToldWithItsTimes) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id);
  record(b, "a.h5");
  Json& json = measures.results["a.h5"] = FakeMeasures::of(visit, "aa", 97.0);
  json["helped_s"] = 30.0;
  json["led_s"] = 45.0;
  json["ended_by"] = "broken_off";
  json["recording"]["complete"] = false;
  look(b, measures);
  const Json trial = b.get("/api/visits/open")["visit"]["trials"][0];
  EXPECT_EQ(trial["state"], "measured");
  EXPECT_EQ(trial["ended_by"], "broken_off");
  EXPECT_NE(trial["why"].get<std::string>().find("broken off"), std::string::npos) << trial;
  EXPECT_EQ(trial["active_s"], 120.0);
  EXPECT_EQ(trial["helped_s"], 30.0);
  EXPECT_EQ(trial["led_s"], 45.0);
  b.finish(visit);
  const std::string csv = b.raw("GET", "/api/export/all.csv", "").body;
  for (const char* line : {"a.h5,active,120.0,s", "a.h5,helped,30.0,s", "a.h5,led,45.0,s"}) {
    EXPECT_NE(csv.find(line), std::string::npos) << csv;
  }
}

TEST(Trials, RecordingsMadeWhileTheProcessWasDown_AreFound) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id);
  b.clinic.reset();
  for (int i = 0; i < 5; ++i) {
    const std::string name = fmt::format("{}.h5", i);
    record(b, name);
    measures.results[name] = FakeMeasures::of(visit, name, 50.0 + i);
  }
  b.restart();
  look(b, measures);
  EXPECT_EQ(b.get("/api/visits/open")["visit"]["trials"].size(), 5U);
}

TEST(Trials, UnusableOrMovedRecordings_AreReportedWithTheReason) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id);
  for (const char* name :
       {"ours.h5", "copy.h5", "foreign.h5", "none.h5", "broken.h5", "empty.h5", "part.h5"})
    record(b, name);
  measures.results = {{"ours.h5", FakeMeasures::of(visit, "aa", 1)},
                      {"copy.h5", FakeMeasures::of(visit, "aa", 1)},
                      {"foreign.h5", FakeMeasures::of(12345, "bb", 1)},
                      {"none.h5", FakeMeasures::of(0, "cc", 1)},
                      {"empty.h5", FakeMeasures::of(visit, "dd", 1, 0)},
                      {"part.h5", FakeMeasures::of(0, "ff", 1)}};
  measures.results["part.h5"]["recording"]["complete"] = false;
  look(b, measures);
  const auto trials = [&] { return b.get("/api/visits/open")["visit"]["trials"]; };
  ASSERT_EQ(trials().size(), 2U);  // a recording and its copy count once
  const auto why = [&](const char* name) {
    Database db(b.database(), Database::Mode::kReadWrite);
    Statement row = db.query("SELECT state || ': ' || why FROM trial WHERE recording = ?", name);
    return row.step() ? row.text(0) : "";
  };
  EXPECT_EQ(why("foreign.h5"), "ignored: visit 12345 is not of this clinic");
  EXPECT_EQ(why("none.h5"), "measured: ");  // not yet given to a person
  EXPECT_EQ(why("broken.h5"), "failed: is truncated");
  EXPECT_EQ(why("empty.h5"), "failed: the recording has no tick");
  EXPECT_EQ(why("part.h5"), "measured: the recording is not whole: its measures are of a part");
  const std::string kept = why("ours.h5") == "measured: " ? "ours.h5" : "copy.h5";
  std::filesystem::remove(b.options.recordings + "/ours.h5");
  std::filesystem::remove(b.options.recordings + "/copy.h5");
  look(b, measures);
  EXPECT_EQ(why(kept.c_str()), "measured: the recording is gone");
  record(b, "renamed.h5");
  measures.results["renamed.h5"] = FakeMeasures::of(visit, "aa", 1);
  look(b, measures);
  EXPECT_EQ(why("renamed.h5"), "measured: ");
  EXPECT_EQ(trials().size(), 2U);
  std::ofstream(b.options.recordings + "/broken.h5", std::ios::app)
      << "the rest";  // the file grows: it was still being written
  measures.results["broken.h5"] = FakeMeasures::of(visit, "ee", 1);
  look(b, measures);
  EXPECT_EQ(trials().size(), 3U);
}

// Each recording is named where a therapist looks: in the list of its visit, or among the sessions
// without a visit.
TEST(Trials, EveryKindOfBadRecording_IsListedByName) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t visit = b.beginVisit(b.addPatient("P-001"));
  const std::string stem = fmt::format("20261128-120005-visit-{}-bar-level-1", visit);
  const auto named = [&](const Json& list) {
    std::map<std::string, std::string> out;
    for (const Json& trial : list) out[trial["recording"]] = trial["why"];
    return out;
  };
  record(b, stem + ".h5", "half a recor");              // truncated; its name tells the visit
  record(b, stem + "-2.h5");                            // deleted later
  record(b, stem + "-3.h5");                            // a recording without a tick
  record(b, "20261128-120005-visit-77-bar.h5", "cut");  // of a visit that does not exist here
  record(b, "foreign.h5");
  record(b, "written.h5");
  b.station.now.recording = "written.h5";
  measures.results = {{stem + "-2.h5", FakeMeasures::of(visit, "aa", 1)},
                      {stem + "-3.h5", FakeMeasures::of(visit, "bb", 1, 0)},
                      {"foreign.h5", FakeMeasures::of(12345, "cc", 1)},
                      {"written.h5", FakeMeasures::of(visit, "dd", 1)}};
  b.clinic->lookAtStation();
  look(b, measures);
  std::filesystem::remove(b.options.recordings + "/" + stem + "-2.h5");
  look(b, measures);
  using Named = std::map<std::string, std::string>;
  EXPECT_EQ(named(b.get(fmt::format("/api/visits/{}", visit))["trials"]),
            (Named{{stem + ".h5", "is truncated"},
                   {stem + "-2.h5", "the recording is gone"},
                   {stem + "-3.h5", "the recording has no tick"},
                   {"written.h5", ""}}));
  EXPECT_EQ(named(b.get("/api/sessions")["sessions"]),
            (Named{{"20261128-120005-visit-77-bar.h5", "is truncated"},
                   {"foreign.h5", "visit 12345 is not of this clinic"}}));
  // A recording that returns, or is written to its end, is measured.
  record(b, stem + "-2.h5");
  b.station.now.recording = "";
  look(b, measures);
  const Json trials = b.get(fmt::format("/api/visits/{}", visit))["trials"];
  EXPECT_EQ(std::count_if(trials.begin(), trials.end(),
                          [](const Json& t) { return t["state"] == "measured"; }),
            2);
}

TEST(Trials, FailedMeasurement_IsRetriedWhileTheProcessRuns) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t visit = b.beginVisit(b.addPatient("P-001"));
  record(b, "a.h5");
  int tries = 0;
  bool memory_is_back = false;
  const Measure measure = [&](const std::string&, std::string& why) -> std::optional<Json> {
    ++tries;
    if (memory_is_back) return FakeMeasures::of(visit, "aa", 5.0);
    why = "out of memory";
    return {};
  };
  const auto pass = [&](int seconds) {
    for (int s = 0; s < seconds; s += 4, b.clock.pass(4 * kSecond_us)) {
      b.clinic->lookAtRecordings(measure, {});
    }
  };
  pass(3600);
  EXPECT_GE(tries, 4);
  EXPECT_LE(tries, 8);  // the interval doubles: 30 s, 60 s, ..., 1920 s
  memory_is_back = true;
  pass(3700);
  EXPECT_EQ(b.get("/api/visits/open")["visit"]["trials"][0]["state"], "measured");
  const int then = tries;
  pass(3700);
  EXPECT_EQ(tries, then);
}

TEST(Trials, RecordingsDuringADatabaseLoss_AreFoundLater) {
  Bench b;
  const std::int64_t visit = b.beginVisit(b.addPatient("P-001"));
  bool lose = true;
  const Measure measure = [&](const std::string& path, std::string&) -> std::optional<Json> {
    if (std::exchange(lose, false)) {
      std::filesystem::rename(b.database(), b.database() + ".away");
      EXPECT_EQ(b.refused("/api/patients", patientOf("P-002")), "database");
    }
    return FakeMeasures::of(visit, path, 5.0);
  };
  record(b, "a.h5");
  record(b, "b.h5");
  const auto look = [&] {
    for (int i = 0; i < 2; ++i, b.clock.pass(3 * kSecond_us)) {
      b.clinic->lookAtRecordings(measure, {});
    }
  };
  look();
  EXPECT_FALSE(lose);
  std::filesystem::rename(b.database() + ".away", b.database());
  look();
  EXPECT_EQ(b.get("/api/visits/open")["visit"]["trials"].size(), 2U);
}

TEST(Sessions, SessionsRecordedWithoutTheRecords_CanBeAssignedOrDeleted) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t id = b.addPatient("P-001"), earlier = b.beginVisit(id, 2);
  b.finish(earlier);
  b.clinic.reset();
  for (const char* name : {"a.h5", "b.h5", "c.h5"}) {
    record(b, name);
    measures.results[name] = FakeMeasures::of(0, name, 5.0);
  }
  record(b, "c.json");
  measures.results["b.h5"]["recording"]["began_utc"] = "2026-11-28T12:10:05Z";
  b.restart();
  look(b, measures);
  const Json list = b.get("/api/sessions")["sessions"];
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(list[0]["recording"], "b.h5");  // newest first
  std::map<std::string, std::int64_t> number;
  for (const Json& session : list) number[session["recording"]] = session["id"];
  const Json gift = {{"patient", id}, {"sessions", {number["a.h5"], number["b.h5"]}}};
  const Json visit = b.post("/api/sessions/give", gift);
  ASSERT_EQ(b.status, 200) << visit;
  EXPECT_EQ(visit["state"], "done");
  EXPECT_EQ(visit["side"], "left");
  EXPECT_EQ(visit["began_us"], kNoon_us + 5 * kSecond_us);
  EXPECT_EQ(visit["ended_us"], kNoon_us + 665 * kSecond_us);
  EXPECT_EQ(visit["trials"].size(), 2U);
  EXPECT_EQ(b.refused("/api/sessions/give", gift), "changed");
  EXPECT_EQ(personOf(b, id)["today"].size(), 2U);  // the plan of the earlier visit
  b.ask("DELETE", fmt::format("/api/sessions/{}", number["c.h5"]));
  EXPECT_EQ(b.status, 200);
  EXPECT_FALSE(std::filesystem::exists(b.options.recordings + "/c.h5"));
  EXPECT_FALSE(std::filesystem::exists(b.options.recordings + "/c.json"));
  EXPECT_EQ(b.get("/api/sessions")["sessions"], Json::array());
  b.clinic.reset();  // the recordings name no visit; the assignment must stay
  ASSERT_TRUE(rebuildTrials(b.options.folder, b.options.recordings, measures.measure()).ok());
  std::filesystem::rename(b.options.recordings + "/a.h5", b.options.recordings + "/z.h5");
  measures.results["z.h5"] = measures.results["a.h5"];
  b.restart();
  look(b, measures);
  const Json kept = b.get(fmt::format("/api/visits/{}", visit["id"].get<std::int64_t>()));
  ASSERT_EQ(kept["trials"].size(), 2U);
  for (const Json& trial : kept["trials"]) EXPECT_EQ(trial["state"], "measured") << trial;
}

TEST(Sessions, VisitOpenWhenTheProcessDies_Continues) {
  Bench b;
  const std::int64_t visit = b.beginVisit(b.addPatient("P-001"), 2);
  b.restart();
  for (int i = 0; i < 12; ++i, b.clock.pass(kSecond_us)) b.clinic->lookAtStation();
  EXPECT_EQ(b.get("/api/visits/open")["visit"]["id"], visit);
  EXPECT_TRUE(b.station.closed.empty());
  EXPECT_EQ(b.post(fmt::format("/api/visits/{}/item", visit), {{"item", 1}})["item"], 1);
}

TEST(Sessions, DeletedGuestVisit_DeletesItsRecording) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t guest = b.post("/api/guest_visits", {{"side", "left"}})["id"];
  b.finish(guest);
  record(b, "a.h5");
  measures.results["a.h5"] = FakeMeasures::of(guest, "aa", 5.0);
  look(b, measures);
  std::filesystem::create_directory(b.options.recordings + "/a-report");
  record(b, "a-report/index.html");
  const Json deleted = b.ask("DELETE", fmt::format("/api/visits/{}", guest));
  EXPECT_EQ(deleted["recordings_left"], Json::array());
  EXPECT_FALSE(std::filesystem::exists(b.options.recordings + "/a.h5"));
  EXPECT_FALSE(std::filesystem::exists(b.options.recordings + "/a-report"));
}

TEST(Trials, Rebuild_RestoresTrialsFromTheFolderAlone) {
  Bench b;
  FakeMeasures measures;
  const std::int64_t id = b.addPatient("P-001"), visit = b.beginVisit(id);
  record(b, "a.h5");
  measures.results["a.h5"] = FakeMeasures::of(visit, "aa", 12.0);
  record(b, "g.h5");
  measures.results["g.h5"] = FakeMeasures::of(0, "gg", 7.0);
  look(b, measures);
  const Json session = b.get("/api/sessions")["sessions"][0];
  const std::int64_t given =
      b.post("/api/sessions/give", {{"patient", id}, {"sessions", {session["id"]}}})["id"];
  b.clinic.reset();
  {
    Database(b.database(), Database::Mode::kReadWrite)
        .run("UPDATE trial SET measures = '{}', state = 'failed'");
  }
  for (const char* name : {"a (copy).h5", "a.h5.h5"}) {
    record(b, name);
    measures.results[name] = measures.results["a.h5"];
  }
  std::filesystem::rename(b.options.recordings + "/g.h5", b.options.recordings + "/h.h5");
  measures.results["h.h5"] = measures.results["g.h5"];
  for (int i = 0; i < 2; ++i) {  // a second rebuild changes nothing
    const auto rebuilt = rebuildTrials(b.options.folder, b.options.recordings, measures.measure());
    ASSERT_TRUE(rebuilt.ok());
    EXPECT_EQ(*rebuilt, "4 recordings: 2 are trials of this clinic's visits, 2 are not");
  }
  b.restart();
  EXPECT_EQ(b.get("/api/visits/open")["visit"]["trials"].size(), 1U);
  const Json gift = b.get(fmt::format("/api/visits/{}", given))["trials"];
  ASSERT_EQ(gift.size(), 1U);
  EXPECT_EQ(gift[0]["recording"], "h.h5");
  EXPECT_EQ(gift[0]["state"], "measured");
  EXPECT_EQ(b.get("/api/visits/open")["visit"]["trials"][0]["results"][0]["value"], 12.0);
}

TEST(Trials, MeasuringProcess_ReportsItsReasonAndIsLimitedInTime) {
  const test::Folder folder;
  const std::string program = folder.path() + "/measures";
  std::ofstream(program) << "#!/bin/sh\ncase $2 in *good*) echo '{\"measures\":1}';; *) echo \"$2: "
                            "no tick\" >&2; exit 2;; esac\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const Measure measure = measureByChild(program, {});
  std::string why;
  EXPECT_TRUE(measure("good.h5", why).has_value());
  EXPECT_FALSE(measure("bad.h5", why).has_value());
  EXPECT_EQ(why, "bad.h5: no tick");
}

}  // namespace
}  // namespace wholehand::clinic
