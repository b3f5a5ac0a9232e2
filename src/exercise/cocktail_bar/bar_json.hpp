#pragma once

#include "exercise/cocktail_bar/bar.hpp"

#include <string>

namespace wholehand {

/// Description of a bar for the page (docs/exercises.md).
[[nodiscard]] std::string barJson(const Bar& bar);

}  // namespace wholehand
