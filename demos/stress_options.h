#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "supple/world/stress.h"

namespace supple::demos {

/// --stress FILE and what it may mean; `run` and `eval` share them.
struct StressOptions {
    std::string file;
    std::string at = "vertex";
    std::string strain = "corotational";
    std::string recovery = "volume-weighted";

    void add(CLI::App& command);
    void check() const;  ///< @error Error(file_unreadable) if the file cannot be written
    StressDef def() const;
};

}  // namespace supple::demos
