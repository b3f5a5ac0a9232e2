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

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <array>
#include <iterator>

namespace wholehand::test {
namespace {

// Single mistakes are rows of tests/exercises/faults.txt.

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
