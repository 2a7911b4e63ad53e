#include "supple/io/xml_tags.h"

namespace supple::io {

namespace {

bool is_space(char c) { return is_blank(c) || c == '\n'; }

}  // namespace

bool XmlTagReader::next(XmlTag& tag) {
    for (;;) {
        at_ = text_.find('<', at_);
        if (at_ == std::string_view::npos) return false;
        if (starts("<!--")) {
            jump_behind("-->");
        } else if (starts("<?")) {
            jump_behind("?>");
        } else {
            break;
        }
    }
    const char* begin = text_.data() + at_;
    const std::size_t end = text_.find_first_of("<>", at_ + 1);
    if (end == std::string_view::npos || text_[end] == '<') scanner_.fail("a tag is not closed with >", begin);
    std::string_view inside = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    tag = {};
    tag.position = begin;
    tag.behind = text_.data() + at_;
    if (!inside.empty() && inside.back() == '/') {
        tag.empty = true;
        inside.remove_suffix(1);
    }
    read_inside(inside, tag);
    return true;
}

void XmlTagReader::jump_behind(std::string_view closing) {
    const std::size_t end = text_.find(closing, at_);
    if (end == std::string_view::npos) scanner_.fail("a comment is not closed: the file is truncated", text_.data() + at_);
    at_ = end + closing.size();
}

void XmlTagReader::read_inside(std::string_view inside, XmlTag& tag) const {
    const auto skip_space = [&] {
        while (!inside.empty() && is_space(inside.front())) inside.remove_prefix(1);
    };
    std::size_t length = 0;
    while (length < inside.size() && !is_space(inside[length])) ++length;
    tag.name = inside.substr(0, length);
    inside.remove_prefix(length);
    for (skip_space(); !inside.empty(); skip_space()) {
        const std::size_t equals = inside.find('=');
        if (equals == std::string_view::npos) scanner_.fail("an attribute of <" + std::string(tag.name) + "> has no value", tag.position);
        std::string_view key = inside.substr(0, equals);
        while (!key.empty() && is_space(key.back())) key.remove_suffix(1);
        inside.remove_prefix(equals + 1);
        skip_space();
        const char mark = inside.empty() ? ' ' : inside.front();
        const std::size_t end = mark == '"' || mark == '\'' ? inside.find(mark, 1) : std::string_view::npos;
        if (end == std::string_view::npos)
            scanner_.fail("the value of an attribute of <" + std::string(tag.name) + "> must stand in quotes", tag.position);
        tag.attributes[key] = inside.substr(1, end - 1);
        inside.remove_prefix(end + 1);
    }
}

}  // namespace supple::io
