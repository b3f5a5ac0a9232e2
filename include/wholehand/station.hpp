#pragma once

/// What `wholehand run` is made of: people arm, stop and load at a page or in a game.
///
///   wholehand::Station station(config);                          // runs the loop, on this thread
///   station.load();
///   wholehand::ControlsArbiter controls;                         // who of the clients steers
///   auto server = wholehand::Server::open(station, {}, controls);  // pages and WebSocket
///   station.addSink([&](const auto& record) { (*server)->publish(record); });
///   station.run(false, 0.0);                                     // until Ctrl-C or quit()
///
/// The station outlives the server. The pages are in WHOLEHAND_SHARE_DIR "/web" where they were
/// built before the installation. Nothing here is for the tick.

// IWYU pragma: begin_exports
#include "loop/runtime/interrupt_scope.hpp"  // InterruptScope: Ctrl-C ends the station gently
#include "rig/models.hpp"                    // makeMotionPlayer(), for StationConfig::make_player
#include "station/server/control_desk.hpp"
#include "station/server/server.hpp"      // Server: docs/protocol.md
#include "station/server/udp_bridge.hpp"  // UdpBridge: docs/udp.md
#include "station/station.hpp"
// IWYU pragma: end_exports
