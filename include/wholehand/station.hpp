#pragma once

/// The parts of `wholehand run`: people arm, stop and load exercises from a web page or from a
/// game.
///
///   wholehand::Station station(config);                          // runs the loop, on this thread
///   station.load();
///   wholehand::ControlHolder controls;                           // which client has the controls
///   auto server = wholehand::Server::open(station, {}, controls);  // pages and WebSocket
///   station.addSink([&](const auto& record) { (*server)->publish(record); });
///   station.run(false, 0.0);                                     // until Ctrl-C or quit()
///
/// The station outlives the server. The pages are in WHOLEHAND_SHARE_DIR "/web" if they were built
/// before the installation. Nothing here may be called in the tick.

// IWYU pragma: begin_exports
#include "loop/runtime/interrupt_scope.hpp"   // InterruptScope: Ctrl-C ends the station gently
#include "rig/models.hpp"                     // makeMotionPlayer(), for StationConfig::make_player
#include "station/server/control_holder.hpp"  // ControlHolder: which client has the controls
#include "station/server/server.hpp"          // Server: docs/protocol.md
#include "station/server/udp_bridge.hpp"      // UdpBridge: docs/udp.md
#include "station/station.hpp"
// IWYU pragma: end_exports

namespace wholehand {

using ControlsArbiter = ControlHolder;  ///< name in programs written for earlier versions

}  // namespace wholehand
