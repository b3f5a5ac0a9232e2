#include "server/http_connection.hpp"

#include "core/printable.hpp"
#include "realtime/monotonic_clock.hpp"
#include "server/http_text.hpp"
#include "server/websocket_line.hpp"
#include "server/wire.hpp"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <utility>

namespace wholehand {

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
  line_->read(
      [self = shared_from_this()](ReceivedRequest heard) { self->haveRead(std::move(heard)); });
}

void HttpConnection::hangUpIdle() {
  stopWaiting();
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

void HttpConnection::haveRead(ReceivedRequest heard) {
  stopWaiting();
  request_ = std::move(heard.request);
  ++context_.traffic.http_requests;
  route_ = Site::routeOf(request_);
  if (heard.what != ReceivedRequest::What::kRequest) {
    const int status = heard.what == ReceivedRequest::What::kHasBody ? 413 : 400;
    answer(plainRefusal(status, "malformed_http", "This is not a request that can be answered."));
  } else if (heard.upgrade && request_.path() == "/ws") {
    upgrade();
  } else if (route_ != Site::Route::kNoFile) {
    answerByWorker();
  } else {
    answer(context_.site.answer(request_));
  }
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
          std::make_shared<WebSocketLine>(std::move(stream), address, context.clients,
                                          context.traffic)
              ->join(role);
        });
  }
}

// A worker's job reaches this connection only through the connection's thread: the connection may
// be gone by then, and must not be destroyed on the worker.
bool HttpConnection::letWork(const std::shared_ptr<Work>& work, std::function<void(Work&)> job,
                             void (HttpConnection::*then)(Work&)) {
  work_ = work;
  auto done = [weak = weak_from_this(), work, then, &desk = workers()] {
    const auto self = weak.lock();
    if (self && self->work_ == work) {
      self->line_->callOffAlarm();
      self->work_.reset();
      ((*self).*then)(*work);
    }
    desk.close(std::move(work->file));
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
  // A child process with time limits draws reports and opens recordings.
  const bool works = route_ == Site::Route::kReport || route_ == Site::Route::kReplay;
  line_->setAlarm(works ? context_.report_patience : context_.disk_patience,
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
  } else if (!work.file) {  // deleted meanwhile
    answer(plainRefusal(404, "vanished", "This file is not there any more."));
  } else {
    sendHeader(work);
  }
}

// The disk does not respond. The worker keeps waiting; its result is discarded.
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

// Sends the header, then the file in pieces, so that the timeout restarts with each piece taken.
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
