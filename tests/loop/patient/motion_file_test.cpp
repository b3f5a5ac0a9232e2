#include "files/patient/motion_file.hpp"

#include "loop/patient/motion.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace wholehand::test {
namespace {

std::string written(const std::string& content) {
  const std::string path = ::testing::TempDir() + "wholehand_motion_" +
                           ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

/// The file's faults, one per line.
std::string faultsOf(const std::string& content, const DeviceModel* device = nullptr) {
  const std::string path = written(content);
  const Expected<MotionFile> motion = loadMotionFile(path, device);
  std::filesystem::remove(path);
  return motion.ok() ? "" : format(motion.errors());
}

DeviceModel sled() {
  DeviceModel device;
  device.name = "sled";
  DeviceAxis axis;
  axis.name = "index_flexion";
  axis.kind = AxisKind::kRotation;
  device.axes = {axis};
  return device;
}

#define EXPECT_CONTAINS(text, part) \
  EXPECT_TRUE(contains((text), part)) << "it says instead:\n" << (text)

TEST(MotionFile, ValidFile_IsReadAndItsUnitsRemoved) {
  const std::string path = written(
      "\xEF\xBB\xBF# recorded by hand\r\ntime_s, x_m ,finger_flexion_rad\r\n"
      "0.5,-1e-3,+0.25\r\n\r\n0.51, 2e-3 ,0.5\r\n");
  const MotionFile motion = orThrow(loadMotionFile(path));
  EXPECT_EQ(motion.path, path);
  EXPECT_EQ(motion.columns, (std::vector<std::string>{"x", "finger_flexion"}));
  EXPECT_EQ(motion.time_s, (std::vector<double>{0.5, 0.51}));
  EXPECT_EQ(motion.samples, (std::vector<std::vector<double>>{{-1e-3, 0.25}, {2e-3, 0.5}}));
}

TEST(MotionFile, TimeColumn_MayBeAnywhere) {
  const std::string path = written("x_m,time_s,z_m\n1,0,3\n4,1,6\n");
  const MotionFile motion = orThrow(loadMotionFile(path));
  EXPECT_EQ(motion.columns, (std::vector<std::string>{"x", "z"}));
  EXPECT_EQ(motion.samples[1], (std::vector<double>{4.0, 6.0}));
}

TEST(MotionFile, MissingOrUnreadableFile_IsReported) {
  EXPECT_CONTAINS(format(loadMotionFile("/no/such/motion.csv").errors()),
                  "/no/such/motion.csv: cannot be opened");
  EXPECT_CONTAINS(format(loadMotionFile(::testing::TempDir()).errors()), "not a folder");
}

TEST(MotionFile, EmptyOrTooShort_IsRefused) {
  EXPECT_CONTAINS(faultsOf(""), "is empty");
  EXPECT_CONTAINS(faultsOf("\n# nothing\n\n"), "is empty");
  EXPECT_CONTAINS(faultsOf("time_s,x_m\n"), "has no row of samples");
  EXPECT_CONTAINS(faultsOf("time_s,x_m\n0,0\n"), "has only 1 row of samples");
}

/// A file of another kind gets one message without raw bytes, whatever it holds.
TEST(MotionFile, FileOfAnotherKind_GetsOneMessage) {
  const auto once = [](const std::string& content) {
    const std::string faults = faultsOf(content);
    EXPECT_EQ(std::count(faults.begin(), faults.end(), '\n'), 0) << faults;
    EXPECT_TRUE(
        std::none_of(faults.begin(), faults.end(), [](unsigned char c) { return c < 0x20; }));
    EXPECT_CONTAINS(faults, "first line names the columns: time_s, x_m");
    return faults;
  };
  std::string every_byte;
  for (int i = 0; i < 1024; ++i) every_byte += static_cast<char>(i);
  EXPECT_CONTAINS(once(every_byte), "is not a CSV text");
  EXPECT_CONTAINS(faultsOf("\x89HDF\r\n\x1a\n"), "is HDF5, as recordings");
  EXPECT_CONTAINS(faultsOf(std::string("t\0i\0m\0e\0", 8)),
                  "is a text in UTF-16; save it as UTF-8");
  EXPECT_CONTAINS(once("# A scene.\nkind = \"scene\"\nversion = 1\nsize_m = [1, 2, 3]\n"),
                  ":2: is a file of kind \"scene\"");
  EXPECT_CONTAINS(once("0.0,0.1,0.2\n0.1,0.1,0.2\n"), ":1: is not a motion");  // no header
  EXPECT_CONTAINS(faultsOf("\xFF\xFEt"), "is a text in UTF-16; save it as UTF-8");
  EXPECT_CONTAINS(faultsOf("time_s x_m\n0 0\n1 1\n"), "its columns are divided by blanks");
  EXPECT_CONTAINS(once("time_s,x_m\n0,0\n1,\x01\n2,\x01\n"), ":3: is not a CSV text");
  EXPECT_CONTAINS(format(loadMotionFile("/dev/zero").errors()), "is not a file");
}

TEST(MotionFile, ValueInAMessage_IsValidUtf8) {
  EXPECT_CONTAINS(faultsOf("time_s,größe_m\n0,0\n1,1\n"), "column 2 = größe_m: is no known axis");
  EXPECT_CONTAINS(faultsOf("time_s,gr\xF6\xDF"
                           "e_m\n0,0\n1,1\n"),
                  "column 2 = gr??e_m");  // Latin-1
}

TEST(MotionFile, FaultInTheHeader_NamesItsColumn) {
  EXPECT_CONTAINS(faultsOf("x_m\n0\n1\n"), "time_s: is missing");
  EXPECT_CONTAINS(faultsOf("time_s\n0\n1\n"), "has no axis column");
  EXPECT_CONTAINS(faultsOf("time_s,x\n0,0\n1,1\n"), "column 2 = x: has no known unit");
  EXPECT_CONTAINS(faultsOf("time_s,x_in\n0,0\n1,1\n"), "column 2 = x_in: has no known unit");
  EXPECT_CONTAINS(faultsOf("time_m,x_m\n0,0\n1,1\n"), "column 1 = time_m: is a time in the unit");
  EXPECT_CONTAINS(faultsOf("time_s,x_ms\n0,0\n1,1\n"), "column 2 = x_ms: has the wrong unit");
  EXPECT_CONTAINS(faultsOf("time_s,x_m,x_mm\n0,0,0\n1,1,1\n"), "column 3 = x_mm: is the axis x");
  EXPECT_CONTAINS(faultsOf("time_s,figner_flexion_rad\n0,0\n1,1\n"),
                  "column 2 = figner_flexion_rad: is no known axis; use one of x, y, z");
  EXPECT_CONTAINS(faultsOf("time_s,x_rad\n0,0\n1,1\n"), "x is a translation: use _m");
  EXPECT_CONTAINS(faultsOf("time_s,yaw_m\n0,0\n1,1\n"), "yaw is a rotation: use _rad");
  EXPECT_CONTAINS(faultsOf("time_s,x_m,x_m\n0,0,0\n1,1,1\n"), "column 3 = x_m: stands there twice");
  EXPECT_CONTAINS(faultsOf("time_s,,x_m\n0,0,0\n1,1,1\n"), "column 2: has no name");
}

TEST(MotionFile, FaultInARow_NamesItsLineAndColumn) {
  const std::string head = "time_s,x_m\n0,0\n";
  EXPECT_CONTAINS(faultsOf(head + "1\n"), ":3: has 1 value, the header names 2 columns");
  EXPECT_CONTAINS(faultsOf(head + "1,2,3\n"), ":3: has 3 values");
  EXPECT_CONTAINS(faultsOf(head + "1,fast\n"), ":3: x_m = fast: is not a number");
  EXPECT_CONTAINS(faultsOf(head + "1,+-1\n"), ":3: x_m = +-1: is not a number");
  EXPECT_CONTAINS(faultsOf(head + "1,0x10\n"), ":3: x_m = 0x10: is not a number");
  EXPECT_CONTAINS(faultsOf(head + "1,\n"), ":3: x_m: is empty");
  EXPECT_CONTAINS(faultsOf(head + "1,nan\n"), ":3: x_m = nan: is not finite");
  EXPECT_CONTAINS(faultsOf(head + "inf,1\n"), ":3: time_s = inf: is not finite");
  EXPECT_CONTAINS(faultsOf(head + "1,1e999\n"), ":3: x_m = 1e999: is not finite");
  EXPECT_CONTAINS(faultsOf(head + "1,1e6\n"), ":3: x_m = 1e6: is out of range");
  EXPECT_CONTAINS(faultsOf(head + "0,1\n"), ":3: time_s = 0: does not increase");
  EXPECT_CONTAINS(faultsOf(head + "1,1\n0.5,1\n"), ":4: time_s = 0.5: does not increase");
  EXPECT_CONTAINS(faultsOf(head + "3601,1\n"), ":3: time_s = 3601: is more than an hour");
}

TEST(MotionFile, SeveralFaults_AreAllReportedAndCappedAtTwenty) {
  const std::string faults = faultsOf("time_s,x_m,y_in\n0,zero,0\n0,1,1\n2,2\n");
  EXPECT_CONTAINS(faults, ":1: column 3 = y_in");
  EXPECT_CONTAINS(faults, ":2: x_m = zero");
  EXPECT_CONTAINS(faults, ":3: time_s = 0");
  EXPECT_CONTAINS(faults, ":4: has 2 values");

  std::string many = "time_s,x_m\n";
  for (int i = 0; i < 50; ++i) many += std::to_string(i) + ",bad\n";
  const Expected<MotionFile> motion = loadMotionFile(written(many));
  ASSERT_FALSE(motion.ok());
  EXPECT_EQ(motion.errors().size(), 21U);
  EXPECT_CONTAINS(format(motion.errors().back()), "has 30 more faults");
}

TEST(MotionFile, DeviceWithItsOwnAxes_ExtendsTheKnownAxes) {
  const DeviceModel device = sled();
  EXPECT_EQ(faultsOf("time_s,index_flexion_rad\n0,0\n1,1\n", &device), "");
  // A column that the device lacks is no fault as long as another column moves an axis.
  EXPECT_EQ(faultsOf("time_s,x_m,index_flexion_rad\n0,0,0\n1,1,1\n", &device), "");
  EXPECT_CONTAINS(faultsOf("time_s,index_flexion_rad\n0,0\n1,1\n"), "is no known axis");
  EXPECT_CONTAINS(faultsOf("time_s,index_flexion_m\n0,0\n1,1\n", &device), "has the wrong unit");
  EXPECT_CONTAINS(faultsOf("time_s,x_m\n0,0\n1,1\n", &device), "moves no axis of the device sled");
}

/// The file's notices, one per line.
std::string noticesOf(const std::string& content, const DeviceModel* device = nullptr) {
  return format(orThrow(loadMotionFile(written(content), device)).notices);
}

TEST(MotionFile, TablesOfOtherPrograms_AreRead) {
  const MotionFile plain = orThrow(loadMotionFile(written("time_s,x_m\n0,1\n0.5,2\n")));
  for (const char* content :
       {"\"time_s\",\"x_m\"\n\"0\",\"1\"\n\"0.5\",\"2\"\n",              // RFC 4180
        "\"\",\"time_s\",\"x_m\"\n\"1\",0,1\n\"2\",0.5,2\n",             // R: write.csv
        "\"time_s\",\"x_m\"\n\"1\",0,1\n\"2\",0.5,2\n",                  // R: write.table
        ",time_s,x_m\n0,0,1\n1,0.5,2\n",                                 // pandas
        "time_s,x_m\r0,1\r0.5,2",                                        // \r alone, Excel for Mac
        "time_s,frame_id,x_m\n0,\"base, link \"\"1\"\"\",1\n0.5,,2\n"})  // ROS
  {
    const MotionFile motion = orThrow(loadMotionFile(written(content)));
    EXPECT_EQ(motion.columns, plain.columns) << content;
    EXPECT_EQ(motion.time_s, plain.time_s) << content;
    EXPECT_EQ(motion.samples, plain.samples) << content;
  }
}

TEST(MotionFile, ColumnsOfUnknownAxes_AreIgnoredAndNamed) {
  const std::string notices =
      noticesOf("seq,stamp,frame_id,time_s,x_m,elbow_flexion_rad\n1,7,map,0,0,9\n2,8,map,1,1,9\n");
  EXPECT_CONTAINS(notices, ":1: column 1 = seq: has no known unit and is ignored");
  EXPECT_CONTAINS(notices, "column 3 = frame_id");
  EXPECT_CONTAINS(notices, "column 6 = elbow_flexion_rad: is no known axis and is ignored");
  EXPECT_EQ(noticesOf("time_s,x_m\n0,0\n1,1\n"), "");
}

TEST(MotionFile, ManyColumnsOfUnknownAxes_AreNamedInBriefAndCounted) {
  std::string names, values;
  for (int i = 0; i < 23; ++i) {
    names += ",field.position" + std::to_string(i);
    values += ",0";
  }
  const std::string faults = faultsOf("time_s" + names + "\n0" + values + "\n1" + values + "\n");
  EXPECT_CONTAINS(faults, "names 23 columns and no known axis: \"field.position0\", ");
  const std::string notices = noticesOf("time_s,x_m" + names + "\n0,0" + values + "\n1,0" + values);
  EXPECT_CONTAINS(notices, "has 3 more columns that no axis has, ignored");
}

TEST(MotionFile, TimeWithoutUnit_IsReported) {
  EXPECT_CONTAINS(faultsOf("time,x\n0,0\n1,0.1\n"),
                  "time_s: is missing: the column time does not say its unit");
  EXPECT_CONTAINS(faultsOf("time,x\n0,0\n1,0.1\n"), "column 2 = x: has no known unit");
  EXPECT_CONTAINS(faultsOf("__time,x_m\n0,0\n1,0.1\n"), "the column __time does not say its unit");
  EXPECT_CONTAINS(faultsOf("%time,x_m\n0,0\n1,0.1\n"), "the column %time does not say its unit");
}

// The same motion in each unit: factors of the SI brochure, and π/180.
TEST(MotionFile, UnitsInTheNamesOfColumns_AreConvertedAndSaid) {
  const auto sample = [&](const std::string& content) {
    const MotionFile motion = orThrow(loadMotionFile(written(content)));
    std::vector<double> all = motion.samples.back();
    all.push_back(motion.time_s.back());
    return all;
  };
  const std::vector<double> si = sample("time_s,x_m,yaw_rad\n0,0,0\n0.5,0.02,0.1\n");
  for (const char* content : {"time_ms,x_mm,yaw_deg\n0,0,0\n500,20,5.729577951308232\n",
                              "timestamp_us,x_cm,yaw_rad\n0,0,0\n500000,2,0.1\n",
                              "Time (s),X (mm),Yaw [deg]\n0,0,0\n0.5,20,5.729577951308232\n",
                              "t_ns,x_m,yaw_rad\n0,0,0\n500000000,0.02,0.1\n",
                              "time_msec,Time_s,x_m,yaw_rad\n0,0,0,0\n500,9,0.02,0.1\n"}) {
    const std::vector<double> read = sample(content);
    ASSERT_EQ(read.size(), si.size()) << content;
    for (std::size_t i = 0; i < si.size(); ++i) EXPECT_NEAR(read[i], si[i], 1e-15) << content;
  }
  EXPECT_CONTAINS(noticesOf("time_s,x_mm\n0,0\n1,1\n"),
                  "column 2 = x_mm: is converted: its values times 0.001");
  EXPECT_EQ(noticesOf("time_s,x_m\n0,0\n1,1\n"), "");
}

TEST(MotionFile, PositionOfAnotherProgram_MustSayWhichAxisPointsUp) {
  const std::string rows = "Time (s),X (m),Y (m),Z (m)\n0,0,0,0\n1,0.1,0.2,0.3\n";
  EXPECT_CONTAINS(faultsOf(rows), "put the line \"# up = y\" or \"# up = z\" before");
  EXPECT_CONTAINS(faultsOf("# up = x\n" + rows), "is no axis that may point up");
  const MotionFile as_it_is = orThrow(loadMotionFile(written("# up = z\n" + rows)));
  EXPECT_EQ(as_it_is.samples.back(), (std::vector<double>{0.1, 0.2, 0.3}));
  // A turn by 90° about x: y becomes z, z becomes -y.
  const MotionFile turned = orThrow(loadMotionFile(written("# up = y\n" + rows)));
  EXPECT_EQ(turned.samples.back(), (std::vector<double>{0.1, -0.3, 0.2}));
}

TEST(MotionFile, ValuesInAnotherUnit_AreReported) {
  const std::string degrees = "time_s,finger_flexion_rad\n0,10\n0.1,12.56\n0.2,12.57\n0.3,40\n";
  EXPECT_CONTAINS(faultsOf(degrees), ":4: finger_flexion_rad = 12.57: is beyond two turns");
  EXPECT_CONTAINS(faultsOf(degrees), "multiply degrees by");
  DeviceModel device = sled();
  device.axes[0].group = AxisGroup::kHand;
  EXPECT_EQ(faultsOf("time_s,index_flexion_rad\n0,0\n1,6.28\n", &device), "");
  EXPECT_CONTAINS(faultsOf("time_s,index_flexion_rad\n0,0\n1,6.29\n", &device),
                  ":3: index_flexion_rad = 6.29: is beyond a turn (2π rad)");
  device = sled();
  device.axes[0].name = "x";
  device.axes[0].kind = AxisKind::kTranslation;
  device.axes[0].lower = -0.1;
  device.axes[0].upper = 0.1;
  device.axes[0].speed_limit = 0.5;
  // Ten times the range is 2 m from the first row, wherever that is; ten times the speed is 5 m/s.
  EXPECT_EQ(faultsOf("time_s,x_m\n0,7\n1,9\n", &device), "");
  EXPECT_CONTAINS(
      faultsOf("time_s,x_m\n0,7\n1,9.01\n", &device),
      ":3: x_m = 9.01: is 2.01 m from the first row; the axis of sled has a range of 0.2 m");
  EXPECT_EQ(faultsOf("time_s,x_m\n0,0\n0.01,0.049\n", &device), "");
  EXPECT_CONTAINS(
      faultsOf("time_s,x_m\n0,0\n0.01,0.051\n", &device),
      ":3: x_m = 0.051: is reached at 5.1 m/s; the axis of sled moves at 0.5 m/s at most");
  EXPECT_EQ(faultsOf("time_s,x_m\n0,0\n0.01,0.051\n"), "");
}

TEST(MotionFile, MillisecondsInsteadOfSeconds_AreReported) {
  const auto at = [](double step_s) {
    std::string text = "time_s,x_m\n";
    for (int i = 0; i < 20; ++i) text += std::to_string(i * step_s) + ",0\n";
    return noticesOf(text);
  };
  EXPECT_CONTAINS(at(10.0), "time_s: has a row every 10 s; if these are milliseconds, divide them");
  EXPECT_EQ(at(0.01), "");
}

// Rows of an occlusion are dropped; the motion played in between is a slow drift.
TEST(MotionFile, GapInTheTime_IsReportedWithLineAndLength) {
  const auto with_gaps = [](double step_s, int rows, std::vector<double> gaps_s) {
    std::string text = "time_s,x_m\n";
    double time_s = 0.0;
    for (int i = 0; i < rows; ++i) {
      if (i > 0) time_s += step_s;
      if (i >= rows / 2 && !gaps_s.empty()) {
        time_s += gaps_s.back();
        gaps_s.pop_back();
      }
      text += std::to_string(time_s) + ",0\n";
    }
    return noticesOf(text);
  };
  const std::string minute = with_gaps(0.01, 2000, {60.0});
  EXPECT_CONTAINS(minute, ":1002: time_s = 70: is 60.01 s after the row before, where 0.01 s");
  // The mean step of these is 20 s.
  const std::string lost = with_gaps(0.01, 50, {1000.0});
  EXPECT_CONTAINS(lost, ":27: time_s = 1000.25: is 1000 s after the row before");
  EXPECT_EQ(lost.find("milliseconds"), lost.npos);
  EXPECT_CONTAINS(with_gaps(0.01, 50, {0.5, 3.0, 0.5}), "is 3.01 s");
  EXPECT_CONTAINS(with_gaps(0.01, 50, {0.5, 3.0, 0.5}), "(the longest of 3 gaps)");
  EXPECT_EQ(with_gaps(0.01, 50, {0.18}), "");
  EXPECT_EQ(with_gaps(0.1, 50, {0.85}), "");
  EXPECT_EQ(with_gaps(0.01, 8, {60.0}), "");  // waypoints, not a recording
  EXPECT_CONTAINS(with_gaps(10.0, 50, {1000.0}), "if these are milliseconds");
}

TEST(MotionFile, FileOfAnotherProgram_IsRecognised) {
  EXPECT_CONTAINS(faultsOf("PathFileType\t4\t(X/Y/Z)\tm.trc\n"), "is TRC");
  EXPECT_CONTAINS(faultsOf("HIERARCHY\nROOT Hips\n"), "bvh2csv");
  EXPECT_CONTAINS(faultsOf(std::string("\x02\x50\0\0", 4)), "c3d2csv");
}

TEST(MotionFile, EveryRecordingOfTheProject_Loads) {
  int recordings = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(WHOLEHAND_SOURCE_DIR "/data/human-motion")) {
    if (entry.path().extension() != ".csv") continue;
    const MotionFile motion = orThrow(loadMotionFile(entry.path().string()));
    EXPECT_EQ(motion.columns.size(), 6U);
    EXPECT_GT(motion.time_s.back(), 2.0);
    ++recordings;
  }
  EXPECT_EQ(recordings, 15);
}

}  // namespace
}  // namespace wholehand::test
