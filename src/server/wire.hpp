#pragma once

#include "core/expected.hpp"
#include "dynamics/articulated_body.hpp"
#include "server/backend.hpp"
#include "server/commissioning_facts.hpp"
#include "server/roles.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

// Messages of protocol/wholehand.fbs: the only place that knows FlatBuffers.
namespace wholehand::wire {

/// Counts changes of the schema that older clients cannot read.
inline constexpr std::uint16_t kSchemaVersion = 1;

/// How much of a record a WorldState carries.
enum class Detail {
  kFull,     ///< all of it: the browser
  kCompact,  ///< hand coordinates, joints, efforts, values; no links, bodies, contacts: fits a
             ///< datagram
  kRecorded  ///< all that a record holds, without what the loop says of itself beside it: a replay
};

/// Encodes one scene's states. Allocates only while its buffer grows. One thread.
class StateEncoder {
 public:
  explicit StateEncoder(std::shared_ptr<const SceneFacts> scene);
  ~StateEncoder();
  StateEncoder(const StateEncoder&) = delete;
  StateEncoder& operator=(const StateEncoder&) = delete;

  /// The message; valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> encode(const TickRecord& record,
                                                     const LoopStatus& status, Detail detail,
                                                     std::int64_t sent_monotonic_ns);

 private:
  struct Buffer;
  std::shared_ptr<const SceneFacts> scene_;
  ArticulatedBody kinematics_;
  std::unique_ptr<Buffer> buffer_;
};

using Bytes = std::vector<std::uint8_t>;

struct NumberedEvent {
  std::uint64_t tick = 0;
  ExerciseEvent event;
};

[[nodiscard]] Bytes sceneMessage(const SceneFacts& scene);
[[nodiscard]] Bytes eventsMessage(std::span<const NumberedEvent> events);
/// Where a client may send datagrams, and the key to them; port 0: nowhere.
struct DatagramDoor {
  std::uint16_t port = 0;
  std::uint64_t key = 0;
};
[[nodiscard]] Bytes welcomeMessage(std::uint32_t client, bool controls,
                                   const std::string& program_version,
                                   const DatagramDoor& door = {});
/// Who has the controls, as one client is told.
struct ControlsFacts {
  bool held_by_you = false, held = false;
  Role your_role = Role::kUnsaid, holder_role = Role::kUnsaid;
  bool led = false;  ///< a therapist is connected
};
[[nodiscard]] Bytes controlsMessage(const ControlsFacts& facts);
[[nodiscard]] Bytes commissioningMessage(const CommissioningFacts& facts);
[[nodiscard]] Bytes replyMessage(std::uint32_t command, const OrderReply& reply);

/// What a client may say.
enum class ClientMessageType { kOrder, kTakeControls, kReleaseControls, kHeartbeat };

struct ClientMessage {
  ClientMessageType type = ClientMessageType::kHeartbeat;
  std::uint32_t id = 0;  ///< Command.id
  Order order;
  std::string token;  ///< kTakeControls

  /// A stop of either kind: whatever else a client sends, it is heard.
  [[nodiscard]] bool stops() const noexcept {
    return type == ClientMessageType::kOrder &&
           (order.type == OrderType::kStop || order.type == OrderType::kEmergencyStop);
  }
  /// Comes by the hundred, and the next one corrects it: nobody waits for its answer.
  [[nodiscard]] bool streams() const noexcept {
    return type == ClientMessageType::kHeartbeat ||
           (type == ClientMessageType::kOrder &&
            (order.type == OrderType::kAim || order.type == OrderType::kHoldToMove));
  }
};

/// By the schema's name: "EmergencyStop".
[[nodiscard]] const char* nameOf(const ClientMessage& message) noexcept;

/// The largest message a client may send [bytes].
inline constexpr std::size_t kLargestClientMessage = 4096;

/// Verifies and decodes; the reason where it is refused: too large, not a message, another schema
/// version, not for the program, unknown enum, a number that is not finite, more axes than there
/// can be.
[[nodiscard]] Expected<ClientMessage> decode(std::span<const std::uint8_t> message);

/// What decode() refused, as clients are told.
[[nodiscard]] Refusal refusalOf(const Diagnostics& errors);

}  // namespace wholehand::wire
