#include <algorithm>
#include <cstdio>

#include "command.h"
#include "demo.h"

namespace supple::demos {

void add_list_command(CLI::App& app, int& /*status*/) {
    CLI::App* command = app.add_subcommand("list", "list the demos");
    command->callback([] {
        std::size_t width = 0;
        for (const Demo& demo : all_demos()) width = std::max(width, demo.name.size());
        for (const Demo& demo : all_demos()) std::printf("%-*s  %s\n", static_cast<int>(width), demo.name.c_str(), demo.summary.c_str());
    });
}

}  // namespace supple::demos
