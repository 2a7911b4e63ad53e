// $ElementData "fill" of Gmsh 2 and 4: VolumeMesh::fill, one value per volume element in the file's order. Other element data is passed over.
#include <limits>

#include "supple/io/binary_scanner.h"
#include "supple/io/gmsh_parts.h"

namespace supple::io {

void read_gmsh_fill(TextScanner& scanner, bool binary, std::endian order, MeshBuilder& builder) {
    constexpr std::int64_t kBig = std::numeric_limits<std::int32_t>::max();
    const auto number = [&](const char* what) {
        scanner.skip_space();
        const std::int64_t value = scanner.integer(what, 0, kBig);
        scanner.end_line(what);
        return value;
    };
    std::string_view title;
    for (std::int64_t i = 0, tags = number("the number of string tags"); i < tags; ++i) {
        const std::string_view line = scanner.rest_of_line();
        if (i == 0) title = line;
        if (scanner.at_end()) break;
    }
    if (title != "\"fill\"") return;
    for (std::int64_t i = 0, tags = number("the number of real tags"); i < tags; ++i) scanner.next_line();
    std::int64_t count = 0;
    for (std::int64_t i = 0, tags = number("the number of integer tags"); i < tags; ++i) {
        const std::int64_t value = number("an integer tag");
        if (i == 1 && value != 1) scanner.fail("the element data \"fill\" must have one component, found " + std::to_string(value));
        if (i == 2) count = value;
    }
    std::vector<double> fill;
    fill.reserve(scanner.plausible(count, 4));
    const char* begin = scanner.position();
    BinaryScanner bytes({begin, scanner.bytes_left()}, scanner.name(), order);
    std::int64_t last = -1;
    for (std::int64_t i = 0; i < count; ++i) {
        if (!binary) scanner.skip_space();
        const std::int64_t id = binary ? bytes.read<std::int32_t>("the element data \"fill\"") : scanner.integer("the element number");
        const double value = binary ? bytes.read<double>("the element data \"fill\"") : scanner.real("the fill of the element");
        if (!binary) scanner.end_line("the fill of the element");
        if (id <= last) scanner.fail("the element data \"fill\" must name the elements in ascending order");
        if (!(value > 0 && value <= 1)) scanner.fail("the fill of element " + std::to_string(id) + " is " + to_text(value) + "; legal is (0, 1]");
        last = id;
        fill.push_back(value);
    }
    builder.set_fill(scanner, begin, std::move(fill));
}

}  // namespace supple::io
