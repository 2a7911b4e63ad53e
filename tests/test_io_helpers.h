#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::test {

/// Real meshes that are not part of the repository: $SUPPLE_SHARED, or ../shared beside it; empty where there are none.
inline std::filesystem::path shared_data(const std::string& what) {
    const char* named = std::getenv("SUPPLE_SHARED");
    const std::filesystem::path folder = named ? std::filesystem::path(named) : std::filesystem::path(SUPPLE_SOURCE_DIR) / ".." / "shared";
    if (std::filesystem::exists(folder / what)) return folder / what;
    std::cout << "skipped: " << (folder / what).string() << " is not there (set SUPPLE_SHARED)" << std::endl;
    return {};
}

/// A Python that has this module. False, loudly, where there is none.
inline bool python_with(const std::string& module, std::string& python) {
    for (const char* candidate : {"/usr/bin/python3", "python3"}) {
        python = candidate;
        if (std::system((python + " -c 'import " + module + "' >/dev/null 2>&1").c_str()) == 0) return true;
    }
    std::cout << "skipped: python3 has no " << module << " (apt-get install python3-" << (module == "vtkmodules" ? "vtk9" : module) << ")" << std::endl;
    return false;
}

/// A folder of its own for a test, removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::random_device random;
        path_ = std::filesystem::temp_directory_path() / ("supple-test-" + std::to_string(random()) + "-" + std::to_string(random()));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

/// Runs `action` and returns the Error it throws; a test failure and an empty Error where it throws none. Other exceptions pass through.
template <class Action>
Error caught(Action&& action) {
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no Error was thrown";
    return Error(ErrorCode::invalid_argument, "", "");
}

/// Expects an Error of this code whose where() is `where` and whose message holds every one of `words`.
template <class Action>
void expect_error(ErrorCode code, const std::string& where, const std::vector<std::string>& words, Action&& action) {
    const Error error = caught(action);
    EXPECT_EQ(to_string(error.code()), to_string(code)) << error.what();
    EXPECT_EQ(error.where(), where) << error.what();
    for (const std::string& word : words)
        EXPECT_NE(error.message().find(word), std::string::npos) << "\"" << word << "\" is missing in: " << error.what();
}

/// What every reader promises about a mesh that it accepts.
inline void expect_consistent(const VolumeMesh& mesh) {
    const auto in_range = [&](std::int32_t v) { return v >= 0 && std::size_t(v) < mesh.vertices.size(); };
    for (const Tet& tet : mesh.tets) {
        for (std::int32_t v : tet) ASSERT_TRUE(in_range(v));
    }
    for (const Hex& hex : mesh.hexes) {
        for (std::int32_t v : hex) ASSERT_TRUE(in_range(v));
    }
    for (const Vec3& x : mesh.vertices) ASSERT_TRUE(x.allFinite());
    ASSERT_EQ(mesh.element_region.size(), mesh.regions.empty() ? 0 : mesh.element_count());
    for (std::int32_t r : mesh.element_region) ASSERT_TRUE(r >= -1 && r < std::int32_t(mesh.regions.size()));
    for (const Region& region : mesh.regions) ASSERT_FALSE(region.name.empty());
    for (const VertexGroup& group : mesh.groups) {
        for (std::size_t i = 0; i < group.vertices.size(); ++i) {
            ASSERT_TRUE(in_range(group.vertices[i]));
            ASSERT_TRUE(i == 0 || group.vertices[i - 1] < group.vertices[i]);
        }
    }
    ASSERT_GT(mesh.element_count(), 0u);
}

/// One random change of a text: a byte, a piece cut out, doubled or moved, or a number made nasty. Depends on nothing but the generator.
inline std::string mutated(std::string text, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : std::size_t(random() % n); };
    static const char* const kNasty[] = {"-1",
                                         "0",
                                         "2147483647",
                                         "2147483648",
                                         "1152921504606846976",
                                         "9223372036854775807",
                                         "-9223372036854775808",
                                         "nan",
                                         "inf",
                                         "1e400",
                                         "1e-400",
                                         "0x10",
                                         "",
                                         "18446744073709551616",
                                         "1.5",
                                         "\"",
                                         "$",
                                         "$EndNodes\n",
                                         "-2147483648",
                                         "99999",
                                         "\n",
                                         "1D+3",
                                         "null",
                                         "{",
                                         "[[",
                                         "\xff\xfe",
                                         "1e308",
                                         "true"};
    const std::size_t at = below(text.size());
    switch (random() % 6) {
        case 0:
            if (!text.empty()) text[at] = char(random());
            break;
        case 1:
            text.insert(at, 1, char(random() % 96 + 32));
            break;
        case 2:
            text.erase(at, 1 + below(8));
            break;
        case 3:
            text.insert(below(text.size()), text.substr(at, 1 + below(40)));
            break;
        case 4:
            text.insert(at, kNasty[below(std::size(kNasty))]);
            break;
        default: {
            const std::size_t begin = text.find_first_of("0123456789", at);
            if (begin == std::string::npos) break;
            const std::size_t end = text.find_first_not_of("0123456789.", begin);
            text.replace(begin, (end == std::string::npos ? text.size() : end) - begin, kNasty[below(std::size(kNasty))]);
        }
    }
    return text;
}

/// Parses `trials` random variants of each text: only Errors may escape, accepted meshes must be consistent. Returns how many were
/// accepted.
template <class Parse>
std::size_t expect_only_errors(const std::vector<std::string>& texts, int trials, unsigned seed, Parse&& parse) {
    std::mt19937 random(seed);
    std::size_t accepted = 0;
    for (const std::string& whole : texts) {
        for (int trial = 0; trial < trials; ++trial) {
            std::string text = whole;
            for (unsigned change = 0, changes = 1 + random() % 4; change < changes; ++change) text = mutated(text, random);
            try {
                expect_consistent(parse(text));
                ++accepted;
            } catch (const Error& error) {
                EXPECT_FALSE(error.where().empty() || error.message().empty()) << text;
            } catch (const std::exception& other) {
                ADD_FAILURE() << other.what() << "\n" << text;
            }
            if (testing::Test::HasFailure()) {
                ADD_FAILURE() << "in this text:\n" << text;
                return accepted;
            }
        }
    }
    return accepted;
}

}  // namespace supple::test
