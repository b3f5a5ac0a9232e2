#include "devices/plugin/plugin_driver.hpp"

#include "loop/core/sha256.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstring>
#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <mutex>
#include <set>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".so";

std::string namesIn(const std::vector<std::string>& folders) {
  std::set<std::string> names;
  for (const std::string& folder : folders) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() == kEnding) names.insert(entry.path().stem().string());
    }
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kSymbol = "wh_plugin_v1";
// Ends of the structure: of the functions that every driver has, and of those of versions 1.1,
// 1.2 and 1.3.
constexpr std::size_t kSixFunctions = offsetof(wh_plugin, close) + sizeof(wh_plugin::close);
constexpr std::size_t kIdentifies = offsetof(wh_plugin, identify) + sizeof(wh_plugin::identify);
constexpr std::size_t kEnables = offsetof(wh_plugin, enable) + sizeof(wh_plugin::enable);
constexpr std::size_t kStates =
    offsetof(wh_plugin, switches_within_s) + sizeof(wh_plugin::switches_within_s);
constexpr const char* kRemedy = "build it with this version's wholehand/device.h";

// Reason why the driver cannot be used; empty: it can.
std::string whyNot(const wh_plugin* plugin, CalledBy called_by) {
  if (plugin == nullptr) return "gives no driver";
  if (plugin->size < offsetof(wh_plugin, open)) return "gives a structure that is too short";
  if (plugin->major != WH_MAJOR) {
    return "is built for version " + std::to_string(plugin->major) + " of the boundary, this is " +
           std::to_string(WH_MAJOR);
  }
  if (plugin->size < kSixFunctions) return "gives a structure that is too short";
  if (plugin->open == nullptr || plugin->describe == nullptr || plugin->control == nullptr ||
      plugin->read == nullptr || plugin->write == nullptr || plugin->close == nullptr) {
    return "leaves out one of its six functions";
  }
  if (called_by == CalledBy::kLoop && (plugin->flags & WH_NEVER_WAITS) == 0) {
    return "does not say that it never waits (WH_NEVER_WAITS): the loop cannot call it, a host can "
           "(wholehand device-host)";
  }
  return {};
}

// The code stays loaded because the driver's own threads may still run in it.
Expected<const wh_plugin*> findPlugin(const std::string& path, CalledBy called_by) {
  const auto no = [&path](const std::string& why, const char* remedy) {
    return fileFault(path, why, remedy);
  };
  // Without a slash dlopen would search the system's library folders.
  const bool bare = path.find('/') == std::string::npos;
  const std::string full = bare ? "./" + path : path;
  void* const library = ::dlopen(full.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) {
    return no(loaderProblem(full), "give the path of a driver's shared object");
  }
  void* const symbol = ::dlsym(library, kSymbol);
  if (symbol == nullptr) return no(std::string("has no ") + kSymbol + "()", kRemedy);
  const wh_plugin* const plugin = reinterpret_cast<decltype(&wh_plugin_v1)>(symbol)();
  if (const std::string why = whyNot(plugin, called_by); !why.empty()) return no(why, kRemedy);
  return plugin;
}

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Paths that settings may contain: each word, the value of each word "key=value", and the settings
// as a whole, since a path may contain a blank or '='.
std::vector<std::string> pathsIn(const std::string& settings) {
  std::vector<std::string> paths;
  std::istringstream words(settings);
  for (std::string word; words >> word;) {
    paths.push_back(word);
    const std::size_t equals = word.find('=');
    if (equals != std::string::npos) paths.push_back(word.substr(equals + 1));
  }
  if (paths.empty() || paths.front() != settings) paths.push_back(settings);
  return paths;
}

// Digest of everything on this machine between an effort and the motor.
std::string digestOf(const std::string& path, const std::string& settings) {
  std::string all = sha256(contentOf(path)) + settings;
  for (const std::string& named : pathsIn(settings)) {
    std::error_code none;
    if (fs::is_regular_file(named, none)) all += sha256(contentOf(named));
  }
  return sha256(all);
}

// A time that the driver states [s].
double statedWithin_s(const wh_plugin& plugin, double wh_plugin::*time) {
  if (plugin.size < kStates) return kCallWithin_s;
  const double stated_s = plugin.*time;
  return stated_s > kCallWithin_s ? std::min(stated_s, 3600.0) : kCallWithin_s;
}

// Tells people about a call that does not return, from another thread.
class AnswerWatch {
 public:
  using Report = std::function<void(const std::string&)>;
  AnswerWatch(const Report& report, double within_s) : report_(report), within_s_(within_s) {
    if (!report) return;
    try {
      thread_ = std::thread([this] { watch(); });
    } catch (const std::system_error&) {  // no thread to be had: the call is made all the same
    }
  }
  ~AnswerWatch() {
    {
      const std::lock_guard lock(mutex_);
      returned_ = true;
    }
    wake_.notify_one();
    if (thread_.joinable()) thread_.join();
  }
  AnswerWatch(const AnswerWatch&) = delete;
  AnswerWatch& operator=(const AnswerWatch&) = delete;

 private:
  void watch() {
    std::unique_lock lock(mutex_);
    const auto returned = [this] { return returned_; };
    if (wake_.wait_for(lock, std::chrono::duration<double>(within_s_), returned)) return;
    report_(kNoAnswer);
    wake_.wait(lock, returned);
    report_(kAnswersAgain);
  }

  const Report& report_;
  double within_s_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool returned_ = false;
  std::thread thread_;
};

}  // namespace

std::string loaderProblem(const std::string& path) {
  const char* const why = ::dlerror();
  const std::string problem = why != nullptr ? why : "cannot be loaded";
  const std::string lead = path + ": ";
  return problem.starts_with(lead) ? problem.substr(lead.size()) : problem;
}

std::vector<std::string> shippedDriverFolders() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  return {(program / "drivers").string(),
          (program.parent_path() / "lib" / "wholehand" / "drivers").string()};
}

Expected<std::string> findDriver(const std::string& name, const std::vector<std::string>& folders) {
  if (name.find('/') != std::string::npos) return name;
  // Without a slash dlopen would search the system's library folders.
  if (name.ends_with(kEnding)) return std::string("./").append(name);
  for (const std::string& folder : folders) {
    const fs::path path = fs::path(folder) / (name + kEnding);
    std::error_code error;
    if (!name.empty() && fs::exists(path, error)) return path.string();
  }
  const std::string known = namesIn(folders);
  return keyFault("", "--driver", name, "is no driver that ships with this program",
                  known.empty()
                      ? "give the path of a driver's shared object; none ship with this program"
                      : "give one of " + known + ", or the path of a driver's shared object");
}

PluginDriver::PluginDriver(DriverLocation location, std::function<void(const std::string&)> report)
    : location_(std::move(location)), report_(std::move(report)) {
  host_.size = sizeof(host_);
  host_.context = this;
  host_.say = &PluginDriver::take;
}

void PluginDriver::take(void* self, const char* line) {
  auto& driver = *static_cast<PluginDriver*>(self);
  driver.last_line_ = line != nullptr ? line : "";
  if (driver.report_) driver.report_("driver: " + driver.last_line_);
}

Diagnostic PluginDriver::failed(const std::string& what, const std::string& remedy) const {
  return fileFault(location_.path, last_line_.empty() ? what : what + ": " + last_line_, remedy);
}

Expected<PluginFacts> pluginFacts(const std::string& name) {
  auto path = findDriver(name, shippedDriverFolders());
  if (!path) return path.errors();
  auto plugin = findPlugin(*path, CalledBy::kHost);
  if (!plugin) return plugin.errors();
  const wh_plugin& facts = **plugin;
  return PluginFacts{facts.name != nullptr ? facts.name : "", facts.major, facts.minor,
                     (facts.flags & WH_NEVER_WAITS) != 0};
}

Expected<std::shared_ptr<PluginDriver>> PluginDriver::load(
    const DriverLocation& location, std::function<void(const std::string&)> report,
    CalledBy called_by) {
  auto path = findDriver(location.path, shippedDriverFolders());
  if (!path) return path.errors();
  auto plugin = findPlugin(*path, called_by);
  if (!plugin) return plugin.errors();
  std::shared_ptr<PluginDriver> driver(new PluginDriver(location, std::move(report)));
  driver->plugin_ = *plugin;
  driver->identity_.driver_sha256 = digestOf(*path, location.settings);
  if (Expected<Done> opened = driver->open(); !opened) return opened.errors();
  // A driver that opens other drivers knows only after opening whether all of them never block.
  if (const std::string why = whyNot(driver->plugin_, called_by); !why.empty()) {
    return fileFault(location.path, why, "let a host hold it");
  }
  driver->never_waits_ = (driver->plugin_->flags & WH_NEVER_WAITS) != 0;
  const AnswerWatch watch(driver->report_, kCallWithin_s);
  if (Expected<Done> described = driver->describe(); !described) return described.errors();
  driver->identify();
  return driver;
}

Expected<Done> PluginDriver::open() {
  const AnswerWatch watch(report_, statedWithin_s(*plugin_, &wh_plugin::opens_within_s));
  const int result =
      plugin_->open(&host_, location_.locator.c_str(), location_.settings.c_str(), &device_);
  if (result >= 0 && device_ != nullptr) return Done{};
  device_ = nullptr;
  return failed("no device was found" +
                    (location_.locator.empty() ? std::string() : " at " + location_.locator),
                "is it connected and switched on, and is --device-at right?");
}

Expected<Done> PluginDriver::describe() {
  std::array<wh_axis, WH_MAX_AXES> axes{};
  for (wh_axis& axis : axes) axis.size = sizeof(wh_axis);
  std::uint32_t count = 0;
  if (plugin_->describe(device_, axes.data(), WH_MAX_AXES, &count) < 0) {
    return failed("the device does not say which axes it has", kRemedy);
  }
  if (count < 1 || count > WH_MAX_AXES) {
    return failed("has " + std::to_string(count) + " axes; 1 to " + std::to_string(WH_MAX_AXES) +
                      " can be rendered to",
                  "let the driver offer fewer");
  }
  axes_.assign(axes.begin(), axes.begin() + count);
  for (wh_axis& axis : axes_) axis.name[sizeof(axis.name) - 1] = 0;
  return Done{};
}

// Unknown fields stay empty. Such a device may be used, but gets no passport.
void PluginDriver::identify() {
  if (plugin_->size < kIdentifies || plugin_->identify == nullptr) return;
  wh_identity said{};
  said.size = sizeof(said);
  if (plugin_->identify(device_, &said) < 0) return;
  const auto text = [](const auto& field) {
    return std::string(field, ::strnlen(field, sizeof(field)));
  };
  identity_.serial = text(said.serial);
  identity_.firmware = text(said.firmware);
  identity_.sdk = text(said.sdk);
}

PluginDriver::~PluginDriver() {
  if (device_ == nullptr) return;
  const AnswerWatch watch(report_, switchesWithin_s());
  plugin_->close(device_);
}

double PluginDriver::switchesWithin_s() const noexcept {
  return statedWithin_s(*plugin_, &wh_plugin::switches_within_s);
}

std::string PluginDriver::name() const {
  return plugin_->name != nullptr ? plugin_->name : "";
}

Expected<Done> PluginDriver::control(std::uint32_t verb, double argument) {
  static constexpr std::array<const char*, 7> kVerbs = {
      "be identified", "be homed",           "be tared",         "be enabled",
      "be disabled",   "pass its self-test", "drop its watchdog"};
  const int result = plugin_->control(device_, verb, argument);
  if (result >= 0) return Done{};
  const std::string what = verb < kVerbs.size() ? kVerbs.at(verb) : "do that";
  return failed(
      std::string(result == WH_UNSUPPORTED ? kUnsupportedPrefix : "the device did not ") + what,
      "look at the device");
}

bool PluginDriver::enablesAtNeutral() const noexcept {
  return plugin_->size >= kEnables && plugin_->enable != nullptr;
}

Expected<Done> PluginDriver::enable(const wh_command& neutral) {
  if (!enablesAtNeutral()) return control(WH_ENABLE, 0.0);
  if (plugin_->enable(device_, &neutral) >= 0) return Done{};
  return failed("the device did not be enabled", "look at the device");
}

int PluginDriver::read(wh_sample& sample) noexcept {
  sample.size = sizeof(sample);
  // Fields that the driver leaves out are unknown.
  std::fill(std::begin(sample.effort), std::end(sample.effort), kNan);
  std::fill(std::begin(sample.temperature_c), std::end(sample.temperature_c), kNan);
  sample.derating = sample.reserved = 0;
  return plugin_->read(device_, &sample);
}

int PluginDriver::write(const wh_command& command) noexcept {
  return plugin_->write(device_, &command);
}

}  // namespace wholehand
