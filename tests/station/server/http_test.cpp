#include "station/server/file_workers.hpp"
#include "station/server/server_test.hpp"

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

// Tests every route over a real socket, and the ways to ask for files that nobody may have.
namespace wholehand::test {
namespace {

using HttpTest = ServerTest;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(HttpTest, Page_IsSentWithTypeCachingAndSecurityHeaders) {
  open();
  HttpReply r = get(port(), "/");
  EXPECT_EQ(r.status, 200);
  EXPECT_EQ(r.body, "<title>the bar</title>");
  EXPECT_EQ(r.headers["content-type"], "text/html; charset=utf-8");
  EXPECT_EQ(r.headers["cache-control"], "no-cache");
  EXPECT_EQ(r.headers["x-content-type-options"], "nosniff");
  const std::string policy = r.headers["content-security-policy"];
  EXPECT_TRUE(contains(policy, "default-src 'self'"));
  EXPECT_TRUE(contains(policy, "'wasm-unsafe-eval'"));  // needed for hand tracking
  EXPECT_FALSE(contains(policy, "'unsafe-eval'"));
  EXPECT_TRUE(contains(policy, "frame-ancestors 'none'"));
  EXPECT_EQ(get(port(), "/console").body, "<title>the console</title>");
  EXPECT_EQ(get(port(), "/console?demo=1").body, "<title>the console</title>");
  r = get(port(), "/assets/main-B2xk9_aQ.js");
  EXPECT_EQ(r.headers["content-type"], "text/javascript; charset=utf-8");
  EXPECT_TRUE(contains(r.headers["cache-control"], "immutable"));
  r = get(port(), "/mediapipe/hands.wasm");
  EXPECT_EQ(r.headers["content-type"], "application/wasm");
  EXPECT_EQ(r.headers["cache-control"], "no-cache");  // its name has no hash
}

TEST_F(HttpTest, UnchangedPage_IsNotSentAgain) {
  open();
  const std::string tag = get(port(), "/").headers["etag"];
  ASSERT_NE(tag, "");
  EXPECT_EQ(get(port(), "/", "If-None-Match: " + tag + "\r\n").status, 304);
  write("web/index.html", "<title>another bar</title>");
  EXPECT_EQ(get(port(), "/", "If-None-Match: " + tag + "\r\n").status, 200);
}

TEST_F(HttpTest, HeadRequest_ReturnsTheLengthAndNoBody) {
  open();
  RawSocket socket(port());
  const std::string host = "Host: localhost:" + std::to_string(port()) + "\r\n\r\n";
  const HttpReply r = ask(socket, "HEAD / HTTP/1.1\r\n" + host);
  EXPECT_EQ(r.status, 200);
  EXPECT_EQ(r.headers.at("content-length"), "22");
  // The connection stays usable: no bytes of a body follow.
  EXPECT_EQ(ask(socket, "GET / HTTP/1.1\r\n" + host).body, "<title>the bar</title>");
}

TEST_F(HttpTest, MissingPage_IsAnsweredWithAPageWithoutTheRequestedMarkup) {
  open();
  const HttpReply r = get(port(), "/no<script>");
  EXPECT_EQ(r.status, 404);
  EXPECT_TRUE(contains(r.body, "no&lt;script&gt;"));
  EXPECT_FALSE(contains(r.body, "<script>"));
  EXPECT_TRUE(contains(r.body, "<h1>Not here</h1>"));
}

TEST_F(HttpTest, PagesNotBuilt_IsAnsweredWithHowToBuildThem) {
  options.web_folder = (root / "nowhere").string();
  open();
  EXPECT_EQ(get(port(), "/").status, 503);
  EXPECT_TRUE(contains(get(port(), "/console").body, "npm run build"));
}

TEST_F(HttpTest, RequestWithoutMemory_IsRefusedAndTheNextOneAnswered) {
  open();
  const char* const wanted = "/api/recordings/night%20shift.h5";
  const int before = get(port(), wanted).status;
  program.no_memory = true;
  for (int i = 0; i < 3; ++i) {
    const HttpReply r = get(port(), wanted);
    EXPECT_EQ(r.status, 503);
    EXPECT_TRUE(contains(r.body, "no memory"));
  }
  program.no_memory = false;
  EXPECT_EQ(get(port(), wanted).status, before);
}

// Memory does not even suffice for the refusal.
TEST(FileWorkers, JobWithoutMemory_IsDroppedAndTheNextOneCarriedOut) {
  std::promise<void> done;
  FileWorkers workers(1, 4);
  ASSERT_TRUE(workers.post([] { throw std::bad_alloc(); }));
  ASSERT_TRUE(workers.post([&] { done.set_value(); }));
  EXPECT_EQ(done.get_future().wait_for(kPatience), std::future_status::ready);
}

TEST_F(HttpTest, PathTraversal_IsRefusedInEverySpelling) {
  open();
  std::filesystem::create_symlink(root / "secret.txt", root / "web/link.txt");
  for (const char* target :
       {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt",
        "/%2e%2e%2fsecret.txt", "/..%5csecret.txt", "/..\\secret.txt",
        "/assets/%2e%2e/%2e%2e/secret.txt", "//secret.txt", "/./index.html", "/index.html%00.js",
        "/%", "/%zz", "/.secret", "/link.txt", "/%c0%ae%c0%ae/secret.txt", "/%252e%252e/secret.txt",
        "secret.txt", "*"}) {
    const HttpReply r = get(port(), target);
    EXPECT_TRUE(r.status == 400 || r.status == 404) << target << " gave " << r.status;
    EXPECT_FALSE(contains(r.body, "outside")) << target;
    EXPECT_FALSE(contains(r.body, "hidden")) << target;
  }
  EXPECT_GT(refused("path"), 0.0);
  EXPECT_TRUE(logged("refused (path)"));
}

TEST_F(HttpTest, OtherMethodsAndBodies_AreRefused) {
  open();
  EXPECT_EQ(get(port(), "/", "", "POST").status, 405);
  EXPECT_EQ(get(port(), "/", "", "DELETE").headers["allow"], "GET, HEAD");
  EXPECT_EQ(get(port(), "/", "Content-Length: 100000\r\n", "POST").status, 413);
  RawSocket nonsense(port());
  EXPECT_EQ(ask(nonsense, "what is this\r\n\r\n").status, 400);
  RawSocket large(port());
  EXPECT_EQ(ask(large, "GET / HTTP/1.1\r\nX: " + std::string(20000, 'x') + "\r\n\r\n").status, 431);
  EXPECT_EQ(get(port(), "/").status, 200);
}

// Three clients ask for pages with headers of 2 MB, again and again. Each is refused after 0.5 s:
// in a session of 2 s at most 4 times, not hundreds of times. Other clients are answered meanwhile.
TEST_F(HttpTest, ClientsOfGiantHeaders_AreRefusedTwiceASecondAndDelayNobody) {
  open();
  constexpr int kClients = 3;
  const std::string giant = "GET / HTTP/1.1\r\nX: " + std::string(2'000'000, 'x') + "\r\n\r\n";
  std::atomic<bool> ends{false};
  std::atomic<int> asked{0};
  std::vector<std::thread> clients;
  const auto began = std::chrono::steady_clock::now();
  for (int i = 0; i < kClients; ++i) {
    clients.emplace_back([&] {
      while (!ends) {
        RawSocket socket(port());
        socket.send(giant);
        ++asked;
        (void)socket.receive(1, kPatience);
      }
    });
  }
  int answered = 0;
  while (asked < 2 * kClients) {
    EXPECT_EQ(get(port(), "/healthz").status, 200);
    ++answered;
  }
  ends = true;
  for (std::thread& client : clients) client.join();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  EXPECT_LE(refused("header_too_large"), kClients * (took.count() / 0.5 + 1.0));
  EXPECT_GT(refused("header_too_large"), 0.0);
  EXPECT_GT(answered, 0);
}

// As many wait with a refusal as there may be connections.
TEST_F(HttpTest, WaitingRefusals_MakeRoomForOtherClients) {
  open();
  const std::string large = "GET / HTTP/1.1\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n";
  std::vector<std::unique_ptr<RawSocket>> refused_ones;
  for (int i = 0; i < 128; ++i) {
    refused_ones.push_back(std::make_unique<RawSocket>(port()));
    refused_ones.back()->send(large);
  }
  for (int i = 0; i < 20; ++i) EXPECT_EQ(get(port(), "/healthz").status, 200);
}

TEST_F(HttpTest,
       ForeignHost_IsRefused) {  // DNS rebinding: a page's host name resolves to 127.0.0.1
  open();
  EXPECT_EQ(get(port(), "/", "Host: evil.example\r\n").status, 421);
  EXPECT_EQ(get(port(), "/api/recordings", "Host: evil.example:8080\r\n").status, 421);
  EXPECT_EQ(get(port(), "/", "Host: localhost:1\r\n").status, 200);  // a forwarded port
  EXPECT_EQ(get(port(), "/", "Host: [::1]:8080\r\n").status, 200);
}

TEST_F(HttpTest, Health_FollowsTheLoop) {
  seesRealTime();
  open();
  HttpReply r = get(port(), "/healthz");
  EXPECT_EQ(r.status, 200);
  EXPECT_TRUE(contains(r.body, R"("run_state":"disarmed")")) << r.body;
  EXPECT_TRUE(contains(r.body, R"("record_age_s":null)"));
  LoopStatus status;
  status.run_state = RunState::kRendering;
  status.ticks = 5000;
  program.setStatus(status);
  server->publish(busyRecord());
  r = get(port(), "/healthz");
  EXPECT_EQ(r.status, 200);
  EXPECT_TRUE(contains(r.body, R"("ticks":5000)"));
  std::this_thread::sleep_for(1100ms);  // the state says rendering, but no record comes
  EXPECT_EQ(get(port(), "/healthz").status, 503);
  server->publish(busyRecord());
  EXPECT_EQ(get(port(), "/healthz").status, 200);
  status.run_state = RunState::kFaulted;
  program.setStatus(status);
  EXPECT_EQ(get(port(), "/healthz").status, 503);
}

TEST_F(HttpTest, Health_OfALoopThatDoesNotAnswer_IsTheAlarmInEveryState) {
  open();
  const std::string words =
      "The robot does not answer. Press the emergency stop on the device now.";
  for (const RunState state : {RunState::kDisarmed, RunState::kRendering, RunState::kStopping,
                               RunState::kStopped, RunState::kFaulted}) {
    LoopStatus status;
    status.run_state = state;
    status.device = DeviceStatus{};
    status.loop_age_s = 0.25;
    server->publish(busyRecord());
    program.setStatus(status);
    HttpReply r = get(port(), "/healthz");
    EXPECT_EQ(r.status, state == RunState::kFaulted ? 503 : 200);
    EXPECT_TRUE(contains(r.body, R"("alarm":null)")) << r.body;
    EXPECT_TRUE(contains(r.body, R"("loop_age_s":0.25)")) << r.body;
    status.silent = true;
    program.setStatus(status);
    r = get(port(), "/healthz");
    EXPECT_EQ(r.status, 503);
    EXPECT_TRUE(contains(r.body, R"("alarm":")" + words + "\"")) << r.body;
    EXPECT_TRUE(contains(r.body, R"("healthy":false)"));
    status.device.reset();
    program.setStatus(status);
    EXPECT_FALSE(contains(get(port(), "/healthz").body, "emergency stop")) << "nothing pushes";
  }
  EXPECT_TRUE(contains(get(port(), "/metrics").body, "wholehand_loop_silent 1\n"));
}

TEST_F(HttpTest, Metrics_ArePrometheusText) {
  LoopStatus status;
  status.run_state = RunState::kRendering;
  status.ticks = 60000;
  status.missed_deadlines = 3;
  status.cpu_p99_us = 125.0;
  status.safety_state = SafetyState::kArmed;
  status.fault_ticks[12] = 4;  // kSpeedLimit
  status.rehearsal_p999_us = 250.0;
  program.setStatus(status);
  options.address = "localhost";
  options.more_metrics = [] { return std::string("wholehand_udp_peers 2\n"); };
  open();
  EXPECT_EQ(server->url(), "http://127.0.0.1:" + std::to_string(port()) + "/");
  HttpReply r = get(port(), "/metrics");
  EXPECT_EQ(metric("udp_peers"), 2.0);
  EXPECT_EQ(r.headers["content-type"], "text/plain; version=0.0.4");
  EXPECT_EQ(metric("ticks_total"), 60000.0);
  EXPECT_EQ(metric("missed_deadlines_total"), 3.0);
  EXPECT_EQ(metric("run_state{state=\"rendering\"}"), 1.0);
  EXPECT_EQ(metric("run_state{state=\"faulted\"}"), 0.0);
  EXPECT_NEAR(metric("tick_cpu_seconds{quantile=\"0.99\"}"), 125e-6, 1e-12);
  EXPECT_EQ(metric("clients"), 0.0);
  EXPECT_EQ(metric("safety_state{state=\"armed\"}"), 1.0);
  EXPECT_EQ(metric("safety_state{state=\"rendering\"}"), 0.0);
  EXPECT_EQ(metric("fault_ticks_total{reason=\"speed_limit_exceeded\",stops=\"yes\"}"), 4.0);
  EXPECT_EQ(metric("fault_ticks_total{reason=\"tank_damped\",stops=\"no\"}"), 0.0);
  EXPECT_NEAR(metric("rehearsal_tick_cpu_seconds{quantile=\"0.999\"}"), 250e-6, 1e-12);
  // Every line is a comment, or a name and a number.
  for (std::size_t begin = 0; begin < r.body.size();) {
    const std::size_t end = r.body.find('\n', begin);
    ASSERT_NE(end, std::string::npos);
    const std::string line = r.body.substr(begin, end - begin);
    if (!line.starts_with("# ")) {
      EXPECT_TRUE(line.starts_with("wholehand_")) << line;
      EXPECT_NO_THROW((void)std::stod(line.substr(line.rfind(' ') + 1))) << line;
    }
    begin = end + 1;
  }
}

TEST_F(HttpTest, Recordings_ListDownloadAndReport) {
  open();
  HttpReply r = get(port(), "/api/recordings");
  EXPECT_EQ(r.headers["content-type"], "application/json");
  EXPECT_TRUE(contains(r.body, R"("name":"night shift.h5")"));
  EXPECT_TRUE(contains(r.body, R"("duration_s":61.5)"));
  EXPECT_TRUE(contains(r.body, R"("report":"/api/recordings/night%20shift.h5/report/")"));
  r = get(port(), "/api/recordings/night%20shift.h5");
  EXPECT_EQ(r.body, "eleven byte");
  EXPECT_EQ(r.headers["content-type"], "application/x-hdf5");
  EXPECT_TRUE(r.headers["content-disposition"].starts_with("attachment;"));
  r = get(port(), "/api/recordings/night%20shift.h5/report");
  EXPECT_EQ(r.status, 308);
  EXPECT_EQ(r.headers["location"], "/api/recordings/night%20shift.h5/report/");
  EXPECT_EQ(get(port(), r.headers["location"]).body, "<title>report</title>");
  EXPECT_EQ(get(port(), "/api/recordings/night%20shift.h5/report/plot.svg").body, "<svg/>");
}

TEST_F(HttpTest, RecordingBeingWritten_IsListedAndReplayedButNotDownloaded) {
  options.replay = [](const std::string&, const std::string&) -> ReplayAnswer {
    return {200, "application/json", "{}"};
  };
  open();
  SceneFacts facts = *program.scene();
  facts.recording = "night shift.h5";
  program.setScene(facts);
  const std::string list = get(port(), "/api/recordings").body;
  EXPECT_TRUE(contains(list, R"("name":"night shift.h5")")) << list;
  EXPECT_TRUE(contains(list, R"("being_written":true)")) << list;
  EXPECT_FALSE(contains(list, R"("report")")) << list;
  const std::string address = "/api/recordings/night%20shift.h5";
  EXPECT_EQ(get(port(), address + "/replay/about").status, 200);
  for (const char* rest : {"", "/report", "/report/", "/report/plot.svg"}) {
    const HttpReply r = get(port(), address + rest);
    EXPECT_EQ(r.status, 409) << rest;
    EXPECT_TRUE(contains(r.body, "Still being recorded")) << rest;
  }
  facts.recording = "";
  program.setScene(facts);
  EXPECT_EQ(get(port(), address).status, 200);
}

TEST_F(HttpTest, NamesWithoutARecording_AreNotFound) {
  open();
  // Well-formed names that cannot be the name of a recording.
  for (const char* target : {"/api/recordings/a%2fb.h5", "/api/recordings/a%2Fb.h5/replay/about",
                             "/replay%2f..", "/assets%2Fx"}) {
    EXPECT_EQ(get(port(), target).status, 404) << target;
  }
  for (const char* target :
       {"/api/recordings/other.h5", "/api/recordings/", "/api/recordings/a%2fb.h5",
        "/api/recordings/..%2fsecret.txt", "/api/recordings/%2e%2e/secret.txt",
        "/api/recordings/night%20shift.h5/report/../../../secret.txt",
        "/api/recordings/night%20shift.h5/other", "/api/recordings/sub/night%20shift.h5",
        "/api/recordings/other.h5/report/"}) {
    const HttpReply r = get(port(), target);
    EXPECT_TRUE(r.status == 400 || r.status == 404) << target << " gave " << r.status;
    EXPECT_FALSE(contains(r.body, "outside"));
  }
}

TEST_F(HttpTest, Replay_AnswersFromTheServiceForTheRecordingsFile) {
  write("web/replay.html", "<title>replay</title>");
  std::promise<void> read;
  const std::shared_future<void> disk = read.get_future().share();
  options.replay = [disk](const std::string& path, const std::string& question) -> ReplayAnswer {
    if (question.starts_with("series")) disk.wait();
    if (question.starts_with("scene")) return {422, "application/json", "{\"error\": \"no\"}"};
    return {200, "application/octet-stream", path + "|" + question};
  };
  open();
  EXPECT_EQ(get(port(), "/replay?recording=night%20shift.h5").body, "<title>replay</title>");
  const std::string base = "/api/recordings/night%20shift.h5/replay/";
  HttpReply r = get(port(), base + "states?tick=0&count=1&step=1");
  EXPECT_EQ(r.status, 200);
  EXPECT_EQ(r.headers["content-type"], "application/octet-stream");
  EXPECT_EQ(r.headers["cache-control"], "no-store");
  EXPECT_EQ(r.body, (program.folder / "night shift.h5").string() + "|states?tick=0&count=1&step=1");
  r = get(port(), base + "scene");
  EXPECT_EQ(r.status, 422);
  EXPECT_EQ(r.body, "{\"error\": \"no\"}");
  for (const char* target :
       {"/api/recordings/other.h5/replay/about", "/api/recordings/%2e%2e/replay/about",
        "/api/recordings/..%2fsecret.txt/replay/about", "/api/recordings//replay/about",
        "/api/recordings/night%20shift.h5/replay/../../secret.txt",
        "/api/recordings/night%20shift.h5/replay"}) {
    r = get(port(), target);
    EXPECT_TRUE(r.status == 400 || r.status == 404) << target << " gave " << r.status;
  }
  // A slow disk delays neither other requests nor downloads nor health.
  std::thread slow([&] { EXPECT_EQ(get(port(), base + "series?from_s=0").status, 200); });
  EXPECT_EQ(get(port(), base + "states?tick=1&count=1&step=1").status, 200);
  EXPECT_EQ(get(port(), "/api/recordings/night%20shift.h5").status, 200);
  EXPECT_EQ(get(port(), "/healthz").status, 200);
  read.set_value();
  slow.join();
}

TEST_F(HttpTest, ProgramWithoutAReplayService_HasNoReplay) {
  open();
  EXPECT_EQ(get(port(), "/api/recordings/night%20shift.h5/replay/about").status, 404);
  EXPECT_EQ(get(port(), "/replay").status, 404) << "the pages are built, this one is not";
}

TEST_F(HttpTest, Report_MayRunInlineScriptsAndLoadNothingElse) {
  open();
  const HttpReply r = get(port(), "/api/recordings/night%20shift.h5/report/");
  const std::string policy = r.headers.at("content-security-policy");
  EXPECT_TRUE(contains(policy, "default-src 'none'")) << policy;
  EXPECT_TRUE(contains(policy, "script-src 'unsafe-inline'")) << policy;  // the scripts are inline
  EXPECT_TRUE(contains(policy, "worker-src blob:")) << policy;
  EXPECT_FALSE(contains(policy, "connect-src")) << policy;
  EXPECT_FALSE(contains(policy, "'self'")) << policy;
}

TEST_F(HttpTest, ReportThatCannotBeMade_SaysWhy) {
  program.report_fails = true;
  open();
  const HttpReply r = get(port(), "/api/recordings/night%20shift.h5/report/");
  EXPECT_EQ(r.status, 500);
  EXPECT_TRUE(contains(r.body, "&lt;damaged&gt;")) << r.body;
}

TEST_F(HttpTest, ReportBeingMade_DelaysNoOtherRequest) {
  std::promise<void> written;
  program.report_waits_for = written.get_future().share();
  open();
  std::thread patient(
      [&] { EXPECT_EQ(get(port(), "/api/recordings/night%20shift.h5/report/").status, 200); });
  while (!program.report_begun) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(program.report_begun);
  EXPECT_EQ(get(port(), "/healthz").status, 200);
  EXPECT_EQ(get(port(), "/api/recordings").status, 200);  // answered by the second worker
  written.set_value();
  patient.join();
}

// A client that waits for a hanging disk gets an answer and delays no other client.
TEST_F(HttpTest, RequestThatTakesTooLong_IsRefusedAndItsWorkerReplaced) {
  std::promise<void> answers;
  program.report_waits_for = answers.get_future().share();
  options.report_patience = 1s;
  open();
  const char* report = "/api/recordings/night%20shift.h5/report/";
  HttpReply r = get(port(), report);
  EXPECT_EQ(r.status, 503);
  EXPECT_TRUE(contains(r.body, "does not answer")) << r.body;
  EXPECT_EQ(get(port(), report).status, 503) << "the second worker";
  EXPECT_EQ(get(port(), "/").status, 200) << "pages have a worker of their own";
  EXPECT_EQ(refused("disk"), 2.0);
  answers.set_value();  // the workers continue; their results come too late
  EXPECT_EQ(get(port(), report).status, 200);
}

TEST_F(HttpTest, LargeRecording_ArrivesWhole) {
  const std::string bytes(20'000'000, 'r');
  write("recordings/night shift.h5", bytes);
  open();
  EXPECT_EQ(get(port(), "/api/recordings/night%20shift.h5").body, bytes);
}

constexpr const char* kToken = "a-token-of-twenty-ch";

TEST_F(HttpTest, Token_IsRequiredForAllButThePages) {
  options.token = kToken;
  open();
  EXPECT_EQ(get(port(), "/").status, 200);
  EXPECT_EQ(get(port(), "/healthz").status, 200);
  EXPECT_EQ(get(port(), "/metrics").status, 401);
  EXPECT_EQ(get(port(), "/api/recordings").status, 401);
  EXPECT_EQ(get(port(), "/api/recordings?token=a-token-of-twenty-cx").status, 401);
  EXPECT_EQ(get(port(), "/api/recordings?token=").status, 401);
  EXPECT_EQ(get(port(), "/metrics", std::string("Authorization: Bearer ") + kToken + "\r\n").status,
            200);
  HttpReply r = get(port(), std::string("/?token=") + kToken);
  const std::string cookie = r.headers["set-cookie"];
  EXPECT_TRUE(contains(cookie, "HttpOnly"));
  EXPECT_TRUE(contains(cookie, "SameSite=Strict"));
  EXPECT_EQ(
      get(port(), "/api/recordings", "Cookie: a=b; " + cookie.substr(0, cookie.find(';')) + "\r\n")
          .status,
      200);
}

// Browsers send a cookie to every port of a machine, so the cookie may belong to another Wholehand
// or to an earlier token.
TEST_F(HttpTest, ForeignCookieWithAGoodToken_IsAccepted) {
  options.token = kToken;
  open();
  const std::string good = get(port(), std::string("/?token=") + kToken).headers["set-cookie"];
  const std::string ours = good.substr(0, good.find(';'));
  EXPECT_TRUE(contains(ours, "wholehand_token_" + std::to_string(port()) + "="));
  const std::string others =
      "wholehand_token=stale-stale-stale-x; wholehand_token_1=foreign-foreign";
  const auto status = [this](const std::string& query, const std::string& headers) {
    return get(port(), "/api/recordings" + query, headers).status;
  };
  EXPECT_EQ(status("", "Cookie: " + others + "\r\n"), 401);
  EXPECT_EQ(status("", "Cookie: " + others + "; " + ours + "\r\n"), 200);
  EXPECT_EQ(status("", "Cookie: " + ours + "; " + others + "\r\n"), 200);
  EXPECT_EQ(status(std::string("?token=") + kToken, "Cookie: " + others + "\r\n"), 200);
  EXPECT_EQ(status("?token=wrong", "Cookie: " + ours + "\r\n"), 200);
  EXPECT_EQ(
      status("", std::string("Authorization: Bearer ") + kToken + "\r\nCookie: " + others + "\r\n"),
      200);
}

TEST_F(HttpTest, OptionsThatOpenTheProgramToEverybody_AreRefused) {
  options.address = "0.0.0.0";
  auto refusalOf = [&] {
    auto opened = Server::open(program, options, controls);
    return opened ? std::string() : format(opened.errors());
  };
  EXPECT_TRUE(contains(refusalOf(), "needs a token of at least 16 characters"));
  options.token = "fifteen-chars-x";
  EXPECT_TRUE(contains(refusalOf(), "at least 16"));
  options.token = "sixteen chars xx";
  EXPECT_TRUE(contains(refusalOf(), "letters, digits"));
  options.token = kToken;
  EXPECT_EQ(refusalOf(), "");
  options.max_clients = 0;
  options.address = "no address";
  EXPECT_TRUE(contains(refusalOf(), "max_clients"));
  options.max_clients = 1;
  EXPECT_TRUE(contains(refusalOf(), "is no IP address"));
}

TEST_F(HttpTest, PortInUse_IsReported) {
  open();
  options.port = port();
  auto second = Server::open(program, options, controls);
  ASSERT_FALSE(second);
  EXPECT_TRUE(contains(format(second.errors()), "in use")) << format(second.errors());
}

TEST_F(HttpTest, ManyIdleConnections_LeaveRoomForANewOne) {
  open();
  std::vector<std::unique_ptr<RawSocket>> idle;
  for (int i = 0; i < 200; ++i) idle.push_back(std::make_unique<RawSocket>(port()));
  EXPECT_EQ(get(port(), "/healthz").status, 200) << "at once, while 200 hold theirs open";
  EXPECT_EQ(idle.front()->receive(1, kPatience), std::nullopt);
  EXPECT_TRUE(idle.front()->closed()) << "of 128 the one that asked for nothing longest makes room";
  EXPECT_EQ(ask(*idle.back(), "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 200);
  EXPECT_GT(refused("connections"), 70.0);
}

}  // namespace
}  // namespace wholehand::test
