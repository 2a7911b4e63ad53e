#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

namespace supple {

/// Order-sensitive 64-bit hash of raw bytes, the same on every little-endian machine; a fingerprint, not cryptography.
class Hasher {
public:
    void add_bytes(std::span<const std::byte> bytes) {
        std::size_t i = 0;
        for (; i + 8 <= bytes.size(); i += 8) {
            std::uint64_t word;
            std::memcpy(&word, bytes.data() + i, 8);
            mix(word);
        }
        std::uint64_t tail = bytes.size();
        for (; i < bytes.size(); ++i) tail = (tail << 8) | std::uint64_t(bytes[i]);
        mix(tail);
    }
    std::uint64_t value() const { return state_ ^ (state_ >> 31); }

private:
    void mix(std::uint64_t word) {  // one round of MurmurHash3's finaliser constants
        word *= 0xff51afd7ed558ccdULL;
        word ^= word >> 33;
        state_ = std::rotl(state_ ^ word, 27) * 0xc4ceb9fe1a85ec53ULL + 0x52dce729ULL;
    }
    std::uint64_t state_ = 0x9e3779b97f4a7c15ULL;
};

}  // namespace supple
