#include "station/server/http_connection.hpp"

#include "loop/core/printable.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "station/server/clients.hpp"
#include "station/server/http_line.hpp"
#include "station/server/traffic.hpp"
#include "station/server/websocket_stream.hpp"
#include "station/server/wire.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

namespace wholehand {

namespace {

/// A header that is too large is refused after this time. The kernel copies megabytes for every
/// such request before anybody can refuse it; a client that is answered at once repeats it hundreds
/// of times a second and occupies the processors of this machine.
constexpr std::chrono::milliseconds kTooLargeWait{500};

/// A client's WebSocket connection. Lives while one of its operations is pending, or while
/// `clients` holds it. Server's thread only.
class WebSocketConnection final : public ClientConnection,
                                  public std::enable_shared_from_this<WebSocketConnection> {
 public:
  /// @pre clients and traffic outlive every operation
  WebSocketConnection(std::unique_ptr<WebSocketStream> stream, std::string address,
                      Clients& clients, Traffic& traffic);

  /// Joins the clients and starts to read.
  void join(Role role);

  void deliver(SharedBytes message) override;
  bool offer(SharedBytes state, std::int64_t arrived_ns) override;
  std::size_t waiting() const override { return queue_.size(); }
  std::int64_t writingSince_ns() const override { return writing_ ? since_ns_ : 0; }
  std::string address() const override { return address_; }
  void close(const std::string& reason) override;
  void cut() override { stream_->cut(); }

 private:
  void read();
  void haveRead(const ReceivedMessage& received);
  void writeNext();
  void write(SharedBytes message);
  void haveWritten(bool sent);
  void end();

  std::unique_ptr<WebSocketStream> stream_;
  const std::string address_;
  Clients& clients_;
  Traffic& traffic_;
  std::uint32_t number_ = 0;
  std::deque<SharedBytes> queue_;
  std::optional<std::string> closing_;  ///< why the connection ends
  SharedBytes writing_;
  std::int64_t since_ns_ = 0;    ///< start of the current write
  std::int64_t arrived_ns_ = 0;  ///< arrival of the state in writing_; 0: not a state
};

WebSocketConnection::WebSocketConnection(std::unique_ptr<WebSocketStream> stream,
                                         std::string address, Clients& clients, Traffic& traffic)
    : stream_(std::move(stream)),
      address_(std::move(address)),
      clients_(clients),
      traffic_(traffic) {}

void WebSocketConnection::join(Role role) {
  number_ = clients_.join(shared_from_this(), role, monotonicNow_ns());
  read();
}

void WebSocketConnection::deliver(SharedBytes message) {
  if (closing_) return;
  queue_.push_back(std::move(message));
  if (!writing_) writeNext();
}

bool WebSocketConnection::offer(SharedBytes state, std::int64_t arrived_ns) {
  if (writing_ || closing_) return false;
  arrived_ns_ = arrived_ns;
  write(std::move(state));
  return true;
}

void WebSocketConnection::close(const std::string& reason) {
  if (closing_) return;
  closing_ = reason;
  if (!writing_) end();
}

// Closes the stream; the pending read ends with the connection.
void WebSocketConnection::end() {
  stream_->close(*closing_, [self = shared_from_this()] { (void)self; });
}

void WebSocketConnection::read() {
  stream_->read(
      [self = shared_from_this()](const ReceivedMessage& received) { self->haveRead(received); });
}

void WebSocketConnection::haveRead(const ReceivedMessage& received) {
  const std::int64_t now_ns = monotonicNow_ns();
  if (received.what == ReceivedMessage::Kind::kTooLarge) clients_.refuseOversized(number_, now_ns);
  if (received.what != ReceivedMessage::Kind::kMessage) {
    clients_.leave(number_, now_ns);
    return;
  }
  clients_.receive(number_, received.bytes, received.text, now_ns);
  read();
}

void WebSocketConnection::writeNext() {
  SharedBytes next = std::move(queue_.front());
  queue_.pop_front();
  arrived_ns_ = 0;
  write(std::move(next));
}

void WebSocketConnection::write(SharedBytes message) {
  writing_ = std::move(message);
  since_ns_ = monotonicNow_ns();
  stream_->write(*writing_, [self = shared_from_this()](bool sent) { self->haveWritten(sent); });
}

void WebSocketConnection::haveWritten(bool sent) {
  const std::int64_t now_ns = monotonicNow_ns();
  if (!sent) {
    clients_.leave(number_, now_ns);
    return;
  }
  traffic_.bytes_sent += writing_->size();
  if (arrived_ns_ != 0) traffic_.addAge(now_ns - arrived_ns_);
  writing_.reset();
  if (!queue_.empty()) {
    writeNext();
  } else if (closing_) {
    end();
  }
}

}  // namespace

HttpConnection::HttpConnection(std::unique_ptr<HttpLine> line, ConnectionContext& context)
    : line_(std::move(line)), context_(context) {
  ++context_.connections;
}

HttpConnection::~HttpConnection() {
  stopWaiting();
  closeFile();
  --context_.connections;
}

void HttpConnection::read() {
  place_ = context_.idle.insert(context_.idle.end(), this);
  line_->read([self = shared_from_this()](ReceivedRequest received) {
    self->haveRead(std::move(received));
  });
}

void HttpConnection::hangUpIdle() {
  stopWaiting();
  line_->cancelTimer();
  line_->close();
}

void HttpConnection::stopWaiting() {
  if (place_) context_.idle.erase(*place_);
  place_.reset();
}

void HttpConnection::closeFile() {
  if (file_) workers().close(std::move(file_));
}

HttpLine::Then HttpConnection::next(Then then) {
  return [self = shared_from_this(), then] { ((*self).*then)(); };
}

FileWorkers& HttpConnection::workers() {
  if (route_ == Site::Route::kPage) return context_.pages;
  return route_ == Site::Route::kReplay ? context_.replays : context_.recordings;
}

void HttpConnection::haveRead(ReceivedRequest received) {
  stopWaiting();
  request_ = std::move(received.request);
  ++context_.traffic.http_requests;
  route_ = Site::routeOf(request_);
  if (received.what == ReceivedRequest::Kind::kTooLarge) {
    refuseLate();
  } else if (received.what != ReceivedRequest::Kind::kRequest) {
    const int status = received.what == ReceivedRequest::Kind::kHasBody ? 413 : 400;
    answer(plainRefusal(status, "malformed_http", "This is not a request that can be answered."));
  } else if (received.upgrade && request_.path() == "/ws") {
    upgrade();
  } else if (route_ != Site::Route::kNoFile) {
    answerByWorker();
  } else {
    answer(context_.site.answer(request_));
  }
}

// Reads nothing more meanwhile, so the client's header stays in its own buffers.
void HttpConnection::refuseLate() {
  place_ = context_.idle.insert(context_.idle.begin(), this);
  line_->setTimer(kTooLargeWait, [self = shared_from_this()] {
    self->stopWaiting();
    self->answer(plainRefusal(431, "header_too_large",
                              "The header of the request is too large. Delete the cookies of this "
                              "address and try again."));
  });
}

void HttpConnection::upgrade() {
  HttpAnswer verdict = context_.site.mayConnect(request_);
  if (verdict.status != 200) {
    answer(std::move(verdict));
  } else if (context_.clients.count() + context_.upgrading >= context_.max_clients &&
             !context_.clients.makeRoom(line_->peer(), monotonicNow_ns())) {
    answer(plainRefusal(503, "too_many_clients",
                        "The largest number of clients is connected already. Close a page or a "
                        "client and try again."));
  } else {
    std::string cookie = context_.site.cookieFor(request_);
    ++context_.upgrading;
    line_->upgrade(
        std::move(cookie), wire::kLargestClientMessage,
        [&context = context_, address = line_->peer(),
         role = context_.site.roleOf(request_)](std::unique_ptr<WebSocketStream> stream) {
          --context.upgrading;
          if (!stream) return;
          std::make_shared<WebSocketConnection>(std::move(stream), address, context.clients,
                                                context.traffic)
              ->join(role);
        });
  }
}

// Queues a job for a worker. The result comes back through the connection's thread, because the
// connection may be gone by then and must not be destroyed on the worker.
bool HttpConnection::letWork(const std::shared_ptr<Work>& work, std::function<void(Work&)> job,
                             void (HttpConnection::*then)(Work&)) {
  work_ = work;
  auto done = [weak = weak_from_this(), work, then, &file_workers = workers()] {
    const auto self = weak.lock();
    if (self && self->work_ == work) {
      self->line_->cancelTimer();
      self->work_.reset();
      ((*self).*then)(*work);
    }
    file_workers.close(std::move(work->file));
  };
  if (!workers().post([work, job = std::move(job), done, &context = context_] {
        try {
          if (!work->given_up) job(*work);
        } catch (const std::bad_alloc&) {
          work->no_memory = true;
        }
        context.post(done);
      })) {
    work_.reset();
    return false;
  }
  // Reports and replays have a longer timeout: a child process with its own time limits makes them.
  const bool works = route_ == Site::Route::kReport || route_ == Site::Route::kReplay;
  line_->setTimer(works ? context_.report_patience : context_.disk_patience,
                  [self = shared_from_this(), work] { self->giveUp(work); });
  return true;
}

void HttpConnection::answerByWorker() {
  auto work = std::make_shared<Work>();
  work->request = request_;
  work->head = line_->headOnly();
  const auto job = [&site = context_.site](Work& w) {
    try {
      w.answer = site.answer(w.request);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception&) {
      w.answer = plainRefusal(500, "exception", "This could not be made.");
    }
    if (w.answer.file.empty()) return;
    w.file = FileReader::open(w.answer.file);
    if (w.file && !w.head) w.piece = w.file->next();
  };
  if (!letWork(work, job, &HttpConnection::haveMade)) {
    answer(
        plainRefusal(503, "busy", "Too much is being read or drawn at present. Try again soon."));
  }
}

void HttpConnection::haveMade(Work& work) {
  if (work.no_memory) {
    answer(plainRefusal(503, "memory", "This machine has no memory left for it. Try again later."));
  } else if (work.answer.file.empty()) {
    answer(std::move(work.answer));
  } else if (!work.file) {  // the file was deleted meanwhile
    answer(plainRefusal(404, "vanished", "This file is not there any more."));
  } else {
    sendHeader(work);
  }
}

// Answers when the disk does not respond. The worker keeps waiting; its result is discarded.
void HttpConnection::giveUp(const std::shared_ptr<Work>& work) {
  if (work_ != work) return;
  work_->given_up = true;
  work_.reset();
  line_->keepNoLonger();
  if (sending_) {
    line_->close();
  } else {
    answer(plainRefusal(503, "disk", "The disk does not answer, or the report is too large."));
  }
}

void HttpConnection::answer(HttpAnswer a) {
  if (!a.refused.empty()) {
    ++context_.traffic.refused[a.refused];
    context_.log.write(
        fmt::format("{} refused ({}): {}", line_->peer(), a.refused, printable(request_.path())),
        monotonicNow_ns());
  }
  line_->send(std::move(a), next(&HttpConnection::haveAnswered));
}

// Sends the header, then the file in pieces, so that the timeout restarts with each piece.
void HttpConnection::sendHeader(Work& work) {
  file_ = std::move(work.file);
  sending_ = true;
  line_->sendHeader(work.answer, file_->size(),
                    [self = shared_from_this(), piece = std::move(work.piece)]() mutable {
                      if (self->line_->headOnly()) return self->haveSentFile();
                      self->sendPiece(std::move(piece));
                    });
}

void HttpConnection::sendPiece(std::string piece) {
  line_->sendPiece(std::move(piece), next(&HttpConnection::readPiece));
}

void HttpConnection::readPiece() {
  if (file_->left() == 0) return haveSentFile();
  auto work = std::make_shared<Work>();
  work->file = std::move(file_);
  const auto job = [](Work& w) { w.piece = w.file->next(); };
  if (!letWork(work, job, &HttpConnection::havePiece)) {
    file_ = std::move(work->file);
    line_->close();  // the announced length cannot be sent
  }
}

void HttpConnection::havePiece(Work& work) {
  if (work.piece.empty()) return line_->close();  // the file was shortened
  file_ = std::move(work.file);
  sendPiece(std::move(work.piece));
}

void HttpConnection::haveSentFile() {
  closeFile();
  sending_ = false;
  haveAnswered();
}

void HttpConnection::haveAnswered() {
  if (line_->keepsAlive()) return read();
  line_->finish();
}

}  // namespace wholehand
