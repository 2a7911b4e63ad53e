#include "supple/io/text_files.h"

#include <charconv>

#include "supple/io/binary_file.h"
#include "supple/io/text_scanner.h"
#include "supple/world/evaluate.h"

namespace supple::io {

namespace {

/// What %.17g prints, whatever the locale.
void append(std::string& text, double value) {
    char digits[40];
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 17).ptr);
}

/// Calls read(scanner) at every line that holds a record, and checks how many there were.
template <class Read>
void for_each_record(std::string_view text, const std::string& name, const char* record, std::optional<std::size_t> expected, Read&& read) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    TextScanner scanner(text, name);
    std::size_t count = 0;
    for (scanner.skip_space(); !scanner.at_end(); scanner.skip_space()) {
        if (*scanner.position() == '#') {
            scanner.next_line();
            continue;
        }
        if (expected && count == *expected)
            scanner.fail("more than the " + std::to_string(*expected) + " lines expected, one per " + record);
        read(scanner);
        ++count;
    }
    if (expected && count != *expected) {
        scanner.fail("the file ends after " + std::to_string(count) + " of the " + std::to_string(*expected) + " lines expected, one per " +
                     record);
    }
}

}  // namespace

std::vector<Vec3> parse_vectors(std::string_view text, const std::string& name, std::optional<std::size_t> expected) {
    std::vector<Vec3> vectors;
    for_each_record(text, name, "vertex", expected, [&](TextScanner& scanner) {
        Vec3 v;
        v[0] = scanner.real("the x component");
        v[1] = scanner.real("the y component");
        v[2] = scanner.real("the z component");
        scanner.end_line("the z component");
        vectors.push_back(v);
    });
    return vectors;
}

std::vector<Voigt> parse_stress(std::string_view text, const std::string& name, std::optional<std::size_t> expected) {
    std::vector<Voigt> stress;
    for_each_record(text, name, "vertex or element", expected, [&](TextScanner& scanner) {
        scanner.real("the von Mises stress");
        Voigt cauchy;
        for (double& component : cauchy) component = scanner.real("a component of the stress");
        scanner.end_line("the six components of the stress");
        stress.push_back(cauchy);
    });
    return stress;
}

std::vector<Vec3> read_vectors(const std::filesystem::path& file, std::optional<std::size_t> expected) {
    return parse_vectors(read_text_file(file), file.string(), expected);
}

std::vector<Voigt> read_stress(const std::filesystem::path& file, std::optional<std::size_t> expected) {
    return parse_stress(read_text_file(file), file.string(), expected);
}

void write_vectors(const std::filesystem::path& file, std::span<const Vec3> vectors) {
    std::string text;
    text.reserve(72 * vectors.size());
    for (const Vec3& v : vectors) {
        for (int axis = 0; axis < 3; ++axis) {
            append(text, v[axis]);
            text += axis < 2 ? ' ' : '\n';
        }
    }
    write_text_file(file, text);
}

void write_stress(const std::filesystem::path& file, std::span<const Voigt> cauchy_pa) {
    std::string text;
    text.reserve(168 * cauchy_pa.size());
    for (const Voigt& cauchy : cauchy_pa) {
        append(text, von_mises(cauchy));
        for (double component : cauchy) {
            text += ' ';
            append(text, component);
        }
        text += '\n';
    }
    write_text_file(file, text);
}

}  // namespace supple::io
