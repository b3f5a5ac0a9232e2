#include "picture/picture.hpp"

#include "model/device_model.hpp"
#include "model/hand_file.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

struct Decoded {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb;

  [[nodiscard]] std::array<int, 3> at(int x, int y) const {
    const auto i = static_cast<std::size_t>(3 * (y * width_px + x));
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
  [[nodiscard]] int light(int x, int y) const {
    const auto [r, g, b] = at(x, y);
    return r + g + b;
  }
  /// The backdrop is teal: only what stands before it is redder than blue.
  [[nodiscard]] bool warm(int x, int y) const { return at(x, y)[0] > at(x, y)[2] + 8; }
};

/// Reads a PNG with libpng; empty when it is none.
Decoded decode(const std::string& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) return {};
  image.format = PNG_FORMAT_RGB;
  Decoded out{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  out.rgb.resize(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, out.rgb.data(), 0, nullptr) == 0) return {};
  return out;
}

class Picture : public testing::Test {
 protected:
  void SetUp() override {
    request_.width_px = 120;
    request_.height_px = 80;
    request_.samples = 2;
    request_.elevation_rad = 0.2;
  }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_.file(name); }

  /// No hand: an empty model is a picture of the scene alone.
  Expected<Done> draw(const std::string& file) {
    return drawPicture({}, scene_, {}, bodies_, contacts_, request_, file);
  }

  void addSphere(double radius_m, const Eigen::Vector3d& at_m) {
    Shape shape;
    shape.type = ShapeType::kSphere;
    shape.radius_m = radius_m;
    SceneBody body;
    body.name = "ball";
    body.color = "#FF5020";
    body.shapes = {shape};
    scene_.bodies.push_back(body);
    BodyState state;
    state.position_m = Vec3::from(at_m);
    bodies_.push_back(state);
  }

  void addContact(const Eigen::Vector3d& at_m, double force_n) {
    Contact contact;
    contact.capsule = static_cast<int>(contacts_.size());
    contact.body = 0;
    contact.point_m = Vec3::from(at_m);
    contact.force_n = {0.0, 0.0, force_n};
    contacts_.push_back(contact);
  }

  const test::Folder folder_;
  SceneModel scene_;
  std::vector<BodyState> bodies_;
  std::vector<Contact> contacts_;
  PictureRequest request_;
};

TEST_F(Picture, OfTheShippedHand_DecodesAndShowsSkinOnABackdrop) {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
  const auto device = loadDeviceFile(config + "devices/lambda-pride.toml");
  const auto file = loadHandFile(config + "hands/adult-median-right.toml");
  ASSERT_TRUE(device.ok() && file.ok());
  const auto hand = assembleHand(*file, *device);
  ASSERT_TRUE(hand.ok());
  request_.target_m = {0.05, 0.0, 0.0};  // 5 cm before the palm's origin: the knuckles
  request_.azimuth_rad = 1.2;
  ASSERT_TRUE(drawPicture(*hand, {}, hand->theta0, {}, {}, request_, path("hand.png")).ok());
  const Decoded picture = decode(path("hand.png"));
  ASSERT_EQ(picture.width_px, 120);
  ASSERT_EQ(picture.height_px, 80);
  EXPECT_TRUE(picture.warm(60, 40));
  EXPECT_FALSE(picture.warm(2, 2));
  EXPECT_FALSE(picture.warm(117, 77));
}

TEST_F(Picture, OfASphere_HasTheAnalyticSilhouette) {
  request_.target_m = {0.3, -0.2, 0.1};
  request_.azimuth_rad = -0.7;
  addSphere(0.04, request_.target_m);
  ASSERT_TRUE(draw(path("ball.png")).ok());
  const Decoded picture = decode(path("ball.png"));
  ASSERT_EQ(picture.width_px, 120);
  int covered = 0, left = 120, right = -1, top = 80, bottom = -1;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      if (!picture.warm(x, y)) continue;
      ++covered;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
  }
  // The cone of rays that touch a sphere: half angle asin(R/D), seen by a pinhole.
  const double focal_px = 40.0 / std::tan(0.25);
  const double expected_px = focal_px * std::tan(std::asin(0.04 / request_.distance_m));
  EXPECT_NEAR(std::sqrt(covered / 3.14159265358979), expected_px, 1.0);
  EXPECT_NEAR(0.5 * (right - left + 1), expected_px, 1.0);
  EXPECT_NEAR(0.5 * (bottom - top + 1), expected_px, 1.0);
  EXPECT_NEAR(0.5 * (right + left + 1), 60.0, 1.0);
  EXPECT_NEAR(0.5 * (bottom + top + 1), 40.0, 1.0);
}

TEST_F(Picture, OfABodyWhoseCentreOfMassIsOff_ShowsItWhereItsFrameIs) {
  addSphere(0.03, {0.0, 0.0, 0.0});
  scene_.bodies[0].com_m = {0.0, 0.05, 0.0};
  bodies_[0].position_m = {0.0, 0.05, 0.0};  // the state is that of the centre of mass
  ASSERT_TRUE(draw(path("off.png")).ok());
  EXPECT_TRUE(decode(path("off.png")).warm(60, 40));
}

TEST_F(Picture, OfAContact_GlowsAtItsProjection) {
  request_.azimuth_rad = 0.0;
  request_.elevation_rad = 0.0;
  addSphere(0.03, {0.0, 0.0, 0.0});
  addContact({0.0, -0.06, 0.02}, 3.0);
  request_.show_contacts = false;
  ASSERT_TRUE(draw(path("dark.png")).ok());
  request_.show_contacts = true;
  ASSERT_TRUE(draw(path("glow.png")).ok());
  const Decoded dark = decode(path("dark.png")), glow = decode(path("glow.png"));
  // Camera 0.5 m behind on -x, so -y is to the right and z up: x = W/2 + f 0.06/0.5.
  const double focal_px = 40.0 / std::tan(0.25);
  const int x = static_cast<int>(60.0 + focal_px * 0.06 / 0.5);
  const int y = static_cast<int>(40.0 - focal_px * 0.02 / 0.5);
  EXPECT_GT(glow.light(x, y), dark.light(x, y) + 150);
  EXPECT_EQ(glow.at(20, 60), dark.at(20, 60));  // far away nothing changes
}

TEST_F(Picture, OfAStrongerContact_GlowsWider) {
  addSphere(0.01, {0.0, 0.2, 0.0});
  const auto lit = [&](double force_n) {
    contacts_.clear();
    addContact({0.0, 0.0, 0.0}, force_n);
    EXPECT_TRUE(draw(path("lit.png")).ok());
    const Decoded picture = decode(path("lit.png"));
    int count = 0;
    for (int y = 0; y < 80; ++y) {
      for (int px = 0; px < 120; ++px) count += picture.warm(px, y) ? 1 : 0;
    }
    return count;
  };
  const int none = lit(0.0), weak = lit(0.5), strong = lit(3.0);
  EXPECT_GT(weak, none);
  // Diameter 19 + 6.6 mm/N: 22.3 and 38.8 mm, so three times the area.
  EXPECT_GT(strong - none, 2 * (weak - none));
}

TEST_F(Picture, DrawnTwice_IsTheSameFile) {
  addSphere(0.04, {0.0, 0.0, 0.0});
  addContact({0.0, 0.0, 0.04}, 2.0);
  ASSERT_TRUE(draw(path("a.png")).ok());
  ASSERT_TRUE(draw(path("b.png")).ok());
  std::ifstream a(path("a.png"), std::ios::binary), b(path("b.png"), std::ios::binary);
  const std::string first{std::istreambuf_iterator<char>(a), {}};
  const std::string second{std::istreambuf_iterator<char>(b), {}};
  EXPECT_FALSE(first.empty());
  EXPECT_EQ(first, second);
}

TEST_F(Picture, ToAMissingFolder_SaysSoAndLeavesNothing) {
  const std::string target = path("missing/hand.png");
  const auto result = draw(target);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.errors().front().file, target);
  EXPECT_NE(result.errors().front().problem.find("cannot be written"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(Picture, OverAFolder_SaysSoAndLeavesNoPartialFile) {
  fs::create_directories(path("hand.png/inside"));
  ASSERT_FALSE(draw(path("hand.png")).ok());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(Picture, OfAnImpossibleRequest_NamesEveryFault) {
  addSphere(0.04, {0.0, 0.0, 0.0});
  bodies_[0].position_m.x = std::nan("");
  request_.width_px = 0;
  request_.samples = 0;
  request_.distance_m = std::nan("");
  const auto result = draw(path("never.png"));
  ASSERT_FALSE(result.ok());
  std::string keys;
  for (const Diagnostic& d : result.errors()) keys += d.key + " ";
  EXPECT_EQ(keys, "width_px samples distance_m bodies[0] ");
  EXPECT_FALSE(fs::exists(path("never.png")));
}

}  // namespace
}  // namespace wholehand
