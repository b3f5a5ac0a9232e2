#include "server/websocket_line.hpp"

#include "realtime/monotonic_clock.hpp"

#include <utility>

namespace wholehand {

WebSocketLine::WebSocketLine(std::unique_ptr<WebSocketStream> stream, std::string address,
                             Clients& clients, Traffic& traffic)
    : stream_(std::move(stream)),
      address_(std::move(address)),
      clients_(clients),
      traffic_(traffic) {}

void WebSocketLine::join(Role role) {
  number_ = clients_.join(shared_from_this(), role, monotonicNow_ns());
  read();
}

void WebSocketLine::deliver(SharedBytes message) {
  if (closing_) return;
  queue_.push_back(std::move(message));
  if (!writing_) writeNext();
}

bool WebSocketLine::offer(SharedBytes state, std::int64_t arrived_ns) {
  if (writing_ || closing_) return false;
  arrived_ns_ = arrived_ns;
  write(std::move(state));
  return true;
}

void WebSocketLine::close(const std::string& reason) {
  if (closing_) return;
  closing_ = reason;
  if (!writing_) end();
}

// The pending read ends with the connection.
void WebSocketLine::end() {
  stream_->close(*closing_, [self = shared_from_this()] { (void)self; });
}

void WebSocketLine::read() {
  stream_->read(
      [self = shared_from_this()](const ReceivedMessage& heard) { self->haveRead(heard); });
}

void WebSocketLine::haveRead(const ReceivedMessage& heard) {
  const std::int64_t now_ns = monotonicNow_ns();
  if (heard.what == ReceivedMessage::What::kTooLarge) clients_.refuseOversized(number_, now_ns);
  if (heard.what != ReceivedMessage::What::kMessage) {
    clients_.leave(number_, now_ns);
    return;
  }
  clients_.heard(number_, heard.bytes, heard.text, now_ns);
  read();
}

void WebSocketLine::writeNext() {
  SharedBytes next = std::move(queue_.front());
  queue_.pop_front();
  arrived_ns_ = 0;
  write(std::move(next));
}

void WebSocketLine::write(SharedBytes message) {
  writing_ = std::move(message);
  since_ns_ = monotonicNow_ns();
  stream_->write(*writing_, [self = shared_from_this()](bool sent) { self->haveWritten(sent); });
}

void WebSocketLine::haveWritten(bool sent) {
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

}  // namespace wholehand
