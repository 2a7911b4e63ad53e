// What an edited body takes over from the one before is what a new one would be made of, to the last bit.
#include "supple/fem/element_passes.h"
#include "supple/world/template_data.h"
#include "support/bodies.h"
#include "support/edits.h"
#include "supple/mesh/embedding.h"
#include "supple/mesh/mesh_grow.h"

namespace supple {
namespace {

template <class T>
void expect_same(const T& a, const T& b, const char* what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]) << what << " " << i;
}

void expect_same(const TemplateData& a, const TemplateData& b) {
    expect_same(a.mesh.vertices, b.mesh.vertices, "vertices");
    expect_same(a.mesh.tets, b.mesh.tets, "tets");
    expect_same(a.mesh.hexes, b.mesh.hexes, "hexes");
    expect_same(a.boundary.triangles, b.boundary.triangles, "triangles");
    expect_same(a.boundary.element, b.boundary.element, "their elements");
    expect_same(a.boundary.edges, b.boundary.edges, "edges");
    expect_same(a.boundary_vertices, b.boundary_vertices, "boundary vertices");
    expect_same(a.pattern.vertex, b.pattern.vertex, "order");
    expect_same(a.pattern.row, b.pattern.row, "places");
    expect_same(a.pattern.row_start, b.pattern.row_start, "rows");
    expect_same(a.pattern.column, b.pattern.column, "columns");
    expect_same(a.pattern.diagonal, b.pattern.diagonal, "diagonal");
    expect_same(a.pattern.mirror, b.pattern.mirror, "mirror");
    ASSERT_EQ(a.pattern.rows, b.pattern.rows);
    ASSERT_EQ(a.gather.size(), b.gather.size());
    for (std::size_t g = 0; g < a.gather.size(); ++g) {
        expect_same(a.gather[g].start, b.gather[g].start, "gather start");
        expect_same(a.gather[g].pair, b.gather[g].pair, "gather pairs");
    }
    ASSERT_EQ(a.layout.groups.size(), b.layout.groups.size());
    for (std::size_t g = 0; g < a.layout.groups.size(); ++g) {
        const fem::ElementGroup &p = a.layout.groups[g], &q = b.layout.groups[g];
        ASSERT_EQ(p.kind, q.kind);
        ASSERT_EQ(p.first_block, q.first_block);
        ASSERT_EQ(p.first_place, q.first_place);
        expect_same(p.element, q.element, "group");
        expect_same(p.tets.vertex, q.tets.vertex, "tet corners");
        expect_same(p.tets.gradient, q.tets.gradient, "tet gradients");
        expect_same(p.tets.volume, q.tets.volume, "tet volumes");
        expect_same(p.hexes.vertex, q.hexes.vertex, "hex corners");
        expect_same(p.hexes.edge, q.hexes.edge, "hex edges");
        expect_same(p.hexes.gradient, q.hexes.gradient, "hex gradients");
        expect_same(p.hexes.volume, q.hexes.volume, "hex volumes");
        expect_same(p.sums.first, q.sums.first, "chunks");
        expect_same(p.sums.vertex, q.sums.vertex, "places");
        expect_same(p.sums.count, q.sums.count, "counts");
        expect_same(p.sums.corner, q.sums.corner, "corners");
    }
    expect_same(a.layout.slot, b.layout.slot, "slots");
    expect_same(a.layout.volume, b.layout.volume, "volumes");
    expect_same(a.layout.around.start, b.layout.around.start, "around");
    expect_same(a.layout.around.element, b.layout.around.element, "elements around");
    expect_same(a.layout.forces.start, b.layout.forces.start, "forces");
    expect_same(a.layout.forces.place, b.layout.forces.place, "places of forces");
    const MeshReport &r = a.mesh_report(), &s = b.mesh_report();
    EXPECT_EQ(a.min_m, b.min_m);
    EXPECT_EQ(a.max_m, b.max_m);
    EXPECT_EQ(r.components, s.components);
    EXPECT_EQ(r.volume_m3, s.volume_m3);
    EXPECT_EQ(r.duplicate_vertices, s.duplicate_vertices);
}

/// Tets and hexes that share nothing, with regions and a group.
VolumeMesh both_kinds() {
    VolumeMesh m = make_tet_box({.min_m = Vec3::Zero(), .max_m = {4, 3, 3}, .cells = {4, 3, 3}});
    const VolumeMesh h = make_hex_box({.min_m = {6, 0, 0}, .max_m = {10, 3, 3}, .cells = {4, 3, 3}});
    const auto first = std::int32_t(m.vertices.size());
    m.vertices.insert(m.vertices.end(), h.vertices.begin(), h.vertices.end());
    m.hexes = h.hexes;
    for (Hex& hex : m.hexes)
        for (std::int32_t& v : hex) v += first;
    return m;
}

MeshEdit random_edit(const VolumeMesh& m, test::Random& random) {
    const Vec3 centre = m.vertices[std::size_t(random.uniform(0, double(m.vertices.size())))];
    const double kind = random.uniform(0, 1);
    if (kind < 0.4) {
        const Mat3 R = random.rotation();
        const Vec3 u = 3 * R.col(0), w = 1.5 * R.col(1);
        return cut(m, m.vertices, swept_blade(std::vector<Vec3>{centre - u - w, centre + u - w}, std::vector<Vec3>{centre - u + w, centre + u + w}));
    }
    if (kind < 0.6) {
        const std::vector<double> weight(m.vertices.size(), 1.0);
        return heal(m, m.vertices, weight, {.gap_m = 0.1, .centre_m = centre, .radius_m = random.uniform(1, 4)});
    }
    std::vector<std::int32_t> chosen;
    for (std::size_t e = 0; e < m.element_count(); ++e)
        if ((m.vertices[std::size_t(element_vertices(m, e)[0])] - centre).norm() < random.uniform(0.3, 1.2)) chosen.push_back(std::int32_t(e));
    if (kind < 0.8) {
        std::vector<ElementFace> faces;
        for (const std::int32_t e : chosen) faces.push_back({e, int(random.uniform(0, e < std::int32_t(m.tets.size()) ? 4 : 6))});
        return separate_faces(m, faces);
    }
    if (3 * chosen.size() > m.element_count()) chosen.resize(1);
    return remove_elements(m, chosen);
}

TEST(TopologyTemplate, AnEditedOneEqualsANewOneToTheBit) {
    std::size_t taken_over = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        auto shape = BodyTemplate::build(seed % 3 == 0 ? both_kinds() : seed % 3 == 1 ? make_tet_box({.max_m = {8, 4, 4}, .cells = {8, 4, 4}}) : make_hex_box({.max_m = {8, 5, 4}, .cells = {8, 5, 4}}));
        test::Random random(seed);
        for (int i = 0; i < 12; ++i) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", edit " + std::to_string(i));
            const MeshEdit edit = random_edit(shape->mesh(), random);
            const auto edited = shape->edited(edit);
            taken_over += !edited->data().checked.has_value();
            expect_same(edited->data(), BodyTemplate::build(edit.mesh)->data());
            if (HasFatalFailure()) return;
            shape = edited;
        }
    }
    EXPECT_GT(taken_over, 140u) << "of 144: else this compares build() with itself";
}

}  // namespace
}  // namespace supple
