// Your own program that does what `wholehand run --driver` does: it drives a real device, and
// people arm and stop it at the console in a browser. Nothing moves until a person arms it.
//
//   06_serve_a_driver rails.so [settings of the driver [folder that holds config/ [and the pages]]]
#include "wholehand/drivers.hpp"
#include "wholehand/station.hpp"
#include "wholehand/wholehand.hpp"

#include <cstdio>
#include <memory>
#include <string>

using namespace wholehand;

constexpr double kPeriod_s = 1e-3;

int fail(const Diagnostics& why) {
  return std::fprintf(stderr, "%s\n", format(why).c_str()), 2;
}

StationConfig configOf(const std::string& config, const std::shared_ptr<PluginDriver>& driver) {
  StationConfig out;
  out.files = {config + "/scenes/four-shapes.toml",      config + "/hands/adult-median-right.toml",
               config + "/devices/desktop-3axis.toml",   config + "/rendering/desktop-3axis.toml",
               config + "/patients/no-arm.toml",         "",
               config + "/exercises/free-grasping.toml", 1};
  out.rig.period_s = kPeriod_s;
  out.config_folder = config;
  out.make_player = makeMotionPlayer;
  out.make_device = [driver](const DeviceModel& model) {
    // rails.so simulates its device. For a real device, checkArmingPermit() shows that it was
    // commissioned and checked today: checkArmingPermit(driver->identity(), model, 1.0 / kPeriod_s,
    // placeTimeNow()).
    return PluginDevice::make(driver, model, kPeriod_s, ArmingPermit::withoutPassport());
  };
  out.log = [](const std::string& line) { std::printf("%s\n", line.c_str()); };
  return out;
}

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  if (argc < 2) return std::fprintf(stderr, "which driver?\n"), 2;
  const std::string share = argc > 3 ? argv[3] : WHOLEHAND_SOURCE_DIR;
  const InterruptScope signals;  // from here on Ctrl-C ramps to neutral and ends
  auto driver = PluginDriver::load({argv[1], "", argc > 2 ? argv[2] : ""});
  if (!driver) return fail(driver.errors());
  Station station(configOf(share + "/config", *driver));
  if (auto loaded = station.load(); !loaded) return fail(loaded.errors());

  ControlHolder controls;
  ServerOptions options;
  options.port = 0;  // any free port
  options.web_folder = argc > 4 ? argv[4] : share + "/web/dist";
  auto server = Server::open(station, options, controls);
  if (!server) return fail(server.errors());
  station.addSink([&server](const TickRecord& record) { (*server)->publish(record); });
  std::printf("%sconsole\n", (*server)->url().c_str());
  auto outcome = station.run(/*arm_at_once=*/false, 0.0);
  server->reset();  // before the station, which the server uses
  if (!outcome) return fail(outcome.errors());
  std::printf("%llu sessions%s\n", static_cast<unsigned long long>(outcome->sessions),
              outcome->faulted ? ", the last ended by a fault" : "");
  return outcome->faulted ? 1 : 0;
}
