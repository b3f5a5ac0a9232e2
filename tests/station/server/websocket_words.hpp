#pragma once

#include "station/server/server_test.hpp"

/// What the tests with real WebSockets say and hear.
namespace wholehand::test {

namespace fb = wholehand::protocol;
using replies::answer;
using replies::message;
using replies::next;
using namespace words;  // NOLINT(google-build-using-namespace): the client's vocabulary

}  // namespace wholehand::test
