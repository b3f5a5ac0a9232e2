// Motions of other programs: heads of OptiTrack Motive and Vicon Nexus as their manuals describe
// them, columns of a hand tracker and of a hand model. Expected values: the cells, in m, s and rad,
// with z up.
#include "files/patient/motion_file.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/mocap_files.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

const char* const kTracker =
    "timestamp,hand_type,palm_position_x,palm_position_y,palm_position_z,pinch\n"
    "1000000,right,10,20,30,0.5\n1010000,right,11,20,30,0.5\n";

const char* const kHandModel = "frame,theta_0,theta_1\n0,0.1,0.2\n1,0.2,0.3\n2,0.3,0.4\n";

class Motions : public ::testing::Test {
 protected:
  Expected<MotionFile> read(const std::string& motion, const std::string& columns = "") {
    std::ofstream(path_) << (columns.empty() ? "" : "# columns: " + columns + "\n") << motion;
    return loadMotionFile(path_);
  }
  std::string refusal(const std::string& motion, const std::string& columns = "") {
    const auto read_motion = read(motion, columns);
    return read_motion ? "" : format(read_motion.errors());
  }

  const Folder folder_;
  const std::string path_ = folder_.path() + "/motion.csv";
};

TEST_F(Motions, OfMotive_AreReadInItsUnitsWithZUp) {
  const auto motion = read(kMotive,
                           "Wrist Position X = x, Wrist Position Y = y, Wrist Position Z = z, "
                           "Wrist Rotation X = finger_flexion, up = y");
  ASSERT_TRUE(motion) << format(motion.errors());
  EXPECT_EQ(motion->columns, (std::vector<std::string>{"finger_flexion", "x", "y", "z"}));
  EXPECT_EQ(motion->time_s, (std::vector<double>{0.0, 0.01, 0.02}));
  ASSERT_EQ(motion->samples.size(), 3U);
  const std::vector<double> last{std::numbers::pi / 2.0, 0.12, -0.31, 0.2};  // x, -z, y
  for (std::size_t i = 0; i < last.size(); ++i) EXPECT_NEAR(motion->samples[2][i], last[i], 1e-12);
}

TEST_F(Motions, OfNexus_AreTimedByTheirRateAndRowsWithoutAMarkerAreLeftOut) {
  const auto motion = read(kNexus, "RWRI X = x");
  ASSERT_TRUE(motion) << format(motion.errors());
  EXPECT_EQ(motion->columns, (std::vector<std::string>{"x"}));
  ASSERT_EQ(motion->time_s.size(), 3U);
  const double expected[3][2] = {{0.5, 1e-3}, {0.51, 2e-3}, {0.515, 3e-3}};  // frame / 200 Hz, mm
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(motion->time_s[i], expected[i][0], 1e-12);
    EXPECT_NEAR(motion->samples[i][0], expected[i][1], 1e-15);
  }
  std::string notices;
  for (const Diagnostic& notice : motion->notices) notices += format(notice) + "\n";
  EXPECT_TRUE(contains(notices, "1 row without a value of a column that is read, left out"))
      << notices;
}

// Nexus writes force plates before the markers, other sections after them, and drops empty cells.
TEST_F(Motions, OfNexusBetweenOtherSections_AreFound) {
  const std::string content =
      "\n\nDevices\n1000\n,,Plate\nFrame,Sub Frame,Fx\n,,N\n1,0,5\n1,1,6\n\n"
      "Trajectories\n100\n,,A:RWRI\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n"
      "1,0,1,2,3,\n2,0,2,2\n3,0,3,2,3\n4,0\n\nModel Outputs\n100\n,,A:Angle\n"
      "Frame,Sub Frame,X\n,,deg\n1,0,99\n";
  const auto motion = read(content, "RWRI X = x, RWRI Z = z, up = z");
  ASSERT_TRUE(motion) << format(motion.errors());
  EXPECT_EQ(motion->samples, (std::vector<std::vector<double>>{{1e-3, 3e-3}, {3e-3, 3e-3}}));
  ASSERT_EQ(motion->time_s.size(), 2U);
  EXPECT_NEAR(motion->time_s[1] - motion->time_s[0], 0.02, 1e-12);
}

TEST_F(Motions, OfAHandTracker_TakeUnitsFromTheMap) {
  const auto motion = read(kTracker,
                           "timestamp = time_us, palm_position_x = x_mm, palm_position_y = y_mm, "
                           "palm_position_z = z_mm, up = y");
  ASSERT_TRUE(motion) << format(motion.errors());
  EXPECT_NEAR(motion->time_s[1] - motion->time_s[0], 0.01, 1e-12);
  const std::vector<double> first{0.010, -0.030, 0.020};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(motion->samples[0][i], first[i], 1e-12);
}

TEST_F(Motions, WithoutATime_AreTimedByTheRateOfTheMap) {
  const auto motion = read(kHandModel, "rate_hz = 25, theta_1 = finger_flexion_rad");
  ASSERT_TRUE(motion) << format(motion.errors());
  ASSERT_EQ(motion->time_s.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(motion->time_s[i], static_cast<double>(i) / 25.0, 1e-12);
  EXPECT_EQ(motion->samples[2], (std::vector<double>{0.4}));
}

// Heads in the form of public files of motion capture, hand trackers and head-mounted displays.
const char* const kOtherHeads[] = {
    "Time (ms),Wrist X,Wrist Y,Wrist Z\n0,1,2,3\n10,1,2,3\n",
    "frame,wrist_x,wrist_y,wrist_z,thumb\n0,1,2,3,4\n1,1,2,3,4\n",
    "elapsed;s,Hand.X,Hand.Y,Hand.Z\n0,1,2,3\n1,1,2,3\n",
    // Motive: a rigid body, and its version 1.25 with parents and empty cells at the end.
    "Format Version,1.23,Take Name,T,Length Units,Meters,Rotation Type,Quaternion\n\n"
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n"
    ",Name,Hand,Hand,Hand,Hand,Hand,Hand,Hand\n,ID,1,1,1,1,1,1,1\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,,\n0,0,0,0,0,1,0.1,0.2,0.3,,,\n"
    "1,0.01,0,0,0,1,0.1,0.2,0.3,,,\n2,0.02,,,,,,,,,,\n3,0.03,0,0,0,1,0.1,0.2,0.3,,,\n",
    "Format Version,1.25,Take Name,T,Length Units,Millimeters\n\n,Type,Marker,Marker,Marker\n"
    ",Name,A:RWRB,A:RWRB,A:RWRB\n,ID,9F:1,9F:1,9F:1\n,Parent,,,\n,,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z\n0,0,496.1,516.1,2854.7\n1,0.008333,496.2,516.1,2854.6\n",
    // Vicon Tracker, and a Nexus file of segments.
    "Objects\n100\n,,Global Angle (Quaternion) Hand:Hand,,,,,,,\n"
    "Frame,Sub Frame,RX,RY,RZ,RW,TX,TY,TZ,\n,,,,,,mm,mm,mm,\n"
    "1,0,0,0,0,1,10,20,30,\n2,0,0,0,0,1,11,20,30,\n",
    "Segments\n200\n,,S:Hand,,,,,\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n,,deg,deg,deg,mm,mm,mm\n"
    "1,0,0,0,0,10,20,30\n2,0,0,0,0,11,20,30\n",
    // Trackers of hands: times without a unit, in a column of their own or as a text.
    "frame_id,timestamp,hand_position_x,hand_position_y,hand_position_z,pitch,roll,yaw\n"
    "1,85334234,12.1,180.2,-3.4,0.1,0.2,0.3\n2,85343123,12.3,180.9,-3.4,0.1,0.2,0.3\n",
    "frame,hand_number,wrist_x,wrist_y,wrist_z,thumb_cmc_x,thumb_cmc_y,thumb_cmc_z\n"
    "0,0,0.51,0.42,0.01,0.5,0.4,0\n1,0,0.52,0.42,0.01,0.5,0.4,0\n",
    "timestamp,Wrist_x,Wrist_y,Wrist_z,Wrist_qx,Wrist_qy,Wrist_qz,Wrist_qw\n"
    "1000000000,0.1,0.2,0.3,0,0,0,1\n1011111111,0.1,0.2,0.3,0,0,0,1\n",
    "RowType,Subject,UnixTime_s,ObjectName,Wrist_x,Wrist_y,Wrist_z\n"
    "frame,P01,1700000000.011,cup,0.1,1.2,0.3\nframe,P01,1700000000.025,cup,0.1,1.2,0.3\n",
    "frame_t_ms,target_frame,palm_x,palm_y,palm_z,yaw,pitch,roll,grip\n"
    "0,reach,0.1,0.2,0.3,0,0,0,0\n16,reach,0.1,0.2,0.3,0,0,0,0.1\n",
    "Frame,UnityTime,PosX,PosY,PosZ,AngleX,AngleY,AngleZ,Events\n"
    "1,0.011,0.1,1.2,0.3,0,0,0,\n2,0.022,0.1,1.2,0.3,0,0,0,\n",
    "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z "
    "[]\n"
    "1403636580838555648,4.6,-1.7,0.7,0.5,0.1,-0.8,-0.1\n"
    "1403636580843555328,4.6,-1.7,0.7,0.5,0.1,-0.8,-0.1\n",
    "datetime,x0,y0,z0,x1,y1,z1\n2021-03-04 10:00:00.010,0.5,0.4,0,0.6,0.4,0\n"
    "2021-03-04 10:00:00.043,0.5,0.4,0,0.6,0.4,0\n",
    "time,x,y,z\n0,10,20,30\n0.01,11,20,30\n0.02,12,20,30\n",
    "time,palm_x,palm_y,palm_z,pinch\n0.01,1,2,3,0\n0.02,,,,\n0.03,nan,nan,nan,0\n0.04,1,2,3,0\n",
};

// Spreadsheets divide columns by semicolons or tabs where the comma is the decimal point. Each
// drawn table is written both ways: the same values are read, or both are refused.
TEST_F(Motions, DividedBySemicolonsOrTabs_AreReadAsThoseOfCommas) {
  auto random = seededRandom(6211);
  for (int n = 0; n < cases(60); ++n) {
    const int rows = 2 + static_cast<int>(random() % 60);
    const char divider = random() % 2 == 0 ? ';' : '\t', point = random() % 3 > 0 ? ',' : '.';
    const bool named = random() % 2 == 0;  // as another program names them
    std::vector<std::string> lines{named ? "Time (s),X (mm),Y (mm),Z (mm)" : "time_s,x_m,y_m,z_m"};
    for (int i = 0; i < rows; ++i) {
      lines.push_back(fmt::format("{:.3f}", 0.01 * i));
      for (int axis = 0; axis < 3; ++axis) {
        lines.back() += fmt::format(",{:.{}f}", uniform(random, -0.5, 0.5), random() % 5);
      }
    }
    const std::string head = named ? "# up = y\n" : "";
    std::string commas = head, others = head;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      commas += lines[i] + "\n";
      for (const char c : lines[i]) others += c == ',' ? divider : c == '.' && i > 0 ? point : c;
      others += "\r\n";
    }
    const auto a = read(commas), b = read(others);
    ASSERT_TRUE(a) << format(a.errors());
    ASSERT_TRUE(b) << format(b.errors());
    EXPECT_EQ(a->samples, b->samples);
    EXPECT_EQ(a->time_s, b->time_s);
    EXPECT_EQ(contains(format(b->notices), "has decimal commas: \"0,5\" is read as 0.5"),
              point == ',');
  }
}

TEST_F(Motions, DividedBySemicolons_AreNotReadWhereACommaMayStandBetweenThousands) {
  const std::string head = "time_s;x_mm\n";
  EXPECT_TRUE(contains(refusal(head + "0;1,234\n0.5;1,235\n"),
                       ":2: has decimal commas, and decimal points in line 3"));
  EXPECT_TRUE(contains(refusal(head + "0;1.234,5\n1;1.235,5\n"), "= 1.234,5: is not a number"));
  EXPECT_TRUE(contains(refusal(head + "0;1,234,567\n1;1,234,568\n"), "is not a number"));
  EXPECT_TRUE(contains(refusal("time_s,x_mm\n0,1,5\n1,2,5\n"), "has 3 values"));
  const auto read_motion = read("sep=;\n\"time_s\";\"x_m\"\n0;\"0,25\"\n1;\"0,5\"\n");
  ASSERT_TRUE(read_motion) << format(read_motion.errors());
  EXPECT_EQ(read_motion->samples, (std::vector<std::vector<double>>{{0.25}, {0.5}}));
}

// An empty cell before a tab is a cell: a row of a marker that was not seen is not shifted.
TEST_F(Motions, DividedByTabs_KeepEmptyCellsAtTheEnds) {
  const auto motion = read("Tip X\tTip Y\tTip Z\n\t5\t6\n1\t2\t3\n4\t5\t\n7\t8\t9\n",
                           "Tip X = x_m, Tip Y = y_m, Tip Z = z_m, up = z, rate_hz = 100");
  ASSERT_TRUE(motion) << format(motion.errors());
  EXPECT_EQ(motion->samples, (std::vector<std::vector<double>>{{1, 2, 3}, {7, 8, 9}}));
  EXPECT_EQ(motion->time_s, (std::vector<double>{0.01, 0.03}));
}

// A motion with a row for each landmark of each hand, in drawn numbers, orders and names. The line
// of the refusal keeps one of them; without it the parts would play one after the other.
TEST_F(Motions, WithARowForEachPartOfAHand_ArePlayedByOneOfThem) {
  auto random = seededRandom(6212);
  for (int n = 0; n < cases(40); ++n) {
    const int hands = 1 + static_cast<int>(random() % 2),
              parts = 2 + static_cast<int>(random() % 20);
    const bool numbered = random() % 2 == 0, timed = random() % 2 == 0;
    const int kept = numbered ? 0 : static_cast<int>(random() % parts);  // the wrist
    std::string content = timed ? "timestamp,Hand,Part,X,Y,Z\n" : "Frame,Hand,Part,X,Y,Z\n";
    std::vector<std::vector<double>> expected;
    for (int frame = 0; frame < 6; ++frame) {
      for (int hand = 0; hand < hands; ++hand) {
        for (int part = 0; part < parts; ++part) {
          const std::string name = numbered       ? std::to_string(part)
                                   : part == kept ? "wrist"
                                                  : "tip" + std::to_string(part);
          const double x = 0.001 * (frame + part) + 0.1 * hand;
          content += fmt::format(
              "{},{},{},{:.4f},0.2,0.3\n",
              timed ? fmt::format("{:.3f}", 0.01 * frame) : std::to_string(frame), hand, name, x);
          if (hand == 0 && part == kept) expected.push_back({x, -0.3, 0.2});
        }
      }
    }
    const std::string why = refusal(content), mark = "# columns: ";
    const auto begin = why.find(mark);
    ASSERT_NE(begin, std::string::npos) << content << why;
    const std::string line = why.substr(begin + mark.size());
    const auto motion = read(content, line.substr(0, line.find('\n')));
    ASSERT_TRUE(motion) << format(motion.errors()) << line;
    ASSERT_EQ(motion->samples.size(), 6U) << line;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(motion->samples[i][k], expected[i][k], 1e-12) << line;
      }
    }
    EXPECT_TRUE(contains(refusal(content, "X = x_m, Y = y_m, Z = z_m, up = y, rate_hz = 30"),
                         timed ? "several rows" : "each frame has several rows"));
  }
  EXPECT_TRUE(
      contains(refusal("Frame,Part,X\n0,a,1\n1,a,2\n", "X = x_m, Part = only b, rate_hz = 9"),
               "has no row of samples that its line # columns keeps"));
  EXPECT_TRUE(
      contains(refusal("Frame,Part,X\n0,a,1\n1,a,2\n", "X = x_m, Par = only a, rate_hz = 9"),
               "Par = only a: names no column of the motion"));
}

// A user writes the line that the refusal prints, and the motion plays.
TEST_F(Motions, OfEveryKind_ArePlayedWithTheLineOfTheRefusal) {
  std::vector<const char*> all{kMotive, kNexus, kHandModel, kTracker};
  all.insert(all.end(), std::begin(kOtherHeads), std::end(kOtherHeads));
  for (const char* content : all) {
    const std::string why = refusal(content), mark = "# columns: ";
    const auto begin = why.find(mark);
    ASSERT_NE(begin, std::string::npos) << content << why;
    const bool is_place = std::string(content).find("theta") == std::string::npos;
    EXPECT_EQ(contains(why, " = finger_flexion"), !is_place) << why;
    for (const char* axis : {" = x", " = y", " = z"}) {
      EXPECT_EQ(contains(why, axis), is_place) << why;
    }
    const std::string line = why.substr(begin + mark.size());
    const auto motion = read(content, line.substr(0, line.find('\n')));
    ASSERT_TRUE(motion) << format(motion.errors()) << "\nwith " << why;
    EXPECT_GE(motion->samples.size(), 2U) << content;
    EXPECT_LE(motion->time_s.back() - motion->time_s.front(), 1.0) << line;  // all are short
  }
}

// The line names the column of the time with the unit at which its rows come at a tracker's rate.
TEST_F(Motions, WithATimeOfUnknownUnit_AreProposedTheLikelyOne) {
  const auto proposed = [&](const std::string& name, const std::string& a, const std::string& b) {
    const std::string why =
        refusal(name + ",Tip X,Tip Y,Tip Z\n" + a + ",1,2,3\n" + b + ",1,2,3\n");
    return why.substr(why.rfind(", ") + 2);
  };
  EXPECT_EQ(proposed("Timestamp", "0", "0.01"), "Timestamp = time_s");
  EXPECT_EQ(proposed("timestamp", "1700000000000", "1700000000008"), "timestamp = time_ms");
  EXPECT_EQ(proposed("timestamp", "1700000000000000", "1700000000008000"), "timestamp = time_us");
  EXPECT_EQ(proposed("sensor_timestamp", "85334234000", "85343123000"),
            "sensor_timestamp = time_ns");
  EXPECT_EQ(proposed("device_ms", "3", "11"), "device_ms = time");
  EXPECT_EQ(proposed("timestamp", "10:00:00.01", "10:00:00.02"), "rate_hz = 120");
  EXPECT_EQ(proposed("timestamp", "5", "5"),
            "rate_hz = 120");  // two hands a frame, or whole seconds
}

// A line that reads a rate of turn or a part of a quaternion as a place would play, wrongly.
TEST_F(Motions, OtherQuantities_AreNotProposedAsPlaces) {
  for (const char* head :
       {"Time (s),Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s)",
        "Time (s),Accelerometer X (g),Accelerometer Y (g),Accelerometer Z (g)",
        "Time (s),W,Hand X,Hand Y,Hand Z", "Time (s),Hand X,Hand Y,Hand Z,Hand W",
        "Time (s),quat_x,quat_y,quat_z", "frame,Wrist Rotation X,Wrist Rotation Y,Wrist Rotation Z",
        "Time (s),Roll | X (degrees),Pitch | Y (degrees),Yaw | Z (degrees)", "Time (s),Q0,Qx,Qy,Qz",
        "Time (s),palm_qx,palm_qy,palm_qz", "Time (s),X_inch,Y_inch,Z_inch",
        "Time (s),palm_normal_x,palm_normal_y,palm_normal_z",
        "Time (s),Battery (V),Thermometer (degrees C)"}) {
    std::string content = std::string(head) + "\n0,1,2,3,4\n1,1,2,3,4\n";
    EXPECT_TRUE(contains(refusal(content), "none is named as a place or an angle")) << head;
  }
  // Beside them, the place and the angle are found.
  EXPECT_TRUE(contains(refusal("Time (s),acc_x,acc_y,acc_z,Tip X,Tip Y,Tip Z\n0,1,2,3,4,5,6\n"),
                       "# columns: Tip X = x_mm, Tip Y = y_mm, Tip Z = z_mm, up = y"));
  // Of several places that of the hand.
  EXPECT_TRUE(contains(refusal("Time (s),Cup X,Cup Y,Cup Z,Palm X,Palm Y,Palm Z\n0,4,5,6,7,8,9\n"),
                       "# columns: Palm X = x_mm, Palm Y = y_mm"));
  EXPECT_TRUE(contains(refusal("Time (s),gyro_x,flexion,Light (lx)\n0,1,2,3\n1,1,2,3\n"),
                       "# columns: flexion = finger_flexion_deg"));
}

// Motive writes the bones and the markers of a skeleton, some by one name.
TEST_F(Motions, OfMotiveWithABoneAndAMarkerOfOneName_AreRead) {
  const std::string content =
      "Format Version,1.25,Length Units,Millimeters,Rotation Type,Quaternion\n\n"
      ",Type,Bone,Bone,Bone,Bone Marker,Bone Marker,Bone Marker\n"
      ",Name,A:Arm,A:Arm,A:Arm,A:Arm,A:Arm,A:Arm\n,ID,1,1,1,2,2,2\n"
      ",,Position,Position,Position,Position,Position,Position\n"
      "Frame,Time (Seconds),X,Y,Z,X,Y,Z\n0,0,1,2,3,11,12,13\n1,0.01,1,2,3,11,12,13\n";
  const auto bone = read(content, "A:Arm Position X = x");
  ASSERT_TRUE(bone) << format(bone.errors());
  EXPECT_EQ(bone->samples[0], (std::vector<double>{1e-3}));
  const auto marker = read(content, "A:Arm Bone Marker Position X = x");
  ASSERT_TRUE(marker) << format(marker.errors());
  EXPECT_EQ(marker->samples[0], (std::vector<double>{11e-3}));
}

TEST_F(Motions, WrongMaps_AreNamed) {
  const struct {
    const char *columns, *words;
  } wrong[] = {
      {"Palm X = x", "Palm X = x: names no column of the motion"},
      {"up = y, RWRI X = x, RWRI Z = z", "needs both columns, y and z"},
      {"up = x, RWRI X = x", "is no axis that may point up"},
      {"rate_hz = -1.0, RWRI X = x", "is no rate; must be in (0, 100000] Hz"},
      {"rate_hz = 120 Hz, RWRI X = x", "is no rate"},
      {"rate_hz = 50, RWRI X = x", "stands beside a time: the column Frame"},
      {"RWRI X = elbow", "no known axis"},
      {"RWRI X = finger_flexion", "is a rotation: use _rad"},
      {"RWRI X = x, RFIN X = x", "stands there twice"},
      {"RWRI X = x, RFIN X = x_cm", "once more"},
      {"RWRI X = x, RWRI X = y", "names this column twice"},
      {"RWRI X = x, RWRI Y = y, RWRI Z = z", "does not say which of its axes points up"},
      {"RWRI X", "says nothing of a column"},
      {"Sub Frame = pitch, RWRI X = x", "column 2 = pitch: has no known unit"},
  };
  for (const auto& [columns, words] : wrong) {
    EXPECT_TRUE(contains(refusal(kNexus, columns), words)) << columns << refusal(kNexus, columns);
  }
}

TEST_F(Motions, DamagedHeads_AreRefusedAndNothingCrashes) {
  const std::string whole = kNexus, motive = kMotive;
  for (std::size_t cut = 1; cut < whole.size(); cut += 5) (void)read(whole.substr(0, cut));
  for (std::size_t cut = 1; cut < motive.size(); cut += 5) (void)read(motive.substr(0, cut));
  // A motion that is read has a whole sample at every time, and times that increase.
  std::mt19937_64 random(seed());
  for (const std::string head : kOtherHeads) {
    for (int draw = 0; draw < 20; ++draw) {
      std::string damaged = head;
      damaged[random() % head.size()] = ",\n;=\"#nx9 "[random() % 10];
      if (draw % 2 == 0) damaged.erase(random() % head.size(), 1 + random() % 8);
      const auto motion = read(damaged, draw % 3 == 0 ? "wrist_x = x_mm, up = y" : "");
      if (!motion) continue;
      EXPECT_EQ(motion->samples.size(), motion->time_s.size()) << damaged;
      for (const auto& sample : motion->samples) EXPECT_EQ(sample.size(), motion->columns.size());
      EXPECT_TRUE(std::is_sorted(motion->time_s.begin(), motion->time_s.end())) << damaged;
    }
  }
  EXPECT_TRUE(contains(refusal("a,b,c\n1,2,\n2,3,\n3,4,5\n", "c = x_mm, rate_hz = 50"),
                       "has 1 row with a value of every column that is read"));
  EXPECT_TRUE(
      contains(refusal("a,b,c\n1,2,\n2,3,\n", "c = x_mm, rate_hz = 50"), "has 0 rows with"));
  EXPECT_TRUE(contains(refusal("Devices\n1000\n,,Plate\nFrame,Sub Frame,Fx\n,,N\n1,0,5\n2,0,5\n"),
                       "holds no positions: only a section such as Devices"));
  EXPECT_TRUE(contains(refusal("Trajectories\n200\n1,2,3\n4,5,6\n7,8,9\n"),
                       "names do not stand where they should"));
}

}  // namespace
}  // namespace wholehand::test
