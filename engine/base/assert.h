#pragma once

/// SUPPLE_ASSERT(condition): a bug of our own, never user data. Active where SUPPLE_ASSERTS is defined (debug, relassert, sanitizers).
#ifdef SUPPLE_ASSERTS
namespace supple {
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line) noexcept;
}
#define SUPPLE_ASSERT(condition) ((condition) ? (void)0 : ::supple::assertion_failed(#condition, __FILE__, __LINE__))
#else
#define SUPPLE_ASSERT(condition) ((void)0)
#endif
