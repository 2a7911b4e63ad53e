#pragma once
#include <charconv>
#include <concepts>
#include <string>

#include "supple/math/types.h"

namespace supple::io {

/// Appends the shortest text that reads back to the same bits.
template <class T>
requires std::integral<T> || std::floating_point<T>
void append(std::string& out, T value) {
    char text[32];
    out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

/// "x y z"
inline void append(std::string& out, const Vec3& x) {
    append(out, x.x());
    out += ' ';
    append(out, x.y());
    out += ' ';
    append(out, x.z());
}

}  // namespace supple::io
