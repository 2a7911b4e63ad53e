#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "supple/io/binary_file.h"
#include "supple/io/text_files.h"
#include "supple/io/text_scanner.h"
#include "test_io_helpers.h"

namespace supple::io {
namespace {

using test::expect_error;

TEST(IoText, VectorsComeBackBitForBit) {
    std::vector<Vec3> vectors = {Vec3(0.1, 1.0 / 3, -0.0), Vec3(5e-324, 1.7976931348623157e308, -2.2250738585072014e-308),
                                 Vec3(1e22, 123456789.123456789, 1)};
    std::mt19937_64 random(3);
    for (int i = 0; i < 2000; ++i) {
        Vec3 v;
        for (int axis = 0; axis < 3; ++axis) {
            do {
                const std::uint64_t bits = random();
                std::memcpy(&v[axis], &bits, 8);
            } while (!std::isfinite(v[axis]));
        }
        vectors.push_back(v);
    }
    const test::TemporaryFolder folder;
    write_vectors(folder / "x.txt", vectors);
    const std::vector<Vec3> back = read_vectors(folder / "x.txt", vectors.size());
    ASSERT_EQ(back.size(), vectors.size());
    for (std::size_t i = 0; i < back.size(); ++i)
        EXPECT_EQ(std::memcmp(back[i].data(), vectors[i].data(), 24), 0) << vectors[i].transpose();
}

TEST(IoText, VectorsLookLikePrintf17g) {
    const test::TemporaryFolder folder;
    const std::vector<Vec3> vectors = {Vec3(0.1, -1e-7, 100000), Vec3(1e17, 3, -0.0)};
    write_vectors(folder / "x.txt", vectors);
    std::string expected;
    for (const Vec3& v : vectors) {
        char line[128];
        std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", v[0], v[1], v[2]);
        expected += line;
    }
    EXPECT_EQ(read_text_file(folder / "x.txt"), expected);
}

TEST(IoText, BrokenVectorFilesNameTheLine) {
    const auto refuse = [](const std::string& text, const std::string& where, const std::vector<std::string>& words) {
        SCOPED_TRACE(text);
        expect_error(ErrorCode::parse, where, words, [&] { parse_vectors(text, "x.txt", 2); });
    };
    EXPECT_EQ(parse_vectors("# comment\r\n1 2 3\r\n\r\n 4\t5 6", "x.txt", 2).at(1), Vec3(4, 5, 6));
    EXPECT_EQ(parse_vectors("", "x.txt").size(), 0u);
    refuse("1 2 3\n", "x.txt:2", {"after 1 of the 2"});
    refuse("1 2 3\n4 5 6\n7 8 9\n", "x.txt:3", {"more than the 2"});
    refuse("1 2 3\n4 5\n", "x.txt:2", {"z component", "line ends"});
    refuse("1 2 3\n4 5 6 7\n", "x.txt:2", {"unexpected \"7\""});
    refuse("1 2 3\n4,5,6\n", "x.txt:2", {"x component", "4,5,6"});
    refuse("1 2 nan\n", "x.txt:1", {"finite"});
    refuse("1 2 inf\n", "x.txt:1", {"finite"});
    refuse("1 2 3", "x.txt:1", {"after 1"});
    refuse("\x01\xff 2 3", "x.txt:1", {"\"??\""});
    expect_error(ErrorCode::file_unreadable, "/nonexistent/x.txt", {"cannot open"}, [] { read_vectors("/nonexistent/x.txt", 2); });
}

TEST(IoText, StressFilesHoldVonMisesAndTheTensor) {
    const test::TemporaryFolder folder;
    const std::vector<Voigt> stress = {{3, 0, 0, 0, 0, 0}, {0, 0, 0, 2, 0, 0}, {5, 5, 5, 0, 0, 0}, {1.1, 2.2, 3.3, 4.4, 5.5, 6.6}};
    write_stress(folder / "s.txt", stress);
    EXPECT_EQ(read_stress(folder / "s.txt", 4), stress);
    const std::string text = read_text_file(folder / "s.txt");
    EXPECT_EQ(text.substr(0, text.find('\n')), "3 3 0 0 0 0 0");
    TextScanner scanner(text, "s.txt");
    scanner.next_line();
    EXPECT_NEAR(scanner.real("von Mises"), 2 * std::sqrt(3.0), 1e-15);
    scanner.next_line();
    EXPECT_EQ(scanner.real("von Mises"), 0);
    expect_error(ErrorCode::parse, "s.txt:1", {"component", "line ends"}, [] { parse_stress("1 2 3 4 5 6\n", "s.txt"); });
    expect_error(ErrorCode::parse, "s.txt:2", {"more than the 1"}, [] { parse_stress("1 2 3 4 5 6 7\n1 2 3 4 5 6 7\n", "s.txt", 1); });
}

TEST(IoText, NumbersInEveryFashion) {
    const auto real = [](std::string_view word) {
        double value = -7;
        return parse_real(word, value) ? value : std::numeric_limits<double>::quiet_NaN();
    };
    EXPECT_EQ(real("1.0D+03"), 1000);
    EXPECT_EQ(real("1d-3"), 1e-3);
    EXPECT_EQ(real("+2.5"), 2.5);
    EXPECT_EQ(real("6.12323e-018"), 6.12323e-18);
    EXPECT_EQ(real("1e-400"), 0);
    EXPECT_EQ(real("-.5"), -0.5);
    EXPECT_EQ(real("5."), 5);
    for (const char* bad :
         {"", "+", "-", ".", "e5", "1e", "1e400", "nan", "inf", "-inf", "0x10", "1,5", "1 2", "+-1", "1dd3", "1e5e5", "--1"}) {
        EXPECT_TRUE(std::isnan(real(bad))) << bad;
    }
}

}  // namespace
}  // namespace supple::io
