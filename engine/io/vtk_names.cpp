#include "supple/io/vtk_names.h"

namespace supple::io {

namespace {

constexpr char kHex[] = "0123456789ABCDEF";

int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

struct Entity {
    char c;
    std::string_view text;
};
constexpr Entity kEntities[] = {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&apos;"}};

}  // namespace

std::string encode_vtk_name(std::string_view name) {
    std::string out;
    for (const char c : name) {
        if (c > ' ' && c < 127 && c != '"' && c != '%') {
            out += c;
        } else {
            const auto byte = static_cast<unsigned char>(c);
            out += {'%', kHex[byte / 16], kHex[byte % 16]};
        }
    }
    return out;
}

std::string decode_vtk_name(std::string_view name) {
    std::string out;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (name[i] == '%' && i + 2 < name.size() && digit(name[i + 1]) >= 0 && digit(name[i + 2]) >= 0) {
            out += char(16 * digit(name[i + 1]) + digit(name[i + 2]));
            i += 2;
        } else {
            out += name[i];
        }
    }
    return out;
}

std::string escape_xml(std::string_view text) {
    std::string out;
    for (const char c : text) {
        bool found = false;
        for (const Entity& entity : kEntities) {
            if (entity.c != c) continue;
            out += entity.text;
            found = true;
        }
        if (!found) out += c;
    }
    return out;
}

std::string unescape_xml(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        bool found = false;
        for (const Entity& entity : kEntities) {
            if (found || text.substr(0, entity.text.size()) != entity.text) continue;
            out += entity.c;
            text.remove_prefix(entity.text.size());
            found = true;
        }
        if (found) continue;
        out += text.front();
        text.remove_prefix(1);
    }
    return out;
}

}  // namespace supple::io
