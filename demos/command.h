#pragma once
#include <CLI/CLI.hpp>

#include "demo.h"

namespace supple::demos {

/// Exit statuses of the program.
inline constexpr int kAllWell = 0, kRunFailed = 1, kBadInput = 2;

// Each declares one command with its options. Its callback sets `status`; bad input leaves as supple::Error.
void add_list_command(CLI::App& app, int& status);
void add_run_command(CLI::App& app, int& status);
void add_record_command(CLI::App& app, int& status);
void add_bench_command(CLI::App& app, int& status);
void add_eval_command(CLI::App& app, int& status);
void add_inspect_command(CLI::App& app, int& status);
void add_mesh_command(CLI::App& app, int& status);
void add_verify_command(CLI::App& app, int& status);
void add_view_command(CLI::App& app, int& status);

/// --isa: forces an instruction set.
void add_isa_option(CLI::App& command, ShowOptions& options);

/// --size "1280x720". @error Error(invalid_argument) for anything else
void read_size(const std::string& text, int& width, int& height);

}  // namespace supple::demos
