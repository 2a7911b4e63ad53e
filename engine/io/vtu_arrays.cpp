#include "supple/io/vtu_arrays.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "supple/io/binary_scanner.h"

namespace supple::io {

namespace {

/// Base64 (RFC 4648): the value of a letter, -1 for none.
int base64_value(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    if (c == '/') return 63;
    return -1;
}

/// Bytes as they are, or out of base64. Padding may stand in the middle, where a writer encoded head and data one by one.
class EncodedBytes {
public:
    EncodedBytes(const char* begin, const char* end, bool base64) : at_(begin), end_(end), base64_(base64) {}

    std::uint64_t most_left() const { return std::uint64_t(end_ - at_) + ready_.size(); }

    /// Appends the next `count` bytes; false where they are not there.
    bool read(std::uint64_t count, std::string& out) {
        if (count > most_left()) return false;
        if (!base64_) {
            out.append(at_, std::size_t(count));
            at_ += count;
            return true;
        }
        while (count > 0) {
            if (ready_.empty() && !decode_four()) return false;
            const std::size_t taken = std::min<std::size_t>(std::size_t(count), ready_.size());
            out.append(ready_, 0, taken);
            ready_.erase(0, taken);
            count -= taken;
        }
        return true;
    }

private:
    bool decode_four() {
        std::uint32_t bits = 0;
        int letters = 0, padding = 0;
        while (letters + padding < 4) {
            while (at_ != end_ && (is_blank(*at_) || *at_ == '\n')) ++at_;
            if (at_ == end_) return false;
            const char c = *at_;
            const int value = base64_value(c);
            if (c == '=' && letters >= 2) {
                ++padding;
            } else if (value < 0 || padding > 0) {
                return false;
            } else {
                ++letters;
            }
            bits = bits << 6 | std::uint32_t(c == '=' ? 0 : value);
            ++at_;
        }
        for (int i = 0; i < letters - 1; ++i) ready_ += char(bits >> (16 - 8 * i) & 0xff);
        return true;
    }

    const char *at_, *end_;
    bool base64_;
    std::string ready_;
};

/// The decoded bytes of an array.
class ArrayBytes {
public:
    ArrayBytes(const TextScanner& file, const VtuStorage& storage, const XmlTag& array) : file_(file), storage_(storage), array_(array) {}

    std::string read() {
        EncodedBytes bytes = place();
        return storage_.zlib ? read_blocks(bytes) : read_plain(bytes);
    }

private:
    [[noreturn]] void fail(const std::string& message) const {
        file_.fail("the data array " + quoted(array_.attribute("Name")) + " " + message, array_.position);
    }

    EncodedBytes place() const {
        if (array_.attribute("format") == "binary") return {array_.behind, std::find(array_.behind, file_.end(), '<'), true};
        if (!storage_.appended) fail("is appended, but the file has no <AppendedData>: it is truncated");
        const std::string_view text = array_.attribute("offset");
        std::uint64_t offset = 0;
        const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), offset);
        if (error != std::errc() || rest != text.data() + text.size()) fail("has the offset " + quoted(text) + ", which is no number");
        if (offset > std::uint64_t(storage_.end - storage_.appended))
            fail("begins behind the end of the appended data: the file is truncated");
        return {storage_.appended + offset, storage_.end, storage_.appended_base64};
    }

    std::uint64_t head_number(EncodedBytes& bytes) const {
        std::string raw;
        if (!bytes.read(std::uint64_t(storage_.header_bytes), raw)) fail("ends inside its size: the file is truncated, or not base64");
        BinaryScanner scanner(raw, {}, storage_.order);
        return storage_.header_bytes == 4 ? scanner.read<std::uint32_t>("a size") : scanner.read<std::uint64_t>("a size");
    }

    std::string read_plain(EncodedBytes& bytes) const {
        const std::uint64_t size = head_number(bytes);
        std::string out;
        if (!bytes.read(size, out))
            fail("announces " + std::to_string(size) + " bytes, more than there are: the file is truncated, or its header_type is wrong");
        return out;
    }

    std::string read_blocks(EncodedBytes& bytes) const {
        const std::uint64_t blocks = head_number(bytes);
        if (blocks == 0) return {};
        const std::uint64_t size = head_number(bytes), last = head_number(bytes);
        if (blocks > bytes.most_left() / std::uint64_t(storage_.header_bytes))
            fail("announces " + std::to_string(blocks) + " compressed blocks, more than fit: the file is truncated");
        std::vector<std::uint64_t> packed(blocks);
        for (std::uint64_t& n : packed) n = head_number(bytes);
        std::string out, block;
        for (std::uint64_t b = 0; b < blocks; ++b) {
            const std::uint64_t expected = b + 1 == blocks && last != 0 ? last : size;
            block.clear();
            if (!bytes.read(packed[b], block)) fail("ends inside a compressed block: the file is truncated");
            // zlib packs 1032 to 1 at most: a larger promise is a lie, and no memory is given for it.
            if (expected > 1032 * packed[b] + 1024)
                fail("announces a block of " + std::to_string(expected) + " bytes out of " + std::to_string(packed[b]));
            const std::size_t begin = out.size();
            out.resize(begin + std::size_t(expected));
            uLongf written = uLongf(expected);
            const int status = uncompress(reinterpret_cast<Bytef*>(out.data() + begin), &written,
                                          reinterpret_cast<const Bytef*>(block.data()), uLong(block.size()));
            if (status != Z_OK || written != expected) fail("has a block that zlib cannot unpack to its size: the file is damaged");
        }
        return out;
    }

    const TextScanner& file_;
    const VtuStorage& storage_;
    const XmlTag& array_;
};

/// The text of an ASCII array, up to the next tag.
TextScanner ascii_content(const TextScanner& file, const XmlTag& array) {
    const char* end = std::find(array.behind, file.end(), '<');
    return file.part(array.behind, array.empty ? array.behind : end);
}

bool is_ascii(const TextScanner& file, const XmlTag& array) {
    const std::string_view format = array.attribute("format");
    if (format == "ascii" || format.empty()) return true;
    if (format == "binary" || format == "appended") return false;
    file.fail("the format of a data array must be ascii, binary or appended, found " + quoted(format), array.position,
              ErrorCode::unsupported);
}

/// Calls visit(value) for each number, in the array's own type.
template <class Visit>
void for_each_value(const TextScanner& file, const VtuStorage& storage, const XmlTag& array, Visit&& visit) {
    const std::string bytes = ArrayBytes(file, storage, array).read();
    const std::string_view type = array.attribute("type");
    const auto all = [&](auto zero) {
        if (bytes.size() % sizeof zero != 0)
            file.fail("the data array " + quoted(array.attribute("Name")) + " ends inside a number", array.position);
        BinaryScanner scanner(bytes, {}, storage.order);
        while (!scanner.at_end()) visit(scanner.read<decltype(zero)>("a value"));
    };
    if (type == "Int8") return all(std::int8_t());
    if (type == "UInt8") return all(std::uint8_t());
    if (type == "Int16") return all(std::int16_t());
    if (type == "UInt16") return all(std::uint16_t());
    if (type == "Int32") return all(std::int32_t());
    if (type == "UInt32") return all(std::uint32_t());
    if (type == "Int64") return all(std::int64_t());
    if (type == "UInt64") return all(std::uint64_t());
    if (type == "Float32") return all(float());
    if (type == "Float64") return all(double());
    file.fail("the data array has the type " + quoted(type) + "; known are Int8 to UInt64, Float32 and Float64", array.position,
              ErrorCode::unsupported);
}

}  // namespace

VtuStorage read_vtu_storage(const TextScanner& file, std::string_view text, const XmlTag& head) {
    VtuStorage storage;
    storage.order = head.attribute("byte_order") == "BigEndian" ? std::endian::big : std::endian::little;
    storage.header_bytes = head.attribute("header_type") == "UInt64" ? 8 : 4;
    const std::string_view compressor = head.attribute("compressor");
    storage.zlib = compressor == "vtkZLibDataCompressor";
    if (!compressor.empty() && !storage.zlib)
        file.fail("the file is compressed by " + quoted(compressor) + "; only vtkZLibDataCompressor is read: save it with that or without",
                  head.position, ErrorCode::unsupported);
    const std::size_t tag = text.find("<AppendedData");
    const std::size_t behind = tag == std::string_view::npos ? tag : text.find('>', tag);
    if (behind == std::string_view::npos) return storage;
    storage.appended_base64 = text.substr(tag, behind - tag).find("base64") != std::string_view::npos;
    const std::size_t underscore = text.find('_', behind);
    if (underscore == std::string_view::npos) file.fail("the appended data do not begin with an underscore", text.data() + tag);
    storage.appended = text.data() + underscore + 1;
    storage.end = storage.appended_base64 ? std::find(storage.appended, text.data() + text.size(), '<') : text.data() + text.size();
    return storage;
}

Numbers read_vtu_integers(const TextScanner& file, const VtuStorage& storage, const XmlTag& array) {
    Numbers numbers;
    numbers.start = array.position;
    if (is_ascii(file, array)) {
        TextScanner scanner = ascii_content(file, array);
        for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
            numbers.positions.push_back(scanner.position());
            numbers.values.push_back(scanner.integer("an entry of the array"));
        }
        return numbers;
    }
    for_each_value(file, storage, array, [&](auto value) {
        if constexpr (std::is_floating_point_v<decltype(value)>) {
            if (!(std::abs(double(value)) < 9e15)) file.fail("a whole number was expected in this array", array.position);
        } else if constexpr (std::is_same_v<decltype(value), std::uint64_t>) {
            if (value > std::uint64_t(std::numeric_limits<std::int64_t>::max()))
                file.fail("a number of this array is beyond 2^63", array.position);
        }
        numbers.values.push_back(std::int64_t(value));
    });
    return numbers;
}

std::vector<double> read_vtu_reals(const TextScanner& file, const VtuStorage& storage, const XmlTag& array,
                                   std::vector<const char*>& positions) {
    std::vector<double> values;
    if (is_ascii(file, array)) {
        TextScanner scanner = ascii_content(file, array);
        for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
            if (values.size() % 3 == 0) positions.push_back(scanner.position());
            values.push_back(scanner.real("a coordinate of a point"));
        }
        return values;
    }
    for_each_value(file, storage, array, [&](auto value) {
        if (!std::isfinite(double(value))) file.fail("a number of the array is not finite", array.position);
        if (values.size() % 3 == 0) positions.push_back(array.position);
        values.push_back(double(value));
    });
    return values;
}

}  // namespace supple::io
