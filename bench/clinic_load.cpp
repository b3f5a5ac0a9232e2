// clinic_load [PATIENTS] [SECONDS]: lists, searches and notes of a clinic beside ten clients that
// list, as in docs/clinic.md. Prints the distribution of the times of answers over HTTP. The folder
// is temporary.
#include "clinic/clinic.hpp"
#include "clinic/http_server.hpp"
#include "clinic/row_digests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

using namespace wholehand::clinic;  // NOLINT(google-build-using-namespace): the program's own main
using Time = std::chrono::steady_clock;

constexpr const char* kOrigin = "http://127.0.0.1:8787";
constexpr int kListing = 10, kVisits = 20;

std::string exchanged(std::uint16_t port, const std::string& bytes) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string out;
  if (::connect(socket, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0) {
    (void)::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    static thread_local char part[65536];
    for (ssize_t n = 0; (n = ::recv(socket, part, sizeof part, 0)) > 0;) {
      out.append(part, static_cast<std::size_t>(n));
    }
  }
  ::close(socket);
  return out;
}

struct Client {
  std::uint16_t port = 0;
  std::string token;
  /// Sends a request. @return its time [ms]; ends the program when it was refused
  double ask(const std::string& method, const std::string& path,
             const std::string& body = {}) const {
    static std::atomic<int> keys{0};
    const auto began = Time::now();
    const std::string said = exchanged(
        port, fmt::format("{} {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nOrigin: {}\r\nAuthorization: "
                          "Bearer {}\r\nIdempotency-Key: {}\r\nContent-Length: {}\r\n\r\n{}",
                          method, path, port, kOrigin, token, ++keys, body.size(), body));
    const double ms = std::chrono::duration<double, std::milli>(Time::now() - began).count();
    if (said.starts_with("HTTP/1.1 200")) return ms;
    std::fprintf(stderr, "%s %s: %.300s\n", method.c_str(), path.c_str(), said.c_str());
    std::exit(1);
  }
};

void print(const char* what, std::vector<double> ms, double asked_ms) {
  if (ms.empty()) return;
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double share) {
    return ms[std::min(ms.size() - 1,
                       static_cast<std::size_t>(share * static_cast<double>(ms.size())))];
  };
  std::printf("%-18s %6zu  p50 %8.1f  p95 %8.1f  p99 %8.1f  most %8.1f ms", what, ms.size(),
              at(0.5), at(0.95), at(0.99), ms.back());
  if (asked_ms > 0) std::printf("  (asked: %.0f)", asked_ms);
  std::printf("\n");
}

/// Fills the tables by hand: through requests it would take minutes.
void fill(const std::string& folder, const Key& key, int patients) {
  Database db(folder + "/clinic.db", Database::Mode::kReadWrite);
  guardByKeys(db, folder);
  const std::string measures =
      R"({"exercise":"cocktail-bar","level":1,"active_s":300.0,"results":[{"name":"poured_total_l","value":0.4,"unit":"l"}]})";
  Transaction transaction(db);
  for (int i = 1; i <= patients; ++i) {
    const std::string secret = fmt::format(
        R"({{"name":"Person {} of the clinic","born":"1950-01-01","number":"{}","warnings":""}})",
        i, i);
    db.change(
        "INSERT INTO patient (mark, version, code, side, hands, preset, parameters, plan, "
        "created_us,"
        " secret) VALUES (?, 1, ?, 'right', '{}', 'gentle', '{}', '[]', 0, ?)",
        fmt::format("mark-{}", i), fmt::format("P-{:05}", i), Blob{key.seal("patient", secret)});
    for (int k = 0; k < kVisits; ++k) {
      const std::int64_t visit = std::int64_t{i} * 1000 + k;
      db.change(
          "INSERT INTO visit (id, patient, account, side, hand, hand_file, began_us, ended_us,"
          " offset_min, state, plan, item) VALUES (?, ?, 1, 'right', '', '', ?, ?, 0, 'done', "
          "'[]', 0)",
          visit, i, visit * kSecond_us, visit * kSecond_us);
      db.change(
          "INSERT INTO trial (recording, size, modified_ns, state, why, visit, item, began_us, "
          "sha256,"
          " measures_version, measures) VALUES (?, 1, 1, 'measured', '', ?, 0, ?, ?, 3, ?)",
          fmt::format("visit-{}.h5", visit), visit, visit * kSecond_us,
          fmt::format("{:064}", visit), measures);
    }
  }
  transaction.commit();
}

int run(int patients, int seconds) {
  std::string pattern = (std::filesystem::temp_directory_path() / "clinic-load-XXXXXX").string();
  const std::string folder = ::mkdtemp(pattern.data());
  const std::string phrase = "correct horse", pin = "1234";
  ClinicOptions options;
  options.folder = folder;
  options.config = WHOLEHAND_SOURCE_DIR "/config";
  options.cost = {1, 8192};
  const SystemClock clock;
  NoStation station;
  const Json begin = {{"pass_phrase", phrase},
                      {"tile", {{"name", "A"}, {"colour", "#0d6b5a"}, {"pin", pin}}}};
  (void)Clinic(options, clock, station).answer({"POST", "/api/init", {}, {}, {}, begin.dump()});
  const auto keys = readKeyFile(folder + "/keys");
  const auto key = unwrap(keys->by_phrase, phrase);
  fill(folder, *key, patients);

  Clinic clinic(options, clock, station);
  auto server = HttpServer::start(clinic, 0, {kOrigin});
  Client client{(*server)->port(), {}};
  print("open and unlock",
        {client.ask("POST", "/api/unlock", Json({{"pass_phrase", phrase}}).dump())}, 0);
  const auto began = Time::now();
  const std::string body = Json({{"account", 1}, {"pin", pin}}).dump();
  const std::string said = clinic.answer({"POST", "/api/sign_in", {}, {}, {}, body}).body;
  client.token = Json::parse(said).at("token");
  print("sign in", {std::chrono::duration<double, std::milli>(Time::now() - began).count()}, 0);

  std::atomic<bool> ends{false};
  std::mutex mutex;
  std::vector<double> lists, searches, notes, records;
  std::vector<std::thread> threads;
  const auto repeat = [&](std::vector<double>& into, const std::function<double(int)>& work) {
    threads.emplace_back([&, work] {
      std::vector<double> own;
      for (int i = 0; !ends; ++i) own.push_back(work(i));
      const std::lock_guard lock(mutex);
      into.insert(into.end(), own.begin(), own.end());
    });
  };
  for (int i = 0; i < kListing; ++i) {
    repeat(lists, [&client](int) { return client.ask("GET", "/api/patients"); });
  }
  const auto rest = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
  repeat(searches, [&](int n) {
    rest();
    return client.ask("GET", fmt::format("/api/patients?find=Person%20{}", n));
  });
  repeat(records, [&](int n) {
    rest();
    return client.ask("GET", fmt::format("/api/patients/{}", 1 + n % patients));
  });
  repeat(notes, [&](int n) {
    rest();
    return client.ask("POST", fmt::format("/api/visits/{}/notes", (1 + n % patients) * 1000),
                      R"({"text":"cue given"})");
  });
  std::this_thread::sleep_for(std::chrono::seconds(seconds));
  ends = true;
  for (std::thread& thread : threads) thread.join();
  std::printf("%d patients, %d visits; ten clients list without a pause\n", patients,
              patients * kVisits);
  print("list", lists, 100);
  print("search", searches, 100);
  print("note", notes, 50);
  print("a patient's record", records, 0);
  // An export, and lists meanwhile.
  lists.clear();
  double export_ms = 0.0;
  std::atomic<bool> exported{false};
  std::thread thread([&] {
    export_ms = client.ask("GET", "/api/export/all.csv");
    exported = true;
  });
  while (!exported) lists.push_back(client.ask("GET", "/api/patients"));
  thread.join();
  print("export of all", {export_ms}, 0);
  print("list beside it", lists, 100);
  std::filesystem::remove_all(folder);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc > 1 ? std::atoi(argv[1]) : 10'000, argc > 2 ? std::atoi(argv[2]) : 10);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "clinic_load: %s\n", error.what());
  }
  return 1;
}
