// The driver `force_dimension`, with the interface of device.h.
#include "drivers/opened_device.hpp"
#include "force_dimension_device.hpp"
#include "force_settings.hpp"
#include "sdk.hpp"

#include <memory>
#include <string>
#include <utility>

using namespace wholehand;
using namespace wholehand::force_dimension;

struct wh_device : OpenedDevice<ForceDimensionDevice> {};

namespace {

Expected<std::unique_ptr<ForceDimensionDevice>> openDevice(const std::string& locator,
                                                           const std::string& path,
                                                           const wh_device::Report& report) {
  const Expected<ForceSettings> settings = loadForceSettings(path);
  if (!settings) return settings.errors();
  Expected<Sdk> sdk = loadSdk();
  if (!sdk) return sdk.errors();
  return ForceDimensionDevice::open(std::move(*sdk), *settings, locator, report);
}

using Functions = PluginFunctions<wh_device, openDevice>;

}  // namespace

const wh_plugin* wh_plugin_v1(void) {
  // Without WH_NEVER_WAITS: the SDK waits for its bus and its time guard, and runs its own threads.
  static constexpr wh_plugin kPlugin = Functions::table(0, "Force Dimension", 10.0, 1.0);
  return &kPlugin;
}
