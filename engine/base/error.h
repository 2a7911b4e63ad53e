#pragma once
#include <stdexcept>
#include <string>
#include <string_view>

namespace supple {

/// What kind of mistake an Error reports. Stable: the C API hands these numbers out.
enum class ErrorCode {
    invalid_argument = 1,  ///< a value outside its legal range, or values that contradict each other
    stale_id = 2,          ///< an id whose body, drag or template is gone
    file_unreadable = 3,   ///< a file that cannot be opened, read or written
    parse = 4,             ///< text that does not follow its format
    unsupported = 5,       ///< a format, element or option that this build does not handle
    surface_mesh = 6,      ///< a surface where a volume mesh is needed
    corrupt_snapshot = 7,  ///< a snapshot that is truncated, of another version or of another scene
    no_display = 8,        ///< no OpenGL context could be made
    external_tool = 9,     ///< a program we call (ffmpeg) is missing or failed
};

std::string_view to_string(ErrorCode code);

/// Thrown by everything that loads, configures, creates or edits; never by World::step().
/// what() reads "where: message"; the message names the value, its legal range and the fix.
class Error : public std::runtime_error {
public:
    /// @param where  "file.msh:12", "scene.json:/bodies/0/material/poisson" or the function and field, e.g. "BodyDef.density_kg_m3"
    Error(ErrorCode code, std::string where, std::string message);

    ErrorCode code() const noexcept { return code_; }
    const std::string& where() const noexcept { return where_; }
    const std::string& message() const noexcept { return message_; }

private:
    ErrorCode code_;
    std::string where_;
    std::string message_;
};

/// Throws Error(invalid_argument) "where: name = value is outside [low, high]; fix" unless low <= value <= high (NaN fails).
void require_in_range(double value, double low, double high, std::string_view where, std::string_view fix = {});

/// Shortest decimal text that reads back to the same double; for messages and reports.
std::string to_text(double value);

}  // namespace supple
