// Gmsh 2.2 and 4.1, as text and as bytes. One writer per version; `Sink` says how a number goes out.
#include <algorithm>
#include <charconv>
#include <span>

#include "supple/io/binary_scanner.h"
#include "supple/io/number_text.h"
#include "supple/io/volume_formats.h"

namespace supple::io {

namespace {

/// Numbers as text, separated by blanks.
class TextSink {
public:
    static constexpr bool kBinary = false;
    explicit TextSink(std::string& out) : out_(out) {}
    void int32(std::int64_t value) { whole(value); }
    void size(std::int64_t value) { whole(value); }
    void real(double value) {
        separate();
        char digits[40];
        out_.append(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 17).ptr);
    }
    void end_line() { out_ += '\n'; }
    void end_section() {}

private:
    void whole(std::int64_t value) {
        separate();
        append(out_, value);
    }
    void separate() {
        if (!out_.empty() && out_.back() != '\n') out_ += ' ';
    }
    std::string& out_;
};

/// Numbers as bytes; lines mean nothing, but each section ends one.
class ByteSink {
public:
    static constexpr bool kBinary = true;
    explicit ByteSink(std::string& out) : out_(out), bytes_(out) {}
    void int32(std::int64_t value) { bytes_.add(std::int32_t(value)); }
    void size(std::int64_t value) { bytes_.add(std::uint64_t(value)); }
    void real(double value) { bytes_.add(value); }
    void end_line() {}
    void end_section() { out_ += '\n'; }

private:
    std::string& out_;
    BinaryText bytes_;
};

std::string head(const char* version, bool binary) {
    std::string text = std::string("$MeshFormat\n") + version + (binary ? " 1 8\n" : " 0 8\n");
    if (binary) {
        BinaryText(text).add(std::int32_t(1));
        text += '\n';
    }
    return text + "$EndMeshFormat\n";
}

void append_names(std::string& text, const VolumeMesh& mesh, const std::vector<int>& tags) {
    if (mesh.regions.empty() && mesh.groups.empty()) return;
    text += "$PhysicalNames\n" + std::to_string(mesh.regions.size() + mesh.groups.size()) + "\n";
    for (std::size_t g = 0; g < mesh.groups.size(); ++g) text += "0 " + std::to_string(g + 1) + " \"" + mesh.groups[g].name + "\"\n";
    for (std::size_t r = 0; r < tags.size(); ++r) text += "3 " + std::to_string(tags[r]) + " \"" + mesh.regions[r].name + "\"\n";
    text += "$EndPhysicalNames\n";
}

/// Calls visit(type, tag, vertices) for each element, then for each vertex of each group; tag 0 is none.
template <class Visit>
void for_each_record(const VolumeMesh& mesh, Visit&& visit) {
    const std::vector<int> tags = element_tags(mesh);
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) visit(4, tags[e], std::span<const std::int32_t>(mesh.tets[e]));
    for (std::size_t e = 0; e < mesh.hexes.size(); ++e) visit(5, tags[mesh.tets.size() + e], std::span<const std::int32_t>(mesh.hexes[e]));
    for (std::size_t g = 0; g < mesh.groups.size(); ++g)
        for (const std::int32_t& v : mesh.groups[g].vertices) visit(15, int(g) + 1, std::span<const std::int32_t>(&v, 1));
}

std::size_t record_count(const VolumeMesh& mesh) {
    std::size_t count = mesh.element_count();
    for (const VertexGroup& group : mesh.groups) count += group.vertices.size();
    return count;
}

/// A run of records of one type and tag.
struct Run {
    int type, tag;
    std::size_t count;
};

std::vector<Run> runs_of(const VolumeMesh& mesh) {
    std::vector<Run> runs;
    for_each_record(mesh, [&](int type, int tag, std::span<const std::int32_t>) {
        if (runs.empty() || runs.back().type != type || runs.back().tag != tag) runs.push_back({type, tag, 0});
        ++runs.back().count;
    });
    return runs;
}

/// VolumeMesh::fill as element data; elements are numbered from 1 in both versions.
template <class Sink>
void append_fill(std::string& text, const VolumeMesh& mesh) {
    if (mesh.fill.empty()) return;
    text += "$ElementData\n1\n\"fill\"\n1\n0\n3\n0\n1\n" + std::to_string(mesh.fill.size()) + "\n";
    Sink sink(text);
    for (std::size_t e = 0; e < mesh.fill.size(); ++e) {
        sink.int32(std::int64_t(e) + 1);
        sink.real(mesh.fill[e]);
        sink.end_line();
    }
    sink.end_section();
    text += "$EndElementData\n";
}

template <class Sink>
std::string format_version2(const VolumeMesh& mesh) {
    require_writable_mesh(mesh, "write_mesh");
    std::string text = head("2.2", Sink::kBinary);
    text.reserve(64 * mesh.vertices.size() + 48 * mesh.element_count());
    append_names(text, mesh, region_tags(mesh));
    text += "$Nodes\n" + std::to_string(mesh.vertices.size()) + "\n";
    Sink sink(text);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        sink.int32(std::int64_t(i) + 1);
        for (int axis = 0; axis < 3; ++axis) sink.real(mesh.vertices[i][axis]);
        sink.end_line();
    }
    sink.end_section();
    text += "$EndNodes\n$Elements\n" + std::to_string(record_count(mesh)) + "\n";
    const std::vector<Run> runs = runs_of(mesh);
    std::size_t run = 0, left = 0;
    std::int64_t number = 0;
    for_each_record(mesh, [&](int type, int tag, std::span<const std::int32_t> vertices) {
        if (Sink::kBinary && left == 0) {
            left = runs[run].count;
            sink.int32(type);
            sink.int32(std::int64_t(runs[run++].count));
            sink.int32(2);
        }
        if (Sink::kBinary) --left;
        sink.int32(++number);
        if (!Sink::kBinary) {
            sink.int32(type);
            sink.int32(2);
        }
        sink.int32(tag);
        sink.int32(tag > 0 ? tag : 1);
        for (const std::int32_t v : vertices) sink.int32(std::int64_t(v) + 1);
        sink.end_line();
    });
    sink.end_section();
    text += "$EndElements\n";
    append_fill<Sink>(text, mesh);
    return text;
}

/// Entities: a point per group, and a volume per region, tag 0 standing for none. They say nothing of the shape but its box.
template <class Sink>
void append_entities(std::string& text, const VolumeMesh& mesh, const std::vector<int>& tags) {
    const std::vector<int> of_elements = element_tags(mesh);
    const bool has_rest = std::find(of_elements.begin(), of_elements.end(), 0) != of_elements.end();
    Vec3 low = mesh.vertices.empty() ? Vec3(Vec3::Zero()) : mesh.vertices[0], high = low;
    for (const Vec3& x : mesh.vertices) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    text += "$Entities\n";
    Sink sink(text);
    sink.size(std::int64_t(mesh.groups.size()));
    sink.size(0);
    sink.size(0);
    sink.size(std::int64_t(tags.size()) + has_rest);
    sink.end_line();
    for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
        const auto& list = mesh.groups[g].vertices;
        const Vec3 x = list.empty() ? low : mesh.vertices[std::size_t(list.front())];
        sink.int32(std::int64_t(g) + 1);
        for (int axis = 0; axis < 3; ++axis) sink.real(x[axis]);
        sink.size(1);
        sink.int32(std::int64_t(g) + 1);
        sink.end_line();
    }
    const auto add_volume = [&](int tag, bool physical) {
        sink.int32(tag);
        for (int axis = 0; axis < 3; ++axis) sink.real(low[axis]);
        for (int axis = 0; axis < 3; ++axis) sink.real(high[axis]);
        sink.size(physical ? 1 : 0);
        if (physical) sink.int32(tag);
        sink.size(0);
        sink.end_line();
    };
    for (const int tag : tags) add_volume(tag, true);
    if (has_rest) add_volume(0, false);
    sink.end_section();
    text += "$EndEntities\n";
}

template <class Sink>
std::string format_version4(const VolumeMesh& mesh) {
    require_writable_mesh(mesh, "write_mesh");
    const std::vector<int> tags = region_tags(mesh);
    std::string text = head("4.1", Sink::kBinary);
    text.reserve(64 * mesh.vertices.size() + 48 * mesh.element_count());
    append_names(text, mesh, tags);
    append_entities<Sink>(text, mesh, tags);
    const std::vector<Run> runs = runs_of(mesh);
    const int home = runs.empty() || runs[0].type == 15 ? 0 : runs[0].tag;  // the volume that the nodes are booked under
    const auto vertices = std::int64_t(mesh.vertices.size());
    text += "$Nodes\n";
    Sink sink(text);
    for (const std::int64_t number : {std::int64_t(1), vertices, std::int64_t(1), vertices}) sink.size(number);
    sink.end_line();
    for (const int number : {3, home, 0}) sink.int32(number);
    sink.size(vertices);
    sink.end_line();
    for (std::int64_t i = 1; i <= vertices; ++i) {
        sink.size(i);
        sink.end_line();
    }
    for (const Vec3& x : mesh.vertices) {
        for (int axis = 0; axis < 3; ++axis) sink.real(x[axis]);
        sink.end_line();
    }
    sink.end_section();
    text += "$EndNodes\n$Elements\n";
    const auto records = std::int64_t(record_count(mesh));
    for (const std::int64_t number : {std::int64_t(runs.size()), records, std::int64_t(1), records}) sink.size(number);
    sink.end_line();
    std::size_t run = 0, left = 0;
    std::int64_t number = 0;
    for_each_record(mesh, [&](int type, int tag, std::span<const std::int32_t> corners) {
        if (left == 0) {
            left = runs[run++].count;
            for (const int entry : {type == 15 ? 0 : 3, tag, type}) sink.int32(entry);
            sink.size(std::int64_t(left));
            sink.end_line();
        }
        --left;
        sink.size(++number);
        for (const std::int32_t v : corners) sink.size(std::int64_t(v) + 1);
        sink.end_line();
    });
    sink.end_section();
    text += "$EndElements\n";
    append_fill<Sink>(text, mesh);
    return text;
}

}  // namespace

std::string format_gmsh22(const VolumeMesh& mesh) { return format_version2<TextSink>(mesh); }
std::string format_gmsh22_binary(const VolumeMesh& mesh) { return format_version2<ByteSink>(mesh); }
std::string format_gmsh41(const VolumeMesh& mesh) { return format_version4<TextSink>(mesh); }
std::string format_gmsh41_binary(const VolumeMesh& mesh) { return format_version4<ByteSink>(mesh); }

}  // namespace supple::io
