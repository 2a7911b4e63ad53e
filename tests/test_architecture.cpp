// The plan of the house, enforced by reading the sources: who may include whom, and what may be used where.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

/// What each room may include besides itself and the standard library. An arrow that is not here is a mistake.
const std::map<std::string, std::set<std::string>>& rooms() {
    static const std::map<std::string, std::set<std::string>> table = {
        {"base", {}},
        {"math", {"base"}},
        {"mesh", {"math", "base"}},
        {"material", {"math", "base"}},
        {"solve", {"math", "base"}},
        {"fem", {"material", "mesh", "math", "base"}},
        {"contact", {"mesh", "math", "base"}},
        {"world", {"contact", "solve", "fem", "material", "mesh", "math", "base"}},
        {"io", {"world", "contact", "mesh", "material", "math", "base"}},
        {"haptics", {"world", "contact", "math", "base"}},
        {"render", {"world", "mesh", "math", "base"}},
        {"bindings", {"render", "haptics", "io", "world", "contact", "fem", "solve", "material", "mesh", "math", "base"}},
    };
    return table;
}

/// The text with comments blanked and the contents of string literals removed (but for those of directives); lines stay.
std::string code_of(const std::string& text) {
    enum class In { code, line_comment, block_comment, string, character } in = In::code;
    std::string out;
    bool directive = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i], next = i + 1 < text.size() ? text[i + 1] : '\0';
        if (c == '\n') {
            if (in == In::line_comment || in == In::string || in == In::character) in = In::code;
            directive = false;
            out += c;
            continue;
        }
        switch (in) {
            case In::code:
                if (c == '#') directive = true;
                if (c == '/' && next == '/') {
                    in = In::line_comment;
                } else if (c == '/' && next == '*') {
                    in = In::block_comment;
                    ++i;
                } else {
                    if (c == '"' && !directive) in = In::string;
                    if (c == '\'' && (i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1])))) in = In::character;
                    out += c;
                }
                break;
            case In::string:
            case In::character:
                if (c == '\\') ++i;
                if (c == (in == In::string ? '"' : '\'')) {
                    in = In::code;
                    out += c;
                }
                break;
            case In::block_comment:
                if (c == '*' && next == '/') {
                    in = In::code;
                    ++i;
                }
                break;
            case In::line_comment: break;
        }
    }
    return out;
}

/// Top folder ("engine", "demos", ...) and room of a path relative to the source tree.
std::pair<std::string, std::string> place_of(const std::string& path) {
    const auto slash = path.find('/');
    if (slash == std::string::npos) return {"", ""};
    const auto second = path.find('/', slash + 1);
    return {path.substr(0, slash), second == std::string::npos ? "" : path.substr(slash + 1, second - slash - 1)};
}

bool starts_with(const std::string& text, const std::string& prefix) { return text.rfind(prefix, 0) == 0; }

/// Included names with their line numbers.
std::vector<std::pair<int, std::string>> includes_of(const std::string& code) {
    static const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
    std::vector<std::pair<int, std::string>> found;
    std::istringstream lines(code);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::smatch match;
        if (std::regex_search(line, match, include)) found.emplace_back(number, match[1]);
    }
    return found;
}

/// A thing that only some places may use.
struct Reserved {
    std::string what;
    std::regex include;  ///< of an included name
    std::regex code;     ///< of a line of code
    bool (*allowed)(const std::string& path);
};

const std::vector<Reserved>& reserved() {
    static const std::regex never("^\\b$");
    static const std::vector<Reserved> list = {
        {"OpenMP outside base/parallel.*", std::regex(R"(^omp\.h$)"), std::regex(R"(^\s*#\s*pragma\s+omp\b|\b_Pragma\b|\bomp_\w+\s*\()"),
         [](const std::string& p) { return starts_with(p, "engine/base/parallel."); }},
        {"SIMD intrinsics outside math/", std::regex(R"(^(\w*intrin|arm_neon|arm_sve)\.h$)"),
         std::regex(R"(\b_mm\d*_\w+|\b__m(64|128|256|512)[di]?\b|\bv(ld1|st1|fma)q?_\w+)"),
         [](const std::string& p) { return starts_with(p, "engine/math/"); }},
        {"GL, EGL, GLFW or ImGui outside render/ and demos/", std::regex(R"(^(epoxy|GL|GLES\d?|EGL|GLFW|KHR)/|^imgui)"), never,
         [](const std::string& p) { return starts_with(p, "engine/render/") || starts_with(p, "demos/"); }},
        {"a file library outside io/",
         std::regex(R"(^(nlohmann|assimp|rapidjson|rapidxml|hdf5|vtk)/|^(json|zlib|bzlib|tinyxml2?|pugixml|expat|yaml|png|jpeglib|hdf5)\.h(pp)?$)"),
         never, [](const std::string& p) { return starts_with(p, "engine/io/"); }},
        {"stb outside io/ and render/", std::regex(R"(^(stb/)?stb_)"), never,
         [](const std::string& p) { return starts_with(p, "engine/io/") || starts_with(p, "engine/render/"); }},
    };
    return list;
}

constexpr int kMostLines = 600;

/// Everything that is wrong with one source file, one sentence each.
Strings violations(const std::string& path, const std::string& text) {
    Strings found;
    const auto add = [&](int line, const std::string& what) { found.push_back(path + ":" + std::to_string(line) + ": " + what); };
    const std::string code = code_of(text);
    const auto [top, room] = place_of(path);

    if (top == "engine" && !room.empty() && !rooms().count(room)) add(1, "\"" + room + "\" is no room of the plan");
    for (const auto& [line, name] : includes_of(code)) {
        if (name.find("../") != std::string::npos) add(line, "includes " + name + " by a relative path; write supple/<room>/<file>");
        if (top != "engine" || room.empty() || !rooms().count(room)) continue;
        if (starts_with(name, "supple/")) {
            const std::string other = place_of(name).second;
            if (other.empty() && room != "bindings") add(line, room + "/ includes " + name + ", which is everything");
            if (!other.empty() && other != room && !rooms().at(room).count(other)) add(line, room + "/ may not include " + other + "/");
        } else if (rooms().count(place_of(name).first)) {
            add(line, "includes " + name + "; write supple/" + name);
        }
    }
    for (const Reserved& thing : reserved()) {
        if (thing.allowed(path)) continue;
        for (const auto& [line, name] : includes_of(code))
            if (std::regex_search(name, thing.include)) add(line, thing.what + ": includes " + name);
        std::istringstream lines(code);
        std::string line;
        for (int number = 1; std::getline(lines, line); ++number)
            if (std::regex_search(line, thing.code)) add(number, thing.what + ": " + line);
    }
    const auto lines = std::count(text.begin(), text.end(), '\n');
    if (path.ends_with(".cpp") && lines > kMostLines)
        add(static_cast<int>(lines), std::to_string(lines) + " lines; the ceiling of a .cpp is " + std::to_string(kMostLines));
    return found;
}

bool is_source(const fs::path& file) {
    const std::string e = file.extension().string();
    return e == ".cpp" || e == ".h" || e == ".inl" || e == ".c";
}

std::vector<std::pair<std::string, std::string>> sources(const Strings& folders) {
    std::vector<std::pair<std::string, std::string>> found;
    const fs::path root = SUPPLE_SOURCE_DIR;
    for (const std::string& folder : folders) {
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            if (!entry.is_regular_file() || !is_source(entry.path())) continue;
            std::ifstream in(entry.path());
            found.emplace_back(fs::relative(entry.path(), root).generic_string(), std::string(std::istreambuf_iterator<char>(in), {}));
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

int count(const std::string& path, const std::string& text) { return static_cast<int>(violations(path, text).size()); }

TEST(Architecture, SourcesKeepThePlan) {
    const auto files = sources({"engine", "demos"});
    ASSERT_GT(files.size(), 20u);
    for (const auto& [path, text] : files)
        for (const std::string& sentence : violations(path, text)) ADD_FAILURE() << sentence;
}

TEST(Architecture, TestsStayReadable) {
    for (const auto& [path, text] : sources({"tests"}))
        EXPECT_LE(std::count(text.begin(), text.end(), '\n'), kMostLines) << path;
}

/// Every header starts with #pragma once (the C header has a guard), so that any order of includes works.
TEST(Architecture, HeadersAreGuarded) {
    for (const auto& [path, text] : sources({"engine", "demos"})) {
        if (!path.ends_with(".h")) continue;
        const std::string code = code_of(text);
        EXPECT_TRUE(code.find("#pragma once") != std::string::npos || code.find("#ifndef SUPPLE_C_H") != std::string::npos) << path;
    }
}

/// The includes between rooms, as found, hold no cycle between files either: a header that reaches itself cannot be read.
TEST(Architecture, HeadersFormNoCycle) {
    std::map<std::string, Strings> graph;
    for (const auto& [path, text] : sources({"engine"}))
        for (const auto& [line, name] : includes_of(code_of(text)))
            if (starts_with(name, "supple/")) graph[path].push_back("engine/" + name.substr(7));
    std::map<std::string, int> state;  // 1 = on the way, 2 = done
    const std::function<void(const std::string&)> visit = [&](const std::string& file) {
        if (state[file] == 2) return;
        ASSERT_NE(state[file], 1) << "the headers around " << file << " include each other in a circle";
        state[file] = 1;
        for (const std::string& next : graph[file]) visit(next);
        state[file] = 2;
    };
    for (const auto& entry : std::map<std::string, Strings>(graph)) visit(entry.first);
}

// -- the checker itself: it must be able to fail ------------------------------------------------------

TEST(ArchitectureChecker, SeesUpwardIncludes) {
    EXPECT_EQ(count("engine/base/x.cpp", "#include \"supple/math/types.h\"\n"), 1);
    EXPECT_EQ(count("engine/solve/x.h", "#include <supple/fem/tet4.h>\n"), 1);
    EXPECT_EQ(count("engine/solve/x.h", "#  include \"supple/mesh/volume_mesh.h\"\n"), 1);
    EXPECT_EQ(count("engine/world/x.cpp", "#include \"supple/io/scene.h\"\n"), 1);
    EXPECT_EQ(count("engine/world/x.cpp", "#include \"supple/render/frame_view.h\"\n"), 1);
    EXPECT_EQ(count("engine/material/x.cpp", "#include \"supple/mesh/surface.h\"\n"), 1);
    EXPECT_EQ(count("engine/render/x.cpp", "#include \"supple/solve/pcg.h\"\n"), 1);
    EXPECT_EQ(count("engine/io/x.cpp", "#include \"supple/fem/tet4.h\"\n"), 1);
    EXPECT_EQ(count("engine/fem/x.cpp", "#include \"supple/supple.h\"\n"), 1);
}

TEST(ArchitectureChecker, AcceptsDownwardIncludes) {
    EXPECT_EQ(count("engine/world/step.cpp", "#include <vector>\n#include \"supple/fem/a.h\"\n#include \"supple/world/b.h\"\n"), 0);
    EXPECT_EQ(count("engine/bindings/c/supple.cpp", "#include \"supple/supple.h\"\n#include \"supple/io/scene.h\"\n"), 0);
    EXPECT_EQ(count("engine/base/x.cpp", "// #include \"supple/world/world.h\"\n/* #include \"supple/fem/a.h\" */\n"), 0);
    EXPECT_EQ(count("demos/x.cpp", "#include \"supple/render/renderer.h\"\n#include <GLFW/glfw3.h>\n"), 0);
}

TEST(ArchitectureChecker, SeesRoomsAndPathsOutsideThePlan) {
    EXPECT_EQ(count("engine/utils/x.cpp", "int x;\n"), 1);
    EXPECT_EQ(count("engine/fem/x.cpp", "#include \"../mesh/surface.h\"\n"), 1);
    EXPECT_EQ(count("engine/fem/x.cpp", "#include \"mesh/surface.h\"\n"), 1);
}

TEST(ArchitectureChecker, SeesOpenMp) {
    EXPECT_EQ(count("engine/solve/x.cpp", "void f() {\n  #pragma omp parallel for\n}\n"), 1);
    EXPECT_EQ(count("engine/solve/x.cpp", "#include <omp.h>\n"), 1);
    EXPECT_EQ(count("demos/x.cpp", "int n = omp_get_max_threads();\n"), 1);
    EXPECT_EQ(count("engine/base/parallel.cpp", "#include <omp.h>\n#pragma omp parallel\n"), 0);
    EXPECT_EQ(count("engine/base/x.cpp", "// #pragma omp parallel\nconst char* s = \"omp_get_max_threads()\";\n"), 0);
}

TEST(ArchitectureChecker, SeesIntrinsics) {
    EXPECT_EQ(count("engine/fem/x.cpp", "#include <immintrin.h>\n"), 1);
    EXPECT_EQ(count("engine/base/x.cpp", "void pause() { _mm_pause(); }\n"), 1);
    EXPECT_EQ(count("engine/fem/x.h", "__m256d a;\n"), 1);
    EXPECT_EQ(count("engine/math/transpose.h", "#include <immintrin.h>\n__m512 a = _mm512_setzero_ps();\n"), 0);
}

TEST(ArchitectureChecker, SeesGraphicsAndFileLibraries) {
    EXPECT_EQ(count("engine/world/x.cpp", "#include <epoxy/gl.h>\n"), 1);
    EXPECT_EQ(count("engine/io/x.cpp", "#include <GL/gl.h>\n"), 1);
    EXPECT_EQ(count("engine/render/x.cpp", "#include <epoxy/egl.h>\n#include <imgui.h>\n"), 0);
    EXPECT_EQ(count("engine/mesh/x.cpp", "#include <nlohmann/json.hpp>\n"), 1);
    EXPECT_EQ(count("demos/x.cpp", "#include <zlib.h>\n"), 1);
    EXPECT_EQ(count("engine/io/x.cpp", "#include <nlohmann/json.hpp>\n#include <zlib.h>\n"), 0);
    EXPECT_EQ(count("engine/world/x.cpp", "#include <stb/stb_image_write.h>\n"), 1);
    EXPECT_EQ(count("engine/render/image.cpp", "#include <stb/stb_image_write.h>\n"), 0);
}

TEST(ArchitectureChecker, SeesLongFiles) {
    EXPECT_EQ(count("engine/fem/x.cpp", std::string(600, '\n')), 0);
    EXPECT_EQ(count("engine/fem/x.cpp", std::string(601, '\n')), 1);
    EXPECT_EQ(count("engine/fem/x.h", std::string(601, '\n')), 0);
}

TEST(ArchitectureChecker, ReadsTextAsTheCompilerDoes) {
    EXPECT_EQ(code_of("a // b\nc"), "a \nc");
    EXPECT_EQ(code_of("a /* b\nc */ d"), "a \n d");
    EXPECT_EQ(code_of("f(\"a // b\");"), "f(\"\");");
    EXPECT_EQ(code_of("f(\"a\\\"b\", 'x');"), "f(\"\", '');");
    EXPECT_EQ(code_of("int million = 1'000'000; // c"), "int million = 1'000'000; ");
    EXPECT_EQ(code_of("#include \"a.h\" // b"), "#include \"a.h\" ");
}

}  // namespace
