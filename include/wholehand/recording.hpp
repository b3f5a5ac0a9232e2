#pragma once

/// Recordings: read one tick by tick, or run a rig and keep every tick.
///
///   auto reader = wholehand::RecordingReader::open("run.h5");
///   while ((*reader)->read(i++, record)) ...
///
/// While an InterruptScope lives, SIGINT, SIGTERM, SIGHUP and SIGTSTP (Ctrl-Z) stop a run gently if
/// its plan names the scope's `shared()`. A separate thread handles the signals. A program with
/// signal handlers of its own writes to an Interrupts instead. Nothing here may be called in the
/// tick.

// IWYU pragma: begin_exports
#include "loop/runtime/interrupt_scope.hpp"
#include "loop/runtime/statistics.hpp"  // TickStatistics
#include "record/hub.hpp"               // TelemetryHub: from the queue to writer and sinks
#include "record/recording.hpp"         // RecordingReader, RecordingWriter
#include "rig/run/run.hpp"              // Run, runAndRecord()
// IWYU pragma: end_exports
