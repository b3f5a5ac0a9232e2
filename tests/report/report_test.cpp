#include "report/report.hpp"

#include "report/report_data.hpp"
#include "telemetry/synthetic_recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <signal.h>
#include <sys/resource.h>

namespace wholehand {
namespace {

using synthetic::Folder;

std::string readFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string printed(const char* form, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), form, value);
  return text.data();
}

/// 4 s of a simple story: the fingers press the sphere from 1.0 to 1.5 s and, with the thumb, hold
/// the cylinder from 2.0 to 3.5 s while it moves 20 cm along y; the cube is never touched.
struct Story {
  RecordingMeta meta = synthetic::meta();
  std::uint64_t skipped = 0;
  Fault faults = Fault::kNone;               ///< of every hundredth tick
  int fault_axis = -1;                       ///< and of the first of them another axis
  std::uint64_t lost_from = 0, lost_to = 0;  ///< ticks that never reached the disk
  double largest_tip_n = 0.0, largest_z_n = 0.0;

  Story() {
    meta.seed = 42;
    meta.capsule_names = {"palm_1", "index_distal", "thumb_distal"};
    meta.files = {{"d.toml", "kind = \"device\"\nname = \"lambda-pride\"\n"}};
  }

  TickRecord tick(std::uint64_t number, std::uint32_t elapsed) {
    TickRecord r;
    r.tick = number;
    r.time_s = static_cast<double>(number) * 1e-3;
    r.elapsed_periods = elapsed;
    r.wall_ns = 60000 + static_cast<std::int64_t>(number % 100) * 1000;  // 60 .. 159 µs, evenly
    r.cpu_ns = r.wall_ns / 2;
    r.q_m = r.q_s = AxisPosition(6, 0.1);
    r.phi = AxisRatio(6, r.time_s < 1.0 ? 0.9 : 0.1);
    r.sent = AxisEffort(6);
    r.sent[3] = -0.5 * std::sin(r.time_s);  // N·m, lever arm 0.08 m
    r.sent[2] = 3.0 * std::cos(r.time_s);
    largest_tip_n = std::max(largest_tip_n, std::abs(r.sent[3]) / 0.08);
    largest_z_n = std::max(largest_z_n, std::abs(r.sent[2]));
    if (number % 100 == 0) {
      r.faults = faults;
      r.fault_axis = number == 0 ? 1 : fault_axis;
    }
    r.palm_distance_m = 0.05;
    r.body_count = 4;
    const double share = std::clamp((r.time_s - 2.0) / 1.5, 0.0, 1.0);
    r.bodies[2].position_m = {0.0, 0.2 * share, 0.0};
    if (r.time_s >= 1.0 && r.time_s < 1.5) touch(r, 1, 1, 2.5);
    if (r.time_s >= 2.0 && r.time_s < 3.5) {
      touch(r, 1, 2, 4.0);
      touch(r, 2, 2, 5.0);
    }
    return r;
  }

  static void touch(TickRecord& r, int capsule, int body, double force_n) {
    Contact& c = r.contacts[static_cast<std::size_t>(r.contact_count++)];
    c.capsule = capsule;
    c.body = body;
    c.force_n = {0.0, 0.6 * force_n, 0.8 * force_n};  // 3-4-5 triangle: its length is force_n
  }

  void write(const std::string& path) {
    auto writer = RecordingWriter::create(path, meta).value();
    for (std::uint64_t i = 0; i < 4000; ++i) {
      const bool skip = i % 1000 == 500;  // one period is lost before these
      if (skip) ++skipped;
      if (i % 1000 == 499 || (i >= lost_from && i < lost_to)) continue;
      ASSERT_TRUE(writer->append(tick(i, skip ? 2 : 1)));
    }
  }
};

TEST(Report, SyntheticRecording_ShowsTheFiguresComputedIndependently) {
  const Folder folder;
  Story story;
  story.write(folder.file("run.h5"));
  const auto done = writeReport(folder.file("run.h5"), folder.file("out"));
  ASSERT_TRUE(done.ok()) << format(done.errors());
  const std::string page = readFile(folder.file("out/index.html"));
  const auto has = [&page](const std::string& text) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  };
  has("<h1>Reach and grasp</h1>");
  has("20 Nov 2026, 09:38 UTC");
  has("lambda-pride, 6 axes");
  has("<b>4.0 s</b><span>length of the recording");
  has("<b>" + printed("%.1f", story.largest_tip_n) +
      " <small>N, limit 10</small></b><span>largest effort, fingers");  // 0.8 N·m / 0.08 m
  has("<b>" + printed("%.1f", story.largest_z_n) +
      " <small>N, limit 20</small></b><span>largest effort, arm z");
  has("<b>2 <small>of 4 objects</small></b><span>touched; moved 0.20 m in all");
  has("<b>0 <small>faults</small></b><span>no limit reached");
  has("<b>" + std::to_string(story.skipped) + " <small>of 4,000</small>");
  has("deadlines missed");
  // first touch, touches, longest, held, force, way: by the story; 4 N + 5 N; 20 cm less a last
  // step under 1 mm
  has("<td>sphere</td><td>1.0</td><td>1</td><td>0.50</td><td>0.0</td><td>2.5</td><td>0.0</td>");
  has("<td>cylinder</td><td>2.0</td><td>1</td><td>1.50</td><td>1.5</td><td>9.0</td><td>19.9</td>");
  has("<td>cube</td><td>–</td><td>0</td>");
  has("<td>Damping Φ above 0.5</td><td>25 % of the time</td>");  // the first of four seconds
  // Durations 60 .. 159 µs, evenly: nearest rank p50 109 µs, p99 158 µs, within the bins' 1 %.
  std::smatch found;
  ASSERT_TRUE(std::regex_search(page, found, std::regex("p50 (\\d+) µs")));
  EXPECT_NEAR(std::stod(found[1]), 109.0, 1.6);
  ASSERT_TRUE(std::regex_search(page, found, std::regex("p99 (\\d+) µs")));
  EXPECT_NEAR(std::stod(found[1]), 158.0, 2.1);
}

TEST(Report, MissingTicks_AreToldAndNoLineLeadsAcross) {
  const Folder folder;
  Story story;
  story.lost_from = 1600;
  story.lost_to = 2600;  // none of them was skipped by the loop but 2499: a period without record
  story.write(folder.file("run.h5"));
  const auto data = collectReport(folder.file("run.h5"), 500);
  ASSERT_TRUE(data.ok());
  EXPECT_EQ(data->missing_ticks, 1000U);
  for (const auto* line : {&data->contact_force_n, &data->axes[3].effort, &data->axes[0].device}) {
    for (std::size_t i = 1; i < line->size(); ++i) {
      const PlotPoint &a = (*line)[i - 1], &b = (*line)[i];
      const bool joined = std::isfinite(a.y) && std::isfinite(b.y);
      EXPECT_FALSE(joined && a.x < 1.61 && b.x > 2.59) << a.x << " to " << b.x;
    }
  }
  ASSERT_TRUE(writeReport(folder.file("run.h5"), folder.file("out")).ok());
  EXPECT_NE(readFile(folder.file("out/index.html")).find("<dt>Missing</dt><dd>1,000 ticks, 1.0 s"),
            std::string::npos);
}

TEST(Report, EmergencyStopAndRealDevice_AreTold) {
  const Folder folder;
  Story story;
  story.meta.simulated_device = false;
  story.faults = Fault::kEmergencyStop;
  story.write(folder.file("run.h5"));
  ASSERT_TRUE(writeReport(folder.file("run.h5"), folder.file("out")).ok());
  const std::string page = readFile(folder.file("out/index.html"));
  EXPECT_NE(page.find("<dt>Emergency stop</dt><dd>at 0.00 s"), std::string::npos);
  EXPECT_NE(page.find("lambda-pride, 6 axes, held by a person"), std::string::npos);
}

TEST(Report, FaultsOfAnAxis_NameTheOneThatHadMost) {
  const Folder folder;
  const auto page = [&folder](Fault faults, int axis) {
    Story story;
    story.faults = faults;
    story.fault_axis = axis;
    story.write(folder.file("run.h5"));
    EXPECT_TRUE(writeReport(folder.file("run.h5"), folder.file("out")).ok());
    return readFile(folder.file("out/index.html"));
  };
  const std::string axis = synthetic::meta().axis_names[4],
                    second = synthetic::meta().axis_names[1];
  // 4,000 ticks; the hundredth ones are all recorded.
  EXPECT_NE(page(Fault::kEffortLimit, 4).find("limit reached in 40 ticks, most on " + axis + "<"),
            std::string::npos);
  EXPECT_NE(page(Fault::kEffortLimit, 1).find("limit reached in 40 ticks, " + second + "<"),
            std::string::npos);
  EXPECT_NE(page(Fault::kWorkspace, 4).find("workspace left, most on " + axis + "<"),
            std::string::npos);
  EXPECT_NE(page(Fault::kPhysicsStep, -1).find("physics step failed<"), std::string::npos);
}

TEST(Report, Page_NeedsNothingFromOutside) {
  const Folder folder;
  Story story;
  story.write(folder.file("run.h5"));
  std::ofstream(folder.file("a.png"), std::ios::binary) << "\x89PNG\r\n\x1a\n"
                                                        << "rest";
  ASSERT_TRUE(writeReport(folder.file("run.h5"), folder.file("out"),
                          {{"A \"hand\" & <cube>", folder.file("a.png")}})
                  .ok());
  std::string page = readFile(folder.file("out/index.html"));
  // echo -ne '\x89PNG\r\n\x1a\nrest' | base64
  EXPECT_NE(page.find("src=\"data:image/png;base64,iVBORw0KGgpyZXN0\""), std::string::npos);
  EXPECT_NE(page.find("<figcaption>A &quot;hand&quot; &amp; &lt;cube&gt;</figcaption>"),
            std::string::npos);
  const std::string name_space = "http://www.w3.org/2000/svg";  // a name, not an address
  for (std::size_t at; (at = page.find(name_space)) != std::string::npos;) {
    page.erase(at, name_space.size());
  }
  for (const char* outside :
       {"http:", "https:", "//", "<link rel=\"style", "@import", "<script", "url("}) {
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  }
}

TEST(Report, TextsOfTheRecording_AreEscaped) {
  const Folder folder;
  Story story;
  const std::string attack = "\"><script>alert(1)</script>";
  story.meta.title = attack;
  story.meta.engine = attack;
  story.meta.git_version = attack;
  story.meta.created_utc = attack;
  story.meta.axis_names[1] = attack;
  story.meta.body_names[1] = attack;
  story.meta.files = {{"d", "kind = \"device\"\nname = \"<script>\"\n"}};
  story.write(folder.file("run.h5"));
  ASSERT_TRUE(writeReport(folder.file("run.h5"), folder.path()).ok());
  const std::string page = readFile(folder.file("index.html"));
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("\"><script"), std::string::npos);
  EXPECT_NE(page.find("<h1>&quot;&gt;&lt;script&gt;alert(1)&lt;/script&gt;</h1>"),
            std::string::npos);
}

TEST(Report, UnusableFolder_IsNamedAndNothingIsWritten) {
  const Folder folder;
  Story story;
  story.write(folder.file("run.h5"));
  const auto refused = [&folder](const std::string& out) {
    const auto done = writeReport(folder.file("run.h5"), out);
    return done.ok() ? std::string("written") : format(done.errors());
  };
  const std::string deep = folder.file("none/out"), file = folder.file("run.h5");
  EXPECT_NE(refused(deep).find(deep + ": cannot be written: No such file"), std::string::npos)
      << refused(deep);
  EXPECT_FALSE(std::filesystem::exists(folder.file("none")));
  EXPECT_NE(refused(file).find("Not a directory"), std::string::npos) << refused(file);

  ::signal(SIGXFSZ, SIG_IGN);  // the disk "fills" within the page
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  rlimit tight = before;
  tight.rlim_cur = 20000;
  ::setrlimit(RLIMIT_FSIZE, &tight);
  const std::string full = refused(folder.file("out"));
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(full.find("File too large"), std::string::npos) << full;
  EXPECT_FALSE(std::filesystem::exists(folder.file("out")));
}

TEST(Report, UnusableInputs_AreRefused) {
  const Folder folder;
  Story story;
  story.write(folder.file("run.h5"));
  RecordingWriter::create(folder.file("empty.h5"), story.meta).value()->close();
  const auto refused = [&folder](const std::string& in,
                                 const std::vector<ReportPicture>& pictures) {
    const auto done = writeReport(folder.file(in), folder.file("out"), pictures);
    EXPECT_FALSE(std::filesystem::exists(folder.file("out")));
    return done.ok() ? std::string("written") : format(done.errors());
  };
  EXPECT_NE(refused("none.h5", {}).find("No such file"), std::string::npos);
  EXPECT_NE(refused("empty.h5", {}).find("holds no ticks"), std::string::npos);
  EXPECT_NE(refused("run.h5", {{"", folder.file("none.png")}}).find("none.png: cannot be read"),
            std::string::npos);
  EXPECT_NE(refused("run.h5", {{"", folder.file("run.h5")}}).find("is no PNG picture"),
            std::string::npos);
}

}  // namespace
}  // namespace wholehand
