// The session that the program has with it (data/README.md).
#pragma once

#include <string>

namespace replay {

// The compressed trace.
std::string default_session();

}  // namespace replay
