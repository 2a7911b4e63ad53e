#include "supple/io/text_scanner.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace supple::io {

namespace {

const char* end_of_word(const char* at, const char* end) {
    while (at != end && !is_blank(*at) && *at != '\n') ++at;
    return at;
}

/// Whether a number that from_chars could not represent is too small rather than too large.
bool underflows(std::string_view word) {
    const std::size_t exponent = word.find_first_of("eE");
    if (exponent != std::string_view::npos) return exponent + 1 < word.size() && word[exponent + 1] == '-';
    const std::size_t first = word.find_first_not_of("+-");
    return first != std::string_view::npos && word[first] == '0';
}

}  // namespace

std::string quoted(std::string_view word) {
    constexpr std::size_t kLongest = 40;
    std::string text = "\"";
    for (char c : word.substr(0, kLongest)) text += (c >= ' ' && c < 127) ? c : '?';
    return text + (word.size() > kLongest ? "...\"" : "\"");
}

bool parse_real(std::string_view word, double& value) {
    if (!word.empty() && word.front() == '+') {
        word.remove_prefix(1);
        if (!word.empty() && word.front() == '-') return false;
    }
    char copy[64];
    const std::size_t fortran = word.find_first_of("dD");
    if (fortran != std::string_view::npos && word.size() <= sizeof copy) {
        std::memcpy(copy, word.data(), word.size());
        copy[fortran] = 'e';
        word = {copy, word.size()};
    }
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (rest != word.data() + word.size()) return false;
    if (error == std::errc::result_out_of_range && underflows(word)) {
        value = 0;
        return true;
    }
    return error == std::errc() && std::isfinite(value);
}

TextScanner::TextScanner(std::string_view text, std::string name)
    : begin_(text.data()), at_(text.data()), end_(text.data() + text.size()), name_(std::move(name)) {}

TextScanner TextScanner::part(const char* begin, const char* end) const {
    TextScanner copy = *this;
    copy.at_ = begin;
    copy.end_ = end;
    return copy;
}

void TextScanner::skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
}

bool TextScanner::line_ended() {
    skip_blanks();
    return at_ == end_ || *at_ == '\n';
}

void TextScanner::next_line() {
    const void* line_end = at_ == end_ ? nullptr : std::memchr(at_, '\n', bytes_left());
    at_ = line_end ? static_cast<const char*>(line_end) + 1 : end_;
}

void TextScanner::skip_space() {
    while (at_ != end_ && (is_blank(*at_) || *at_ == '\n')) ++at_;
}

std::string_view TextScanner::word() {
    skip_blanks();
    const char* begin = at_;
    at_ = end_of_word(at_, end_);
    return {begin, std::size_t(at_ - begin)};
}

std::string_view TextScanner::rest_of_line() {
    skip_blanks();
    const char* begin = at_;
    next_line();
    const char* last = at_;
    while (last != begin && (is_blank(last[-1]) || last[-1] == '\n')) --last;
    return {begin, std::size_t(last - begin)};
}

void TextScanner::fail_value(std::string_view what, std::string_view kind, const char* begin) {
    if (begin == end_)
        fail("nothing is left where " + std::string(what) + " was expected: the file is truncated, or a count in it is wrong", begin);
    if (*begin == '\n') fail("the line ends where " + std::string(what) + " was expected", begin);
    const std::string_view found(begin, std::size_t(end_of_word(begin, end_) - begin));
    fail(std::string(what) + " must be " + std::string(kind) + ", found " + quoted(found), begin);
}

std::int64_t TextScanner::integer(std::string_view what) {
    skip_blanks();
    std::int64_t value = 0;
    const char* first = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
    const auto [rest, error] = std::from_chars(first, end_, value);
    if (error != std::errc() || (rest != end_ && !is_blank(*rest) && *rest != '\n')) fail_value(what, "a whole number below 2^63", at_);
    at_ = rest;
    return value;
}

std::int64_t TextScanner::integer(std::string_view what, std::int64_t low, std::int64_t high) {
    skip_blanks();
    const char* begin = at_;
    const std::int64_t value = integer(what);
    if (value < low || value > high) {
        fail(std::string(what) + " is " + std::to_string(value) + ", outside [" + std::to_string(low) + ", " + std::to_string(high) + "]",
             begin);
    }
    return value;
}

double TextScanner::real(std::string_view what) {
    skip_blanks();
    double value = 0;
    const auto [rest, error] = std::from_chars(at_, end_, value);
    const bool whole_word = rest == end_ || is_blank(*rest) || *rest == '\n';
    if (error == std::errc() && whole_word && std::isfinite(value)) {
        at_ = rest;
        return value;
    }
    const char* begin = at_;
    if (!parse_real(word(), value)) fail_value(what, "a finite number", begin);
    return value;
}

void TextScanner::end_line(std::string_view record) {
    if (!line_ended()) {
        const std::string_view found(at_, std::size_t(end_of_word(at_, end_) - at_));
        fail("unexpected " + quoted(found) + " after " + std::string(record));
    }
    next_line();
}

std::size_t TextScanner::plausible(std::int64_t count, std::size_t least_bytes_each) const {
    return std::size_t(std::min<std::uint64_t>(count < 0 ? 0 : std::uint64_t(count), bytes_left() / least_bytes_each + 1));
}

std::string TextScanner::where(const char* position) const {
    if (!position) return name_;
    if (binary_ && position >= binary_) return name_ + ":byte " + std::to_string(position - begin_);
    return name_ + ":" + std::to_string(1 + std::count(begin_, position, '\n'));
}

void TextScanner::fail(const std::string& message, const char* position, ErrorCode code) const {
    throw Error(code, where(position), message);
}

}  // namespace supple::io
