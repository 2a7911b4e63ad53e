// Defaults of the sanitizers for every test executable, so that a test run by hand behaves as under ctest.
extern "C" {
const char* __asan_default_options();
const char* __ubsan_default_options();
const char* __tsan_default_options();

const char* __asan_default_options() {
#ifdef SUPPLE_NO_LEAK_CHECK
    return "strict_string_checks=1:detect_stack_use_after_return=1:detect_leaks=0";
#else
    return "strict_string_checks=1:detect_stack_use_after_return=1";
#endif
}
const char* __ubsan_default_options() { return "print_stacktrace=1"; }
const char* __tsan_default_options() { return "halt_on_error=1"; }
}
