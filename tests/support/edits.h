#pragma once
// What must hold after every edit of a mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "../mesh_helpers.h"
#include "supple/mesh/mesh_edit.h"
#include "supple/mesh/quality.h"
#include "supple/mesh/topology.h"

namespace supple::test {

/// A blade across x, endless along z.
inline mesh::TriangleMesh blade_at_x(double x, double low_y = -10, double high_y = 10) {
    return swept_blade(std::vector<Vec3>{{x, low_y, -10}, {x, low_y, 10}}, std::vector<Vec3>{{x, high_y, -10}, {x, high_y, 10}});
}

inline double element_volume(const VolumeMesh& m, std::size_t e) {
    if (e < m.tets.size()) {
        const Tet& t = m.tets[e];
        return tet_volume(m.vertices[std::size_t(t[0])], m.vertices[std::size_t(t[1])], m.vertices[std::size_t(t[2])], m.vertices[std::size_t(t[3])]);
    }
    std::array<Vec3, 8> x;
    for (std::size_t a = 0; a < 8; ++a) x[a] = m.vertices[std::size_t(m.hexes[e - m.tets.size()][a])];
    return hex_volume(x);
}

inline double total_volume(const VolumeMesh& m) {
    double v = 0;
    for (std::size_t e = 0; e < m.element_count(); ++e) v += element_volume(m, e);
    return v;
}

/// Maps that fit one another and the meshes; rest positions that are those of the parents; volumes that are the parents' shares.
/// @param several  edits, composed: parts of an element may have been erased
inline void expect_consistent(const VolumeMesh& before, const MeshEdit& edit, bool several = false) {
    const TopologyDelta& d = edit.delta;
    const VolumeMesh& m = edit.mesh;
    ASSERT_EQ(d.vertex_to_new.size(), before.vertices.size());
    ASSERT_EQ(d.element_to_new.size(), before.element_count());
    ASSERT_EQ(d.vertex_parents.size(), m.vertices.size());
    ASSERT_EQ(d.element_parent.size(), m.element_count());
    ASSERT_EQ(d.element_share.size(), m.element_count());
    ASSERT_EQ(m.element_region.size(), before.element_region.empty() ? 0 : m.element_count());
    std::int32_t last = -1;
    for (std::size_t v = 0; v < before.vertices.size(); ++v) {
        const std::int32_t now = d.vertex_to_new[v];
        if (now < 0) continue;
        ASSERT_GT(now, last) << "kept vertices keep their order";
        last = now;
        ASSERT_EQ(d.vertex_parents[std::size_t(now)].vertex[0], std::int32_t(v));
        ASSERT_EQ(d.vertex_parents[std::size_t(now)].weight[0], 1.0);
    }
    for (std::size_t v = 0; v < m.vertices.size(); ++v) {
        Vec3 x = Vec3::Zero();
        double sum = 0;
        for (std::size_t k = 0; k < 4 && d.vertex_parents[v].vertex[k] >= 0; ++k) {
            ASSERT_LT(std::size_t(d.vertex_parents[v].vertex[k]), before.vertices.size());
            ASSERT_GT(d.vertex_parents[v].weight[k], 0.0);
            x += d.vertex_parents[v].weight[k] * before.vertices[std::size_t(d.vertex_parents[v].vertex[k])];
            sum += d.vertex_parents[v].weight[k];
        }
        ASSERT_NEAR(sum, 1, 1e-12);
        ASSERT_LT((x - m.vertices[v]).norm(), 1e-12 * (1 + x.norm()));
    }
    std::vector<double> share(before.element_count(), 0.0);
    std::vector<char> used(m.vertices.size(), 0);
    for (std::size_t e = 0; e < m.element_count(); ++e) {
        const auto parent = std::size_t(d.element_parent[e]);
        ASSERT_LT(parent, before.element_count());
        ASSERT_EQ(parent < before.tets.size(), e < m.tets.size());
        ASSERT_NEAR(element_volume(m, e), d.element_share[e] * element_volume(before, parent), 1e-12 * element_volume(before, parent));
        share[parent] += d.element_share[e];
        const auto mark = [&](const auto& ids) {
            for (const std::int32_t v : ids) used[std::size_t(v)] = 1;
        };
        if (e < m.tets.size()) mark(m.tets[e]); else mark(m.hexes[e - m.tets.size()]);
    }
    ASSERT_TRUE(std::all_of(used.begin(), used.end(), [](char u) { return u != 0; })) << "a vertex without elements";
    for (std::size_t e = 0; e < share.size(); ++e) {
        const std::int32_t now = d.element_to_new[e];
        if (now >= 0) {
            ASSERT_EQ(d.element_parent[std::size_t(now)], std::int32_t(e));
            ASSERT_EQ(d.element_share[std::size_t(now)], 1.0);
            ASSERT_EQ(share[e], 1.0);
        }
        ASSERT_TRUE(share[e] == 0 || (several && share[e] < 1) || std::abs(share[e] - 1) < 1e-12) << "element " << e << " lives on in part: " << share[e];
    }
}

/// No face of more than two elements, boundary closed, oriented and of single fans.
inline void expect_manifold(const VolumeMesh& m) {
    std::size_t crowded = 0;
    for_each_face(m, [&](std::span<const HalfFace> sides) { crowded += sides.size() > 2; });
    ASSERT_EQ(crowded, 0u);
    const BoundarySurface boundary = extract_boundary(m);
    ASSERT_TRUE(supple_test::closed_and_oriented(boundary));
    ASSERT_NEAR(supple_test::enclosed_volume(boundary, m), total_volume(m), 1e-10 * total_volume(m));
}

}  // namespace supple::test
