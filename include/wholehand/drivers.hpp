#pragma once

/// Real devices: a driver (wholehand/device.h) runs in this process or in a host process of its
/// own.
///
///   auto driver = wholehand::PluginDriver::load({"./rails.so", "", ""});
///   auto checked = wholehand::checkArmingPermit((*driver)->identity(), models->device, 1000.0,
///                                               wholehand::placeTimeNow());
///   auto device = wholehand::PluginDevice::make(*driver, models->device, 1e-3,
///                                               checked->permit);
///   auto rig = wholehand::buildRig(*models, std::move(*device), options);
///
/// A host outlives the loop and takes the effort to neutral when the loop dies. Only read() and
/// write() may be called in the tick.

// IWYU pragma: begin_exports
#include "devices/host/device_host.hpp"      // DeviceHost: holds a device for another process
#include "devices/host/host_segment.hpp"     // listHosts(): which hosts there are
#include "devices/host/hosted_driver.hpp"    // HostedDriver: a device that a host holds
#include "devices/passport/passport.hpp"     // checkArmingPermit(): passport and today's check
#include "devices/plugin/device_driver.hpp"  // ObservedDriver: what its newest sample says
#include "devices/plugin/plugin_device.hpp"  // PluginDevice: a driver as a HapticDevice
#include "devices/plugin/plugin_driver.hpp"  // PluginDriver: loads a shared object
// IWYU pragma: end_exports

namespace wholehand {

using Clearance = ArmingPermit;  ///< name in programs written for earlier versions

}  // namespace wholehand
