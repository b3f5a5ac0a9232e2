#pragma once

#include "station/server/client_words.hpp"
#include "station/server/fake_program.hpp"
#include "station/server/raw_client.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace wholehand::test {

/// A server on a free port, with a fake program and a small web folder.
struct ServerTest : ::testing::Test {
  ServerTest() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    root = std::filesystem::path(::testing::TempDir()) / (std::string("wholehand_") + info->name());
    std::filesystem::remove_all(root);
    write("web/index.html", "<title>the bar</title>");
    write("web/console.html", "<title>the console</title>");
    write("web/assets/main-B2xk9_aQ.js", "export {};");
    write("web/mediapipe/hands.wasm", "wasm");
    write("web/.secret", "hidden");
    write("secret.txt", "outside");
    write("recordings/night shift.h5", "eleven byte");
    write("recordings/report/index.html", "<title>report</title>");
    write("recordings/report/plot.svg", "<svg/>");
    program.folder = root / "recordings";
    options.port = 0;
    options.web_folder = (root / "web").string();
    options.log = [this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      lines_.push_back(line);
    };
  }
  ~ServerTest() override {
    server.reset();
    std::filesystem::remove_all(root);
  }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root / name).parent_path());
    std::ofstream(root / name) << text;
  }
  void open() { server = orThrow(Server::open(program, options, controls)); }
  std::uint16_t port() const { return server->port(); }

  /// Waits until the log contains `part`; the log has its own thread.
  bool logged(const std::string& part) const {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    while (true) {
      {
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(lines_.begin(), lines_.end(), [&](const auto& line) {
          return line.find(part) != std::string::npos;
        });
        if (found != lines_.end()) return true;
      }
      if (std::chrono::steady_clock::now() > until) return false;
      std::this_thread::sleep_for(1ms);
    }
  }
  /// Value of a line of /metrics; -1 if it is missing.
  double metric(const std::string& name) const {
    const HttpReply reply = get(port(), "/metrics");
    const std::size_t at = reply.body.find("\nwholehand_" + name + " ");
    return at == std::string::npos ? -1.0 : std::stod(reply.body.substr(at + 12 + name.size()));
  }
  double refused(const std::string& reason) const {
    return metric("refused_total{reason=\"" + reason + "\"}");
  }

  std::filesystem::path root;
  FakeProgram program;
  ServerOptions options;
  ControlHolder controls;
  std::unique_ptr<Server> server;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

}  // namespace wholehand::test
