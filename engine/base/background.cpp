#include "supple/base/background.h"

namespace supple {

Background::Background(std::function<void()> job)
    : thread_([this, work = std::move(job)] {
          work();
          done_.store(true, std::memory_order_release);
      }) {}

Background::~Background() { wait(); }

void Background::wait() {
    if (thread_.joinable()) thread_.join();
}

}  // namespace supple
