// Gmsh files: the sections, their order, and the small ones; nodes and elements are read by gmsh_msh2, gmsh_msh4 and gmsh_binary.

#include <cstdlib>
#include <limits>

#include "supple/io/binary_scanner.h"
#include "supple/io/gmsh_parts.h"
#include "supple/io/volume_formats.h"

namespace supple::io {

namespace {

struct Section {
    std::string_view name;  ///< without the dollar
    const char* begin;      ///< behind the head line
    const char* end;        ///< start of the $End line
};

/// Finds the line "$<closing>" from `from` on; end of the text if there is none. Behind bytes it need not begin a line.
const char* find_closing(std::string_view text, const char* from, const std::string& closing, bool binary) {
    const std::string wanted = "$" + closing;
    std::size_t at = std::size_t(from - text.data());
    while ((at = text.find(wanted, at)) != std::string_view::npos) {
        const std::size_t behind = at + wanted.size();
        const bool starts_line = at == 0 || text[at - 1] == '\n';
        if ((starts_line || binary) && (behind == text.size() || is_blank(text[behind]) || text[behind] == '\n')) return text.data() + at;
        at = behind;
    }
    return text.data() + text.size();
}

/// Cuts the file into its sections, whatever they are called, so that they can be read in the order in which they need each other.
std::vector<Section> find_sections(std::string_view text, TextScanner scanner) {
    std::vector<Section> sections;
    bool binary = false;
    for (;;) {
        scanner.skip_space();
        if (scanner.at_end()) return sections;
        const char* head = scanner.position();
        const std::string_view title = scanner.word();
        if (title.size() < 2 || title[0] != '$') scanner.fail("a section such as $Nodes must begin here, found " + quoted(title), head);
        const std::string_view name = title.substr(1);
        if (name.substr(0, 3) == "End" || name.substr(0, 3) == "END")
            scanner.fail(quoted(title) + " ends a section that was not begun", head);
        scanner.end_line(title);
        const bool version1 = name == "NOD" || name == "ELM";
        const std::string closing = (version1 ? "END" : "End") + std::string(name);
        if (name == "MeshFormat") {
            TextScanner line = scanner;
            line.skip_space();
            line.word();
            binary = line.word() == "1";
        }
        const char* end = find_closing(text, scanner.position(), closing, binary);
        sections.push_back({name, scanner.position(), end});
        scanner.seek(end);
        if (scanner.at_end()) {
            // The readers find out more precisely where a truncated list stops; a section nobody reads is reported here.
            if (sections.size() < 2 || (name != "Nodes" && name != "Elements" && !version1)) {
                scanner.fail("section " + std::string(title) + " has no $" + closing + ": the file is truncated", head);
            }
            return sections;
        }
        scanner.next_line();
    }
}

const Section* find(const TextScanner& scanner, const std::vector<Section>& sections, std::string_view name) {
    const Section* found = nullptr;
    for (const Section& section : sections) {
        if (section.name != name) continue;
        if (found) scanner.fail("a second $" + std::string(name) + " section; only one is allowed", section.begin - 1);
        found = &section;
    }
    return found;
}

/// Reads one section to its very end with `read`.
template <class Read>
void read_section(const TextScanner& file, const Section& section, Read&& read) {
    TextScanner scanner = file.part(section.begin, section.end);
    read(scanner);
    scanner.skip_space();
    if (!scanner.at_end()) scanner.fail("section $" + std::string(section.name) + " holds more than its counts announce");
    if (section.end == file.end()) scanner.fail("section $" + std::string(section.name) + " is not closed: the file is truncated");
}

struct Format {
    int version = 1;  ///< the major one
    bool binary = false;
    std::endian order = std::endian::native;
};

/// The version, after refusing what this reader does not do. Of a binary file the number 1 follows, stored in its byte order.
Format read_format(TextScanner& scanner) {
    scanner.skip_space();
    const char* line = scanner.position();
    Format format;
    const double version = scanner.real("the version number");
    const std::int64_t file_type = scanner.integer("the file type (0 = ASCII, 1 = binary)");
    if (file_type != 0 && file_type != 1)
        scanner.fail("the file type must be 0 (ASCII) or 1 (binary), found " + std::to_string(file_type), line);
    const bool is_version2 = version >= 2 && version < 3;
    if (!is_version2 && !(version > 4.05 && version < 4.15)) {
        scanner.fail("Gmsh format version " + to_text(version) +
                         " is not read; versions 1, 2.2 and 4.1 are: save it again with Mesh.MshFileVersion = 4.1",
                     line, ErrorCode::unsupported);
    }
    format.version = is_version2 ? 2 : 4;
    format.binary = file_type == 1;
    const std::int64_t size = scanner.integer("the data size");
    if (!format.binary) return format;
    if (size != 8) scanner.fail("binary Gmsh files have a data size of 8, found " + std::to_string(size), line, ErrorCode::unsupported);
    scanner.next_line();
    if (scanner.bytes_left() < 4) scanner.fail("the number that tells the byte order is missing: the file is truncated");
    std::int32_t one = 0;
    std::memcpy(&one, scanner.position(), 4);
    if (one != 1 && swap_bytes(one) != 1) scanner.fail("the number that tells the byte order is neither 1 nor 1 turned round");
    if (one != 1) format.order = std::endian::native == std::endian::little ? std::endian::big : std::endian::little;
    scanner.seek(scanner.position() + 4);
    return format;
}

void read_names(TextScanner& scanner, MeshBuilder& builder) {
    scanner.skip_space();
    const std::int64_t count = scanner.integer("the number of physical names", 0, std::numeric_limits<std::int64_t>::max());
    scanner.end_line("the number of physical names");
    for (std::int64_t i = 0; i < count; ++i) {
        scanner.skip_space();
        const int dimension = int(scanner.integer("the dimension of the physical group", 0, 3));
        const std::int64_t tag =
            scanner.integer("the tag of the physical group", std::numeric_limits<int>::min() + 1, std::numeric_limits<int>::max());
        const char* line = scanner.position();
        std::string_view name = scanner.rest_of_line();
        if (name.size() < 3 || name.front() != '"' || name.back() != '"')
            scanner.fail("the name of the physical group must stand in quotes", line);
        builder.name_group(dimension, std::abs(tag), std::string(name.substr(1, name.size() - 2)));
    }
}

}  // namespace

void read_gmsh(const MeshSource& source, MeshBuilder& builder) {
    TextScanner file(source.bytes, source.name);
    const std::vector<Section> sections = find_sections(source.bytes, file);
    const auto section = [&](std::string_view title) { return find(file, sections, title); };

    Format format;
    if (const Section* head = section("MeshFormat")) {
        read_section(file, *head, [&](TextScanner& scanner) { format = read_format(scanner); });
        if (format.binary) file.set_binary_from(head->begin);
    } else if (!section("NOD") && !section("ELM")) {
        file.fail("neither $MeshFormat (Gmsh 2 and 4) nor $NOD and $ELM (Gmsh 1) are there: this is no Gmsh mesh");
    }
    const int version = format.version;
    const bool version1 = version == 1;
    const Section* nodes = section(version1 ? "NOD" : "Nodes");
    const Section* parametric = version == 2 ? section("ParametricNodes") : nullptr;
    const Section* elements = section(version1 ? "ELM" : "Elements");
    if (!nodes && !parametric) file.fail(version1 ? "section $NOD is missing" : "section $Nodes is missing");
    if (!elements) file.fail(version1 ? "section $ELM is missing" : "section $Elements is missing");
    if (const Section* partitioned = section("PartitionedEntities")) {
        file.fail("this Gmsh file is partitioned; save it without partitions (in Gmsh: Mesh > Unpartition)", partitioned->begin - 1,
                  ErrorCode::unsupported);
    }
    if (format.binary && parametric)
        file.fail("binary files with parametric nodes are not read; save it without them, or as ASCII", parametric->begin - 1, ErrorCode::unsupported);

    if (const Section* names = section("PhysicalNames")) read_section(file, *names, [&](TextScanner& s) { read_names(s, builder); });
    GmshEntities entities;
    if (const Section* list = version == 4 ? section("Entities") : nullptr) {
        read_section(file, *list, [&](TextScanner& s) {
            entities = format.binary ? read_gmsh4_entities_binary(s, format.order) : read_gmsh4_entities(s);
        });
    }
    for (const Section* list : {nodes, parametric}) {
        if (!list) continue;
        read_section(file, *list, [&](TextScanner& s) {
            if (format.binary) return version == 4 ? read_gmsh4_nodes_binary(s, format.order, builder) : read_gmsh2_nodes_binary(s, format.order, builder);
            version == 4 ? read_gmsh4_nodes(s, builder) : read_gmsh2_nodes(s, builder, list == parametric);
        });
    }
    builder.close_vertices(file);
    read_section(file, *elements, [&](TextScanner& s) {
        if (format.binary)
            return version == 4 ? read_gmsh4_elements_binary(s, format.order, builder, entities)
                                : read_gmsh2_elements_binary(s, format.order, builder);
        version == 4 ? read_gmsh4_elements(s, builder, entities) : read_gmsh2_elements(s, builder, version1);
    });
    for (const Section& data : sections) {
        if (data.name != "ElementData") continue;
        TextScanner scanner = file.part(data.begin, data.end);
        read_gmsh_fill(scanner, format.binary, format.order, builder);
    }
}

}  // namespace supple::io
