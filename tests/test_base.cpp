#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "supple/base/aligned.h"
#include "supple/base/byte_stream.h"
#include "supple/base/error.h"
#include "supple/base/function_ref.h"
#include "supple/base/hash.h"
#include "supple/base/id.h"

namespace supple {
namespace {

TEST(BaseError, SaysWhereThenWhat) {
    const Error e(ErrorCode::parse, "bar.msh:12", "too few numbers");
    EXPECT_STREQ(e.what(), "bar.msh:12: too few numbers");
    EXPECT_EQ(e.where(), "bar.msh:12");
    EXPECT_EQ(e.message(), "too few numbers");
    EXPECT_EQ(e.code(), ErrorCode::parse);
    EXPECT_STREQ(Error(ErrorCode::parse, "", "alone").what(), "alone");
}

TEST(BaseError, EveryCodeHasItsOwnName) {
    std::vector<std::string> names;
    for (int i = 1; i <= 9; ++i) names.emplace_back(to_string(ErrorCode(i)));
    for (std::size_t i = 0; i < names.size(); ++i) {
        EXPECT_NE(names[i], "unknown error");
        for (std::size_t j = 0; j < i; ++j) EXPECT_NE(names[i], names[j]);
    }
}

TEST(BaseError, RangesAreClosedAndRefuseNotANumber) {
    EXPECT_NO_THROW(require_in_range(0, 0, 1, "f"));
    EXPECT_NO_THROW(require_in_range(1, 0, 1, "f"));
    for (const double bad : {-1e-300, 1.0000000001, std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        try {
            require_in_range(bad, 0, 1, "Def.field", "try 0.5");
            ADD_FAILURE() << bad;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
            EXPECT_EQ(e.where(), "Def.field");
            EXPECT_NE(e.message().find("[0, 1]"), std::string::npos) << e.message();
            EXPECT_NE(e.message().find("try 0.5"), std::string::npos) << e.message();
        }
    }
}

TEST(BaseError, NumbersReadBackToTheSameBits) {
    for (const double x : {0.1, 1.0 / 3, -2.5e-300, 1e22, 123456789.125, std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min()}) {
        EXPECT_EQ(std::strtod(to_text(x).c_str(), nullptr), x);
    }
    EXPECT_EQ(to_text(0.1), "0.1");
}

std::uint64_t hash_of(const std::vector<std::uint8_t>& bytes) {
    Hasher hasher;
    hasher.add_bytes(std::as_bytes(std::span(bytes)));
    return hasher.value();
}

TEST(BaseHash, EveryBitAndTheOrderAndTheLengthCount) {
    std::vector<std::uint8_t> bytes(37);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(i * 7);
    const std::uint64_t plain = hash_of(bytes);
    EXPECT_EQ(hash_of(bytes), plain);
    for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
        auto other = bytes;
        other[bit / 8] ^= std::uint8_t(1u << (bit % 8));
        EXPECT_NE(hash_of(other), plain) << "bit " << bit;
    }
    auto swapped = bytes;
    std::swap(swapped[3], swapped[20]);
    EXPECT_NE(hash_of(swapped), plain);
    auto longer = bytes;
    longer.push_back(0);
    EXPECT_NE(hash_of(longer), plain);
    EXPECT_NE(hash_of({}), hash_of({0}));
}

TEST(BaseHash, CutsBetweenArraysCount) {
    const std::vector<std::uint8_t> a{1, 2, 3}, b{4, 5}, c{1, 2}, d{3, 4, 5};
    Hasher ab, cd;
    ab.add_bytes(std::as_bytes(std::span(a)));
    ab.add_bytes(std::as_bytes(std::span(b)));
    cd.add_bytes(std::as_bytes(std::span(c)));
    cd.add_bytes(std::as_bytes(std::span(d)));
    EXPECT_NE(ab.value(), cd.value());
}

TEST(BaseByteStream, GivesBackWhatWasWritten) {
    ByteWriter out;
    out.value(std::uint32_t(7));
    out.value(2.5);
    out.array(std::vector<double>{1, 2, 3});
    out.array(std::vector<std::int32_t>{});
    out.array(std::vector<std::int32_t>{4, 5});
    const std::vector<std::byte> bytes = out.take();
    ByteReader in(bytes);
    EXPECT_EQ(in.value<std::uint32_t>("n"), 7u);
    EXPECT_EQ(in.value<double>("x"), 2.5);
    std::vector<double> three(3), wrong(2);
    in.array(three, "three");
    EXPECT_EQ(three, (std::vector<double>{1, 2, 3}));
    std::vector<std::int32_t> none;
    in.array(none, "none");
    EXPECT_EQ(in.list<std::int32_t>(2, "list"), (std::vector<std::int32_t>{4, 5}));
    EXPECT_TRUE(in.at_end());
    EXPECT_THROW(in.value<char>("more"), Error);
}

TEST(BaseByteStream, NeverReadsPastTheEndNorTrustsALength) {
    ByteWriter out;
    out.array(std::vector<double>{1, 2, 3});
    const std::vector<std::byte> bytes = out.take();
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        ByteReader in{std::span<const std::byte>(bytes).first(size)};
        std::vector<double> three(3);
        try {
            in.array(three, "three");
            ADD_FAILURE() << size;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::corrupt_snapshot);
        }
    }
    std::vector<double> two(2);
    EXPECT_THROW(ByteReader(bytes).array(two, "two"), Error);
    EXPECT_THROW(ByteReader(bytes).list<double>(2, "short list"), Error);
    ByteWriter liar;
    liar.value(~std::uint64_t(0));
    const std::vector<std::byte> lie = liar.take();
    EXPECT_THROW(ByteReader(lie).list<double>(~std::size_t(0), "endless list"), Error);
}

TEST(BaseFunctionRef, CallsWhatItRefersToWithoutCopyingIt) {
    int calls = 0;
    auto count = [&calls, padding = std::array<double, 64>{}](int by) {
        calls += by;
        return calls + int(padding[0]);
    };
    const FunctionRef<int(int)> reference = count;
    EXPECT_EQ(reference(2), 2);
    EXPECT_EQ(reference(3), 5);
    EXPECT_EQ(calls, 5);
}

TEST(BaseId, NoneIsFalseAndGenerationsDiffer) {
    EXPECT_FALSE(BodyId{});
    EXPECT_TRUE((BodyId{0, 1}));
    EXPECT_NE((BodyId{0, 1}), (BodyId{0, 2}));
    EXPECT_EQ((BodyId{3, 1}), (BodyId{3, 1}));
}

TEST(BaseAligned, StartsOnACacheLine) {
    for (std::size_t n = 1; n < 100; n += 7) {
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(AlignedVector<float>(n).data()) % 64, 0u);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(AlignedVector<double>(n).data()) % 64, 0u);
    }
}

}  // namespace
}  // namespace supple
