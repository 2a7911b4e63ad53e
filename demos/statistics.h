#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "supple/io/report.h"
#include "supple/world/world.h"

namespace supple::demos {

/// A flag that was raised: when first, how often, and on which bodies where that is known.
struct FlagRecord {
    StepFlag flag;
    std::uint64_t first_step = 0;
    std::size_t steps = 0;
    std::vector<std::string> bodies;
};

/// What the steps of a run said, for tables and sentences; the report file is io::RunReport's.
class StepStatistics {
public:
    void add(const World& world, const StepReport& report);
    /// Takes in the flags alone.
    void add_untimed(const World& world, const StepReport& report);

    std::size_t steps() const { return step_ms_.size(); }
    const std::vector<double>& step_ms() const { return step_ms_; }
    const std::vector<double>& stage_ms(std::size_t stage) const { return stage_ms_[stage]; }
    const std::vector<double>& iterations() const { return iterations_; }
    const std::vector<double>& residuals() const { return residuals_; }
    const std::vector<double>& solve_bytes() const { return solve_bytes_; }
    const std::vector<FlagRecord>& flags() const { return flags_; }

    /// Rows "stage  median  p99  p99.9" in milliseconds, with the whole step last.
    std::string table() const;
    /// One line per flag that was raised, with what cures it; empty when all is well.
    std::string flag_sentences() const;
    void write_report(const std::filesystem::path& file, const World& world) const;

private:
    std::vector<double> step_ms_, iterations_, residuals_, solve_bytes_;
    std::array<std::vector<double>, kStageCount> stage_ms_;
    std::vector<FlagRecord> flags_;
    std::size_t seen_ = 0;  ///< steps whose flags were looked at
    io::RunReport report_;
};

double mean(const std::vector<double>& values);  ///< 0 of none

std::string hash_text(std::uint64_t hash);  ///< 16 hexadecimal digits

/// What the world is and where it stands: sizes, threads, energy, reaction, hash.
io::RunSummary summary_of(const World& world);

}  // namespace supple::demos
