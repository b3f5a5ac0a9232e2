#pragma once

/// Recordings: read one tick by tick, or run a rig and keep every tick.
///
///   auto reader = wholehand::RecordingReader::open("run.h5");
///   while ((*reader)->read(i++, record)) ...
///
/// Signals are the program's: while an InterruptScope lives, SIGINT, SIGTERM, SIGHUP and SIGTSTP
/// (Ctrl-Z) stop a run gently whose plan names its `shared()`; a thread of its own takes them. A
/// program with handlers of its own writes to an Interrupts instead. Nothing here is for the tick.

// IWYU pragma: begin_exports
#include "loop/runtime/interrupt_scope.hpp"
#include "loop/runtime/statistics.hpp"  // TickStatistics
#include "record/hub.hpp"               // TelemetryHub: from the queue to writer and sinks
#include "record/recording.hpp"         // RecordingReader, RecordingWriter
#include "record/run/run.hpp"           // Run, runAndRecord()
// IWYU pragma: end_exports
