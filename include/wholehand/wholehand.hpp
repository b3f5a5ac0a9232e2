#pragma once

/// Wholehand, for programs that embed the renderer. One include; of the libraries that Wholehand
/// uses, only Eigen appears in its headers.
///
///   auto models = wholehand::loadModels(files);                 // reads TOML; reports all faults
///   at once auto rig = wholehand::buildRig(*models, device, options);   // gains checked, world
///   built auto rehearsal = wholehand::rehearse(*models, at, options); // simulates the rig's worst
///   contacts
///   (*rig)->renderer->arm(rehearsal->passed);                   // places the hand at the device
///   (*rig)->renderer->tick(1, record);                          // your loop, or
///   wholehand::Session session(*(*rig)->renderer, config);      // a real-time thread of its own
///
/// loadModels(), buildRig(), rehearse() and arm() allocate and read files; tick() is real-time
/// safe.

// IWYU pragma: begin_exports
#include "certify/certificate_file.hpp"    // readCertificate(), for RigOptions::certificate
#include "loop/core/body_order.hpp"        // spawnCommand() ..: bodies of a game
#include "loop/core/expected.hpp"          // Expected, Diagnostic
#include "loop/core/tick_record.hpp"       // TickRecord: all that one tick read, computed and sent
#include "loop/device/haptic_device.hpp"   // HapticDevice: implement it for a device of your own
#include "loop/model/game_shapes.hpp"      // prepareShapes(), shapeCommands()
#include "loop/patient/motion.hpp"         // Intention: what the virtual patient wants
#include "loop/physics/physics_world.hpp"  // PhysicsWorld: the interface of an engine
#include "loop/renderer/haptic_renderer.hpp"  // HapticRenderer: arm(), tick()
#include "loop/runtime/session.hpp"           // Session: thread, queue, end at neutral
#include "rig/models.hpp"                     // loadModels(): device, hand, scene, gains, patient
#include "rig/registry/body_table.hpp"        // BodyTable: more bodies than the loop has slots for
#include "rig/rehearsal.hpp"  // rehearse(): required before arming a device that moves a person
#include "rig/rig.hpp"        // buildRig(), checkGains()
// IWYU pragma: end_exports
