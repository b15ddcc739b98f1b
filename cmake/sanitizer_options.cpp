// Linked into every sanitized program, so that it behaves the same in and outside of ctest.
// *_OPTIONS in the environment still win.

extern "C" {
const char* __asan_default_options();
const char* __asan_default_options() {
  return "detect_leaks=1:check_initialization_order=1:strict_init_order=1:detect_stack_use_after_"
         "return=1";
}

const char* __ubsan_default_options();
const char* __ubsan_default_options() { return "print_stacktrace=1"; }

const char* __tsan_default_options();
const char* __tsan_default_options() { return "halt_on_error=1:second_deadlock_stack=1"; }
}
