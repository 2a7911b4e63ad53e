#pragma once
// Tests of what tests/run.sh installs: a machine without it skips them and says so; in CI (SUPPLE_CI is set), where it has run, a test that cannot run has failed.
#include <gtest/gtest.h>

#include <cstdlib>

#define SUPPLE_SKIP(reason)                                                          \
    do {                                                                             \
        if (std::getenv("SUPPLE_CI") != nullptr) FAIL() << "cannot run: " << reason; \
        GTEST_SKIP() << "skipped: " << reason;                                       \
    } while (false)
