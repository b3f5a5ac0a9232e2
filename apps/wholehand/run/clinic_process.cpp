#include "apps/wholehand/run/clinic_process.hpp"

#include "files/process/child_process.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFirstLine = "listening on http://127.0.0.1:";
constexpr std::size_t kLongestLine = 4096;
constexpr std::chrono::seconds kBegins{20}, kBetweenStarts{1}, kForEver{3600};

/// The next line of the child; empty: the child ended, was late, or `stop` returned true.
std::string receiveLine(TalkingChild& child, std::chrono::seconds within,
                        const std::function<bool()>& stop) {
  const auto until = std::chrono::steady_clock::now() + within;
  std::string line;
  while (line.size() < kLongestLine) {
    const std::string next = child.receive(1, until, stop);
    if (next.empty()) return {};
    if (next == "\n") return line;
    line += next;
  }
  return {};
}

std::uint16_t portOf(const std::string& line) {
  if (!line.starts_with(kFirstLine)) return 0;
  unsigned port = 0;
  for (const char digit : line.substr(kFirstLine.size())) {
    if (digit < '0' || digit > '9' || port > 6553) return 0;
    port = 10 * port + static_cast<unsigned>(digit - '0');
  }
  return port > 65535 ? 0 : static_cast<std::uint16_t>(port);
}

}  // namespace

Expected<std::string> ClinicProcess::findProgram() {
  std::error_code error;
  const fs::path beside =
      fs::read_symlink("/proc/self/exe", error).parent_path() / "wholehand-clinic";
  if (fs::is_regular_file(beside, error)) return beside.string();
  return keyFault(beside.string(), "--clinic", "", "is not there",
                  "build it (./start --clinic FOLDER), or install the package wholehand-clinic");
}

ClinicProcess::ClinicProcess(std::string program, Options options)
    : program_(std::move(program)), options_(std::move(options)) {}

ClinicProcess::~ClinicProcess() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void ClinicProcess::start(std::uint16_t station_port) {
  thread_ = std::thread([this, station_port] { keepRunning(station_port); });
}

bool ClinicProcess::ending() {
  const std::lock_guard lock(mutex_);
  return ends_;
}

std::vector<std::string> ClinicProcess::arguments(std::uint16_t station_port) const {
  std::error_code error;
  std::vector<std::string> words = {
      "serve",        options_.folder,
      "--port",       std::to_string(last_port_),
      "--station",    std::to_string(station_port),
      "--recordings", options_.recordings_folder,
      "--program",    fs::read_symlink("/proc/self/exe", error).string()};
  std::vector<std::string> origins = options_.origins;
  for (const char* host : {"127.0.0.1", "localhost"}) {
    origins.push_back(fmt::format("http://{}:{}", host, station_port));
  }
  for (std::string& origin : origins) {
    words.emplace_back("--origin");
    words.push_back(std::move(origin));
  }
  return words;
}

void ClinicProcess::keepRunning(std::uint16_t station_port) {
  while (!ending()) {
    serveOnce(station_port);
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kBetweenStarts, [this] { return ends_; });
  }
}

// Starts the process and waits until it ends. Its other output goes to the terminal.
void ClinicProcess::serveOnce(std::uint16_t station_port) {
  auto child = TalkingChild::start(program_, arguments(station_port), {});
  if (!child) return options_.log("the clinic's records do not start: " + program_);
  const auto stop = [this] { return ending(); };
  const std::string first = receiveLine(*child, kBegins, stop);
  const std::uint16_t port = portOf(first);
  if (port == 0) {
    if (!ending()) {
      options_.log("the clinic's records do not start" +
                   (first.empty() ? std::string() : ": " + printable(first)));
    }
    return;
  }
  last_port_ = port;
  port_ = port;
  options_.log(fmt::format("the clinic's records answer on port {}", port));
  while (!ending()) {
    const std::string line = receiveLine(*child, kForEver, stop);
    if (line.empty()) break;
    options_.log("clinic: " + printable(line));
  }
  port_ = 0;
  if (!ending()) options_.log("the clinic's records ended; they are started again");
}

}  // namespace wholehand
