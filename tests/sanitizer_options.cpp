// Defaults of the sanitizers for every test executable and the program, so that one run by hand behaves as under ctest.
extern "C" {
const char* __asan_default_options();
const char* __ubsan_default_options();
const char* __tsan_default_options();
const char* __tsan_default_suppressions();

const char* __asan_default_options() {
#ifdef SUPPLE_NO_LEAK_CHECK
    return "strict_string_checks=1:detect_stack_use_after_return=1:detect_leaks=0";
#else
    return "strict_string_checks=1:detect_stack_use_after_return=1";
#endif
}
const char* __ubsan_default_options() { return "print_stacktrace=1"; }
const char* __tsan_default_options() { return "halt_on_error=1"; }
// Mesa's software rasteriser is not built for ThreadSanitizer: it destroys fences that its own threads have just released.
const char* __tsan_default_suppressions() { return "race:swrast_dri.so\nrace:libgallium\n"; }
}
