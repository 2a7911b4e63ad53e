#include "one_input.h"

#include <cstdlib>
#include <string>

#include "supple/base/error.h"
#include "supple/io/mesh_builder.h"
#include "supple/io/mesh_formats.h"
#include "supple/io/volume_formats.h"

namespace supple::fuzz {

namespace {

void require(bool good) {
    if (!good) std::abort();
}

void check(const VolumeMesh& mesh) {
    const auto in_range = [&](std::int32_t v) { return v >= 0 && std::size_t(v) < mesh.vertices.size(); };
    require(mesh.element_count() > 0);
    for (const Vec3& x : mesh.vertices) require(x.allFinite());
    for (const Tet& tet : mesh.tets)
        for (std::int32_t v : tet) require(in_range(v));
    for (const Hex& hex : mesh.hexes)
        for (std::int32_t v : hex) require(in_range(v));
    require(mesh.element_region.size() == (mesh.regions.empty() ? 0 : mesh.element_count()));
    for (std::int32_t r : mesh.element_region) require(r >= -1 && r < std::int32_t(mesh.regions.size()));
    for (const VertexGroup& group : mesh.groups)
        for (std::int32_t v : group.vertices) require(in_range(v));
}

void check(const mesh::TriangleMesh& mesh) {
    require(!mesh.triangles.empty());
    for (const Vec3& x : mesh.vertices) require(x.allFinite());
    for (const Triangle& t : mesh.triangles)
        for (std::int32_t v : t) require(v >= 0 && std::size_t(v) < mesh.vertices.size());
}

template <class Read>
int attempt(Read&& read) {
    try {
        check(read());
        return 1;
    } catch (const Error& error) {
        require(error.message().size() > 0 && error.where().size() > 0);
        return 0;
    }
}

}  // namespace

int read_as_everything(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const io::MeshSource source{bytes, "fuzz", {}};
    int accepted = 0;
    for (const io::InputFormat& format : io::input_formats()) {
        if (format.key == "gltf") continue;  // assimp's, not ours
        if (format.read_surface) accepted += attempt([&] { return format.read_surface(source); });
        if (!format.read || format.key == "tetgen") continue;
        accepted += attempt([&] {
            io::MeshBuilder builder;
            format.read(source, builder);
            return builder.finish(source.name);
        });
        accepted += attempt([&] {
            io::MeshBuilder builder;
            format.read(source, builder);
            return builder.finish_surface(source.name);
        });
    }
    // TetGen's two files, cut at a line of its own.
    const std::size_t cut = bytes.find("\n--\n");
    if (cut != std::string_view::npos)
        accepted += attempt([&] {
            io::MeshBuilder builder;
            io::read_tetgen({bytes.substr(cut + 4), "fuzz.ele", {}}, bytes.substr(0, cut), "fuzz.node", builder);
            return builder.finish("fuzz.ele");
        });
    return accepted;
}

}  // namespace supple::fuzz
