#include "sdk.hpp"

#include <cstdlib>
#include <dlfcn.h>
#include <sys/utsname.h>
#include <utility>
#include <vector>

namespace wholehand::force_dimension {
namespace {

constexpr const char* kLibrary = "libdrd.so.3";
constexpr int kMajor = 3, kLeastMinor = 14;

std::vector<std::string> places() {
  std::vector<std::string> out;
  if (const char* folder = std::getenv("FORCEDIM_SDK"); folder != nullptr && *folder != 0) {
    utsname machine{};
    (void)::uname(&machine);
    out.push_back(std::string(folder) + "/" + kLibrary);
    out.push_back(std::string(folder) + "/lib/release/lin-" + machine.machine + "-gcc/" + kLibrary);
  }
  out.emplace_back(kLibrary);
  return out;
}

Expected<std::shared_ptr<void>> openLibrary() {
  std::string why;
  for (const std::string& place : places()) {
    // RTLD_LOCAL keeps the SDK's symbols from other libraries.
    if (void* handle = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL); handle != nullptr) {
      return std::shared_ptr<void>(handle, [](void* library) { ::dlclose(library); });
    }
    const char* error = ::dlerror();
    why += (why.empty() ? "" : "; ") + std::string(error != nullptr ? error : place);
  }
  return fileFault(kLibrary, "Force Dimension's SDK is not there: " + why,
                   "install SDK 3.14 or later, and name its folder in FORCEDIM_SDK");
}

class Symbols {
 public:
  explicit Symbols(void* library) : library_(library) {}
  template <class Function>
  void find(const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(::dlsym(library_, name));
    if (function == nullptr) missing_ += (missing_.empty() ? "" : ", ") + std::string(name);
  }
  [[nodiscard]] const std::string& missing() const { return missing_; }

 private:
  void* library_;
  std::string missing_;
};

Diagnostics checkVersion(Sdk& sdk) {
  int major = 0, minor = 0, release = 0, revision = 0;
  sdk.dhdGetSDKVersion(&major, &minor, &release, &revision);
  sdk.version = std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release);
  if (major == kMajor && minor >= kLeastMinor) return {};
  return {fileFault(kLibrary, "is SDK " + sdk.version, "install SDK 3.14 or later of version 3")};
}

}  // namespace

const char* forceOffText(int cause) noexcept {
  switch (cause) {
    case kNotOff:
      return "force has not been on yet";
    case kButton:
      return "its force button was pressed";
    case kVelocity:
      return "it moved faster than its own limit";
    case kWatchdog:
      return "its watchdog let go: no force came in time";
    case kSoftware:
      return "a program switched force off";
    case kUsb:
      return "its USB cable was pulled";
    case kDeadman:
      return "its dead man's switch was let go";
    default:
      return "for a reason that is not known";
  }
}

Expected<Sdk> loadSdk() {
  Expected<std::shared_ptr<void>> library = openLibrary();
  if (!library) return library.errors();
  Sdk sdk{};
  sdk.library = std::move(*library);
  Symbols symbols(sdk.library.get());
  symbols.find("dhdGetSDKVersion", sdk.dhdGetSDKVersion);
  symbols.find("dhdErrorGetLastStr", sdk.dhdErrorGetLastStr);
  symbols.find("dhdGetDeviceCount", sdk.dhdGetDeviceCount);
  symbols.find("dhdGetSerialNumber", sdk.dhdGetSerialNumber);
  symbols.find("dhdGetSystemName", sdk.dhdGetSystemName);
  symbols.find("dhdHasGripper", sdk.dhdHasGripper);
  symbols.find("dhdIsLeftHanded", sdk.dhdIsLeftHanded);
  symbols.find("dhdGetStatus", sdk.dhdGetStatus);
  symbols.find("dhdEnableForce", sdk.dhdEnableForce);
  symbols.find("dhdGetPosition", sdk.dhdGetPosition);
  symbols.find("dhdGetGripperAngleRad", sdk.dhdGetGripperAngleRad);
  symbols.find("dhdSetForceAndTorqueAndGripperForce", sdk.dhdSetForceAndTorqueAndGripperForce);
  symbols.find("drdOpenID", sdk.drdOpenID);
  symbols.find("drdClose", sdk.drdClose);
  symbols.find("drdIsInitialized", sdk.drdIsInitialized);
  symbols.find("drdAutoInit", sdk.drdAutoInit);
  symbols.find("drdStop", sdk.drdStop);
  if (!symbols.missing().empty()) {
    return fileFault(kLibrary, "has no " + symbols.missing(),
                     "install SDK 3.14 or later of version 3");
  }
  if (Diagnostics old = checkVersion(sdk); !old.empty()) return old;
  return sdk;
}

}  // namespace wholehand::force_dimension
