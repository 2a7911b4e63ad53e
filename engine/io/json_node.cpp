#include "supple/io/json_node.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>

namespace supple::io {

namespace {

/// Edits (insert, delete, replace, swap neighbours) between two words, ignoring case.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    const auto same = [](char x, char y) {
        return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
    };
    std::vector<std::size_t> before, row(b.size() + 1), next(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        next[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            next[j] = std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + (same(a[i - 1], b[j - 1]) ? 0u : 1u)});
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1])) next[j] = std::min(next[j], before[j - 2] + 1);
        }
        before = row;
        row.swap(next);
    }
    return row.back();
}

std::string list_of(std::span<const std::string_view> words) {
    std::string list;
    for (std::string_view word : words) list += (list.empty() ? "\"" : ", \"") + std::string(word) + "\"";
    return list;
}

/// One key or index of a JSON pointer (RFC 6901).
std::string escaped(std::string_view key) {
    std::string text;
    for (char c : key) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return text;
}

/// Reads a text and tells others how far: the parser names a position with some of its errors only.
struct CountingIterator {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    const char* at;
    const char** furthest;

    reference operator*() const { return *at; }
    CountingIterator& operator++() {
        *furthest = ++at;
        return *this;
    }
    bool operator==(const CountingIterator& other) const { return at == other.at; }
};

/// The library's sentence without its own code and position, which stand in `where` already.
std::string plain_sentence(std::string_view what) {
    const std::size_t column = what.find("column ");
    if (column != std::string_view::npos) {
        const std::size_t colon = what.find(": ", column);
        if (colon != std::string_view::npos)
            return std::string(what.substr(column, colon - column)) + ": " + std::string(what.substr(colon + 2));
    }
    const std::size_t bracket = what.find("] ");
    return std::string(bracket == std::string_view::npos ? what : what.substr(bracket + 2));
}

}  // namespace

std::string nearest(std::string_view word, std::span<const std::string_view> known) {
    std::string_view best;
    // Half the letters wrong is no misspelling any more, unless one word holds the other ("young" for "young_pa").
    std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
    for (std::string_view candidate : known) {
        std::size_t distance = edit_distance(word.substr(0, 100), candidate);
        const bool holds =
            word.size() >= 3 && (candidate.find(word) != std::string_view::npos || word.find(candidate) != std::string_view::npos);
        if (holds) distance = std::min<std::size_t>(distance, 2);
        if (distance < least) {
            least = distance;
            best = candidate;
        }
    }
    return std::string(best);
}

nlohmann::json parse_json(std::string_view text, const std::string& name) {
    using nlohmann::json;
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    std::vector<std::set<std::string>> keys;  // of the objects that are open
    std::string repeated, repeated_where;
    const char* furthest = text.data();
    const auto here = [&] {
        // The character behind the last token has been looked at: a line end there belongs to the token's line.
        const char* last = furthest == text.data() ? furthest : furthest - 1;
        return name + ":" + std::to_string(1 + std::count(text.data(), last, '\n'));
    };
    const auto watch = [&](int, json::parse_event_t event, json& parsed) {
        if (event == json::parse_event_t::object_start) keys.emplace_back();
        if (event == json::parse_event_t::object_end) keys.pop_back();
        if (event == json::parse_event_t::key && repeated_where.empty() && !keys.back().insert(parsed.get<std::string>()).second) {
            repeated = parsed.get<std::string>();
            repeated_where = here();
        }
        return true;
    };
    try {
        json document = json::parse(CountingIterator{text.data(), &furthest}, CountingIterator{text.data() + text.size(), &furthest}, watch,
                                    true, true);
        if (!repeated_where.empty()) {
            throw Error(ErrorCode::parse, repeated_where, "the key \"" + repeated + "\" occurs twice in one object; keep one of them");
        }
        return document;
    } catch (const json::exception& error) {
        throw Error(ErrorCode::parse, here(), plain_sentence(error.what()));
    }
}

void JsonNode::fail(const std::string& message, ErrorCode code) const { throw Error(code, where(), message); }

void JsonNode::fail_type(std::string_view wanted) const { fail("must be " + std::string(wanted) + ", found " + shown()); }

std::string JsonNode::shown() const {
    constexpr std::size_t kLongest = 60;
    // Lists of lists are not written out: they may be nested a million deep.
    const auto nested = [](const nlohmann::json& entry) { return entry.is_structured(); };
    if (value_->is_array() && (value_->size() > 8 || std::any_of(value_->begin(), value_->end(), nested))) {
        return "a list of " + std::to_string(value_->size());
    }
    if (value_->is_object()) return "an object";
    std::string text = value_->dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    return text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
}

JsonNode JsonNode::child(const nlohmann::json& value, std::string_view key) const {
    JsonNode node(value, file_);
    node.pointer_ = pointer_ + "/" + escaped(key);
    return node;
}

void JsonNode::require_object(std::span<const std::string_view> known_keys) const {
    if (!value_->is_object()) fail_type("an object with the keys " + list_of(known_keys));
    for (const auto& [key, value] : value_->items()) {
        if (std::find(known_keys.begin(), known_keys.end(), key) != known_keys.end()) continue;
        const std::string near = nearest(key, known_keys);
        child(value, key)
            .fail("unknown key \"" + key + "\"" + (near.empty() ? "" : "; did you mean \"" + near + "\"?") +
                  " Known here: " + list_of(known_keys));
    }
}

JsonNode JsonNode::at(std::string_view key) const { return at(key, ""); }

JsonNode JsonNode::at(std::string_view key, std::string_view fix) const {
    if (!has(key)) fail("the key \"" + std::string(key) + "\" is missing" + (fix.empty() ? "" : "; " + std::string(fix)));
    return child((*value_)[std::string(key)], key);
}

std::vector<JsonNode> JsonNode::items() const {
    if (!value_->is_array()) fail_type("a list [...]");
    std::vector<JsonNode> nodes;
    nodes.reserve(value_->size());
    for (std::size_t i = 0; i < value_->size(); ++i) nodes.push_back(item(i));
    return nodes;
}

JsonNode JsonNode::item(std::size_t index) const { return child((*value_)[index], std::to_string(index)); }

double JsonNode::number() const {
    if (!value_->is_number()) fail_type("a number");
    const double value = value_->get<double>();
    if (!std::isfinite(value)) fail_type("a finite number");
    return value;
}

double JsonNode::number(double low, double high) const {
    const double value = number();
    if (!(value >= low && value <= high)) fail(shown() + " is outside [" + to_text(low) + ", " + to_text(high) + "]");
    return value;
}

double JsonNode::number_above(double low, double high) const {
    const double value = number();
    if (!(value > low && value <= high)) fail(shown() + " is outside (" + to_text(low) + ", " + to_text(high) + "]");
    return value;
}

double JsonNode::number_between(double low, double high) const {
    const double value = number();
    if (!(value > low && value < high)) fail(shown() + " is outside (" + to_text(low) + ", " + to_text(high) + ")");
    return value;
}

std::int64_t JsonNode::integer(std::int64_t low, std::int64_t high) const {
    const std::string range = "in [" + std::to_string(low) + ", " + std::to_string(high) + "]";
    // 2 and 2.0 are the same number in JSON.
    const double value = value_->is_number() ? value_->get<double>() : NAN;
    if (!(value == std::floor(value))) fail_type("a whole number " + range);
    if (value < double(low) || value > double(high)) fail(shown() + " is not " + range);
    return std::int64_t(value);
}

bool JsonNode::boolean() const {
    if (!value_->is_boolean()) fail_type("true or false");
    return value_->get<bool>();
}

std::string JsonNode::text() const {
    if (!value_->is_string()) fail_type("a text in quotes");
    return value_->get<std::string>();
}

Vec3 JsonNode::vec3() const {
    if (!value_->is_array() || value_->size() != 3) fail_type("a list of three numbers [x, y, z]");
    return {item(0).number(), item(1).number(), item(2).number()};
}

Vec3 JsonNode::vec3(double most) const {
    if (!value_->is_array() || value_->size() != 3) fail_type("a list of three numbers [x, y, z]");
    return {item(0).number(-most, most), item(1).number(-most, most), item(2).number(-most, most)};
}

std::string JsonNode::choice(std::initializer_list<std::string_view> offered, std::initializer_list<std::string_view> planned) const {
    const std::span<const std::string_view> can(offered.begin(), offered.size());
    if (!value_->is_string()) fail_type("one of " + list_of(can));
    const std::string word = text();
    if (std::find(can.begin(), can.end(), word) != can.end()) return word;
    if (std::find(planned.begin(), planned.end(), word) != planned.end())
        unsupported(shown() + " is not available in this build; supported: " + list_of(can));
    std::vector<std::string_view> all(can.begin(), can.end());
    all.insert(all.end(), planned.begin(), planned.end());
    const std::string near = nearest(word, all);
    fail(shown() + " is not known" + (near.empty() ? "" : "; did you mean \"" + near + "\"?") + " Supported: " + list_of(can));
}

}  // namespace supple::io
