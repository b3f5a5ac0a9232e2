#pragma once

#include "loop/core/active_time.hpp"
#include "loop/core/expected.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "station/server/access.hpp"
#include "vocabulary/backend.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

// Encoding and decoding of protocol/wholehand.fbs. Only this code knows FlatBuffers.
namespace wholehand::wire {

/// Version of the schema; counts incompatible changes.
inline constexpr std::uint16_t kSchemaVersion = 1;

/// How much of a record a WorldState carries.
enum class Detail {
  kFull,     ///< everything: for the browser
  kCompact,  ///< hand coordinates, joints, efforts, values; without links, bodies and contacts.
             ///< Fits into a datagram
  kRecorded  ///< everything in the record, without the loop's status: for a replay
};

/// Encodes the states of one scene. Allocates only while its buffer grows. One thread.
class StateEncoder {
 public:
  explicit StateEncoder(std::shared_ptr<const SceneFacts> scene);
  ~StateEncoder();
  StateEncoder(const StateEncoder&) = delete;
  StateEncoder& operator=(const StateEncoder&) = delete;

  /// Encodes a state; the bytes are valid until the next call.
  /// @param active active time of the session so far
  [[nodiscard]] std::span<const std::uint8_t> encode(const TickRecord& record,
                                                     const LoopStatus& status, Detail detail,
                                                     std::int64_t sent_monotonic_ns,
                                                     const ActivePeriods& active = {});

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
/// Port and key for a client's datagrams; port 0: none.
struct UdpAccess {
  std::uint16_t port = 0;
  std::uint64_t key = 0;
};
[[nodiscard]] Bytes welcomeMessage(std::uint32_t client, bool controls,
                                   const std::string& program_version,
                                   const UdpAccess& access = {});
/// Holder of the controls, as reported to one client.
struct ControlsFacts {
  bool held_by_you = false, held = false;
  Role your_role = Role::kUnspecified, holder_role = Role::kUnspecified;
  bool led = false;  ///< a therapist is connected
};
[[nodiscard]] Bytes controlsMessage(const ControlsFacts& facts);
[[nodiscard]] Bytes commissioningMessage(const CommissioningFacts& facts);
/// Encodes bodies of a game, and those of their shapes that no body of the previous message had.
/// @param registered registered bodies that changed; one without shapes is no longer registered
[[nodiscard]] Bytes gameBodiesMessage(
    std::uint32_t session, const GameBodies& bodies,
    const std::vector<std::shared_ptr<const GameShapes>>& new_shapes,
    const RegisteredBodies& registered = {});
[[nodiscard]] Bytes replyMessage(std::uint32_t command, const OrderReply& reply);

/// Limit for a client's message [bytes]: the shapes of a body with the most pieces and vertices.
inline constexpr std::size_t kLargestClientMessage = 40 * 1024;

/// Verifies and decodes a message. Refuses one that is too large, malformed, of another schema
/// version or direction, has an unknown enum or a number that is not finite, or more axes than
/// possible.
[[nodiscard]] Expected<Order> decode(std::span<const std::uint8_t> message);

/// Command.id of a message that decode() refuses, for the answer; 0 when it cannot be read.
[[nodiscard]] std::uint32_t commandIdOf(std::span<const std::uint8_t> message);

/// Refusal code for the errors of decode().
[[nodiscard]] Refusal refusalOf(const Diagnostics& errors);

}  // namespace wholehand::wire
