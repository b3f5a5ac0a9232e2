#include "station/station.hpp"

#include "station/station_core.hpp"

#include <filesystem>

namespace wholehand {

std::string pathOfSession(const std::string& path, std::uint64_t number) {
  if (number < 2 || path.empty()) return path;
  const std::filesystem::path first(path);
  const std::string name =
      first.stem().string() + "-" + std::to_string(number) + first.extension().string();
  return (first.parent_path() / name).string();
}

Station::Station(StationConfig config) : core_(std::make_unique<Core>(std::move(config))) {}
Station::~Station() = default;

Expected<Done> Station::load() {
  return core_->load();
}
const Models& Station::models() const {
  return core_->models();
}
void Station::addSink(std::function<void(const TickRecord&)> sink) {
  core_->addSink(std::move(sink));
}
Expected<StationOutcome> Station::run(bool arm_at_once, double duration_s) {
  return core_->run(arm_at_once, duration_s);
}
void Station::quit() {
  core_->quit();
}
void Station::order(const Order& order, std::function<void(OrderReply)> done) {
  core_->order(order, done);
}
std::shared_ptr<const SceneFacts> Station::scene() const {
  return core_->scene();
}
LoopStatus Station::status() const {
  return core_->status();
}
bool Station::latest(TickRecord& record) const {
  return core_->latest(record);
}
std::vector<RecordingEntry> Station::recordings() const {
  return core_->recordings();
}
std::string Station::recordingPath(const std::string& name) const {
  return core_->recordingPath(name);
}
std::string Station::reportFolder(const std::string& name, std::string& why) {
  return core_->reportFolder(name, why);
}

}  // namespace wholehand
