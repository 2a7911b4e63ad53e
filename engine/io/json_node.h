#pragma once
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/error.h"
#include "supple/math/types.h"

namespace supple::io {

/// The entry of `known` with the least edit distance to `word`; empty if none is near enough to be meant.
std::string nearest(std::string_view word, std::span<const std::string_view> known);

/// Parses JSON with comments. Text after the value, a repeated key and a byte order mark in the middle are errors.
/// @error Error(parse) "name:line"
nlohmann::json parse_json(std::string_view text, const std::string& name);

/// A value of a JSON document that knows where it stands, so that every complaint can name its place as "file:/json/pointer".
class JsonNode {
public:
    JsonNode(const nlohmann::json& value, std::string file) : value_(&value), file_(std::move(file)) {}

    // -- objects ------------------------------------------------------------------------------------
    /// This must be an object with no other keys than these; an unknown key is an error that names the nearest known one.
    void require_object(std::span<const std::string_view> known_keys) const;
    void require_object(std::initializer_list<std::string_view> known_keys) const {
        require_object(std::span<const std::string_view>(known_keys.begin(), known_keys.size()));
    }
    bool has(std::string_view key) const { return value_->is_object() && value_->contains(std::string(key)); }
    JsonNode at(std::string_view key) const;                        ///< @error if it is missing
    JsonNode at(std::string_view key, std::string_view fix) const;  ///< the same with a sentence on what to write

    // -- arrays -------------------------------------------------------------------------------------
    bool is_array() const { return value_->is_array(); }
    bool is_object() const { return value_->is_object(); }
    bool is_string() const { return value_->is_string(); }
    bool is_number() const { return value_->is_number(); }
    std::size_t size() const { return value_->size(); }
    std::vector<JsonNode> items() const;  ///< @error unless it is an array
    JsonNode item(std::size_t index) const;

    // -- values: all errors name the value, what is legal and its pointer ------------------------------
    double number() const;                                 ///< finite
    double number(double low, double high) const;          ///< in [low, high]
    double number_above(double low, double high) const;    ///< in (low, high]
    double number_between(double low, double high) const;  ///< in (low, high)
    std::int64_t integer(std::int64_t low, std::int64_t high) const;
    bool boolean() const;
    std::string text() const;
    Vec3 vec3() const;
    Vec3 vec3(double most) const;  ///< each component in [-most, most]
    /// One of `offered`; one of `planned` is Error(unsupported); anything else names the nearest.
    std::string choice(std::initializer_list<std::string_view> offered, std::initializer_list<std::string_view> planned = {}) const;

    const std::string& pointer() const { return pointer_; }
    std::string where() const { return file_ + ":" + (pointer_.empty() ? "/" : pointer_); }
    std::string shown() const;  ///< the value, shortened, for messages
    [[noreturn]] void fail(const std::string& message, ErrorCode code = ErrorCode::parse) const;
    [[noreturn]] void unsupported(const std::string& message) const { fail(message, ErrorCode::unsupported); }

private:
    JsonNode child(const nlohmann::json& value, std::string_view key) const;
    [[noreturn]] void fail_type(std::string_view wanted) const;

    const nlohmann::json* value_;
    std::string file_;
    std::string pointer_;
};

}  // namespace supple::io
