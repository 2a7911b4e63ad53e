// Gives every file of a folder to every reader, without libFuzzer: the corpus in the ordinary build and under its sanitizers.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "one_input.h"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: fuzz_replay FOLDER\n");
        return 2;
    }
    std::size_t files = 0, accepted = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[1])) {
        if (!entry.is_regular_file()) continue;
        std::ifstream in(entry.path(), std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
        std::printf("%s\n", entry.path().filename().c_str());
        std::fflush(stdout);  // the last name is that of a crash
        accepted += supple::fuzz::read_as_everything(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) > 0;
        ++files;
    }
    std::printf("%zu files, %zu accepted by some reader\n", files, accepted);
    return files > 20 && accepted > 20 ? 0 : 1;
}
