#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace supple::demos {

/// --stress FILE and what it may mean; `run` and `eval` share them.
struct StressOptions {
    std::string file;
    std::string at = "vertex";
    std::string strain = "corotational";
    std::string recovery = "volume-weighted";

    void add(CLI::App& command);
    void check() const;  ///< refuses what this version does not compute. @error Error(unsupported)
    bool at_vertices() const { return at == "vertex"; }
};

}  // namespace supple::demos
