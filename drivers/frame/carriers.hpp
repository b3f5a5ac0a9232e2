#pragma once

// Private to the carriers: one function per carrier.
#include "drivers/frame/carrier.hpp"

namespace wholehand {

[[nodiscard]] Diagnostic noCarrier(const std::string& locator, const std::string& problem,
                                   const std::string& remedy);
[[nodiscard]] Expected<std::unique_ptr<Carrier>> openUdp(const std::string& locator,
                                                         const std::string& host,
                                                         const std::string& port);
[[nodiscard]] Expected<std::unique_ptr<Carrier>> openSerial(const std::string& locator,
                                                            const std::string& path,
                                                            const std::string& baud);
[[nodiscard]] Expected<std::unique_ptr<Carrier>> openShared(const std::string& locator,
                                                            const std::string& name);

}  // namespace wholehand
