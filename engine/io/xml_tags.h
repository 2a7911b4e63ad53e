#pragma once
#include <map>
#include <string_view>

#include "supple/io/text_scanner.h"

namespace supple::io {

/// One tag of an XML text, with its attributes as they stand there.
struct XmlTag {
    std::string_view name;  ///< with the slash of a closing tag
    std::map<std::string_view, std::string_view> attributes;
    const char* position = nullptr;
    const char* behind = nullptr;  ///< first character after it
    bool empty = false;            ///< ends with "/>"

    std::string_view attribute(std::string_view key) const {
        const auto found = attributes.find(key);
        return found == attributes.end() ? std::string_view() : found->second;
    }
};

/// Cuts the tags out of the text, one after the other; comments and instructions are passed over.
class XmlTagReader {
public:
    XmlTagReader(std::string_view text, const TextScanner& scanner) : text_(text), scanner_(scanner) {}

    /// False at the end of the text. @error Error(parse) for a tag that is not closed or an attribute without quotes
    bool next(XmlTag& tag);

private:
    bool starts(std::string_view head) const { return text_.substr(at_, head.size()) == head; }
    void jump_behind(std::string_view closing);
    void read_inside(std::string_view inside, XmlTag& tag) const;

    std::string_view text_;
    const TextScanner& scanner_;
    std::size_t at_ = 0;
};

}  // namespace supple::io
