#pragma once

#include "station/server/server_test.hpp"

/// Messages and answers for the tests with real WebSockets.
namespace wholehand::test {

namespace fb = wholehand::protocol;
using replies::answer;
using replies::message;
using replies::next;
using namespace words;  // NOLINT(google-build-using-namespace): the client's vocabulary

}  // namespace wholehand::test
