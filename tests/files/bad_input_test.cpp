#include "files/device/device_file.hpp"
#include "files/device/rendering_file.hpp"
#include "files/hand/hand_file.hpp"
#include "files/patient/patient_file.hpp"
#include "files/scene/scene_file.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"
#include "loop/model/rendering_config.hpp"
#include "loop/model/scene_model.hpp"
#include "support/constants.hpp"
#include "support/contains.hpp"
#include "support/cpu_time.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"
#include "support/toml_lines.hpp"

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <array>
#include <iterator>
#include <sstream>

namespace wholehand::test {
namespace {

/// The shipped file of each kind that the cases below corrupt.
std::string shippedPath(const std::string& kind) {
  if (kind == "device") return kConfig + "devices/lambda-pride.toml";
  if (kind == "rendering") return kConfig + "rendering/lambda-pride.toml";
  if (kind == "patient") return kConfig + "patients/relaxed-adult.toml";
  if (kind == "scene") return kConfig + "scenes/four-shapes.toml";
  return kConfig + "hands/adult-median-right.toml";
}

Diagnostics faultsOf(const std::string& kind, const std::string& path) {
  const auto faults = [](const auto& loaded) {
    return loaded.ok() ? Diagnostics{} : loaded.errors();
  };
  if (kind == "device") return faults(loadDeviceFile(path));
  if (kind == "hand") return faults(loadHandFile(path));
  if (kind == "scene") return faults(loadSceneFile(path));
  const DeviceModel device = loadDeviceFile(shippedPath("device")).value();
  if (kind == "rendering") return faults(loadRenderingFile(path, device));
  return faults(loadPatientFile(path, device));
}

/// The shipped text with the first `find` replaced.
std::string corrupt(const std::string& kind, const std::string& find, const std::string& replace) {
  return replaced(bytesOfFile(shippedPath(kind)), find, replace);
}

/// 1-based line of the first occurrence.
int lineOf(const std::string& text, const std::string& what) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  if (at == std::string::npos) return 0;
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

/// Expected report of a mistake: its kind, or words of the message where several mistakes have the
/// same kind.
struct Reported {
  Reported(DiagnosticCode kind) : code(kind) {}
  Reported(const char* part) : words(part) {}
  DiagnosticCode code = DiagnosticCode::kInvalid;
  std::string words;
};

struct FileMistake {
  std::string kind;     ///< of the file
  std::string find;     ///< in the shipped file ...
  std::string replace;  ///< ... becomes this
  std::string at;       ///< text of the line that must be named; empty: line not checked
  std::string key;      ///< expected key path
  Reported reported;    ///< expected
  std::string remedy;   ///< expected in the remedy
};

void expectFault(const FileMistake& c) {
  SCOPED_TRACE(c.kind + ": " + c.find + " -> " + c.replace);
  const Folder folder;
  const std::string text = corrupt(c.kind, c.find, c.replace);
  const std::string path = folder.write("corrupted.toml", text);
  const Diagnostics faults = faultsOf(c.kind, path);
  ASSERT_EQ(faults.size(), 1U) << format(faults);  // one mistake, one message
  const Diagnostic& fault = faults.front();
  EXPECT_EQ(fault.file, path);
  EXPECT_EQ(fault.key, c.key);
  if (!c.at.empty()) {
    EXPECT_EQ(fault.line, lineOf(text, c.at)) << format(fault);
  }
  if (c.reported.words.empty()) {
    EXPECT_EQ(fault.code, c.reported.code) << format(fault);
  } else {
    EXPECT_TRUE(contains(format(fault), c.reported.words));
  }
  EXPECT_TRUE(contains(fault.remedy, c.remedy)) << format(fault);
}

/// Checks every key of every kind of file; the cases below check the messages of some mistakes.
TEST(BadInput, KeyOfAnotherTypeNameOrSize_IsRefusedWithItsLineAndARemedy) {
  const Folder folder;
  auto random = seededRandom(96);
  std::vector<std::pair<const char*, std::string>> files;
  for (const char* kind : {"device", "rendering", "hand", "scene"}) {
    files.emplace_back(kind, shippedPath(kind));
  }
  for (const char* name : {"relaxed-adult", "tremor", "spastic", "releases", "slams", "fights"}) {
    files.emplace_back("patient", kConfig + "patients/" + name + ".toml");
  }
  for (const auto& [kind, path] : files) {
    const std::vector<std::string> lines = linesOf(bytesOfFile(path));
    const std::vector<KeyLine> keys = keyLines(lines);
    EXPECT_GT(keys.size(), 30U) << path;
    for (const KeyLine& key : keys) {
      for (const std::string& wrong : wrongLines(key, random)) {
        SCOPED_TRACE(path + ": " + lines[key.line] + " -> " + wrong);
        std::vector<std::string> changed = lines;
        changed[key.line] = wrong;
        const Diagnostics faults = faultsOf(kind, folder.write("changed.toml", joined(changed)));
        // A key under another name may be reported as missing at the start of its table.
        const bool renamed = wrong.starts_with(key.key + "_x");
        const auto fault = std::find_if(faults.begin(), faults.end(), [&](const Diagnostic& d) {
          return d.key.find(key.key) != std::string::npos &&
                 (renamed || d.line == static_cast<int>(key.line) + 1);
        });
        EXPECT_NE(fault, faults.end()) << format(faults);
        if (fault == faults.end()) continue;
        EXPECT_FALSE(fault->remedy.empty());
      }
    }
  }
}

TEST(BadInput, MistakeInADeviceFile_GivesOneMessageWithPlaceAndRemedy) {
  const std::vector<FileMistake> cases = {
      {"device", "mass_kg = 0.8\n", "", "[[axes]]", "axes[x].mass_kg", DiagnosticCode::kMissing,
       "(0, 100] kg"},
      {"device", "mass_kg = 0.8", "mas_kg = 0.8", "mas_kg", "axes[x].mas_kg",
       DiagnosticCode::kUnknown, "did you mean mass_kg?"},
      {"device", "mass_kg = 0.8", "mass_kg = 0.8\ncolour = \"red\"", "colour", "axes[x].colour",
       DiagnosticCode::kUnknown, "remove it"},
      {"device", "range_m =", "range_rad =", "range_rad", "axes[x].range_rad",
       DiagnosticCode::kUnknown, "range_m"},
      {"device", "range_m =", "range_mm =", "range_mm", "axes[x].range_mm",
       DiagnosticCode::kUnknown, "range_m"},
      {"device", "effort_limit_n = 20.0", "effort_limit_nm = 20.0", "effort_limit_nm",
       "axes[x].effort_limit_nm", "translation", "effort_limit_n"},
      {"device", "effort_limit_n = 20.0", "effort_limit_tip_n = 20.0", "effort_limit_tip_n",
       "axes[x].effort_limit_tip_n", "fingertip", "effort_limit_n"},
      {"device", "inertia_kg_m2 = 5.0e-4", "mass_kg = 0.1", "mass_kg = 0.1",
       "axes[finger_flexion].mass_kg", "rotation", "inertia_kg_m2"},
      {"device",
       "lever_arm_m = 0.08\neffort_limit_tip_n = 10.0\neffort_slew_tip_n_s = 2500.0\n"
       "speed_limit_rad_s = 10.0\nworkspace_margin_rad = 0.03\ninertia_kg_m2 = 5.0e-4\n"
       "damping_nm_s_rad = 0.015\ncoulomb_tip_n = 0.05",
       "effort_limit_tip_n = 10.0\nspeed_limit_rad_s = 10.0\ninertia_kg_m2 = "
       "5.0e-4\ndamping_nm_s_rad = 0.015",
       "effort_limit_tip_n", "axes[finger_flexion].effort_limit_tip_n", "needs a lever arm",
       "effort_limit_nm"},
      {"device", "effort_slew_n_s = 5000.0", "effort_slew_n_s = 799.0", "effort_slew_n_s = 799.0",
       "axes[x].effort_slew_n_s", "too low to reach neutral", "40"},
      {"device", "power_limit_w = 30.0", "power_limit_w = 0.0", "power_limit_w = 0.0",
       "power_limit_w", DiagnosticCode::kRange, "W"},
      {"device", "effort_limit_n = 20.0", "effort_limit_n = 0.0", "effort_limit_n = 0.0",
       "axes[x].effort_limit_n", DiagnosticCode::kRange, "N"},
      {"device", "effort_limit_nm = 0.6", "effort_limit_nm = 0.6\neffort_limit_tip_n = 7.0",
       "effort_limit_tip_n = 7.0", "axes[thumb_circumduction].effort_limit_tip_n", "twice", ""},
      {"device", "mass_kg = 0.8", "mass_kg = 0", "mass_kg = 0\n", "axes[x].mass_kg",
       DiagnosticCode::kRange, "(0, 100] kg"},
      {"device", "mass_kg = 0.8", "mass_kg = \"0.8\"", "\"0.8\"", "axes[x].mass_kg",
       DiagnosticCode::kType, "without quotes"},
      {"device", "range_m = [-0.085, 0.085]", "range_m = [0.085, -0.085]", "[0.085, -0.085]",
       "axes[x].range_m", "not an interval", "lower < upper"},
      {"device", "range_m = [-0.085, 0.085]", "range_m = [-0.085]", "[-0.085]", "axes[x].range_m",
       "has 1 element", "array of 2 numbers"},
      {"device", "range_m = [-0.085, 0.085]", "range_m = [-0.085, nan]", "nan]", "axes[x].range_m",
       "element 1 is not finite", "m"},
      {"device", "range_m = [-0.085, 0.085]", "range_m = 0.085", "range_m = 0.085",
       "axes[x].range_m", DiagnosticCode::kType, "array of 2 numbers"},
      {"device", "output_delay_ticks = 1", "output_delay_ticks = 9", "= 9", "output_delay_ticks",
       DiagnosticCode::kRange, "[0, 8]"},
      {"device", "output_delay_ticks = 1", "output_delay_ticks = 1.5", "1.5", "output_delay_ticks",
       DiagnosticCode::kType, "[0, 8]"},
      {"device", "drive_lag_s = 0.002", "drive_lag_s = 0.03", "0.03", "drive_lag_s",
       DiagnosticCode::kRange, "[0, 0.02]"},
      {"device", "name = \"y\"", "name = \"x\"", "", "axes[x].name", "twice", "name of its own"},
      {"device", "name = \"y\"", "name = \"up\"", "\"up\"", "axes[up].name",
       "not an axis that carries", "yaw"},
      {"device", "name = \"y\"", "name = \"roll\"", "", "axes[roll].type", "does not match",
       "\"rotation\""},
      {"device", "name = \"y\"", "name = \"\"", "name = \"\"", "axes[].name", "is empty", ""},
      {"device", "group = \"base\"", "group = \"arm\"", "\"arm\"", "axes[x].group",
       DiagnosticCode::kUnknown, "\"base\" or \"hand\""},
      {"device", "neutral_effort_n = 0.0", "neutral_effort_n = 25.0", "", "axes[x]",
       "exceeds the effort limit", ""},
      {"device", "[mount]", "[mounting]", "[mounting]", "mounting", DiagnosticCode::kUnknown,
       "did you mean mount?"},
      {"device", "version = 1", "version = 2", "version = 2", "version", "not known",
       "version = 1"},
      {"device", "kind = \"device\"", "kind = \"hand\"", "kind = \"hand\"", "kind", "another kind",
       "device"},
      {"device", "name = \"lambda-pride\"", "name = \"a\"\nname = \"b\"", "name = \"b\"", "",
       "is not TOML", "correct"},
  };
  for (const FileMistake& c : cases) expectFault(c);
}

std::vector<std::string> keysOf(const Diagnostics& faults) {
  std::vector<std::string> keys;
  for (const Diagnostic& fault : faults) keys.push_back(fault.key);
  return keys;
}

TEST(BadInput, AxisOfUnknownType_ListsAllItsOtherFaults) {
  const Folder folder;
  const auto corrupted = [&](const std::string& kind) {
    std::string text = bytesOfFile(shippedPath("device"));
    const std::size_t axis =
        text.find(kind == "translation" ? "name = \"x\"" : "name = \"thumb_flexion\"");
    const auto replace = [&](const std::string& find, const std::string& with) {
      const std::size_t at = text.find(find, axis);
      ASSERT_NE(at, std::string::npos) << find;
      text.replace(at, find.size(), with);
    };
    replace("type = \"" + kind + "\"", "type = \"linear\"");
    replace("speed_limit_", "sped_limit_");
    replace("damping_", "damping_unit_");
    return faultsOf("device", folder.write(kind + ".toml", text));
  };
  // An unknown key together with the missing key that it stands for is one fault.
  EXPECT_EQ(keysOf(corrupted("translation")),
            (std::vector<std::string>{"axes[x].type", "axes[x].sped_limit_m_s",
                                      "axes[x].damping_unit_n_s_m"}));
  EXPECT_EQ(
      keysOf(corrupted("rotation")),
      (std::vector<std::string>{"axes[thumb_flexion].type", "axes[thumb_flexion].sped_limit_rad_s",
                                "axes[thumb_flexion].damping_unit_nm_s_rad"}));
}

TEST(BadInput, MistakeInGainsPatientOrHand_GivesOneMessageWithPlaceAndRemedy) {
  const std::vector<FileMistake> cases = {
      {"rendering", "k_pm_n_m = 1000.0", "k_pm_nm_rad = 1000.0", "k_pm_nm_rad",
       "axes[x].k_pm_nm_rad", "translation", "k_pm_n_m"},
      {"rendering", "k_pm_n_m = 1000.0\n", "", "", "axes[x].k_pm_n_m", DiagnosticCode::kMissing,
       "N/m"},
      {"rendering", "effort_dead_n = 0.5", "effort_dead_n = 5.0", "", "axes[x]",
       "effort_dead is not below effort_full", "<"},
      {"rendering", "gamma = 0.3", "gamma = 1.5", "gamma = 1.5", "gamma", DiagnosticCode::kRange,
       "[0, 1]"},
      {"rendering", "paper = false", "paper = \"no\"", "\"no\"", "paper", DiagnosticCode::kType,
       "true or false"},
      {"patient", "mass_kg = 1.0", "inertia_kg_m2 = 1.0", "inertia_kg_m2 = 1.0",
       "axes[x].inertia_kg_m2", "translation", "mass_kg"},
      {"patient", "margin = 0.05", "margin = 0.5", "margin = 0.5", "motion.margin",
       DiagnosticCode::kRange, "[0, 0.4]"},
      {"patient", "speed_share = 0.8", "speed_share = 0", "speed_share = 0 ", "motion.speed_share",
       DiagnosticCode::kRange, "(0, 1]"},
      {"hand", "side = \"right\"", "side = \"both\"", "\"both\"", "side", DiagnosticCode::kUnknown,
       "\"left\""},
      {"hand", "length_m = 0.1880", "length_m = 188.0", "length_m = 188", "length_m",
       DiagnosticCode::kRange, "[0.05, 0.35] m"},
      {"hand", "length_m = 0.1880", "length_m = 0.0800", "breadth_m = 0.085", "breadth_m",
       DiagnosticCode::kInvalid, "exchange the two"},
      {"hand", "index_mcp_flexion = 0.375", "index_mpc_flexion = 0.375", "index_mpc_flexion",
       "synergy.finger_flexion.index_mpc_flexion", "not a joint",
       "did you mean index_mcp_flexion?"},
      {"hand", "index_mcp_flexion = {", "index_mpc_flexion = {", "index_mpc_flexion = {",
       "joints.index_mpc_flexion", DiagnosticCode::kUnknown, "did you mean index_mcp_flexion?"},
      {"hand", "rest_rad = 0.35", "rest_rad = 1.7", "1.7", "joints.index_mcp_flexion.rest_rad",
       "outside the joint's own range", "[0, 1.5708] rad"},
      {"hand", "finger_flexion_rad =", "wrist_rad =", "wrist_rad", "reference.wrist_rad",
       "not a coordinate", ""},
      {"hand", "finger_flexion_rad =", "finger_flexion =", "finger_flexion =",
       "reference.finger_flexion", "has no unit", "finger_flexion_rad"},
  };
  for (const FileMistake& c : cases) expectFault(c);
}

TEST(BadInput, WrongAxisName_GivesOneMessageWithTheLikelyName) {
  const std::vector<FileMistake> cases = {
      // Similar spelling; another word, but the only axis without gains; no axis left to suggest.
      {"rendering", "name = \"thumb_flexion\"", "name = \"thumb_flexon\"", "\"thumb_flexon\"",
       "axes[thumb_flexon].name", "is not an axis of the device", "did you mean thumb_flexion?"},
      {"rendering", "name = \"thumb_flexion\"", "name = \"thumb_extension\"", "\"thumb_extension\"",
       "axes[thumb_extension].name", "is not an axis of the device", "did you mean thumb_flexion?"},
      {"rendering", "[[axes]]", "[[axes]]\nname = \"roll\"\n[[axes]]", "\"roll\"",
       "axes[roll].name", "is not an axis of the device", "remove it"},
      {"patient", "name = \"finger_flexion\"", "name = \"finger_flexoin\"", "\"finger_flexoin\"",
       "axes[finger_flexoin].name", "is neither an axis of the device",
       "did you mean finger_flexion?"},
      {"patient", "name = \"x\"", "name = \"elbow\"", "\"elbow\"", "axes[elbow].name",
       "is neither an axis of the device", ""},
  };
  for (const FileMistake& c : cases) expectFault(c);
}

TEST(BadInput, AxesWithoutGains_AreNamedInOneMessage) {
  DeviceModel device = loadDeviceFile(shippedPath("device")).value();
  for (const char* name : {"roll", "pitch"}) {
    device.axes.push_back(device.axes.front());
    device.axes.back().name = name;
  }
  const Diagnostics faults = loadRenderingFile(shippedPath("rendering"), device).errors();
  ASSERT_EQ(faults.size(), 1U) << format(faults);
  EXPECT_EQ(faults.front().value, "");  // not the text of all [[axes]]
  EXPECT_TRUE(contains(faults.front().problem, "have no gains for roll and pitch"))
      << format(faults);
}

TEST(BadInput, PatientOfAnotherDevice_ItsOtherKnownAxesAreIgnoredButChecked) {
  DeviceModel device = loadDeviceFile(shippedPath("device")).value();
  std::erase_if(device.axes, [](const DeviceAxis& axis) { return axis.name == "thumb_flexion"; });
  EXPECT_TRUE(loadPatientFile(shippedPath("patient"), device).ok());
  device.axes.back().name =
      "index_flexion";  // a device's own axis name is known to its own patients
  const Folder folder;
  const std::string path = folder.write(
      "p.toml", corrupt("patient", "name = \"thumb_flexion\"", "name = \"index_flexion\""));
  EXPECT_TRUE(loadPatientFile(path, device).ok());
}

TEST(BadInput, MisspeltJointName_SuggestsOneThatIsNotUsedYet) {
  // "mittle" is as similar to "little" as to "middle": only the missing one can be meant.
  expectFault({"hand", "middle_mcp_flexion = {", "mittle_mcp_flexion = {", "mittle_mcp_flexion = {",
               "joints.mittle_mcp_flexion", "is unknown", "did you mean middle_mcp_flexion?"});
  expectFault({"hand", "little_mcp_flexion = {", "mittle_mcp_flexion = {", "mittle_mcp_flexion = {",
               "joints.mittle_mcp_flexion", "is unknown", "did you mean little_mcp_flexion?"});
  expectFault({"hand", "ring_mcp_flexion = 0.", "rink_pip_flexion = 0.", "rink_pip_flexion",
               "synergy.finger_flexion.rink_pip_flexion", "is not a joint",
               "did you mean ring_mcp_flexion?"});
}

TEST(BadInput, NumbersInMessages_AreTheShortestThatReadBackEqual) {
  const Folder folder;
  const std::string path = folder.write(
      "d.toml", corrupt("device", "range_m = [-0.085, 0.085]", "range_m = [ 0.165,nan ]"));
  const Diagnostics faults = faultsOf("device", path);
  ASSERT_EQ(faults.size(), 1U) << format(faults);
  EXPECT_EQ(faults.front().value, "[0.165, nan]");
}

TEST(BadInput, ManyMistakes_AreAllReportedInFileOrder) {
  const Folder folder;
  std::string text = bytesOfFile(shippedPath("device"));
  const auto replace = [&](const std::string& find, const std::string& with) {
    text.replace(text.find(find), find.size(), with);
  };
  replace("output_delay_ticks = 1", "output_delay_ticks = -1");
  replace("yaw_rad = 0.0", "yaw_deg = 0.0");
  replace("mass_kg = 0.8", "mass_kg = nan");
  replace("coulomb_n = 0.2", "friction = 0.2");
  replace("effort_limit_tip_n = 10.0", "effort_limit_tip_n = \"ten\"");
  const Diagnostics faults = faultsOf("device", folder.write("d.toml", text));
  ASSERT_EQ(faults.size(), 5U) << format(faults);
  EXPECT_EQ(faults[0].key, "output_delay_ticks");
  EXPECT_EQ(faults[1].key, "mount.yaw_deg");
  EXPECT_EQ(faults[2].key, "axes[x].mass_kg");
  EXPECT_EQ(faults[3].key, "axes[x].friction");
  EXPECT_EQ(faults[4].key, "axes[finger_flexion].effort_limit_tip_n");
  EXPECT_TRUE(std::is_sorted(faults.begin(), faults.end(),
                             [](const auto& a, const auto& b) { return a.line < b.line; }));
}

TEST(BadInput, PathThatIsNoFile_IsReportedPlainly) {
  const Folder folder;
  const auto message = [](const std::string& path) { return format(faultsOf("device", path)); };
  EXPECT_TRUE(contains(message(folder.file("none.toml")), "No such file"));
  EXPECT_TRUE(contains(message(folder.file("")), "is a folder"));
  EXPECT_TRUE(contains(message("/dev/zero"), "is not a file"));
  EXPECT_TRUE(contains(message(folder.write("empty.toml", "  \n\n")), "is empty"));
  EXPECT_TRUE(contains(message(folder.write("binary.toml", "\x89PNG\r\n\x1a\n")), "is not TOML"));
  EXPECT_FALSE(fileKind(folder.file("none.toml")).ok());
  EXPECT_FALSE(fileKind(folder.write("no-kind.toml", "version = 1\n")).ok());
}

// Loading a file with any content ends in a value or in messages; it never crashes or throws.
TEST(BadInput, RandomlyCorruptedFiles_LoadOrReportTheReason) {
  const Folder folder;
  auto random = seededRandom(1);
  const auto pick = [&](std::size_t below) { return random() % below; };
  const std::string bytes = "[]{}=\"'.,#\n-+e019_xnan\x80\xff";
  int refused = 0;
  for (const char* kind : {"device", "rendering", "patient", "hand"}) {
    const std::string good = bytesOfFile(shippedPath(kind));
    for (int round = 0; round < 60; ++round) {
      std::string text = good;
      for (std::size_t n = 1 + pick(3); n > 0; --n) {
        const std::size_t at = pick(text.size());
        if (pick(2) == 0) {
          text[at] = bytes[pick(bytes.size())];
        } else {
          text.erase(at, pick(80));
        }
      }
      const std::string path = folder.write("corrupted.toml", text);
      const Diagnostics faults = faultsOf(kind, path);
      refused += faults.empty() ? 0 : 1;
      for (const Diagnostic& fault : faults) {
        EXPECT_EQ(fault.file, path);
        EXPECT_FALSE(fault.problem.empty());
        EXPECT_FALSE(fault.remedy.empty()) << format(fault);
      }
    }
  }
  EXPECT_GT(refused, 60);  // the others changed only comments
}

TEST(BadInput, FileWithoutKindOrVersion_NamesBothAndContinues) {
  const Folder folder;
  const Diagnostics faults = faultsOf("device", folder.write("d.toml", "name = \"d\"\n"));
  const std::string text = format(faults);
  for (const char* key : {"kind", "version", "output_delay_ticks", "mount", "axes"}) {
    EXPECT_TRUE(std::any_of(faults.begin(), faults.end(),
                            [&](const Diagnostic& d) { return d.key == key; }))
        << key << " is not named in\n"
        << text;
  }
}

TEST(BadInput, MistakeInSelfContacts_GivesOneMessageWithPlaceAndRemedy) {
  const std::string at = "index_distal = [";
  const std::vector<FileMistake> cases = {
      {"hand", at, "index_distl = [", "index_distl = [", "self_contacts.index_distl",
       "not a capsule of a hand", "did you mean index_distal?"},
      {"hand", "\"pad_radial\"", "\"pad_radical\"", at, "self_contacts.index_distal",
       "names pad_radical, which is not a capsule", "did you mean pad_radial?"},
      {"hand", at, at + "\"index_distal\", ", at, "self_contacts.index_distal", "lists itself",
       "remove index_distal"},
      {"hand", at, at + "\"hollow\", ", at, "self_contacts.index_distal",
       "the pair with hollow a second time", "remove hollow"},
      // The pair is already in thumb_distal's list.
      {"hand", at, at + "\"thumb_distal\", ", at, "self_contacts.index_distal",
       "the pair with thumb_distal a second time", "a pair counts for both"},
      {"hand", at, at + "3, ", at, "self_contacts.index_distal", "not a text", "texts in quotes"},
      {"hand", at, "web_23 = [\"index_proximal\"]\n" + at, "web_23 = [", "self_contacts.web_23",
       "index_proximal: is part of the same rigid link as web_23", "never move against each other"},
      // Neighbouring segments of a finger share a joint, around which their round ends touch.
      {"hand", at, "index_middle = [\"index_proximal\"]\n" + at, "index_middle = [",
       "self_contacts.index_middle", "index_proximal: overlaps index_middle by",
       "remove index_proximal from index_middle"},
  };
  for (const FileMistake& c : cases) expectFault(c);
}

TEST(BadInput, SelfContactsThatOverlapOnADevice_AreNamed) {
  // A device that keeps the hand closed at its reference: the thumb is inside the fingers there.
  const HandFile hand = loadHandFile(shippedPath("hand")).value();
  DeviceModel device = loadDeviceFile(shippedPath("device")).value();
  device.axes[3].lower = 2.9;
  device.axes[4].lower = 1.5;
  device.axes[5].lower = 1.3;
  const auto assembled = assembleHand(hand, device);
  ASSERT_FALSE(assembled.ok());
  const Diagnostic& fault = assembled.errors().front();
  EXPECT_EQ(fault.file, hand.path);
  EXPECT_EQ(fault.line, lineOf(bytesOfFile(hand.path), "thumb_distal = ["));
  EXPECT_EQ(fault.key, "self_contacts.thumb_distal");
  EXPECT_TRUE(contains(fault.problem, "mm in the reference posture"));
  EXPECT_TRUE(contains(fault.remedy, "open the hand in [reference]"));
}

TEST(BadInput, ManyImpossiblePairs_AreListedUpToTwentyAndCounted) {
  // The palm's nine capsules belong to one rigid link: 21 pairs of them, and one more.
  const Folder folder;
  const std::string pairs =
      "[self_contacts]\n"
      "pad_radial = [\"pad_ulnar\", \"hollow\", \"thenar\", \"hypothenar\", \"metacarpal_2\", "
      "\"metacarpal_3\", \"metacarpal_4\", \"metacarpal_5\"]\n"
      "pad_ulnar = [\"hollow\", \"thenar\", \"hypothenar\", \"metacarpal_2\", \"metacarpal_3\", "
      "\"metacarpal_4\", \"metacarpal_5\"]\n"
      "hollow = [\"thenar\", \"hypothenar\", \"metacarpal_2\", \"metacarpal_3\", \"metacarpal_4\", "
      "\"metacarpal_5\"]\n"
      "thenar = [\"hypothenar\"]\n";
  std::string text = bytesOfFile(shippedPath("hand"));
  text.replace(text.find("[self_contacts]\n"), std::string("[self_contacts]\n").size(), pairs);
  const std::string path = folder.write("h.toml", text);
  const Diagnostics faults = faultsOf("hand", path);
  ASSERT_EQ(faults.size(), 21U) << format(faults);
  EXPECT_EQ(faults.back().file, path);
  EXPECT_EQ(faults.back().problem, "has 2 more faults");
}

TEST(BadInput, SelfContactsThatOverlapOnADevice_AreListedUpToTwentyAndCounted) {
  // A pair that overlaps where the device keeps the hand as closed as its ranges allow.
  HandFile hand = loadHandFile(shippedPath("hand")).value();
  hand.self_contacts.assign(23, {"thumb_distal", "middle_middle", 1});
  DeviceModel device = loadDeviceFile(shippedPath("device")).value();
  for (int axis = 3; axis < 6; ++axis) device.axes[axis].lower = device.axes[axis].upper;
  const auto assembled = assembleHand(hand, device);
  ASSERT_FALSE(assembled.ok());
  ASSERT_EQ(assembled.errors().size(), 21U) << format(assembled.errors());
  EXPECT_EQ(assembled.errors().back().problem, "has 3 more faults");
}

TEST(BadInput, HandAndDeviceThatDoNotMatch_AreReportedWithTheReason) {
  const HandFile hand = loadHandFile(shippedPath("hand")).value();
  DeviceModel device = loadDeviceFile(shippedPath("device")).value();
  device.axes[3].name = "finger_spread";
  auto assembled = assembleHand(hand, device);
  ASSERT_FALSE(assembled.ok());
  EXPECT_EQ(assembled.errors().front().key, "axes[finger_spread]");
  EXPECT_TRUE(refusedWith(assembled, "drives nothing"));

  device = loadDeviceFile(shippedPath("device")).value();
  device.axes[3].upper = 6.0;  // 6 rad * 0.375 is beyond the 90 degrees of a knuckle
  assembled = assembleHand(hand, device);
  ASSERT_FALSE(assembled.ok());
  EXPECT_EQ(assembled.errors().size(), 8U)
      << format(assembled.errors());  // MCP and PIP of 4 fingers
  EXPECT_EQ(assembled.errors().front().key, "joints.index_mcp_flexion.range_rad");

  HandFile foreign = hand;
  foreign.synergy.push_back({"tail_flexion", "finger_flexion", 1.0});
  assembled = assembleHand(foreign, loadDeviceFile(shippedPath("device")).value());
  ASSERT_FALSE(assembled.ok());
  EXPECT_EQ(assembled.errors().front().key, "synergy.finger_flexion.tail_flexion");
}

TEST(NearestWord, Misspelling_FindsTheWordAndUnknownWordFindsNone) {
  const std::vector<std::string> words = {"mass_kg", "range_m", "name"};
  EXPECT_EQ(nearestWord("maas_kg", words), "mass_kg");
  EXPECT_EQ(nearestWord("nmae", words), "name");
  EXPECT_EQ(nearestWord("quaternion", words), "");
}

// Compares the bounds of a TOML file with the parser that they protect: a text that the scanner of
// brackets and quotes accepts is never deeper than the bound. Found by an audit: four quotes at the
// end of a multi-line string hid the rest of the line from the scanner.

constexpr int kBound = 32;

std::string deepKey(int parts) {
  std::string key = "k";
  for (int i = 1; i < parts; ++i) key += ".k";
  return key;
}

int depthOf(const toml::node& node) {
  int most = 0;
  if (const auto* table = node.as_table()) {
    for (const auto& [key, value] : *table) most = std::max(most, depthOf(value));
  } else if (const auto* array = node.as_array()) {
    for (const toml::node& value : *array) most = std::max(most, depthOf(value));
  } else {
    return 0;
  }
  return most + 1;
}

/// Depth of the parsed text; -1: it is not TOML.
int parsedDepth(const std::string& text) {
  try {
    return depthOf(toml::parse(text));
  } catch (const toml::parse_error&) {
    return -1;
  }
}

TEST(TomlBounds, QuotesBeforeADeepKey_NeverHideIt) {
  constexpr std::array<const char*, 12> kTokens = {"\"\"\"", "'''", "\"", "'", "\\", "a",
                                                   "\n",     "#",   ",",  "",  "\"", "'"};
  const std::string deep = deepKey(2 * kBound);
  auto random = seededRandom(5601);
  int refused = 0;
  const int texts = cases(60'000);
  for (int i = 0; i < texts; ++i) {
    std::string text = i % 2 == 0 ? "x = [" : "x = ";
    for (std::size_t n = random() % 10; n > 0; --n) text += kTokens[random() % kTokens.size()];
    text += i % 2 == 0 ? ", {" + deep + " = 1}]\n" : "\n" + deep + " = 1\n";
    const int depth = parsedDepth(text);
    if (depth <= kBound) continue;
    ASSERT_TRUE(beyondBounds(text, "a.toml")) << text;
    ++refused;
  }
  EXPECT_GT(refused, texts / 300);  // the parser would have accepted some of these texts
}

TEST(TomlBounds, TextsWithMoreQuotesAtTheirEnd_EndWhereTheParserEndsThem) {
  const std::string deep = ", {" + deepKey(100) + " = 1}]\n";
  for (const std::string text : {R"("""x"""")", R"("""x""""")", "'''x''''", "'''x'''''",
                                 R"("""""")", R"("""\"""")", R"("""\\""")"}) {
    ASSERT_GE(parsedDepth("x = [" + text + "]\n"), 0) << text;
    EXPECT_FALSE(beyondBounds("x = [" + text + "]\n", "a.toml")) << text;
    EXPECT_TRUE(beyondBounds("x = [" + text + deep, "a.toml")) << text;
  }
}

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

// No look-up is quadratic: within a second, ten under a sanitizer. Measured in ./check --full.
TEST(TomlBounds, FileOfManyTables_IsRefusedWithinASecond) {
  const std::string head =
      "kind = \"scene\"\nversion = 1\nname = \"n\"\ngravity_m_s2 = [0, 0, -9.81]\n";
  std::string keys, long_keys;
  for (int i = 0; i < 11'900; ++i) {
    keys += "k" + std::to_string(i) + " = 1\n";
    long_keys += std::string(330, 'k') + std::to_string(i) + " = 1\n";
  }
  const Folder folder;
  for (const auto& [text, said] : std::initializer_list<std::pair<std::string, const char*>>{
           {"bodies = [" + repeated("{},", 1'000'000) + "]\n", "more than 12000 inline tables"},
           {"bodies = [" + repeated("{},", 11'000) + "]\n", "more faults"},
           {repeated("[[bodies]]\n", 1'199), "more faults"},
           {keys, "more faults"},
           {long_keys, "more faults"}}) {
    const std::string path = folder.write("many.toml", head + text);
    const double before_s = cpu_s();
    const Expected<SceneModel> scene = loadSceneFile(path);
    const double took_s = cpu_s() - before_s;
    if (fullCounts()) {
      EXPECT_LE(took_s, WHOLEHAND_SANITIZED ? 10.0 : 1.0) << text.substr(0, 40);
    }
    ASSERT_FALSE(scene.ok());
    EXPECT_LE(scene.errors().size(), 21U);
    EXPECT_TRUE(refusedWith(scene, said));
  }
}

}  // namespace
}  // namespace wholehand::test
