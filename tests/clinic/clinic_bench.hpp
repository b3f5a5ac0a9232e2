#pragma once

#include "clinic/clinic.hpp"
#include "support/folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::clinic {

constexpr std::int64_t kNoon_us = 1'795'867'200 * kSecond_us;  // 2026-11-28 12:00 UTC

class FakeClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_us() const override { return now; }
  [[nodiscard]] std::int64_t steady_us() const override { return steady; }
  [[nodiscard]] int offset_min(std::int64_t) const override { return offset; }
  void pass(std::int64_t us) {
    now += us;
    steady += us;
  }
  std::int64_t now = kNoon_us, steady = 1000 * kSecond_us;
  int offset = 60;
};

/// A station that obeys like the real one, or as the test sets.
class FakeStation final : public Station {
 public:
  [[nodiscard]] StationScene scene() const override {
    StationScene scene = now;
    for (const char* name : {"effort_limit_hand_tip_n", "effort_limit_arm_n"}) {
      if (const auto set = now.values.find(name); set != now.values.end()) {
        scene.limits.set(name, set->second);
      }
    }
    return scene;
  }
  [[nodiscard]] StationReply open(const VisitOrder& order) override {
    orders.push_back(order);
    if (meanwhile) meanwhile();
    if (reply.what != StationReply::Status::kAccepted) return reply;
    const PersonLimits before = scene().limits;
    now.values = now.initial;
    for (const auto& [name, value] : order.parameters) {
      // As in the real station, the next item of a visit does not raise a limit that was lowered.
      now.values[name] = now.visit == order.visit ? before.lowered(name, value) : value;
    }
    now.visit = order.visit;
    now.item = order.item;
    now.exercise = order.exercise;
    now.level = order.level;
    now.help = order.help;
    return reply;
  }
  [[nodiscard]] StationReply close(std::uint64_t visit) override {
    closed.push_back(visit);
    if (reply.what != StationReply::Status::kAccepted) return reply;
    now.visit = 0;
    now.values = now.initial;
    return reply;
  }
  StationScene now = [] {
    StationScene scene;
    scene.received = true;
    scene.bounds = {{"effort_limit_hand_tip_n", {1.0, 10.0}}, {"effort_limit_arm_n", {2.0, 20.0}}};
    scene.initial = {{"effort_limit_hand_tip_n", 3.0},
                     {"effort_limit_arm_n", 6.0},
                     {"damping_full_n", 5.0},
                     {"level_ratio", 1.0}};
    scene.values = scene.initial;
    return scene;
  }();
  StationReply reply{StationReply::Status::kAccepted, ""};
  std::vector<VisitOrder> orders;
  std::vector<std::uint64_t> closed;
  std::function<void()> meanwhile;
};

inline std::string textOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

inline Json patientOf(const std::string& code, const std::string& name = "Anna Keller") {
  return {
      {"name", name},         {"code", code},
      {"born", "1956-03-02"}, {"number", "4711"},
      {"side", "right"},      {"hands", {{"right", {{"length_m", 0.188}, {"breadth_m", 0.085}}}}},
      {"preset", "gentle"},   {"parameters", Json::object()},
      {"warnings", ""},       {"plan", Json::array()}};
}

inline Json planOf(int items = 1) {
  Json plan = Json::array();
  for (int i = 0; i < items; ++i) {
    plan.push_back({{"exercise", "cocktail-bar"}, {"level", 1}, {"minutes", 10}, {"help", "some"}});
  }
  return plan;
}

/// A clinic whose first account is signed in.
struct Bench {
  explicit Bench(bool begun = true) {
    options.folder = folder.path() + "/clinic";
    options.config = std::string(WHOLEHAND_SOURCE_DIR) + "/config";
    options.recordings = folder.path() + "/recordings";
    options.backups = folder.path() + "/backups";
    options.cost = {1, 8192};
    std::filesystem::create_directory(options.recordings);
    start();
    if (begun) begin();
  }
  void start() { clinic = std::make_unique<Clinic>(options, clock, station); }
  void begin() {
    const Json said =
        ask("POST", "/api/init",
            {{"pass_phrase", "correct horse"},
             {"tile", {{"name", "A. Keller"}, {"colour", "#0d6b5a"}, {"pin", "1234"}}}});
    token = said.value("token", "");
    recovery_code = said.value("recovery_code", "");
  }
  /// Restarts the process as after kill -9: nobody is signed in before the call signs in again.
  void restart(bool signed_in = true) {
    clinic.reset();
    start();
    if (!signed_in) return;
    (void)ask("POST", "/api/unlock", {{"pass_phrase", "correct horse"}});
    token = ask("POST", "/api/sign_in", {{"account", 1}, {"pin", "1234"}}).value("token", "");
  }

  Answer raw(const std::string& method, const std::string& path, const std::string& body,
             std::optional<std::string> key = {}) {
    return clinic->answer({method, path, find, token, key ? *key : std::to_string(++keys), body});
  }
  Json ask(const std::string& method, const std::string& path, const Json& body = Json::object(),
           std::optional<std::string> key = {}) {
    const Answer answer = raw(method, path, method == "GET" ? "" : body.dump(), std::move(key));
    status = answer.status;
    return Json::parse(answer.body);
  }
  Json get(const std::string& path) { return ask("GET", path); }
  Json post(const std::string& path, const Json& body = Json::object()) {
    return ask("POST", path, body);
  }
  std::string refused(const std::string& path, const Json& body) {
    return post(path, body).value("refused", "");
  }
  std::int64_t addPatient(const std::string& code, const std::string& name = "Anna Keller") {
    return post("/api/patients", patientOf(code, name)).value("id", std::int64_t{0});
  }
  std::int64_t beginVisit(std::int64_t patient, int items = 1) {
    return post(fmt::format("/api/patients/{}/visits", patient),
                {{"side", "right"}, {"plan", planOf(items)}})
        .value("id", std::int64_t{0});
  }
  void finish(std::int64_t visit) {
    post(fmt::format("/api/visits/{}/finish", visit), {{"state", "done"}});
  }
  std::string database() const { return options.folder + "/clinic.db"; }

  test::Folder folder;
  FakeClock clock;
  FakeStation station;
  ClinicOptions options;
  std::unique_ptr<Clinic> clinic;
  std::string token, recovery_code, find;
  int keys = 0, status = 0;
};

}  // namespace wholehand::clinic
