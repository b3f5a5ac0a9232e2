// Visits of the clinic's records: which limits apply, and which orders are refused while a visit is
// open.
#include "record/recording.hpp"
#include "station_bench.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <map>

namespace wholehand::test {
namespace {

class Visits : public Bar {
 protected:
  void begin() {
    StationConfig config = barConfig();
    config.rehearse = false;
    config.visit_hands_folder = folder_ + "/hands";
    load(config);
    run(false);
  }
  OrderReply open(const orders::OpenVisit& visit) {
    Order order = of(visit);
    order.may_raise_limits = true;  // the clinic's records process acts as a therapist
    return ask(order);
  }
  OrderReply set(const std::string& name, double value) {
    return ask(orders::SetParameter{name, value});
  }
  std::map<std::string, double> values() {
    const auto scene = station_->scene();
    const auto status = station_->status();
    std::map<std::string, double> out;
    for (std::size_t i = 0; i < scene->parameters.size(); ++i) {
      out[scene->parameters[i].name] = status.parameters[i];
    }
    return out;
  }
  /// Parameter values of the exercise file.
  std::map<std::string, double> ofFile() {
    std::map<std::string, double> out;
    for (const PublishedParameter& p : station_->scene()->parameters) out[p.name] = p.initial;
    return out;
  }
};

orders::OpenVisit ofVisit(std::uint64_t visit) {
  return {.visit = visit, .exercise = "cocktail-bar", .hand = "man-p50-right"};
}

// With several patients in a row, patient B must not get the limits of patient A. Expected are the
// values that B's visit names, and the file's values for the rest.
TEST_F(Visits, NextPatient_KeepsNoValueOfTheLastPatient) {
  begin();
  const std::string first_hand = station_->scene()->hand.name;
  auto random = seededRandom(4001);
  const std::vector<std::string> exercises = {"cocktail-bar", "squeeze-to-level", "free-grasping"};
  const std::vector<std::string> hands = {"man-p95-right", "woman-p05-left", "woman-p50-right"};
  for (int i = 1; i <= (fullCounts() ? 1000 : cases(40)); ++i) {
    orders::OpenVisit visit = ofVisit(static_cast<std::uint64_t>(i));
    visit.exercise = exercises[random() % exercises.size()];
    visit.hand = hands[random() % hands.size()];
    visit.help = static_cast<Help>(random() % kHelps);
    // The parameters are known only when the visit is open, so it is opened, closed and opened
    // again with values.
    ASSERT_TRUE(open(visit).accepted);
    ASSERT_TRUE(ask(orders::CloseVisit{visit.visit}).accepted);
    const bool named = station_->scene()->exercise_name == visit.exercise;
    for (const PublishedParameter& p : station_->scene()->parameters) {
      if (named && random() % 2 == 0) visit.parameters[p.name] = uniform(random, p.lower, p.upper);
    }
    const OrderReply opened = open(visit);
    ASSERT_TRUE(opened.accepted) << opened.reason;
    std::map<std::string, double> expected = ofFile();
    for (const auto& [name, value] : visit.parameters) expected[name] = value;
    EXPECT_EQ(values(), expected);
    EXPECT_EQ(station_->status().help, visit.help);
    EXPECT_EQ(station_->scene()->hand.name, visit.hand);
    EXPECT_EQ(station_->scene()->visit.number, visit.visit);
    // Values that the therapist sets during the visit end with it.
    for (const PublishedParameter& p : station_->scene()->parameters) {
      if (random() % 2 == 0) ASSERT_TRUE(set(p.name, uniform(random, p.lower, p.upper)).accepted);
    }
    ASSERT_TRUE(ask(orders::SetHelp{Help::kSome}).accepted);
    ASSERT_TRUE(ask(orders::CloseVisit{visit.visit}).accepted);
    EXPECT_EQ(values(), ofFile());
    EXPECT_EQ(station_->status().help, Help::kUnspecified);
    EXPECT_EQ(station_->scene()->visit.number, 0U);
    EXPECT_EQ(station_->scene()->hand.name, first_hand);
  }
}

TEST_F(Visits, NextItemOfAVisit_KeepsALoweredLimit) {
  begin();
  orders::OpenVisit visit = ofVisit(7);
  visit.parameters = {{"effort_limit_arm_n", 9.0}, {"effort_limit_hand_tip_n", 4.0}};
  ASSERT_TRUE(open(visit).accepted);
  ASSERT_TRUE(set("effort_limit_arm_n", 5.0).accepted);
  visit.item = 1;
  visit.level = 2;
  ASSERT_TRUE(open(visit).accepted);
  EXPECT_EQ(values()["effort_limit_arm_n"], 5.0) << "lowered by a press in this visit";
  EXPECT_EQ(values()["effort_limit_hand_tip_n"], 4.0);
  EXPECT_EQ(station_->scene()->visit.item, 1U);
  EXPECT_EQ(station_->scene()->level, 2);
  ASSERT_TRUE(ask(orders::CloseVisit{7}).accepted);
  visit.visit = 8;
  ASSERT_TRUE(open(visit).accepted);
  EXPECT_EQ(values()["effort_limit_arm_n"], 9.0) << "another visit begins as it says";
}

// A console still shows the earlier patient and moves a slider although the next visit is already
// open, however long ago.
TEST_F(Visits, LimitRaisedForAnotherVisitThanShown_IsRefusedAndALowerOneIsObeyed) {
  begin();
  const std::uint32_t shown = station_->status().basis;
  orders::OpenVisit visit = ofVisit(9);
  visit.parameters = {{"effort_limit_arm_n", 6.0}};
  ASSERT_TRUE(open(visit).accepted);
  const auto sets = [&](std::uint32_t basis, double value) {
    Order order{orders::SetParameter{"effort_limit_arm_n", value, basis}};
    order.client = 7;
    return ask(order);
  };
  const OrderReply stale = sets(shown, 15.0);
  EXPECT_EQ(stale.refusal, Refusal::kBasisChanged);
  EXPECT_NE(stale.reason.find("visit 9"), std::string::npos) << stale.reason;
  EXPECT_EQ(sets(0, 15.0).refusal, Refusal::kOtherVersion);
  EXPECT_EQ(values()["effort_limit_arm_n"], 6.0);
  EXPECT_TRUE(sets(shown, 5.0).accepted) << "lower is safe whoever it was meant for";
  EXPECT_TRUE(sets(0, 4.0).accepted);
  EXPECT_TRUE(set("effort_limit_arm_n", 15.0).accepted);
}

// ---- the basis of a start

/// A console, client 7, presses Start or raises a limit as its person was shown it.
class BasisOfAStart : public Visits {
 protected:
  OrderReply asConsole(orders::Any what) {
    Order order{std::move(what)};
    order.client = 7;
    return ask(order);
  }
  OrderReply arm(std::uint32_t basis) {
    return asConsole(orders::Arm{station_->status().endings, basis});
  }
  OrderReply raise(double value, std::uint32_t basis) {
    return asConsole(orders::SetParameter{"effort_limit_arm_n", value, basis});
  }
  [[nodiscard]] std::uint32_t basis() const { return station_->status().basis; }
};

// Before, a press 1 to 300 ms after the visit was opened started the next patient with the other
// hand and another limit.
TEST_F(BasisOfAStart, StartOnAConsoleThatShowsThePreviousVisit_StartsNothing) {
  begin();
  auto random = seededRandom(5805);
  const std::vector<std::string> hands = {"man-p50-right", "woman-p05-left"};
  for (int i = 1; i <= cases(60) && !HasFailure(); ++i) {
    orders::OpenVisit visit = ofVisit(static_cast<std::uint64_t>(i));
    visit.hand = hands[random() % hands.size()];
    visit.parameters = {{"effort_limit_arm_n", uniform(random, 2.0, 20.0)}};
    const std::uint32_t before = basis();
    ASSERT_TRUE(open(visit).accepted);
    ASSERT_GT(basis(), before);
    const OrderReply stale = arm(before);
    EXPECT_EQ(stale.refusal, Refusal::kBasisChanged);
    EXPECT_NE(stale.reason.find("visit " + std::to_string(i)), std::string::npos) << stale.reason;
    visit.item = 1;
    visit.level = 2;
    const std::uint32_t first_item = basis();
    ASSERT_TRUE(open(visit).accepted);
    EXPECT_EQ(arm(first_item).refusal, Refusal::kBasisChanged);
    ASSERT_TRUE(ask(orders::CloseVisit{visit.visit}).accepted);
  }
  EXPECT_EQ(records_, 0U) << kAlways << "armed another person than shown";
  EXPECT_EQ(station_->status().session, 0U);
  EXPECT_EQ(arm(0).refusal, Refusal::kOtherVersion);
  EXPECT_EQ(arm(basis() + 1).refusal, Refusal::kBasisChanged);
  EXPECT_TRUE(arm(basis()).accepted) << "who was shown it may start";
}

TEST_F(BasisOfAStart, ChangesThatConcernTheStart_ChangeTheNumber) {
  begin();
  const auto changes = [&](orders::Any what) {
    const std::uint32_t before = basis();
    Order order = of(std::move(what));
    order.may_raise_limits = true;
    const OrderReply reply = ask(order);
    EXPECT_TRUE(reply.accepted) << reply.reason;
    return basis() != before;
  };
  EXPECT_TRUE(changes(kLoadLevel2));
  EXPECT_FALSE(changes(kLoadLevel2)) << "the same level again";
  EXPECT_TRUE(changes(orders::LoadExercise{.exercise = "free-grasping"}));
  EXPECT_TRUE(changes(orders::LoadExercise{.hand = "woman-p05-left"}));
  EXPECT_TRUE(changes(orders::LoadExercise{.hand = "woman-p05-right"}));
  EXPECT_FALSE(changes(orders::SetParameter{"effort_limit_arm_n", 5.0})) << "lower is safer";
  EXPECT_TRUE(changes(orders::SetParameter{"effort_limit_arm_n", 6.0}));
  EXPECT_FALSE(changes(orders::SetParameter{"effort_limit_arm_n", 6.0}));
  EXPECT_FALSE(changes(orders::SetParameter{"damping_decay_s", 0.5}));
  EXPECT_FALSE(changes(orders::SetHelp{Help::kFull}));
  EXPECT_FALSE(changes(orders::Stop{}));
}

// The game's Start with another level sends a load and an order to arm, both as the person saw it
// before. A slider that is dragged upwards sends many orders.
TEST_F(BasisOfAStart, ChangesByTheClientItself_DoNotRefuseItsStart) {
  begin();
  const std::uint32_t shown = basis();
  ASSERT_TRUE(raise(2.0, shown).accepted) << "it lowers the limit";
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(raise(3.0 + 0.1 * i, shown).accepted);
  ASSERT_TRUE(asConsole(kLoadLevel2).accepted);
  ASSERT_GT(basis(), shown + 50);
  EXPECT_TRUE(arm(shown).accepted);
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(set("effort_limit_arm_n", 15.0).accepted) << "another client";
  const OrderReply stale = arm(shown);
  EXPECT_EQ(stale.refusal, Refusal::kBasisChanged);
  EXPECT_NE(stale.reason.find("effort_limit_arm_n = 15 N"), std::string::npos) << stale.reason;
  EXPECT_EQ(raise(20.0, shown).refusal, Refusal::kBasisChanged);
}

// Opening a visit can throw, as when memory runs out or a file disappears.
TEST_F(Visits, OpeningThatThrows_LeavesNoVisitOpen) {
  std::atomic<bool> throws{true};
  StationConfig config = barConfig();
  config.visit_hands_folder = folder_ + "/hands";
  config.make_player = [&throws, make = config.make_player](const Models& models) {
    if (throws) throw std::bad_alloc();
    return make(models);
  };
  load(config);
  run(false);
  const auto before = values();
  orders::OpenVisit visit = ofVisit(77);
  visit.exercise = "free-grasping";
  visit.parameters = {{"effort_limit_arm_n", 3.0}};
  EXPECT_EQ(open(visit).refusal, Refusal::kFailed);
  EXPECT_EQ(values(), before);
  throws = false;
  visit.visit = 78;
  const OrderReply next = open(visit);
  EXPECT_TRUE(next.accepted) << next.reason;
  EXPECT_EQ(station_->scene()->visit.number, 78U);
  quit();
}

TEST_F(Visits, OrdersForAnotherPersonDuringAVisit_AreRefused) {
  begin();
  ASSERT_TRUE(open(ofVisit(3)).accepted);
  const auto before = values();
  EXPECT_EQ(open(ofVisit(4)).refusal, Refusal::kVisitOpen);
  EXPECT_EQ(ask(orders::CloseVisit{4}).refusal, Refusal::kVisitOpen);
  EXPECT_EQ(ask(orders::SaveProfile{"p-1"}).refusal, Refusal::kVisitOpen);
  EXPECT_EQ(ask(orders::LoadProfile{"p-1"}).refusal, Refusal::kVisitOpen);
  EXPECT_EQ(ask(orders::LoadExercise{.hand = "woman-p05-left"}).refusal, Refusal::kVisitOpen);
  EXPECT_EQ(values(), before);
  EXPECT_TRUE(ask(orders::LoadExercise{.level = 2}).accepted) << "the therapist changes the level";
  EXPECT_EQ(station_->scene()->visit.number, 3U);
  EXPECT_EQ(station_->scene()->hand.name, "man-p50-right");
}

TEST_F(Visits, RefusedVisit_ChangesNothing) {
  begin();
  const auto before = values();
  const auto refuses = [&](const std::function<void(orders::OpenVisit&)>& change) {
    orders::OpenVisit visit = ofVisit(5);
    change(visit);
    const OrderReply reply = open(visit);
    EXPECT_FALSE(reply.accepted);
    EXPECT_FALSE(reply.reason.empty());
    EXPECT_EQ(values(), before);
    EXPECT_EQ(station_->scene()->visit.number, 0U);
    return reply.refusal;
  };
  using Visit = orders::OpenVisit;
  EXPECT_EQ(refuses([](Visit& v) { v.parameters["effort_limit_arm_n"] = 0.0; }),
            Refusal::kOutOfRange);
  EXPECT_EQ(refuses([](Visit& v) { v.parameters["effort_limit_arm_n"] = 1e3; }),
            Refusal::kOutOfRange);
  EXPECT_EQ(refuses([](Visit& v) { v.parameters["effort_limit_arm_n"] = std::nan(""); }),
            Refusal::kOutOfRange);
  EXPECT_EQ(refuses([](Visit& v) { v.parameters["no_such"] = 1.0; }), Refusal::kUnknownParameter);
  EXPECT_EQ(refuses([](Visit& v) { v.exercise = "none"; }), Refusal::kUnknownExercise);
  EXPECT_EQ(refuses([](Visit& v) { v.hand = "none"; }), Refusal::kUnknownHand);
  EXPECT_EQ(refuses([](Visit& v) { v.exercise = ""; }), Refusal::kOther);
  EXPECT_EQ(refuses([](Visit& v) { v.visit = 0; }), Refusal::kOther);
  EXPECT_EQ(refuses([](Visit& v) { v.level = 99; }), Refusal::kCannotLoad);
  for (const char* file : {"", "../hands/a.toml", "/etc/passwd", "a/b.toml", "a.txt", "..toml/"}) {
    EXPECT_EQ(refuses([&](Visit& v) {
                v.hand = "";
                v.hand_file = file;
              }),
              Refusal::kUnknownHand)
        << file;
  }
  EXPECT_EQ(refuses([](Visit& v) {
              v.hand = "";
              v.hand_file = "not-there.toml";
            }),
            Refusal::kCannotLoad);
}

// Hand files for hands of 150 to 215 mm, as the clinic's records process writes them.
TEST_F(Visits, HandFileOfTheVisit_IsLoadedFromTheRecordsFolder) {
  begin();
  std::filesystem::create_directories(folder_ + "/hands");
  std::ifstream shipped(kRoot + "/config/hands/man-p50-right.toml");
  const std::string text{std::istreambuf_iterator<char>(shipped), {}};
  const std::size_t at = text.find("length_m = ");
  for (const double length_m : {0.150, 0.168, 0.215}) {
    std::string own = text;
    own.replace(at, text.find_first_of(" \n", at + 11) - at,
                fmt::format("length_m = {:.3f}", length_m));
    std::ofstream(folder_ + "/hands/visit-9-right.toml") << own;
    orders::OpenVisit visit = ofVisit(9);
    visit.hand = "";
    visit.hand_file = "visit-9-right.toml";
    const OrderReply reply = open(visit);
    ASSERT_TRUE(reply.accepted) << reply.reason;
    EXPECT_TRUE(ask(orders::LoadExercise{.level = 2}).accepted) << "another level, the same hand";
  }
}

/// A person's limits hold in the visit and end with it; a program's own prescription is another
/// person's.
TEST_F(Visits, PrescriptionOfTheVisit_HoldsFromOpeningToClosing) {
  begin();
  std::filesystem::create_directories(folder_ + "/hands");
  const auto write = [&](const std::string& name, const std::string& side) {
    std::ofstream(folder_ + "/hands/" + name)
        << "kind = \"prescription\"\nversion = 1\nname = \"visit-9\"\nside = \"" << side
        << "\"\n[[limits]]\naxis = \"x\"\nwithin_m = [-0.07, 0.07]\n";
  };
  write("visit-9-limits.toml", "right");
  write("visit-9-left.toml", "left");
  const auto recordedSchema = [&] {
    EXPECT_TRUE(ask(orders::Arm{}).accepted);
    EXPECT_TRUE(rendersOn());
    const std::string path = station_->recordingPath(station_->scene()->recording);
    EXPECT_TRUE(ask(orders::Stop{}).accepted);
    EXPECT_TRUE(becomes(RunState::kStopped));
    return orThrow(RecordingReader::open(path))->meta().schema;
  };
  orders::OpenVisit visit = ofVisit(9);
  visit.prescription_file = "visit-9-left.toml";
  EXPECT_EQ(open(visit).refusal, Refusal::kCannotLoad) << "the other side";
  for (const char* file : {"../a.toml", "/etc/passwd", "a.txt", "not-there.toml"}) {
    visit.prescription_file = file;
    EXPECT_EQ(open(visit).refusal, Refusal::kCannotLoad) << file;
  }
  visit.prescription_file = "visit-9-limits.toml";
  const OrderReply reply = open(visit);
  ASSERT_TRUE(reply.accepted) << reply.reason;
  EXPECT_TRUE(ask(orders::LoadExercise{.level = 2}).accepted) << "the limits stay";
  EXPECT_EQ(recordedSchema(), kPrescribedSchema);
  visit.prescription_file = "";
  ASSERT_TRUE(open(visit).accepted) << "the therapist took them away";
  EXPECT_EQ(recordedSchema(), kRecordingSchema);
  // Own movement is measured without them; another exercise in the same visit has them again.
  visit.prescription_file = "visit-9-limits.toml";
  const std::string trained = std::exchange(visit.exercise, "own-range");
  ASSERT_TRUE(open(visit).accepted);
  EXPECT_EQ(recordedSchema(), kRecordingSchema);
  ASSERT_TRUE(ask(orders::LoadExercise{.exercise = trained}).accepted);
  EXPECT_EQ(recordedSchema(), kPrescribedSchema);
  ASSERT_TRUE(ask(orders::CloseVisit{9}).accepted);
  EXPECT_EQ(recordedSchema(), kRecordingSchema);
}

TEST_F(Visits, VisitOrdersWhileArmed_AreRefusedAndTheRecordingHoldsOnlyNumbers) {
  begin();
  orders::OpenVisit visit = ofVisit(1'234'567'890'123);
  visit.item = 2;
  visit.parameters = {{"effort_limit_arm_n", 3.0}};
  ASSERT_TRUE(open(visit).accepted);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  EXPECT_EQ(record.effort_limit[0], 3.0) << "from the first tick: x is an axis of the arm";
  EXPECT_EQ(open(visit).refusal, Refusal::kArmedAlready);
  EXPECT_EQ(ask(orders::CloseVisit{visit.visit}).refusal, Refusal::kArmedAlready);
  const std::string path = station_->recordingPath(station_->scene()->recording);
  EXPECT_NE(path.find("visit-1234567890123"), std::string::npos) << path;
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(ask(orders::CloseVisit{visit.visit}).accepted);
  const auto reader = RecordingReader::open(path);
  ASSERT_TRUE(reader) << format(reader.errors());
  EXPECT_EQ((*reader)->meta().clinic_visit, visit.visit);
  EXPECT_EQ((*reader)->meta().clinic_item, 2U);
  EXPECT_EQ((*reader)->meta().profile, "");
}

// If the records process is gone or no visit is open, the session starts with the clinic's gentle
// limits.
TEST_F(Visits, WithoutAnOpenVisit_TheClinicsGentleLimitsApply) {
  StationConfig config = barConfig();
  config.rehearse = false;
  config.visit_hands_folder = folder_ + "/hands";
  config.first_parameters = {{"effort_limit_arm_n", 6.0}, {"no_such_parameter", 1.0}};
  load(config);
  run(false);
  EXPECT_EQ(values()["effort_limit_arm_n"], 6.0);
  orders::OpenVisit visit = ofVisit(2);
  visit.parameters = {{"effort_limit_arm_n", 12.0}};
  ASSERT_TRUE(open(visit).accepted);
  EXPECT_EQ(values()["effort_limit_arm_n"], 12.0);
  ASSERT_TRUE(ask(orders::CloseVisit{2}).accepted);
  EXPECT_EQ(values()["effort_limit_arm_n"], 6.0);
  Order other_hand = of(orders::LoadExercise{.hand = "woman-p05-left"});
  other_hand.may_raise_limits = true;
  ASSERT_TRUE(ask(other_hand).accepted);
  EXPECT_EQ(values()["effort_limit_arm_n"], 6.0);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  EXPECT_EQ(record.effort_limit[0], 6.0);
}

// The clinic's limit is below the range of this device; the lower end of the range applies.
TEST_F(Visits, GentleLimitBelowTheRange_IsRaisedToTheLowerEnd) {
  StationConfig config = barConfig();
  config.rehearse = false;
  config.visit_hands_folder = folder_ + "/hands";
  config.first_parameters = {{"effort_limit_arm_n", 1e-3}};
  load(config);
  run(false);
  const auto least = [this] {
    for (const PublishedParameter& p : station_->scene()->parameters) {
      if (p.name == "effort_limit_arm_n") return p.lower;
    }
    return 0.0;
  };
  ASSERT_GT(least(), 1e-3);
  EXPECT_EQ(values()["effort_limit_arm_n"], least());
  ASSERT_TRUE(ask(orders::LoadExercise{.hand = "woman-p05-left"}).accepted) << "a player's";
  EXPECT_EQ(values()["effort_limit_arm_n"], least());
}

// The rehearsal takes place when the visit is opened, so that nobody waits for it when the session
// is armed.
TEST_F(Visits, OpenVisit_RehearsesTheHandAndArmingDoesNotRepeatIt) {
  StationConfig config = barConfig();
  config.visit_hands_folder = folder_ + "/hands";
  load(config);
  run(false);
  const OrderReply reply = open(ofVisit(6));
  ASSERT_TRUE(reply.accepted) << reply.reason;
  EXPECT_TRUE(logContains("rehearsal "));
  const std::size_t said = log().rfind("rehearsal ");
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(log().rfind("rehearsal "), said);
}

TEST_F(Visits, HandThatFailsItsRehearsal_OpensNoVisit) {
  StationConfig config = barConfig();
  config.visit_hands_folder = folder_ + "/hands";
  config.rehearsal.allowed_period_share = 1e-6;  // 1 ns
  load(config);
  run(false);
  const auto before = values();
  orders::OpenVisit visit = ofVisit(6);
  visit.parameters = {{"effort_limit_arm_n", 3.0}};
  const OrderReply reply = open(visit);
  EXPECT_EQ(reply.refusal, Refusal::kRehearsalFailed) << reply.reason;
  EXPECT_EQ(station_->scene()->visit.number, 0U);
  EXPECT_EQ(values(), before);
}

TEST_F(Visits, VisitWithoutAClinic_IsRefused) {
  run(false);
  EXPECT_EQ(open(ofVisit(1)).refusal, Refusal::kNotHere);
}

}  // namespace
}  // namespace wholehand::test
