#include "supple/mesh/box_mesh.h"

#include <cmath>
#include <limits>

#include "supple/base/error.h"

namespace supple {
namespace {

void check(const BoxDef& def, int elements_per_cell) {
    double vertices = 1, elements = elements_per_cell;
    for (int k = 0; k < 3; ++k) {
        const std::string axis(1, "xyz"[k]);
        if (def.cells[k] < 1)
            throw Error(ErrorCode::invalid_argument, "BoxDef.cells",
                        std::to_string(def.cells[k]) + " cells along " + axis + "; give at least 1");
        if (!std::isfinite(def.min_m[k]) || !std::isfinite(def.max_m[k]) || !(def.min_m[k] < def.max_m[k]) ||
            !std::isfinite(def.max_m[k] - def.min_m[k]))
            throw Error(ErrorCode::invalid_argument, "BoxDef.max_m",
                        axis + " runs from " + to_text(def.min_m[k]) + " to " + to_text(def.max_m[k]) + " m; give finite min < max");
        vertices *= def.cells[k] + 1.0;
        elements *= def.cells[k];
    }
    if (std::max(vertices, elements) > std::numeric_limits<std::int32_t>::max())
        throw Error(ErrorCode::invalid_argument, "BoxDef.cells",
                    "the box would have " + to_text(vertices) + " vertices and " + to_text(elements) +
                        " elements; at most 2147483647 of each, use fewer cells");
}

std::vector<Vec3> grid_vertices(const BoxDef& def) {
    std::array<std::vector<double>, 3> along;
    for (int k = 0; k < 3; ++k) {
        const double h = (def.max_m[k] - def.min_m[k]) / def.cells[k];
        for (int i = 0; i < def.cells[k]; ++i) along[k].push_back(def.min_m[k] + i * h);
        along[k].push_back(def.max_m[k]);  // exact, so that a selection up to max_m holds the last layer
    }
    std::vector<Vec3> x;
    x.reserve(along[0].size() * along[1].size() * along[2].size());
    for (const double z : along[2])
        for (const double y : along[1])
            for (const double xx : along[0]) x.emplace_back(xx, y, z);
    return x;
}

/// Calls visit(corners in VTK order) for every cell, x fastest.
template <class Visit>
void for_each_cell(const BoxDef& def, Visit visit) {
    const std::int32_t row = def.cells[0] + 1, layer = row * (def.cells[1] + 1);
    for (int k = 0; k < def.cells[2]; ++k)
        for (int j = 0; j < def.cells[1]; ++j)
            for (int i = 0; i < def.cells[0]; ++i) {
                const std::int32_t v = i + row * j + layer * k;
                visit(Hex{v, v + 1, v + row + 1, v + row, v + layer, v + layer + 1, v + layer + row + 1, v + layer + row});
            }
}

VolumeMesh start_mesh(const BoxDef& def, const char* kind) {
    VolumeMesh mesh;
    mesh.vertices = grid_vertices(def);
    mesh.source =
        "box of " + std::to_string(def.cells[0]) + "x" + std::to_string(def.cells[1]) + "x" + std::to_string(def.cells[2]) + " " + kind;
    return mesh;
}

/// The six walks from corner 0 to corner 6 along the three axes, wound for positive volume.
constexpr std::array<std::array<int, 4>, 6> kKuhnTets{{{0, 1, 2, 6}, {0, 5, 1, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 4, 5, 6}, {0, 7, 4, 6}}};

}  // namespace

VolumeMesh make_tet_box(const BoxDef& def) {
    check(def, 6);
    VolumeMesh mesh = start_mesh(def, "tet cells");
    mesh.tets.reserve(6 * static_cast<std::size_t>(def.cells[0]) * def.cells[1] * def.cells[2]);
    for_each_cell(def, [&](const Hex& c) {
        for (const auto& t : kKuhnTets) mesh.tets.push_back({c[t[0]], c[t[1]], c[t[2]], c[t[3]]});
    });
    return mesh;
}

VolumeMesh make_hex_box(const BoxDef& def) {
    check(def, 1);
    VolumeMesh mesh = start_mesh(def, "hexes");
    mesh.hexes.reserve(static_cast<std::size_t>(def.cells[0]) * def.cells[1] * def.cells[2]);
    for_each_cell(def, [&](const Hex& c) { mesh.hexes.push_back(c); });
    return mesh;
}

}  // namespace supple
