#pragma once
#include <cstdint>

namespace supple {

/// The low 21 bits of three numbers in turns, the first one's highest in front: near one another in space, near in this order (Morton 1966).
inline std::uint64_t morton_key(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    const auto spread = [](std::uint64_t bits) {  // two zeros between each and the next
        bits &= 0x1fffff;
        bits = (bits | bits << 32) & 0x001f00000000ffff;
        bits = (bits | bits << 16) & 0x001f0000ff0000ff;
        bits = (bits | bits << 8) & 0x100f00f00f00f00f;
        bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
        return (bits | bits << 2) & 0x1249249249249249;
    };
    return spread(a) << 2 | spread(b) << 1 | spread(c);
}

}  // namespace supple
