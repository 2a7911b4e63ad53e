// Edits of meshes alone: maps, volumes, quality, closed surfaces.
#include "support/bodies.h"
#include "support/edits.h"
#include "supple/mesh/embedding.h"
#include "supple/mesh/mesh_grow.h"

namespace supple {
namespace {

using test::expect_consistent;
using test::expect_manifold;
using test::total_volume;

mesh::TriangleMesh plane_blade(const Vec3& centre, const Mat3& turn, double half_width, double half_height) {
    const Vec3 u = turn.col(0) * half_width, v = turn.col(1) * half_height;
    const std::vector<Vec3> from{centre - u - v, centre + u - v}, to{centre - u + v, centre + u + v};
    return swept_blade(from, to);
}

VolumeMesh shaken_tets(std::array<int, 3> cells, std::uint64_t seed, double shake) {
    VolumeMesh m = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3(cells[0], cells[1], cells[2]), .cells = cells});
    test::Random random(seed);
    for (Vec3& x : m.vertices) x += random.vector(shake);
    return m;
}

/// The meshes of the random edits: tets from regular to badly shaken, hexes, both.
VolumeMesh edit_mesh(int kind) {
    switch (kind) {
        case 0: return shaken_tets({4, 4, 4}, 1, 0);
        case 1: return shaken_tets({5, 4, 3}, 2, 0.12);
        case 2: return shaken_tets({8, 3, 2}, 3, 0.15);
        case 3: return shaken_tets({6, 6, 1}, 4, 0.1);
        case 4: return shaken_tets({3, 3, 6}, 5, 0.05);
        case 5: return shaken_tets({7, 2, 2}, 6, 0.12);
        case 6: return shaken_tets({10, 1, 1}, 7, 0.1);
        case 7: return make_hex_box({.min_m = Vec3::Zero(), .max_m = {4, 4, 4}, .cells = {4, 4, 4}});
        case 8: return make_hex_box({.min_m = Vec3::Zero(), .max_m = {6, 3, 3}, .cells = {6, 3, 3}});
        default: return make_hex_box({.min_m = Vec3::Zero(), .max_m = {7, 5, 2}, .cells = {7, 5, 2}});
    }
}

Box bounds(const VolumeMesh& m) {
    Box box;
    for (const Vec3& x : m.vertices) box.include(x);
    return box;
}

/// One random cut, tear or erasure of the mesh as it now is.
MeshEdit random_edit(const VolumeMesh& m, test::Random& random) {
    const Box box = bounds(m);
    const Vec3 size = box.max_m - box.min_m;
    const Vec3 centre = box.min_m + Vec3(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)).cwiseProduct(size);
    const double kind = random.uniform(0, 1);
    if (kind < 0.6) {
        std::vector<Vec3> x = m.vertices;  // where the body is when the blade comes: turned and stretched
        Mat3 F = random.rotation() + random.matrix(0.1);
        if (F.determinant() < 0) F = Mat3::Identity();
        for (Vec3& p : x) p = F * p;
        const double reach = size.norm() * random.uniform(0.1, 0.8);
        return cut(m, x, plane_blade(F * centre, random.rotation(), reach, reach * random.uniform(0.3, 1)));
    }
    std::vector<std::int32_t> chosen;
    const double radius = size.norm() * random.uniform(0.05, 0.2);
    for (std::size_t e = 0; e < m.element_count(); ++e) {
        Vec3 c = Vec3::Zero();
        const auto ids = element_vertices(m, e);
        for (const std::int32_t v : ids) c += m.vertices[std::size_t(v)] / double(ids.size());
        if ((c - centre).norm() < radius) chosen.push_back(std::int32_t(e));
    }
    if (kind < 0.8) {
        std::vector<ElementFace> faces;
        for (const std::int32_t e : chosen) faces.push_back({e, int(random.uniform(0, e < std::int32_t(m.tets.size()) ? 4 : 6))});
        return separate_faces(m, faces);
    }
    if (2 * chosen.size() > m.element_count()) chosen.resize(1);
    return remove_elements(m, chosen);
}

constexpr double kLeastRatio = 0.05;

/// What random edits did.
struct EditCounts {
    std::size_t opened = 0, glued = 0, pinched = 0, filled = 0, refused = 0;
};

/// After heal() and add_elements(): what was stays, at its place.
void expect_kept(const VolumeMesh& before, const MeshEdit& edit) {
    ASSERT_EQ(edit.delta.vertex_to_new.size(), before.vertices.size());
    for (std::size_t v = 0; v < before.vertices.size(); ++v) {
        const std::int32_t now = edit.delta.vertex_to_new[v];
        ASSERT_GE(now, 0);
        ASSERT_EQ(edit.mesh.vertices[std::size_t(now)], before.vertices[v]);
        const auto& p = edit.delta.vertex_parents[std::size_t(now)].vertex;
        ASSERT_TRUE(std::find(p.begin(), p.end(), std::int32_t(v)) != p.end());
    }
    for (std::size_t e = 0; e < before.element_count(); ++e) {
        const std::int32_t now = edit.delta.element_to_new[e];
        ASSERT_GE(now, 0);
        const auto was = element_vertices(before, e), is = element_vertices(edit.mesh, now);
        for (std::size_t a = 0; a < was.size(); ++a) ASSERT_EQ(is[a], edit.delta.vertex_to_new[std::size_t(was[a])]);
    }
    expect_manifold(edit.mesh);
}

/// Lips of `m` in a random ball, some of them too far apart, are glued.
MeshEdit random_heal(const VolumeMesh& m, test::Random& random, EditCounts& counts) {
    std::vector<Vec3> x = m.vertices;
    for (Vec3& p : x) p += random.vector(0.05);
    const std::vector<double> weight(x.size(), 1.0);
    HealReport report;
    MeshEdit edit = heal(m, x, weight, {.gap_m = random.uniform(0.03, 0.2), .centre_m = x[std::size_t(random.uniform(0, double(x.size())))], .radius_m = random.uniform(0.5, 6)}, &report);
    counts.glued += report.faces;
    counts.pinched += report.left;
    return edit;
}

/// Some of what an erasure took is put back; refused where the surface would touch itself.
MeshEdit random_filling(const VolumeMesh& before, const MeshEdit& erased, test::Random& random, EditCounts& counts) {
    AddedElements added;
    std::vector<std::int32_t> number = erased.delta.vertex_to_new;
    const auto named = [&](auto element) {
        for (std::int32_t& v : element) {
            if (number[std::size_t(v)] < 0) {
                number[std::size_t(v)] = std::int32_t(erased.mesh.vertices.size() + added.vertices.size());
                added.vertices.push_back(before.vertices[std::size_t(v)]);
            }
            v = number[std::size_t(v)];
        }
        return element;
    };
    const bool all = random.uniform(0, 1) < 0.7;
    for (const std::int32_t e : erased.delta.removed_elements()) {
        if (!all && random.uniform(0, 1) < 0.5) continue;
        if (std::size_t(e) < before.tets.size()) added.tets.push_back(named(before.tets[std::size_t(e)]));
        else added.hexes.push_back(named(before.hexes[std::size_t(e) - before.tets.size()]));
    }
    added.source = {0};
    try {
        MeshEdit edit = add_elements(erased.mesh, added);
        counts.filled += added.tets.size() + added.hexes.size();
        return edit;
    } catch (const Error& error) {
        ++counts.refused;
        return {erased.mesh, identity_delta(erased.mesh)};
    }
}

/// Edits of one mesh one after the other, each checked.
void run_edits(int kind, std::uint64_t seed, int edits, EditCounts& counts) {
    VolumeMesh m = edit_mesh(kind);
    expect_manifold(m);
    const VolumeMesh original = m;
    const double worst_at_start = m.tets.empty() ? 1 : tet_mesh_quality(m).min_radius_ratio;
    TopologyDelta all = identity_delta(m);
    test::Random random(seed);
    for (int i = 0; i < edits; ++i) {
        SCOPED_TRACE("mesh " + std::to_string(kind) + ", seed " + std::to_string(seed) + ", edit " + std::to_string(i));
        MeshEdit edit;
        edit = random_edit(m, random);
        expect_consistent(m, edit);
        expect_manifold(edit.mesh);
        if (testing::Test::HasFatalFailure()) return;
        double removed = 0;
        for (const std::int32_t e : edit.delta.removed_elements()) removed += test::element_volume(m, std::size_t(e));
        ASSERT_NEAR(total_volume(edit.mesh) + removed, total_volume(m), 1e-12 * total_volume(m));
        if (!m.tets.empty()) {
            ASSERT_GE(tet_mesh_quality(edit.mesh).min_radius_ratio, std::min(kLeastRatio, worst_at_start) * (1 - 1e-9));
        }
        ++counts.opened;
        if (random.uniform(0, 1) < 0.3) {
            const double volume = total_volume(edit.mesh), chance = random.uniform(0, 1);
            const MeshEdit closed = chance < 0.5 || edit.delta.removed_elements().empty() ? random_heal(edit.mesh, random, counts) : random_filling(m, edit, random, counts);
            SCOPED_TRACE(chance < 0.5 || edit.delta.removed_elements().empty() ? "healed" : "filled");
            expect_kept(edit.mesh, closed);
            if (testing::Test::HasFatalFailure()) return;
            ASSERT_GE(total_volume(closed.mesh), volume * (1 - 1e-12));
            const TopologyDelta both = compose(edit.delta, closed.delta);
            ASSERT_EQ(both.vertex_parents.size(), closed.mesh.vertices.size());
            ASSERT_EQ(both.element_parent.size(), closed.mesh.element_count());
            if (seed % 2 == 1) {  // goes on from there; of the others all maps together are checked
                all = compose(all, both);
                m = closed.mesh;
                continue;
            }
        }
        all = compose(all, edit.delta);
        m = std::move(edit.mesh);
        if (4 * total_volume(m) < total_volume(original)) break;
    }
    if (seed % 2 == 0) expect_consistent(original, {m, all}, true);
}

TEST(TopologyMesh, RandomEditsKeepVolumeQualityMapsAndAClosedSurface) {
    EditCounts counts;
    for (int kind = 0; kind < 10; ++kind)
        for (std::uint64_t seed = 100; seed < 103; ++seed) run_edits(kind, seed, 10, counts);
    EXPECT_GT(counts.glued, 100u);
    EXPECT_GT(counts.filled, 10u);
}

// 10 meshes, seeds 1000 .. 1099, ten edits each: 10,000.
TEST(SlowTopologyMesh, TenThousandRandomEdits) {
    EditCounts counts;
    for (int kind = 0; kind < 10; ++kind)
        for (std::uint64_t seed = 1000; seed < 1100; ++seed) {
            run_edits(kind, seed, 10, counts);
            if (HasFatalFailure()) return;
        }
    std::printf("%zu cuts, tears and erasures; faces glued %zu, left open at pinches %zu; elements put back %zu, refused %zu times\n", counts.opened, counts.glued, counts.pinched,
                counts.filled, counts.refused);
}

TEST(TopologyMesh, ACutThroughMakesTwoPiecesOfTheVolumesOnBothSides) {
    for (const double at : {1.5, 1.97, 2.0, 2.31}) {
        const VolumeMesh m = shaken_tets({4, 3, 3}, 1, 0);
        CutReport report;
        const MeshEdit edit = cut(m, m.vertices, swept_blade(std::vector<Vec3>{{at, -1, -1}, {at, -1, 4}}, std::vector<Vec3>{{at, 4, -1}, {at, 4, 4}}), {}, &report);
        expect_consistent(m, edit);
        expect_manifold(edit.mesh);
        const Pieces pieces = find_pieces(edit.mesh);
        ASSERT_EQ(pieces.volume_m3.size(), 2u) << at;
        const double snapped = std::abs(at - 2) < 0.1 ? 2.0 : at;  // crossings that near to a vertex are moved there
        EXPECT_NEAR(*std::min_element(pieces.volume_m3.begin(), pieces.volume_m3.end()), 9 * std::min(snapped, 4 - snapped), 1e-12 * 36) << at;
        EXPECT_GT(report.opened_faces, 0u);
        EXPECT_EQ(snapped == 2.0, report.split_edges == 0) << at;
    }
}

TEST(TopologyMesh, ACutThatEndsInsideOpensAWedgeAndLeavesOnePiece) {
    const VolumeMesh m = shaken_tets({6, 6, 3}, 1, 0);
    const MeshEdit edit = cut(m, m.vertices, swept_blade(std::vector<Vec3>{{3.3, -1, -1}, {3.3, -1, 4}}, std::vector<Vec3>{{3.3, 3.2, -1}, {3.3, 3.2, 4}}));
    expect_consistent(m, edit);
    expect_manifold(edit.mesh);
    EXPECT_EQ(find_pieces(edit.mesh).volume_m3.size(), 1u);
    double laid_open = 0;
    const auto parents = boundary_parents(m, edit);
    const BoundarySurface now = extract_boundary(edit.mesh);
    for (std::size_t t = 0; t < parents.size(); ++t) {
        if (parents[t] >= 0) continue;
        const auto X = [&](std::size_t k) -> const Vec3& { return edit.mesh.vertices[std::size_t(now.triangles[t][k])]; };
        laid_open += 0.5 * (X(1) - X(0)).cross(X(2) - X(0)).norm();
    }
    EXPECT_GT(laid_open, 2 * 3 * 2.5);  // two lips, 3 m deep, to the last part that was crossed wholly
    EXPECT_LT(laid_open, 2 * 3 * 3.3);
}

TEST(TopologyMesh, ACurvedBladeAndAMissChangeOnlyWhatTheyMeet) {
    const VolumeMesh m = shaken_tets({6, 4, 4}, 3, 0.1);
    std::vector<Vec3> from, to;
    for (int i = 0; i <= 12; ++i) {
        const double y = -0.5 + 5.0 * i / 12;
        from.push_back({3 + 0.6 * std::sin(1.5 * y), y, -0.5});
        to.push_back({3 + 0.6 * std::sin(1.5 * y) + 0.4, y, 4.5});
    }
    const MeshEdit edit = cut(m, m.vertices, swept_blade(from, to));
    expect_consistent(m, edit);
    expect_manifold(edit.mesh);
    EXPECT_EQ(find_pieces(edit.mesh).volume_m3.size(), 2u);
    for (Vec3& x : from) x.x() += 50;
    for (Vec3& x : to) x.x() += 50;
    EXPECT_TRUE(cut(m, m.vertices, swept_blade(from, to)).delta.is_identity());
}

TEST(TopologyMesh, ErasingLeavesNoElementHangingByAnEdge) {
    // Two opposite columns of a 2 x 2 x 1 block: what stays touches along the edge in the middle, so it gets a vertex of its own on either side.
    const VolumeMesh m = make_hex_box({.min_m = Vec3::Zero(), .max_m = {2, 2, 1}, .cells = {2, 2, 1}});
    const std::int32_t gone[] = {0, 3};
    const MeshEdit edit = remove_elements(m, gone);
    expect_consistent(m, edit);
    expect_manifold(edit.mesh);
    EXPECT_EQ(edit.mesh.hexes.size(), 2u);
    EXPECT_EQ(edit.mesh.vertices.size(), 16u);
    EXPECT_EQ(find_pieces(edit.mesh).volume_m3.size(), 2u);
    EXPECT_EQ(edit.delta.removed_elements(), (std::vector<std::int32_t>{0, 3}));
    EXPECT_EQ(edit.delta.added_vertices().size(), 2u);
    const std::int32_t all[] = {0, 1, 2, 3}, beyond[] = {4};
    supple_test::expect_error(ErrorCode::invalid_argument, "no element would be left", [&] { remove_elements(m, all); });
    supple_test::expect_error(ErrorCode::invalid_argument, "element 4 is outside [0, 4)", [&] { remove_elements(m, beyond); });
}

TEST(TopologyMesh, APinchWithinOnePartTakesMoreElements) {
    // A ring of hexes open at two places that touch along an edge: 3 x 3 x 1 without the centre and one corner's neighbours keeps one part; two of its elements share only an edge.
    const VolumeMesh m = make_hex_box({.min_m = Vec3::Zero(), .max_m = {3, 3, 2}, .cells = {3, 3, 2}});
    const std::int32_t gone[] = {4, 9};  // centre below, corner above: they share an edge of the part that is left
    const MeshEdit edit = remove_elements(m, gone);
    expect_consistent(m, edit);
    expect_manifold(edit.mesh);
}

TEST(TopologyMesh, TearingASheetOfFacesSeparatesAndOneFaceInsideStaysShut) {
    const VolumeMesh m = make_hex_box({.min_m = Vec3::Zero(), .max_m = {4, 2, 2}, .cells = {4, 2, 2}});
    std::vector<ElementFace> sheet;
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j) sheet.push_back({1 + 4 * (j + 2 * k), 3});  // the +x sides of the second layer
    const MeshEdit torn = separate_faces(m, sheet);
    expect_consistent(m, torn);
    expect_manifold(torn.mesh);
    EXPECT_EQ(find_pieces(torn.mesh).volume_m3, (std::vector<double>{8, 8}));
    EXPECT_EQ(torn.mesh.vertices.size(), m.vertices.size() + 9);
    const VolumeMesh large = shaken_tets({4, 4, 4}, 1, 0);
    const ElementFace inside[] = {{6 * (1 + 4 * (1 + 4 * 1)), 0}};
    EXPECT_TRUE(separate_faces(large, inside).delta.is_identity());
}

TEST(TopologyMesh, BadBladesAreRefused) {
    const VolumeMesh m = shaken_tets({1, 1, 1}, 1, 0);
    const auto refused = [&](const std::string& text, auto run) { supple_test::expect_error(ErrorCode::invalid_argument, text, run); };
    refused("no triangle", [&] { cut(m, m.vertices, {}); });
    refused("positions for a mesh", [&] { cut(m, std::vector<Vec3>(3, Vec3::Zero()), {{Vec3::Zero()}, {{0, 0, 0}}}); });
    refused("uses vertex 1", [&] { cut(m, m.vertices, {{Vec3::Zero()}, {{0, 0, 1}}}); });
    refused("CutDef.snap", [&] { cut(m, m.vertices, {{Vec3::Zero()}, {{0, 0, 0}}}, {.snap = 0.7}); });
    refused("two points", [&] { swept_blade(std::vector<Vec3>(1, Vec3::Zero()), std::vector<Vec3>(1, Vec3::Zero())); });
}

}  // namespace
}  // namespace supple
