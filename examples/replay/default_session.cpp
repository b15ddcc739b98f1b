#include "default_session.hpp"

// REPLAY_DEFAULT_SESSION is the path of the file.
asm(R"(
.section .rodata
.balign 16
replay_default_session:
.incbin ")" REPLAY_DEFAULT_SESSION R"("
replay_default_session_end:
.byte 0
.previous
)");

extern "C" {
extern const char session_begin[] asm("replay_default_session");
extern const char session_end[] asm("replay_default_session_end");
}

namespace replay {

std::string default_session() { return std::string(session_begin, session_end); }

}  // namespace replay
