#pragma once
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/base/error.h"
#include "supple/math/types.h"

namespace supple::demos {

// JSON for output, as text: reports need objects, arrays, numbers and words, no more. Reading JSON is the io room's.

inline std::string json(double value) { return std::isfinite(value) ? to_text(value) : "null"; }
inline std::string json(int value) { return std::to_string(value); }
inline std::string json(std::size_t value) { return std::to_string(value); }
inline std::string json(const Vec3& v) { return "[" + json(v.x()) + ", " + json(v.y()) + ", " + json(v.z()) + "]"; }

inline std::string json(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) < 0x20) {
            char escape[8];
            std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
            out += escape;
        } else {
            out += c;
        }
    }
    return out + "\"";
}

/// Members in the order they are added; values are JSON text already.
class JsonObject {
public:
    JsonObject& add(std::string_view key, std::string value) {
        members_.emplace_back(json(key), std::move(value));
        return *this;
    }
    /// On one line, or one member a line at the given depth.
    std::string line() const { return text(", ", "{", "}"); }
    std::string block(int depth = 0) const {
        const std::string inner(2 * (depth + 1), ' '), outer(2 * depth, ' ');
        return text(",\n" + inner, "{\n" + inner, "\n" + outer + "}");
    }

private:
    std::string text(const std::string& separator, const std::string& open, const std::string& close) const {
        std::string out = open;
        for (std::size_t i = 0; i < members_.size(); ++i) out += (i > 0 ? separator : "") + members_[i].first + ": " + members_[i].second;
        return out + close;
    }
    std::vector<std::pair<std::string, std::string>> members_;
};

inline std::string json_array(const std::vector<std::string>& values, const std::string& separator = ", ") {
    std::string out = "[";
    for (std::size_t i = 0; i < values.size(); ++i) out += (i > 0 ? separator : "") + values[i];
    return out + "]";
}

}  // namespace supple::demos
