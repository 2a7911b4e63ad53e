#include "supple/base/assert.h"

#ifdef SUPPLE_ASSERTS
#include <cstdio>
#include <cstdlib>

namespace supple {

void assertion_failed(const char* condition, const char* file, int line) noexcept {
    std::fprintf(stderr, "supple: assertion failed: %s (%s:%d)\n", condition, file, line);
    std::abort();
}

}  // namespace supple
#endif
