#pragma once

/// Wholehand, for programs that embed the renderer. One include, and of all the libraries it is
/// made with only Eigen shows.
///
///   auto models = wholehand::loadModels(files);                 // TOML, every fault at once
///   auto rig = wholehand::buildRig(*models, device, options);   // gains checked, world built
///   auto rehearsal = wholehand::rehearse(*models, at, options); // its worst contacts, simulated
///   (*rig)->renderer->arm(rehearsal->passed);                   // the hand stands at the device
///   (*rig)->renderer->tick(1, record);                          // your loop, or
///   wholehand::Session session(*(*rig)->renderer, config);      // a real-time thread of its own
///
/// loadModels(), buildRig(), rehearse() and arm() allocate and read files; tick() is real-time
/// safe.

// IWYU pragma: begin_exports
#include "assembly/models.hpp"                 // loadModels(): device, hand, scene, gains, patient
#include "assembly/rehearsal.hpp"              // rehearse(): by it what moves a person is armed
#include "assembly/rig.hpp"                    // buildRig(), checkGains()
#include "certification/certificate_file.hpp"  // readCertificate(), for RigOptions::certificate
#include "core/body_order.hpp"                 // spawnCommand() ..: bodies of a game
#include "core/expected.hpp"                   // Expected, Diagnostic
#include "core/tick_record.hpp"          // TickRecord: all that one tick read, computed and sent
#include "device/haptic_device.hpp"      // HapticDevice: implement it for a device of your own
#include "model/scene/game_shapes.hpp"   // prepareShapes(), shapeCommands()
#include "patient/motion.hpp"            // Intention: what the virtual patient wants
#include "physics/physics_world.hpp"     // PhysicsWorld: the interface of an engine
#include "registry/body_registry.hpp"    // BodyRegistry: more bodies than the loop has slots for
#include "renderer/haptic_renderer.hpp"  // HapticRenderer: arm(), tick()
#include "runtime/session.hpp"           // Session: thread, queue, end at neutral
// IWYU pragma: end_exports
