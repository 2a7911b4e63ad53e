#pragma once
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include "supple/base/error.h"

namespace supple::io {

/// Walks over a text held in memory: words, numbers, lines. Every failure is an Error(parse) at "name:line".
/// Carriage returns count as blanks, so CRLF files need no care. The text must outlive the scanner.
class TextScanner {
public:
    TextScanner(std::string_view text, std::string name);

    const std::string& name() const { return name_; }
    const char* position() const { return at_; }
    const char* end() const { return end_; }
    std::size_t bytes_left() const { return std::size_t(end_ - at_); }
    void seek(const char* position) { at_ = position; }
    /// The text [begin, end) of this scanner with its own cursor; lines are still counted from the start of the file.
    TextScanner part(const char* begin, const char* end) const;

    bool at_end() const { return at_ == end_; }
    bool line_ended();                ///< skips blanks; true at a line end or at the end of the text
    void next_line();                 ///< goes behind the next line end
    void skip_space();                ///< skips blanks and line ends
    std::string_view word();          ///< next word of this line; empty when the line has ended
    std::string_view rest_of_line();  ///< trimmed; goes behind the line end

    /// A whole number / a finite real number on this line. Reals may have Fortran's D exponents and a leading plus.
    /// @param what  names the value in the message, e.g. "the x coordinate"
    std::int64_t integer(std::string_view what);
    double real(std::string_view what);
    /// An integer in [low, high].
    std::int64_t integer(std::string_view what, std::int64_t low, std::int64_t high);
    /// Nothing but blanks may be left on the line; goes behind its end.
    void end_line(std::string_view record);

    /// How many records are worth reserving memory for: never more than the bytes that are left can hold.
    std::size_t plausible(std::int64_t count, std::size_t least_bytes_each) const;

    std::string where() const { return where(at_); }
    std::string where(const char* position) const;  ///< "name:line", or "name:byte N" (from 0) in bytes; the name alone for null
    /// What lies from `begin` on is bytes, not text: where() counts no lines there.
    void set_binary_from(const char* begin) { binary_ = begin; }
    [[noreturn]] void fail(const std::string& message) const { fail(message, at_); }
    [[noreturn]] void fail(const std::string& message, const char* position, ErrorCode code = ErrorCode::parse) const;

private:
    void skip_blanks();
    [[noreturn]] void fail_value(std::string_view what, std::string_view kind, const char* begin);

    const char* begin_;
    const char* at_;
    const char* end_;
    const char* binary_ = nullptr;
    std::string name_;
};

/// A word as it may appear in a message: at most 40 characters, unprintable ones replaced.
std::string quoted(std::string_view word);

/// Reads a finite real number from all of `word`; false if it is none. Underflow gives zero.
bool parse_real(std::string_view word, double& value);

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

}  // namespace supple::io
