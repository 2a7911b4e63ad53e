// supple verify: the engine against closed forms and published references, on this machine.
#include <algorithm>
#include <cstdio>

#include "command.h"
#include "supple/base/clock.h"
#include "supple/base/error.h"
#include "verify/table.h"

namespace supple::demos {
namespace {

struct VerifyOptions {
    std::vector<int> rows;
    bool markdown = false, quick = false, list = false;
    int threads = 0;
};

bool is_wanted(const verify::Case& c, const VerifyOptions& options) {
    if (options.rows.empty()) return !(options.quick && c.slow);
    return std::find(options.rows.begin(), options.rows.end(), c.row) != options.rows.end();
}

void check_rows(const std::vector<int>& rows) {
    for (const int row : rows) {
        const auto& cases = verify::all_cases();
        if (std::none_of(cases.begin(), cases.end(), [&](const verify::Case& c) { return c.row == row; }))
            throw Error(ErrorCode::invalid_argument, "--row", "no case has row " + std::to_string(row) + "; supple verify --list names them");
    }
}

int verify_all(const VerifyOptions& options) {
    check_rows(options.rows);
    if (options.list) {
        for (const verify::Case& c : verify::all_cases())
            if (is_wanted(c, options)) std::printf("%2d  %s%s\n", c.row, c.name.c_str(), c.slow ? " (slow)" : "");
        return kAllWell;
    }
    verify::Table table;
    for (const verify::Case& c : verify::all_cases()) {
        if (!is_wanted(c, options)) continue;
        table.begin_row(c.row);
        const Stopwatch watch;
        try {
            c.run(table, {options.quick, options.threads});
        } catch (const std::exception& error) {
            table.failed(c.name, error.what());
        }
        std::fprintf(stderr, "row %d, %s: %.1f s\n", c.row, c.name.c_str(), watch.ms() / 1000);
    }
    std::fputs((options.markdown ? table.markdown() : table.text()).c_str(), stdout);
    return table.passes() ? kAllWell : kRunFailed;
}

}  // namespace

void add_verify_command(CLI::App& app, int& status) {
    CLI::App* command = app.add_subcommand("verify", "compare the engine with closed forms and published results; exit status 1 if any differs");
    auto options = std::make_shared<VerifyOptions>();
    command->add_option("--row", options->rows, "only these rows of the table");
    command->add_flag("--markdown", options->markdown, "print the table of the README");
    command->add_flag("--quick", options->quick, "leave out what takes long");
    command->add_flag("--list", options->list, "name the cases and run none");
    command->add_option("--threads", options->threads, "0 = all cores")->check(CLI::Range(0, 256));
    command->callback([options, &status] { status = verify_all(*options); });
}

}  // namespace supple::demos
