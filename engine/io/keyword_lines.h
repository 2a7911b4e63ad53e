#pragma once
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/io/mesh_source.h"
#include "supple/io/text_scanner.h"

namespace supple::io {

/// A line of an Abaqus or Vega file, cut at its commas (and blanks, for Vega).
struct KeywordLine {
    std::vector<std::string_view> fields;  ///< trimmed; an empty last one says that a comma ended the line
    const char* position = nullptr;
    const TextScanner* scanner = nullptr;  ///< of the file that it stands in

    bool is_keyword() const { return !fields.empty() && fields[0].size() > 1 && fields[0][0] == '*'; }
    /// The keyword in lower case without its star.
    std::string keyword() const;
    /// The value of a parameter such as ELSET=name, without quotes; empty where it is not there. `key` in lower case.
    std::optional<std::string_view> parameter(std::string_view key) const;
    [[noreturn]] void fail(const std::string& message, ErrorCode code = ErrorCode::parse) const { scanner->fail(message, position, code); }
    std::int64_t integer(std::size_t field, std::string_view what) const;
    double real(std::size_t field, std::string_view what) const;
};

/// Lower case, blanks inside taken out: keywords and parameters of Abaqus.
std::string plain_lower(std::string_view text);

/// The lines of a file and of the files that it includes, without comments and empty ones.
class KeywordReader {
public:
    /// @param cut_blanks  fields end at blanks, too
    /// @param comment     what a comment begins with: "**" or "#"
    KeywordReader(const MeshSource& source, std::string_view comment, bool cut_blanks);

    /// The next line; false at the end of all files.
    bool next(KeywordLine& line);
    /// Goes on in another file, then comes back. @error Error(parse) where files include each other more than 16 deep
    void include(const KeywordLine& line, std::string_view file);
    /// The outermost file.
    const TextScanner& file() const { return scanners_.front(); }

private:
    const MeshSource& source_;
    std::string_view comment_;
    bool cut_blanks_;
    std::deque<std::string> texts_;
    std::deque<TextScanner> scanners_;  ///< all files opened so far; lines point to them
    std::vector<TextScanner*> open_;
};

}  // namespace supple::io
