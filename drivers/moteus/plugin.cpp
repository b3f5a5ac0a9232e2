// The driver `moteus`, with the interface of device.h.
#include "bus_clock.hpp"
#include "can_bus.hpp"
#include "drivers/opened_device.hpp"
#include "moteus_device.hpp"
#include "settings.hpp"

#include <memory>
#include <string>
#include <utility>

using namespace wholehand;
using namespace wholehand::moteus;

struct wh_device : OpenedDevice<MoteusDevice> {};

namespace {

Expected<std::unique_ptr<MoteusDevice>> openDevice(const std::string& locator,
                                                   const std::string& path,
                                                   const wh_device::Report& report) {
  Expected<Settings> settings = loadSettings(path);
  if (!settings) return settings.errors();
  Expected<std::unique_ptr<CanBus>> bus = openCanBus(locator);
  if (!bus) return bus.errors();
  auto device = std::make_unique<MoteusDevice>(std::move(*settings), std::move(*bus),
                                               std::make_unique<MonotonicClock>(), report);
  if (const Expected<Done> checked = device->check(); !checked) return checked.errors();
  return device;
}

using Functions = PluginFunctions<wh_device, openDevice>;

}  // namespace

const wh_plugin* wh_plugin_v1(void) {
  static constexpr wh_plugin kPlugin = Functions::table(WH_NEVER_WAITS, "moteus drives", 10.0, 1.0);
  return &kPlugin;
}
