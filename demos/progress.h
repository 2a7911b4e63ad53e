#pragma once
#include <chrono>
#include <string>

namespace supple::demos {

/// A bar on standard error while something long goes on; silent where standard error is no terminal, and when quiet.
class Progress {
public:
    Progress(std::string what, std::size_t total, bool quiet);
    ~Progress();  ///< wipes the bar
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::size_t done);

private:
    using Clock = std::chrono::steady_clock;
    std::string what_;
    std::size_t total_;
    bool active_;
    Clock::time_point start_ = Clock::now(), last_{};
};

}  // namespace supple::demos
