// Scripts act as pages and connect to a station over WebSocket. Each script runs to its last order,
// and a stop comes at a random moment. Nothing may render afterwards until somebody who was shown
// the stop arms again. WHOLEHAND_FULL tries 1,000 moments.
#include "station/server/client_words.hpp"
#include "station/server/fake_program.hpp"
#include "station/station_bench.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

#include <cstdlib>
#include <map>

namespace wholehand::test {
namespace {

namespace fb = wholehand::protocol;
using replies::Answer;
using Random = std::mt19937_64;

/// A page that sends orders and reads messages in one thread.
class Page {
 public:
  explicit Page(std::uint16_t port) : port_(port) { connect(); }

  void connect() {
    socket_ = std::make_unique<WebSocket>(port_);
    id_ = 0;
    (void)lookUntil([this] { return looked_; });
  }
  void leave() { socket_.reset(); }
  /// Number of the newest ending that the page has shown its person.
  [[nodiscard]] std::uint32_t shown() const { return endings_; }
  /// Number of the person, hand, level and limits that the page has shown.
  [[nodiscard]] std::uint32_t basis() const { return basis_; }
  [[nodiscard]] fb::RunState runState() const { return run_state_; }

  /// Sends a command and reads until its answer arrives.
  Answer send(const wire::Bytes& command) {
    socket_->send(command);
    Answer answer;
    (void)lookUntil([&] { return answered(answer); });
    return answer;
  }
  void sendOnly(const wire::Bytes& command) { socket_->send(command); }
  /// Reads messages until the condition holds; false if the line closes or the time is over.
  template <class Condition>
  bool lookUntil(Condition&& condition) {
    looked_ = false;
    for (const auto until = Clock::now() + kHang; !condition();) {
      const auto frame = socket_->receive(50ms);
      if (frame && frame->opcode == 2) handle(replies::message(*frame));
      if (Clock::now() > until || (!frame && socket_->closed())) return false;
      socket_->send(words::heartbeat(0));  // nothing starts for a client that is not heard
    }
    return true;
  }
  std::uint32_t nextId() { return ++id_; }

 private:
  void handle(const fb::Message& message) {
    if (const auto* state = message.payload_as_WorldState()) {
      endings_ = state->endings();
      basis_ = state->basis();
      run_state_ = state->run_state();
      looked_ = true;
    } else if (const auto* reply = message.payload_as_Reply()) {
      answers_[reply->command()] = {reply->command(), reply->accepted(), reply->reason()->str(),
                                    reply->refusal()};
    }
  }
  bool answered(Answer& answer) {
    const auto found = answers_.find(id_);
    if (found == answers_.end()) return false;
    answer = found->second;
    answers_.clear();
    return true;
  }

  std::uint16_t port_;
  std::unique_ptr<WebSocket> socket_;
  std::uint32_t id_ = 0, endings_ = 0, basis_ = 0;
  fb::RunState run_state_ = fb::RunState::Disarmed;
  bool looked_ = false;
  std::map<std::uint32_t, Answer> answers_;
};

void wait(Random& random, int most_ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(random() % (most_ms + 1)));
}

/// Takes the controls; tries again while another page holds them.
void take(Page& page) {
  for (int tries = 0; tries < 40; ++tries) {
    if (page.send(words::takeControls(page.nextId())).accepted) return;
    std::this_thread::sleep_for(20ms);
  }
}

// ---- presses of a person and the orders of the page: each script names the ending shown then

void pressStart(Page& page, Random& random) {
  const std::uint32_t seen = page.shown(), basis = page.basis();
  take(page);
  page.send(words::load(page.nextId(), "", static_cast<std::uint16_t>(1 + random() % 2), ""));
  wait(random, 50);
  page.send(words::armAcknowledging(seen, page.nextId(), basis));
  page.send(words::steer(page.nextId(), fb::Steering::Person));
  page.send(words::action(page.nextId(), fb::Act::Restart, basis));
  page.send(words::releaseControls(page.nextId()));
}

void pressLoad(Page& page, Random& random) {
  take(page);
  page.send(words::load(page.nextId(), "", static_cast<std::uint16_t>(1 + random() % 2), ""));
  page.send(words::releaseControls(page.nextId()));
}

void pressArm(Page& page, Random& random) {
  const std::uint32_t seen = page.shown(), basis = page.basis();
  take(page);
  wait(random, 100);
  page.send(words::armAcknowledging(seen, page.nextId(), basis));
  page.send(words::releaseControls(page.nextId()));
}

void pressPauseAgainAndAgain(Page& page, Random& random) {
  take(page);
  for (int i = 0; i < 12; ++i) {
    page.send(
        words::action(page.nextId(), i % 2 == 0 ? fb::Act::Pause : fb::Act::Resume, page.basis()));
    wait(random, 80);
  }
  page.send(words::releaseControls(page.nextId()));
}

/// The line breaks during the load; the remaining orders of the press go over the next line.
void pressStartAndReconnect(Page& page, Random& random) {
  const std::uint32_t seen = page.shown(), basis = page.basis();
  take(page);
  page.sendOnly(words::load(page.nextId(), "", 1, ""));
  wait(random, 400);
  page.leave();
  wait(random, 100);
  page.connect();
  take(page);
  page.send(words::armAcknowledging(seen, page.nextId(), basis));
  page.send(words::releaseControls(page.nextId()));
}

/// A hidden page is suspended for a while between its orders.
void pressStartAndHide(Page& page, Random& random) {
  const std::uint32_t seen = page.shown(), basis = page.basis();
  take(page);
  page.send(words::load(page.nextId(), "", 1, ""));
  wait(random, 1000);
  page.send(words::armAcknowledging(seen, page.nextId(), basis));
  page.send(words::releaseControls(page.nextId()));
}

using Script = void (*)(Page&, Random&);
constexpr std::array<Script, 6> kScripts = {
    pressStart,       pressLoad, pressArm, pressPauseAgainAndAgain, pressStartAndReconnect,
    pressStartAndHide};

class RandomStops : public ServedBar {
 protected:
  void open() {
    Bar::load(barConfig());
    station_->addSink([this](const TickRecord& record) { keep(record); });
    serve();
  }
  /// Stores the newest session that pushed. All records of a session come before the next begins.
  void keep(const TickRecord& record) {
    if (record.authority > 0.0) pushed_ = station_->status().session;
  }
  /// A person at another page sees the state and presses Start until it renders.
  void renders(Page& page) {
    ASSERT_TRUE(page.lookUntil([&] {
      if (page.runState() == fb::RunState::Rendering) return true;
      page.send(words::takeControls(page.nextId()));
      const Answer armed =
          page.send(words::armAcknowledging(page.shown(), page.nextId(), page.basis()));
      page.send(words::releaseControls(page.nextId()));
      return armed.accepted;
    }));
    ASSERT_TRUE(page.lookUntil([&] { return page.runState() == fb::RunState::Rendering; }));
  }
  /// Sends an emergency stop over the page's line, or gives a stop to the station directly, as a
  /// game over UDP would.
  void stop(Page& page, Random& random) {
    if (random() % 2 == 0) {
      ASSERT_TRUE(page.send(words::emergencyStop(page.nextId())).accepted);
    } else {
      ASSERT_TRUE(ask(orders::Stop{}).accepted);
    }
  }

  std::atomic<std::uint32_t> pushed_{0};
};

TEST_F(RandomStops, StopAtARandomMoment_NothingRendersUntilSomebodyWhoSawItArms) {
  const int moments = std::getenv("WHOLEHAND_FULL") != nullptr ? 1000 : 8;
  auto random = seededRandom(8801);
  open();
  int tried = 0, rendering = 0;
  for (int moment = 0; moment < moments && !HasFailure(); ++moment) {
    Page observer(server_->port());
    if (random() % 2 == 0) renders(observer);
    std::vector<std::unique_ptr<Page>> pages;
    std::vector<std::thread> people;
    const std::size_t first = random() % kScripts.size();
    for (std::size_t who = 0; who < 1 + random() % 2; ++who) {  // one page, or two at the same time
      pages.push_back(std::make_unique<Page>(server_->port()));
      const Script script = who == 0 ? kScripts[first] : kScripts[random() % kScripts.size()];
      people.emplace_back([&page = *pages.back(), script, seed = random()] {
        Random own(seed);
        script(page, own);
      });
    }
    wait(random, 1500);
    if (station_->status().run_state == RunState::kRendering) ++rendering;
    stop(observer, random);
    // A session begun before the stop may push until it is at neutral; no later one may push.
    const std::uint32_t newest = station_->status().session;
    for (std::thread& person : people) person.join();
    EXPECT_TRUE(becomes(RunState::kStopped)) << "moment " << moment << ", script " << first;
    std::this_thread::sleep_for(100ms);
    EXPECT_EQ(station_->status().run_state, RunState::kStopped) << kAlways << "moment " << moment;
    EXPECT_LE(pushed_, newest) << kAlways << "moment " << moment << ", script " << first;
    if (++tried % 50 == 0) std::printf("%d moments\n", tried);
  }
  figure("stops at random moments", tried, "");
  figure("of them while it rendered", rendering, "");
  Page somebody(server_->port());
  renders(somebody);  // a page that was shown the stop may arm
}

}  // namespace
}  // namespace wholehand::test
