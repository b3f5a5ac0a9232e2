// Mistakes in files: a row of faults.txt each.
#include "exercises/bar_table.hpp"
#include "files/device/device_file.hpp"
#include "files/device/rendering_file.hpp"
#include "files/hand/hand_file.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/patient/patient_file.hpp"
#include "files/scene/scene_file.hpp"
#include "files/scene_text.hpp"
#include "files/urdf/urdf.hpp"
#include "support/constants.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/toml_lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

/// Parts of a text between separators.
std::vector<std::string> parts(const std::string& text, const std::string& separator) {
  std::vector<std::string> out;
  std::size_t from = 0;
  for (std::size_t to; (to = text.find(separator, from)) != std::string::npos;) {
    out.push_back(text.substr(from, to - from));
    from = to + separator.size();
  }
  out.push_back(text.substr(from));
  return out;
}

std::string replacedAll(std::string text, const std::string& find, const std::string& with) {
  for (std::size_t at; (at = text.find(find)) != std::string::npos;) {
    text.replace(at, find.size(), with);
  }
  return text;
}
std::string withLineEnds(const std::string& text) {
  return replacedAll(text, "\\n", "\n");
}
constexpr const char* kBall =
    "<collision><geometry><sphere radius=\"0.02\"/></geometry></collision>";

/// A row of the table; one of text has words in `key`.
struct Mistake {
  std::string file, loaded, device = "lambda-pride";
  std::string around, find, replacement, key, said, remedy, line;
};

std::vector<Mistake> readTable() {
  std::vector<Mistake> out;
  Mistake section;
  for (const std::string& text :
       linesOf(bytesOfFile(std::string(WHOLEHAND_SOURCE_DIR) + "/tests/exercises/faults.txt"))) {
    if (text.empty() || text[0] == '#') continue;
    if (text.starts_with("== text ")) {
      section = {.file = text.substr(8, text.find(' ', 8) - 8)};
      section.around = text.substr(9 + section.file.size());
      continue;
    }
    if (text.starts_with("== ")) {
      const std::vector<std::string> on = parts(text.substr(3), " on "), of = parts(on[0], " for ");
      section = {.file = of.front(), .loaded = of.back()};
      if (on.size() > 1) section.device = on[1];
      continue;
    }
    std::vector<std::string> columns = parts(text, " | ");
    if (!section.around.empty()) {
      Mistake& row = out.emplace_back(section);
      row.find = withLineEnds(replaced(section.around, "{}", columns[0]));
      row.find = replacedAll(row.find, "$BALL", kBall);
      row.key = columns.at(1);
      continue;
    }
    const std::vector<std::string> change = parts(columns[0], " -> ");
    if (columns.size() < 3 || change.size() != 2) throw std::runtime_error("no row: " + text);
    columns.resize(5);
    Mistake& row = out.emplace_back(section);
    row.find = withLineEnds(change[0]);
    row.replacement = withLineEnds(change[1]);
    row.key = columns[1], row.said = columns[2], row.remedy = columns[3];
    row.line = withLineEnds(columns[4]);
  }
  return out;
}

/// What is said about a file of this copy of config/.
Diagnostics saidOf(const std::string& path, const std::string& device_name) {
  const auto faults = [](const auto& loaded) {
    return loaded.ok() ? Diagnostics{} : loaded.errors();
  };
  const std::string kind = fs::path(path).parent_path().filename();
  if (kind == "devices") return faults(loadDeviceFile(path));
  if (kind == "hands") return faults(loadHandFile(path));
  if (kind == "scenes") return faults(loadSceneFile(path));
  const DeviceModel device = loadDeviceFile(kConfig + "devices/" + device_name + ".toml").value();
  if (kind == "rendering") return faults(loadRenderingFile(path, device));
  if (kind == "patients") return faults(loadPatientFile(path, device));
  const auto exercise = loadExercise(path, 1, shippedDevice(), shippedHand());
  return exercise.ok() ? exercise->scene.notices : exercise.errors();
}

/// The line that the row names, or a changed one. @param text changed at `at`
testing::AssertionResult namesTheLine(const Mistake& row, const std::string& text, std::size_t at,
                                      int line) {
  const auto lineAt = [&](std::size_t place) {
    return 1 + static_cast<int>(
                   std::count(text.begin(), text.begin() + static_cast<long>(place), '\n'));
  };
  const std::vector<std::string> lines = linesOf(text);
  const std::string is = line > 0 && line <= static_cast<int>(lines.size()) ? lines[line - 1] : "";
  bool right = line > 0;
  if (row.line.starts_with('^')) {
    right = text.find(row.line.substr(1)) != std::string::npos &&
            line == lineAt(text.find(row.line.substr(1)));
  } else if (!row.line.empty()) {
    right = is.find(row.line) != std::string::npos;
  } else if (!row.replacement.empty()) {
    right = line >= lineAt(at) && line <= lineAt(at + row.replacement.size() - 1);
  }
  if (right) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "line " << line << " is named: " << is;
}

/// A text that is refused, beside the files that it names.
void expectRefusal(const Folder& folder, const Mistake& row) {
  SCOPED_TRACE(row.find);
  const bool urdf = row.file == "urdf";
  const std::string path =
      folder.write("bad." + row.file,
                   urdf ? "<?xml version=\"1.0\"?>\n<robot name=\"r\">" + row.find + "</robot>\n"
                        : kSceneHead + row.find + "\n");
  MeshLoadTime time;
  const Diagnostics faults = urdf ? loadUrdf(path, time, {.inertia = InertiaRule::kRefuse}).errors()
                                  : loadSceneFile(path).errors();
  EXPECT_EQ(format(faults).find(folder.file("")), 0U) << format(faults);
  const bool more = row.key.starts_with('+');
  EXPECT_TRUE(more || faults.size() == 1U) << format(faults);
  for (const std::string& words : parts(row.key.substr(more ? 1 : 0), " & ")) {
    EXPECT_TRUE(contains(format(faults), words));
  }
  EXPECT_FALSE(faults.front().remedy.empty());
}

/// A copy of config/ in which one file at a time is changed.
class ChangedConfig {
 public:
  ChangedConfig() { fs::copy(kConfig, folder_.path(), fs::copy_options::recursive); }
  void expectFault(const Mistake& row) {
    SCOPED_TRACE(row.file + ": " + row.find + " -> " + row.replacement);
    const std::string good = bytesOfFile(folder_.file(row.file));
    const std::string text = replaced(good, row.find, row.replacement);
    folder_.write(row.file, text);
    const Diagnostics faults = saidOf(folder_.file(row.loaded), row.device);
    folder_.write(row.file, good);
    const bool more = row.key.starts_with('+');
    const std::string key = row.key.substr(more ? 1 : 0);
    const auto found = std::find_if(faults.begin(), faults.end(),
                                    [&](const Diagnostic& fault) { return fault.key == key; });
    ASSERT_NE(found, faults.end()) << format(faults);
    EXPECT_TRUE(more || faults.size() == 1U) << format(faults);
    const Diagnostic& fault = *found;
    for (const std::string& words : parts(row.said, " & ")) {
      if (words == "TYPE") {
        EXPECT_EQ(fault.code, DiagnosticCode::kType) << format(fault);
      } else {
        EXPECT_TRUE(contains(fault.value + ": " + fault.problem + "; " + fault.remedy, words));
      }
    }
    EXPECT_TRUE(contains(fault.remedy, row.remedy)) << format(fault);
    EXPECT_FALSE(fault.remedy.empty()) << format(fault);
    if (fault.file.ends_with(row.file)) {
      EXPECT_TRUE(namesTheLine(row, text, good.find(row.find), fault.line)) << format(fault);
    } else {
      EXPECT_TRUE(fault.file.ends_with(row.loaded)) << format(fault);
      EXPECT_TRUE(namesTheLine(row, bytesOfFile(fault.file), 0, fault.line)) << format(fault);
    }
  }

 private:
  const Folder folder_;
};

TEST(FaultTable, EveryMistake_GivesOneMessageWithPlaceAndRemedy) {
  ChangedConfig config;
  const std::vector<Mistake> rows = readTable();
  EXPECT_GT(rows.size(), 230U);
  const Folder folder;
  folder.write("empty.stl", "");
  folder.write("empty.urdf", "");
  folder.write("box.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n");
  folder.write("lid.urdf",
               "<robot name=\"r\">\n<link name=\"a\"/><link name=\"b\"/>\n\n<joint "
               "name=\"lid\" type=\"revolute\"><limit lower=\"1\" upper=\"0.5\"/><parent "
               "link=\"a\"/><child link=\"b\"/></joint></robot>");
  for (const Mistake& row : rows) {
    row.around.empty() ? config.expectFault(row) : expectRefusal(folder, row);
  }
}

// Every key of every kind of file, whatever the rows say.
TEST(FaultTable, KeyOfAnotherTypeNameOrSize_IsRefusedWithItsLineAndARemedy) {
  const Folder folder;
  fs::copy(kConfig, folder.path(), fs::copy_options::recursive);
  auto random = seededRandom(96);
  for (const std::string file :
       {"devices/lambda-pride", "rendering/lambda-pride", "hands/adult-median-right",
        "scenes/four-shapes", "patients/relaxed-adult", "patients/tremor", "patients/spastic",
        "patients/releases", "patients/slams", "patients/fights", "exercises/cocktail-bar"}) {
    const std::string good = bytesOfFile(folder.file(file + ".toml"));
    const std::vector<std::string> lines = linesOf(good);
    const std::vector<KeyLine> keys = keyLines(lines);
    EXPECT_GT(keys.size(), 30U) << file;
    for (const KeyLine& key : keys) {
      for (const std::string& wrong : wrongLines(key, random)) {
        SCOPED_TRACE(file + ": " + lines[key.line] + " -> " + wrong);
        std::vector<std::string> changed = lines;
        changed[key.line] = wrong;
        const Diagnostics faults =
            saidOf(folder.write(file + ".toml", joined(changed)), "lambda-pride");
        // A key under another name may be reported as missing at the start of its table.
        const bool renamed = wrong.starts_with(key.key + "_x");
        const auto fault = std::find_if(faults.begin(), faults.end(), [&](const Diagnostic& d) {
          return d.key.find(key.key) != std::string::npos &&
                 (renamed || d.line == static_cast<int>(key.line) + 1);
        });
        ASSERT_NE(fault, faults.end()) << format(faults);
        EXPECT_FALSE(fault->remedy.empty());
      }
    }
    folder.write(file + ".toml", good);
  }
}

}  // namespace
}  // namespace wholehand::test
