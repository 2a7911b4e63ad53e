#include "supple/io/keyword_lines.h"

#include <cctype>
#include <charconv>

namespace supple::io {

namespace {

constexpr std::size_t kDeepest = 16;
constexpr std::size_t kMostFiles = 256;

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

}  // namespace

std::string plain_lower(std::string_view text) {
    std::string out;
    for (const char c : text)
        if (!is_blank(c)) out += char(std::tolower(static_cast<unsigned char>(c)));
    return out;
}

std::string KeywordLine::keyword() const { return plain_lower(fields[0].substr(1)); }

std::optional<std::string_view> KeywordLine::parameter(std::string_view key) const {
    for (std::size_t f = 1; f < fields.size(); ++f) {
        const std::size_t equals = fields[f].find('=');
        if (plain_lower(fields[f].substr(0, equals)) != key) continue;
        if (equals == std::string_view::npos) return std::string_view();
        std::string_view value = trimmed(fields[f].substr(equals + 1));
        if (value.size() > 1 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
        return value;
    }
    return std::nullopt;
}

std::int64_t KeywordLine::integer(std::size_t field, std::string_view what) const {
    if (field >= fields.size()) fail("the line ends where " + std::string(what) + " was expected");
    std::string_view word = fields[field];
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    std::int64_t value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size())
        fail(std::string(what) + " must be a whole number, found " + quoted(fields[field]));
    return value;
}

double KeywordLine::real(std::size_t field, std::string_view what) const {
    if (field >= fields.size()) fail("the line ends where " + std::string(what) + " was expected");
    double value = 0;
    if (!parse_real(fields[field], value)) fail(std::string(what) + " must be a finite number, found " + quoted(fields[field]));
    return value;
}

KeywordReader::KeywordReader(const MeshSource& source, std::string_view comment, bool cut_blanks)
    : source_(source), comment_(comment), cut_blanks_(cut_blanks) {
    scanners_.emplace_back(source.bytes, source.name);
    open_.push_back(&scanners_.back());
}

bool KeywordReader::next(KeywordLine& line) {
    while (!open_.empty()) {
        TextScanner& scanner = *open_.back();
        if (scanner.at_end()) {
            open_.pop_back();
            continue;
        }
        scanner.line_ended();
        line.position = scanner.position();
        line.scanner = &scanner;
        std::string_view text = scanner.rest_of_line();
        if (comment_.size() == 1) text = trimmed(text.substr(0, text.find(comment_)));
        if (text.empty() || text.substr(0, comment_.size()) == comment_) continue;
        line.fields.clear();
        while (true) {
            const std::size_t end = text.find_first_of(cut_blanks_ ? ", \t" : ",");
            line.fields.push_back(trimmed(text.substr(0, end)));
            if (end == std::string_view::npos) break;
            text = text.substr(end + 1);
            if (!cut_blanks_) continue;
            const std::size_t word = text.find_first_not_of(", \t\r");
            if (word == std::string_view::npos) break;
            text.remove_prefix(word);
        }
        return true;
    }
    return false;
}

void KeywordReader::include(const KeywordLine& line, std::string_view file) {
    if (file.empty()) line.fail("the file to include has no name");
    if (open_.size() >= kDeepest || texts_.size() >= kMostFiles)
        line.fail("files include each other more than " + std::to_string(kDeepest) + " deep, or there are more than " +
                  std::to_string(kMostFiles));
    texts_.push_back(read_partner(source_, std::filesystem::path(file), line.scanner->where(line.position)));
    scanners_.emplace_back(texts_.back(), std::string(file));
    open_.push_back(&scanners_.back());
}

}  // namespace supple::io
