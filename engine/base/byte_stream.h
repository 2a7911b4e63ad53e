#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "supple/base/error.h"

namespace supple {

/// Appends plain values and arrays to a byte buffer (little-endian hosts).
class ByteWriter {
public:
    template <class T>
    void value(const T& x) {
        static_assert(std::is_trivially_copyable_v<T>);
        raw(&x, sizeof x);
    }
    /// Length, then the elements.
    template <class Vector>
    void array(const Vector& x) {
        value(std::uint64_t(x.size()));
        raw(x.data(), x.size() * sizeof(typename Vector::value_type));
    }
    std::vector<std::byte> take() { return std::move(bytes_); }

private:
    void raw(const void* data, std::size_t size) {
        if (size == 0) return;
        const std::size_t at = bytes_.size();
        bytes_.resize(at + size);
        std::memcpy(bytes_.data() + at, data, size);
    }
    std::vector<std::byte> bytes_;
};

/// Reads what ByteWriter wrote; anything that does not fit throws Error(corrupt_snapshot).
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    template <class T>
    T value(const char* what) {
        static_assert(std::is_trivially_copyable_v<T>);
        need(sizeof(T), what);
        T x;
        std::memcpy(&x, bytes_.data() + at_, sizeof x);
        at_ += sizeof x;
        return x;
    }
    /// Reads an array that must have exactly x.size() elements.
    template <class Vector>
    void array(Vector& x, const char* what) {
        using T = typename Vector::value_type;
        const auto size = value<std::uint64_t>(what);
        if (size != x.size()) {
            throw Error(ErrorCode::corrupt_snapshot, "snapshot",
                        std::string(what) + " has " + std::to_string(size) + " entries, this world has " + std::to_string(x.size()) +
                            ": restore into a world built by the same calls");
        }
        need(size * sizeof(T), what);
        if (size != 0) std::memcpy(static_cast<void*>(x.data()), bytes_.data() + at_, size * sizeof(T));
        at_ += size * sizeof(T);
    }
    /// Reads a list of at most `limit` elements.
    template <class T>
    std::vector<T> list(std::size_t limit, const char* what) {
        const auto size = value<std::uint64_t>(what);
        if (size > limit) throw Error(ErrorCode::corrupt_snapshot, "snapshot", std::string(what) + " has more entries than can be");
        need(size * sizeof(T), what);
        std::vector<T> x(size);
        if (size != 0) std::memcpy(static_cast<void*>(x.data()), bytes_.data() + at_, size * sizeof(T));
        at_ += size * sizeof(T);
        return x;
    }
    bool at_end() const { return at_ == bytes_.size(); }

private:
    void need(std::size_t size, const char* what) const {
        if (bytes_.size() - at_ < size) {
            throw Error(ErrorCode::corrupt_snapshot, "snapshot", std::string("truncated in ") + what);
        }
    }
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

}  // namespace supple
