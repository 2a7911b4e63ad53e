#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "supple/base/error.h"

namespace supple::io {

static_assert(std::endian::native == std::endian::little || std::endian::native == std::endian::big);

/// The bytes of `value` turned round.
template <class T>
T swap_bytes(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

/// Walks over numbers stored as bytes. Every failure is an Error(parse) at "name:byte N", N counted from 0. The bytes must outlive it.
class BinaryScanner {
public:
    BinaryScanner(std::string_view bytes, std::string name, std::endian order, std::size_t begin = 0)
        : bytes_(bytes), at_(begin), name_(std::move(name)), swap_(order != std::endian::native) {}

    std::size_t position() const { return at_; }
    std::size_t bytes_left() const { return bytes_.size() - at_; }
    bool at_end() const { return at_ == bytes_.size(); }
    const std::string& name() const { return name_; }

    template <class T>
    T read(std::string_view what) {
        if (bytes_left() < sizeof(T)) fail_truncated(what);
        T value;
        std::memcpy(&value, bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return swap_ ? swap_bytes(value) : value;
    }

    void skip(std::uint64_t count, std::string_view what) {
        if (bytes_left() < count) fail_truncated(what);
        at_ += std::size_t(count);
    }

    /// Refuses a count that the bytes left cannot hold, before anything is allocated for it.
    void require(std::uint64_t count, std::uint64_t bytes_each, std::string_view what) const {
        if (bytes_each != 0 && count > bytes_left() / bytes_each)
            fail("the file announces " + std::to_string(count) + " " + std::string(what) + ", but only " + std::to_string(bytes_left()) +
                 " bytes are left: it is truncated, or the count is wrong");
    }

    std::string where() const { return name_ + ":byte " + std::to_string(at_); }
    [[noreturn]] void fail(const std::string& message, ErrorCode code = ErrorCode::parse) const { throw Error(code, where(), message); }

private:
    [[noreturn]] void fail_truncated(std::string_view what) const {
        fail("the file ends inside " + std::string(what) + ": it is truncated, or a count in it is wrong");
    }

    std::string_view bytes_;
    std::size_t at_;
    std::string name_;
    bool swap_;
};

/// Appends numbers as bytes.
class BinaryText {
public:
    explicit BinaryText(std::string& out, std::endian order = std::endian::little) : out_(out), swap_(order != std::endian::native) {}

    template <class T>
    void add(T value) {
        if (swap_) value = swap_bytes(value);
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        out_.append(bytes, sizeof(T));
    }

private:
    std::string& out_;
    bool swap_;
};

}  // namespace supple::io
