#pragma once

/// Recordings: read one tick by tick, or run a rig and keep every tick.
///
///   auto reader = wholehand::RecordingReader::open("run.h5");
///   while ((*reader)->read(i++, record)) ...
///
/// runAndRecord() brings Ctrl-C with it: while it runs, SIGINT, SIGTERM, SIGHUP and SIGTSTP
/// (Ctrl-Z) stop it gently, but for those that are ignored already (nohup); a thread of its own
/// takes them, and the calling thread has them blocked. A program with handlers of its own takes a
/// Session and feeds a RecordingWriter from its queue, by a TelemetryHub. Nothing here is for the
/// tick.

// IWYU pragma: begin_exports
#include "assembly/recorded_run.hpp"  // runAndRecord()
#include "telemetry/hub.hpp"          // TelemetryHub: from the queue to writer and sinks
#include "telemetry/recording.hpp"    // RecordingReader, RecordingWriter
#include "telemetry/statistics.hpp"   // TickStatistics
// IWYU pragma: end_exports
