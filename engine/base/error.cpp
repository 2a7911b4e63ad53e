#include "supple/base/error.h"

#include <charconv>
#include <utility>

namespace supple {

std::string_view to_string(ErrorCode code) {
    switch (code) {
        case ErrorCode::invalid_argument: return "invalid argument";
        case ErrorCode::stale_id: return "stale id";
        case ErrorCode::file_unreadable: return "file unreadable";
        case ErrorCode::parse: return "parse error";
        case ErrorCode::unsupported: return "unsupported";
        case ErrorCode::surface_mesh: return "surface mesh";
        case ErrorCode::corrupt_snapshot: return "corrupt snapshot";
        case ErrorCode::no_display: return "no display";
        case ErrorCode::external_tool: return "external tool";
    }
    return "unknown error";
}

Error::Error(ErrorCode code, std::string where, std::string message)
    : std::runtime_error(where.empty() ? message : where + ": " + message),
      code_(code),
      where_(std::move(where)),
      message_(std::move(message)) {}

void require_in_range(double value, double low, double high, std::string_view where, std::string_view fix) {
    if (value >= low && value <= high) return;
    std::string message = to_text(value) + " is outside [" + to_text(low) + ", " + to_text(high) + "]";
    if (!fix.empty()) message.append("; ").append(fix);
    throw Error(ErrorCode::invalid_argument, std::string(where), std::move(message));
}

std::string to_text(double value) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return std::string(text, end);
}

}  // namespace supple
