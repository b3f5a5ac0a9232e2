// Damaged inputs at the doors: files of every kind, targets of HTTP, black boxes whose checksums
// are right. Each ends in a value or in a refusal with a remedy, within a second of processor. 10^5
// TOML files and 10^4 of every other kind under WHOLEHAND_FULL=1.
#include "core/crc32.hpp"
#include "model/device_model.hpp"
#include "model/hand_file.hpp"
#include "model/patient_config.hpp"
#include "model/rendering_config.hpp"
#include "model/scene_model.hpp"
#include "model/urdf.hpp"
#include "patient/motion.hpp"
#include "server/http_text.hpp"
#include "server/site.hpp"
#include "support/folder.hpp"
#include "support/mutation.hpp"
#include "support/seed.hpp"
#include "telemetry/black_box.hpp"
#include "telemetry/black_box_layout.hpp"
#include "telemetry/black_box_reader.hpp"
#include "telemetry/synthetic_recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

std::string readAll(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int inputs(int sampled, int full) {
  return std::getenv("WHOLEHAND_FULL") != nullptr ? full : sampled;
}

/// The longest that one input took of a processor [s].
class Longest {
 public:
  template <class F>
  void time(F&& f) {
    const double before_s = now_s();
    f();
    longest_s_ = std::max(longest_s_, now_s() - before_s);
  }
  [[nodiscard]] double s() const { return longest_s_; }

 private:
  static double now_s() {
    timespec t{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  double longest_s_ = 0.0;
};

/// Loads `count` mutants of a file. @param load its faults; none: it was loaded
void expectLoadsOrSaysWhy(const std::string& good, const std::string& name, int count,
                          std::mt19937_64& random,
                          const std::function<Diagnostics(const std::string& path)>& load) {
  const Folder folder;
  const std::string path = folder.file(name);
  Longest longest;
  int loaded = 0;
  for (int i = 0; i < count; ++i) {
    std::ofstream(path, std::ios::binary) << mutated(good, random);
    longest.time([&] {
      const Diagnostics faults = load(path);
      loaded += faults.empty() ? 1 : 0;
      ASSERT_LE(faults.size(), 21U) << "twenty, and how many more";
      for (const Diagnostic& fault : faults) {
        EXPECT_FALSE(fault.problem.empty());
        EXPECT_FALSE(fault.remedy.empty()) << format(fault);
      }
    });
  }
  EXPECT_LE(longest.s(), 1.0);
  std::printf("figure: %s: %d of %d loaded, at most %.3f s\n", name.c_str(), loaded, count,
              longest.s());
}

template <class T>
Diagnostics faultsOf(const Expected<T>& loaded) {
  return loaded ? Diagnostics{} : loaded.errors();
}

struct TomlDoor {
  const char* file;
  std::function<Diagnostics(const std::string& path)> load;
};

const DeviceModel& device() {
  static const DeviceModel model =
      loadDeviceFile(WHOLEHAND_SOURCE_DIR "/config/devices/lambda-pride.toml").value();
  return model;
}

class Toml : public testing::TestWithParam<TomlDoor> {};

TEST_P(Toml, RandomDamage_LoadsOrSaysWhy) {
  auto random = seededRandom(901);
  const std::string good = readAll(std::string(WHOLEHAND_SOURCE_DIR "/config/") + GetParam().file);
  ASSERT_FALSE(good.empty());
  expectLoadsOrSaysWhy(good, "a.toml", inputs(60, 20'000), random, GetParam().load);
}

INSTANTIATE_TEST_SUITE_P(
    EveryKind, Toml,
    testing::Values(
        TomlDoor{"devices/lambda-pride.toml",
                 [](const std::string& p) { return faultsOf(loadDeviceFile(p)); }},
        TomlDoor{"hands/adult-median-right.toml",
                 [](const std::string& p) { return faultsOf(loadHandFile(p)); }},
        TomlDoor{"rendering/lambda-pride.toml",
                 [](const std::string& p) { return faultsOf(loadRenderingFile(p, device())); }},
        TomlDoor{"patients/spastic-fist.toml",
                 [](const std::string& p) { return faultsOf(loadPatientFile(p, device())); }},
        TomlDoor{"scenes/cocktail-bar.toml",
                 [](const std::string& p) { return faultsOf(loadSceneFile(p)); }}));

TEST(Csv, RandomDamage_LoadsOrSaysWhy) {
  auto random = seededRandom(902);
  std::string good = readAll(WHOLEHAND_SOURCE_DIR "/data/human-motion/reach-grasp-00.csv");
  good.resize(std::min<std::size_t>(good.size(), 4096));
  good.resize(good.rfind('\n') + 1);
  expectLoadsOrSaysWhy(good, "a.csv", inputs(200, 10'000), random,
                       [](const std::string& p) { return faultsOf(loadMotionFile(p)); });
}

TEST(Urdf, RandomDamage_LoadsOrSaysWhy) {
  auto random = seededRandom(903);
  const std::string good = readAll(WHOLEHAND_SOURCE_DIR "/config/scenes/assets/mug.urdf");
  ASSERT_FALSE(good.empty());
  expectLoadsOrSaysWhy(good, "a.urdf", inputs(200, 10'000), random,
                       [](const std::string& p) { return faultsOf(loadUrdf(p)); });
}

TEST(HttpTarget, RandomDamage_NeverLeavesTheFolder) {
  auto random = seededRandom(904);
  const std::vector<std::string> good = {"/recordings/night%20shift.h5?token=a-long-secret&x=1",
                                         "/assets/../%2e%2e/etc/passwd", "/report/a/%c3%bc.html",
                                         "/..%2f..%2f%5c%00?token"};
  int taken = 0;
  for (int i = 0; i < inputs(20'000, 10'000'000); ++i) {
    HttpRequest request;
    request.target = mutated(good[static_cast<std::size_t>(i) % good.size()], random);
    (void)Site::needsOf(request);
    (void)request.credentials();
    (void)queryValue(request.query(), "token");
    const auto path = decodedPath(request.path());
    if (!path) continue;
    ++taken;
    ASSERT_EQ(path->find("/../"), std::string::npos) << *path;
    ASSERT_FALSE(path->ends_with("/..")) << *path;
    ASSERT_EQ(path->find('\0'), std::string::npos);
    ASSERT_EQ(path->find('\\'), std::string::npos);
  }
  EXPECT_GT(taken, 100);
}

/// Where each part of a box lies, head included, without its checksum.
struct Span {
  std::size_t begin = 0, head = 0, end = 0;
};

std::vector<Span> partsOf(const std::string& box) {
  std::vector<Span> parts = {{0, 0, offsetof(black_box::Header, crc)}};
  for (std::size_t at = sizeof(black_box::Header); at < box.size();) {
    black_box::PartHeader head;
    std::memcpy(&head, box.data() + at, sizeof head);
    const std::size_t end = at + sizeof head + head.bytes;
    parts.push_back({at, sizeof head, end});
    at = end + sizeof(std::uint32_t);
  }
  return parts;
}

/// Damage that somebody has made on purpose: every checksum is right again.
std::string forged(std::string box, const std::vector<Span>& parts, std::mt19937_64& random) {
  for (std::size_t n = 1 + random() % 4; n > 0; --n) {
    const Span& part = parts[random() % parts.size()];
    const std::size_t at = part.begin + random() % (part.end - part.begin);
    const std::size_t length = std::min<std::size_t>(part.end - at, 1 + random() % 8);
    const bool all_ones = random() % 3 == 0;
    for (std::size_t i = at; i < at + length; ++i) {
      box[i] = all_ones ? '\xFF' : static_cast<char>(random());
    }
  }
  for (const Span& part : parts) {
    const std::uint32_t crc = crc32(0, reinterpret_cast<const std::byte*>(box.data()) + part.begin,
                                    part.end - part.begin);
    std::memcpy(box.data() + part.end, &crc, sizeof crc);
  }
  return box;
}

TEST(BlackBoxFile, ForgedWithRightChecksums_IsReadWithinItsShapesOrRefused) {
  auto random = seededRandom(905);
  const Folder folder;
  BlackBoxPlan plan;
  plan.path = folder.file("a.wbb");
  plan.encoder_step.assign(6, 1e-5);
  plan.most_ticks = 100;
  {
    auto box = BlackBox::arm(synthetic::meta(), plan).value();
    std::mt19937_64 noise(1);
    for (std::uint64_t i = 0; i < 40; ++i) {
      const TickRecord record = synthetic::noisy(i, noise);
      box->beforeTick(record);
      box->afterTick(record);
    }
    ASSERT_TRUE(box->write());
  }
  const std::string good = readAll(plan.path), path = folder.file("forged.wbb");
  const std::vector<Span> parts = partsOf(good);
  ASSERT_EQ(parts.size(), 6U);
  ASSERT_EQ(parts.back().end + sizeof(std::uint32_t), good.size());
  int read = 0, refused = 0;
  Longest longest;
  for (int i = 0; i < inputs(400, 10'000); ++i) {
    std::ofstream(path, std::ios::binary) << forged(good, parts, random);
    longest.time([&] {
      const auto opened = BlackBoxReader::openBox(path);
      if (!opened) {
        ++refused;
        EXPECT_FALSE(opened.errors().front().remedy.empty());
        return;
      }
      ++read;
      TickRecord record;
      for (std::uint64_t k = 0; k < opened.value()->size() && opened.value()->read(k, record);
           ++k) {
        ASSERT_GE(record.contact_count, 0);
        ASSERT_LE(record.contact_count, kMaxContacts);
        ASSERT_LE(record.body_count, static_cast<std::int32_t>(record.bodies.size()));
        ASSERT_LE(record.q_m.size(), kMaxAxes);
        ASSERT_LE(record.sent.size(), kMaxAxes);
      }
      TickInput input;
      for (int k = 0; k < 1000 && opened.value()->nextInput(input); ++k) {
        ASSERT_GE(input.command_count, 0);
        ASSERT_LE(input.command_count, kMaxCommands);
      }
    });
  }
  EXPECT_GT(read, 0);
  EXPECT_GT(refused, 0);
  EXPECT_LE(longest.s(), 1.0);
  std::printf("figure: black boxes: %d read, %d refused, at most %.3f s\n", read, refused,
              longest.s());
}

}  // namespace
}  // namespace wholehand::test
