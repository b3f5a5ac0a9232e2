// Clients' messages by datagram: docs/udp.md.
#include "realtime/monotonic_clock.hpp"
#include "server/clients.hpp"

#include <utility>

namespace wholehand {

namespace {

/// Line of a game without a WebSocket: it sees the results of its orders in the states.
class SilentLine final : public ClientLine {
 public:
  void deliver(SharedBytes) override {}
  [[nodiscard]] bool offer(SharedBytes, std::int64_t) override { return true; }
  [[nodiscard]] std::size_t waiting() const override { return 0; }
  [[nodiscard]] std::int64_t writingSince_ns() const override { return 0; }
  [[nodiscard]] std::string address() const override { return "udp"; }
  void close(const std::string&) override {}
  void cut() override {}
};

}  // namespace

void Clients::joinStandalone() {
  if (udp_ == nullptr || !udp_->awaitsStandalone()) return;
  standalone_ = controls_.newClient();
  clients_[standalone_].line = std::make_shared<SilentLine>();
  udp_->admitStandalone(standalone_);
}

void Clients::heardDatagram(std::uint32_t client, const wire::ClientMessage& m,
                            std::int64_t now_ns) {
  const Entry entry = clients_.find(client);
  if (entry == clients_.end()) return;
  if (m.type == wire::ClientMessageType::kOrder && m.order.type == OrderType::kAim) {
    desk_.heard(client, now_ns);
    aim(entry, m, now_ns);
  } else {
    obey(entry, m, now_ns);
  }
  followControls(now_ns);
}

// Aims arrive up to a thousand times a second: only the first refused one is answered.
void Clients::aim(Entry entry, const wire::ClientMessage& m, std::int64_t now_ns) {
  const std::uint32_t client = entry->first;
  const OrderReply may = mayOrder(entry->second.role, m.order, Standing{desk_.holds(client)});
  if (!may.accepted) {
    if (std::exchange(entry->second.aim_refused, true)) return;
    return refuse(entry, m.id, may.refusal == Refusal::kNotHolder ? "not_holder" : "role", may,
                  now_ns);
  }
  Order order = m.order;
  order.claim = desk_.claim();
  order.client = client;
  backend_.order(
      order, [self = weak_from_this(), post = post_, client, id = m.id](const OrderReply& reply) {
        post([self, client, id, reply] {
          if (const auto clients = self.lock()) clients->aimed(client, id, reply);
        });
      });
}

void Clients::aimed(std::uint32_t client, std::uint32_t command, const OrderReply& reply) {
  const Entry entry = clients_.find(client);
  if (entry == clients_.end()) return;
  const bool told = std::exchange(entry->second.aim_refused, !reply.accepted);
  if (!reply.accepted && !told) refuse(entry, command, "order", reply, monotonicNow_ns());
}

}  // namespace wholehand
