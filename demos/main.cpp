// The program `supple`: one command per file command_*.cpp.
#include <cstdio>
#include <exception>

#include "command.h"
#include "supple/base/error.h"

namespace {

/// A machine that cannot draw or encode is not the user's mistake.
int status_of(const supple::Error& error) {
    using enum supple::ErrorCode;
    return error.code() == no_display || error.code() == external_tool ? supple::demos::kRunFailed : supple::demos::kBadInput;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace supple::demos;
    CLI::App app{"Supple: real-time soft bodies."};
    app.name("supple");
    app.set_version_flag("--version", std::string(SUPPLE_VERSION));
    app.require_subcommand(1);
    int status = kAllWell;
    add_list_command(app, status);
    add_run_command(app, status);
    add_record_command(app, status);
    add_bench_command(app, status);
    add_eval_command(app, status);
    add_inspect_command(app, status);
    add_mesh_command(app, status);
    add_verify_command(app, status);
    add_view_command(app, status);
    const auto is_command = [&](const std::string& word) {
        for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
            if (command->get_name() == word) return true;
        return false;
    };
    if (argc > 1 && argv[1][0] != '-' && !is_command(argv[1])) {
        std::fprintf(stderr, "supple: \"%s\" is no command; supple --help lists them\n", argv[1]);
        return kBadInput;
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kAllWell : kBadInput;  // --help and --version are "errors" of status 0
    } catch (const supple::Error& error) {
        std::fprintf(stderr, "supple: %s\n", error.what());
        return status_of(error);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "supple: %s\n", error.what());
        return kRunFailed;
    }
    return status;
}
