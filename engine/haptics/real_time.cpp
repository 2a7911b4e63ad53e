#include "supple/haptics/real_time.h"

#include <cerrno>
#include <cstring>
#include <ctime>

#include <pthread.h>
#include <sched.h>

namespace supple::haptics {

std::int64_t servo_clock_ns() noexcept {
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

void sleep_until(std::int64_t time_ns) noexcept {
    timespec t;
    t.tv_sec = time_t(time_ns / 1'000'000'000);
    t.tv_nsec = long(time_ns % 1'000'000'000);
    // Absolute: however late a tick was, the next is not later for it.
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
    }
}

std::string ask_for_real_time(int priority) {
    sched_param p{};
    p.sched_priority = priority;
    const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &p);
    return error == 0 ? std::string() : std::strerror(error);
}

}  // namespace supple::haptics
