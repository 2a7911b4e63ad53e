// What leaves the kernel units: wide code must not be reachable under a name that a narrow unit also defines, or the linker may hand it to
// a processor that cannot run it.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <regex>
#include <string>
#include <vector>

namespace supple {
namespace {

namespace fs = std::filesystem;

/// The build tree: test executables lie one folder below it.
fs::path objects_folder() { return fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "CMakeFiles" / "supple_core.dir"; }

std::vector<std::string> lines_of(const std::string& command) {
    std::vector<std::string> lines;
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    char text[4096];
    while (pipe && std::fgets(text, sizeof text, pipe.get()) != nullptr) lines.emplace_back(text);
    return lines;
}

std::vector<fs::path> kernel_objects() {
    std::vector<fs::path> objects;
    if (!fs::exists(objects_folder())) return objects;
    for (const auto& entry : fs::recursive_directory_iterator(objects_folder())) {
        static const std::regex kernel(".*_kernels_(scalar|baseline|avx2|avx512)\\.cpp\\.o");
        if (std::regex_match(entry.path().filename().string(), kernel)) objects.push_back(entry.path());
    }
    return objects;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

TEST(FemSymbols, NoWeakSymbolLeavesAKernelUnit) {
    if (kSanitized) {
        std::printf("skipped: sanitizers add symbols of their own\n");
        return;
    }
    if (lines_of("nm --version 2>/dev/null").empty()) {
        std::printf("skipped: no nm (package binutils); the symbols of the kernel units were not looked at\n");
        return;
    }
    const std::vector<fs::path> objects = kernel_objects();
    if (objects.empty()) {
        std::printf("skipped: no object files in %s; the symbols of the kernel units were not looked at\n", objects_folder().c_str());
        return;
    }
    EXPECT_GE(objects.size(), 4u) << "tet4 and bsr3, scalar and baseline at least";
    for (const fs::path& object : objects) {
        const auto symbols = lines_of("nm -C --defined-only '" + object.string() + "'");
        EXPECT_FALSE(symbols.empty()) << object;
        std::size_t kernels = 0;
        for (const std::string& line : symbols) {
            // "0123456789abcdef W name": W V u are merged across units by the linker, capitals leave the unit.
            const std::size_t at = line.find(' ') + 1;
            const char type = line[at];
            const std::string symbol = line.substr(at + 2);
            if (symbol.rfind("DW.ref.", 0) == 0) continue;  // the address of the exception personality: data, the same in every unit
            if (type == 'W' || type == 'V' || type == 'u') {
                EXPECT_NE(symbol.find("xsimd::"), std::string::npos) << object.filename() << " lets go of the weak symbol " << symbol;
            }
            if (type == 'T') ADD_FAILURE() << object.filename() << " exports code under the name " << symbol;
            kernels += (type == 'R' || type == 'D') && symbol.find("_kernels_") != std::string::npos;
        }
        EXPECT_GE(kernels, 1u) << object.filename() << " must export its table of kernels";
    }
}

}  // namespace
}  // namespace supple
