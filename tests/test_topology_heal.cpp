// Lips that are glued, matter that is added: closed surfaces, mass and momenta, what is on the body follows.
#include "supple/mesh/embedding.h"
#include "supple/mesh/mesh_grow.h"
#include "supple/world/edit_events.h"
#include "supple/world/inspect.h"
#include "support/bodies.h"
#include "support/edits.h"

namespace supple {
namespace {

using test::blade_at_x;
using test::copy;

struct Momenta {
    double mass = 0;
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

Momenta momenta(const World& world, BodyId body) {
    Momenta sum;
    for (std::size_t i = 0; i < world.masses(body).size(); ++i) {
        sum.mass += world.masses(body)[i];
        sum.linear += world.masses(body)[i] * world.velocities(body)[i];
        sum.angular += world.masses(body)[i] * world.positions(body)[i].cross(world.velocities(body)[i]);
    }
    return sum;
}

void expect_conserved(const Momenta& now, const Momenta& before) {
    EXPECT_NEAR(now.mass, before.mass, 1e-12 * before.mass);
    EXPECT_LT((now.linear - before.linear).norm(), 1e-12 * before.linear.norm());
    EXPECT_LT((now.angular - before.angular).norm(), 1e-12 * before.angular.norm());
}

WorldDef still_world() {
    WorldDef def{.gravity_m_s2 = Vec3::Zero(), .time_step_s = 0.01, .threads = 1};
    def.solver.precision = Precision::double_;
    def.solver.cg_relative_tolerance = 1e-10;
    return def;
}

BodyId turning_bar(World& world, std::shared_ptr<const BodyTemplate> shape, double shake) {
    const BodyId body = world.add_body({.shape = std::move(shape), .material = Corotational{.young_pa = 2e4, .poisson = 0.3}, .density_kg_m3 = 1000});
    test::Random random(7);
    std::vector<Vec3> x = copy(world.positions(body)), v = x;
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = Vec3(0.3, -0.2, 0.1) + Vec3(0.5, 2, -1).cross(x[i] - Vec3(0.2, 0.05, 0.05)) + random.vector(shake);
    world.set_state(body, x, v);
    return body;
}

TEST(TopologyHeal, WhatWasTornAndGluedIsTheMeshItWas) {
    for (const bool hexes : {false, true}) {
        const VolumeMesh m = hexes ? make_hex_box({.max_m = {6, 3, 3}, .cells = {6, 3, 3}}) : make_tet_box({.max_m = {6, 3, 3}, .cells = {6, 3, 3}});
        const std::vector<double> weight(m.vertices.size() * 2, 1.0);
        const MeshEdit open = cut(m, m.vertices, swept_blade(std::vector<Vec3>{{3, -1, -1}, {3, -1, 2}}, std::vector<Vec3>{{3, 9, -1}, {3, 9, 2}}), {.snap = 0.5});
        ASSERT_GT(open.mesh.vertices.size(), m.vertices.size());
        ASSERT_EQ(open.mesh.element_count(), m.element_count()) << "along faces";
        HealReport report;
        const MeshEdit shut = heal(open.mesh, open.mesh.vertices, {weight.data(), open.mesh.vertices.size()}, {.gap_m = 1e-9}, &report);
        EXPECT_EQ(report.merged, open.mesh.vertices.size() - m.vertices.size());
        EXPECT_EQ(report.left, 0u);
        EXPECT_EQ(shut.mesh.vertices, m.vertices);
        EXPECT_EQ(shut.mesh.tets, m.tets);
        EXPECT_EQ(shut.mesh.hexes, m.hexes);
        EXPECT_TRUE(heal(m, m.vertices, {weight.data(), m.vertices.size()}, {}).delta.is_identity()) << "nothing is open";
    }
}

TEST(TopologyHeal, LipsWithinTheGapAreGluedMassAndMomentaStay) {
    for (const bool hexes : {false, true}) {
        SCOPED_TRACE(hexes ? "hexes" : "tets");
        World world(still_world());
        const BodyId body = turning_bar(world, hexes ? test::hex_bar({10, 4, 4}) : test::bar({8, 3, 3}), 0.1);
        world.cut(body, blade_at_x(0.217));
        ASSERT_EQ(world.pieces(body).size(), 2u);
        const std::size_t triangles = world.shape(body).boundary().triangles.size();
        for (int i = 0; i < 2; ++i) ASSERT_EQ(world.step().flags, StepFlag::none);
        const Momenta before = momenta(world, body);
        EXPECT_TRUE(world.heal(body, {.gap_m = 1e-7}).is_identity()) << "the shaken lips are farther apart";
        HealReport report;
        const std::vector<std::uint32_t> ids = world.vertex_ids(body);
        const TopologyDelta delta = world.heal(body, {.gap_m = 0.02}, &report);
        EXPECT_GT(report.merged, 10u);
        EXPECT_EQ(world.pieces(body).size(), 1u);
        EXPECT_LT(world.shape(body).boundary().triangles.size(), triangles - 20);
        test::expect_manifold(world.shape(body).mesh());
        expect_conserved(momenta(world, body), before);
        for (std::size_t v = 0; v < ids.size(); ++v) {
            if (!delta.is_merged(std::size_t(delta.vertex_to_new[v]))) {
                EXPECT_EQ(world.vertex_ids(body)[std::size_t(delta.vertex_to_new[v])], ids[v]);
            }
        }
        const Eigen::SparseMatrix<double> K = Inspector(world, body).matrix(SystemMatrix::stiffness);
        World fresh(still_world());
        const BodyId same = fresh.add_body({.shape = BodyTemplate::build(world.shape(body).mesh()), .material = Corotational{.young_pa = 2e4, .poisson = 0.3}, .density_kg_m3 = 1000});
        fresh.set_state(same, world.positions(body), world.velocities(body));
        const Eigen::SparseMatrix<double> fresh_K = Inspector(fresh, same).matrix(SystemMatrix::stiffness);
        EXPECT_LT((K - fresh_K).norm(), 1e-12 * fresh_K.norm());
        for (int i = 0; i < 5; ++i) EXPECT_EQ(world.step().flags, StepFlag::none);
        ASSERT_TRUE(world.undo_edit(body));
        EXPECT_EQ(world.pieces(body).size(), 2u);
        EXPECT_EQ(world.shape(body).boundary().triangles.size(), triangles);
        EXPECT_EQ(world.step().flags, StepFlag::none);
    }
}

TEST(TopologyHeal, ABallAndRandomGapsLeaveAClosedSurface) {
    test::Random random(3);
    std::size_t glued = 0, left = 0;
    for (int round = 0; round < 40; ++round) {
        SCOPED_TRACE(round);
        VolumeMesh m = round % 2 == 0 ? make_tet_box({.max_m = {6, 4, 4}, .cells = {6, 4, 4}}) : make_hex_box({.max_m = {6, 4, 4}, .cells = {6, 4, 4}});
        for (int i = 0; i < 3; ++i) {
            const Mat3 R = random.rotation();
            const Vec3 c(random.uniform(1, 5), random.uniform(1, 3), random.uniform(1, 3)), u = 3 * R.col(0), w = 2 * R.col(1);
            m = cut(m, m.vertices, swept_blade(std::vector<Vec3>{c - u - w, c + u - w}, std::vector<Vec3>{c - u + w, c + u + w})).mesh;
        }
        std::vector<Vec3> x = m.vertices;
        for (Vec3& p : x) p += random.vector(0.05);  // lips here near, there far
        const std::vector<double> weight(x.size(), 1.0);
        HealReport report;
        const MeshEdit edit = heal(m, x, weight, {.gap_m = random.uniform(0.02, 0.2), .centre_m = m.vertices[std::size_t(random.uniform(0, double(x.size())))], .radius_m = random.uniform(1, 5)}, &report);
        test::expect_manifold(edit.mesh);
        if (HasFatalFailure()) return;
        ASSERT_NEAR(test::total_volume(edit.mesh), test::total_volume(m), 1e-12 * test::total_volume(m));
        ASSERT_EQ(extract_boundary(edit.mesh).triangles.size() + 2 * report.faces * (round % 2 == 0 ? 1 : 2), extract_boundary(m).triangles.size());
        for (std::size_t v = 0; v < x.size(); ++v) {
            const std::int32_t now = edit.delta.vertex_to_new[v];
            ASSERT_GE(now, 0);
            ASSERT_EQ(edit.mesh.vertices[std::size_t(now)], m.vertices[v]);
        }
        glued += report.faces;
        left += report.left;
    }
    EXPECT_GT(glued, 300u);
    EXPECT_GT(left, 0u) << "no pinch was met: the test is too tame";
}

TEST(TopologyHeal, AHeldLipHoldsTheOther) {
    World world(still_world());
    const BodyId body = turning_bar(world, test::hex_bar({8, 2, 2}), 0.0);
    world.cut(body, blade_at_x(0.2));
    std::vector<std::int32_t> held;
    const VolumeMesh before = world.shape(body).mesh();
    for (std::size_t h = 0; h < before.hexes.size(); ++h)
        for (const std::int32_t v : before.hexes[h])
            if (before.vertices[std::size_t(v)].x() == 0.2 && before.vertices[std::size_t(before.hexes[h][0])].x() < 0.19) held.push_back(v);
    ASSERT_FALSE(held.empty());
    world.fix(body, VertexList{held});
    world.step();
    const std::vector<Vec3> x = copy(world.positions(body));
    const TopologyDelta delta = world.heal(body, {.gap_m = 0.05});
    for (const std::int32_t v : held) {
        const auto now = std::size_t(delta.vertex_to_new[std::size_t(v)]);
        EXPECT_TRUE(delta.is_merged(now));
        EXPECT_EQ(world.positions(body)[now], x[std::size_t(v)]);
    }
    world.step();
    for (const std::int32_t v : held) EXPECT_EQ(world.positions(body)[std::size_t(delta.vertex_to_new[std::size_t(v)])], x[std::size_t(v)]);
}

TEST(TopologyHeal, BadNumbersAreRefused) {
    World world(still_world());
    const BodyId body = turning_bar(world, test::bar({4, 2, 2}), 0);
    const auto refused = [&](const std::string& text, HealDef def) { supple_test::expect_error(ErrorCode::invalid_argument, text, [&] { world.heal(body, def); }); };
    refused("gap_m", {.gap_m = 0});
    refused("gap_m", {.gap_m = std::nan("")});
    refused("radius_m", {.radius_m = -1});
    refused("centre_m", {.centre_m = {std::nan(""), 0, 0}});
    supple_test::expect_error(ErrorCode::invalid_argument, "HealEvent.gap_m", [] { EditScript({}, {}, {HealEvent{.def = {.gap_m = 0}}}); });
}

/// The elements near a point, with what add_elements() needs to put them back.
AddedElements as_added(const VolumeMesh& before, const MeshEdit& carved, std::span<const std::int32_t> removed) {
    AddedElements added;
    std::map<std::int32_t, std::int32_t> number;
    const auto name = [&](std::int32_t v) {
        if (carved.delta.vertex_to_new[std::size_t(v)] >= 0) return carved.delta.vertex_to_new[std::size_t(v)];
        const auto [known, is_new] = number.try_emplace(v, std::int32_t(carved.mesh.vertices.size() + added.vertices.size()));
        if (is_new) added.vertices.push_back(before.vertices[std::size_t(v)]);
        return known->second;
    };
    for (const std::int32_t e : removed) {
        if (std::size_t(e) < before.tets.size()) {
            Tet t = before.tets[std::size_t(e)];
            for (std::int32_t& v : t) v = name(v);
            added.tets.push_back(t);
        } else {
            Hex h = before.hexes[std::size_t(e) - before.tets.size()];
            for (std::int32_t& v : h) v = name(v);
            added.hexes.push_back(h);
        }
    }
    added.source = {0};
    return added;
}

std::vector<std::int32_t> in_box(const VolumeMesh& m, const Vec3& low, const Vec3& high) {
    std::vector<std::int32_t> out;
    for (std::size_t e = 0; e < m.element_count(); ++e) {
        Vec3 c = Vec3::Zero();
        const auto ids = element_vertices(m, e);
        for (const std::int32_t v : ids) c += m.vertices[std::size_t(v)] / double(ids.size());
        if ((c.array() > low.array()).all() && (c.array() < high.array()).all()) out.push_back(std::int32_t(e));
    }
    return out;
}

TEST(TopologyAdd, AHoleThatIsFilledAgainGivesMassStiffnessAndARigidMotionBack) {
    for (const bool hexes : {false, true}) {
        SCOPED_TRACE(hexes ? "hexes" : "tets");
        World world(still_world());
        const auto shape = hexes ? test::hex_bar({10, 4, 4}) : test::bar({10, 4, 4});
        const BodyId body = turning_bar(world, shape, 0);  // a rigid motion
        const Momenta whole = momenta(world, body);
        const double norm = Inspector(world, body).matrix(SystemMatrix::stiffness).norm();
        const Vec3 low(0.16, 0.05, 0.025), high(0.24, 1, 0.075);  // whole cells: a notch
        const MeshEdit carved = remove_elements(shape->mesh(), in_box(shape->mesh(), low, high));
        const TopologyDelta gone = world.remove_elements(body, in_box(shape->mesh(), low, high));
        ASSERT_GT(gone.removed_elements().size(), 5u);
        const AddedElements back = as_added(shape->mesh(), carved, gone.removed_elements());
        const Momenta hollow = momenta(world, body);
        const TopologyDelta delta = world.add_elements(body, back);
        test::expect_manifold(world.shape(body).mesh());
        EXPECT_EQ(delta.added_vertices().size(), back.vertices.size());
        EXPECT_EQ(world.shape(body).mesh().element_count(), shape->mesh().element_count());
        EXPECT_LT(hollow.mass, 0.97 * whole.mass);
        expect_conserved(momenta(world, body), whole);  // new matter moves as the body does
        const double now = Inspector(world, body).matrix(SystemMatrix::stiffness).norm();
        EXPECT_NEAR(now, norm, 1e-12 * norm);
        for (int i = 0; i < 5; ++i) EXPECT_EQ(world.step().flags, StepFlag::none);
        ASSERT_TRUE(world.undo_edit(body));
        EXPECT_EQ(world.shape(body).mesh().vertices, carved.mesh.vertices);
        ASSERT_TRUE(world.undo_edit(body));
        EXPECT_EQ(world.shape(body).mesh().vertices, shape->mesh().vertices);
    }
}

TEST(TopologyAdd, MatterRegionsAndGroupsComeFromTheSource) {
    VolumeMesh m = make_hex_box({.max_m = {0.4, 0.1, 0.1}, .cells = {4, 1, 1}});
    m.regions = {{"a", 1}, {"b", 2}};
    m.element_region = {0, 0, 1, 1};
    BodyDef def{.shape = BodyTemplate::build(m), .material = Corotational{.young_pa = 2e4, .poisson = 0.3}, .density_kg_m3 = 1000};
    def.regions = {{.where = InsideBox{{0.2, -1, -1}, {1, 1, 1}}, .stiffness_factor = 3, .density_kg_m3 = 2000}};
    World world(still_world());
    const BodyId body = world.add_body(def);
    const double before = momenta(world, body).mass;
    AddedElements block;  // on top of the last element
    for (std::size_t k : {2u, 3u, 6u, 7u}) block.vertices.push_back(m.vertices[std::size_t(m.hexes[3][k])] + Vec3(0, 0.1, 0));
    const std::int32_t n = std::int32_t(m.vertices.size());
    const Hex& h = m.hexes[3];
    block.hexes = {{h[3], h[2], n, n + 1, h[7], h[6], n + 2, n + 3}};
    block.source = {3};
    world.add_elements(body, block);
    test::expect_manifold(world.shape(body).mesh());
    EXPECT_EQ(world.shape(body).mesh().element_region, (std::vector<std::int32_t>{0, 0, 1, 1, 1}));
    EXPECT_NEAR(momenta(world, body).mass, before + 2000 * 1e-3, 1e-12);
    EXPECT_EQ(world.element_ids(body), (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
    EXPECT_EQ(world.step().flags, StepFlag::none);
}

TEST(TopologyAdd, WhatDoesNotFitIsRefusedAndTheBodyStays) {
    const VolumeMesh m = make_tet_box({.max_m = {2, 2, 2}, .cells = {2, 2, 2}});
    World world(still_world());
    const BodyId body = turning_bar(world, BodyTemplate::build(m), 0);
    const std::uint64_t hash = world.hash();
    const auto n = std::int32_t(m.vertices.size());
    const auto refused = [&](const std::string& text, AddedElements added) {
        supple_test::expect_error(ErrorCode::invalid_argument, text, [&] { world.add_elements(body, added); });
        EXPECT_EQ(world.hash(), hash);
    };
    const BoundarySurface boundary = extract_boundary(m);
    const Triangle t = boundary.triangles[0];
    Vec3 out = Vec3::Zero();
    for (const std::int32_t v : t) out += m.vertices[std::size_t(v)] / 3;
    const Vec3 tip = out + 0.5 * (m.vertices[std::size_t(t[1])] - m.vertices[std::size_t(t[0])]).cross(m.vertices[std::size_t(t[2])] - m.vertices[std::size_t(t[0])]);
    const AddedElements good{.vertices = {tip}, .tets = {{t[0], t[1], t[2], n}}, .hexes = {}, .source = {0}};
    refused("sources", {.vertices = {tip}, .tets = good.tets, .hexes = {}, .source = {}});
    refused("has the source 999", {.vertices = {tip}, .tets = good.tets, .hexes = {}, .source = {999}});
    refused("uses vertex " + std::to_string(n + 1), {.vertices = {tip}, .tets = {{t[0], t[1], t[2], n + 1}}, .hexes = {}, .source = {0}});
    refused("is in no new element", {.vertices = {tip, tip}, .tets = good.tets, .hexes = {}, .source = {0}});
    refused("too flat", {.vertices = {out}, .tets = good.tets, .hexes = {}, .source = {0}});
    refused("not finite", {.vertices = {Vec3(std::nan(""), 0, 0)}, .tets = good.tets, .hexes = {}, .source = {0}});
    refused("touch itself", {.vertices = {tip, tip + Vec3(1, 0, 0), tip + Vec3(0, 1, 0)}, .tets = {{t[0], n, n + 1, n + 2}}, .hexes = {}, .source = {0}});
    refused("has the vertices of element", {.vertices = {}, .tets = {m.tets[0]}, .hexes = {}, .source = {0}});
    const Tet inner = m.tets[0];
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t v : inner) middle += m.vertices[std::size_t(v)] / 4;
    bool any = false;
    for (const auto& f : kTetFaces) {  // a face inside the body has its two elements
        const Triangle face{inner[std::size_t(f[0])], inner[std::size_t(f[1])], inner[std::size_t(f[2])]};
        const bool on_boundary = std::any_of(boundary.triangles.begin(), boundary.triangles.end(), [&](Triangle b) {
            Triangle a = face;
            std::sort(a.begin(), a.end());
            std::sort(b.begin(), b.end());
            return a == b;
        });
        if (on_boundary || any) continue;
        refused("shares a face with two others", {.vertices = {middle + Vec3(9, 9, 9)}, .tets = {{face[0], face[1], face[2], n}}, .hexes = {}, .source = {0}});
        any = true;
    }
    EXPECT_TRUE(any);
    EXPECT_FALSE(world.add_elements(body, good).is_identity());
    test::expect_manifold(world.shape(body).mesh());
}

TEST(TopologyAdd, SnapshotsGoAcrossHealingAndAddingToTheBit) {
    const auto make = [] {
        World world({.time_step_s = 0.01, .threads = 1});
        const BodyId body = world.add_body({.shape = test::hex_bar({16, 4, 4}), .material = Corotational{.young_pa = 5e4, .poisson = 0.4}});
        world.fix(body, test::at_x(0));
        return std::pair(std::move(world), body);
    };
    auto [a, body] = make();
    const auto run = [](World& world, int steps) {
        for (int i = 0; i < steps; ++i) EXPECT_EQ(world.step().flags, StepFlag::none);
    };
    run(a, 3);
    a.cut(body, blade_at_x(0.21, 0.05));
    run(a, 3);
    a.heal(body, {.gap_m = 0.004});
    run(a, 2);
    const VolumeMesh& m = a.shape(body).mesh();
    const std::int32_t last = std::int32_t(m.element_count()) - 1, n = std::int32_t(m.vertices.size());
    const Hex h = m.hexes[std::size_t(last)];
    AddedElements block;
    for (std::size_t k : {2u, 1u, 6u, 5u}) block.vertices.push_back(m.vertices[std::size_t(h[k])] + Vec3(0.025, 0, 0));
    block.hexes = {{h[1], n + 1, n, h[2], h[5], n + 3, n + 2, h[6]}};
    block.source = {last};
    a.add_elements(body, block);
    test::expect_manifold(a.shape(body).mesh());
    run(a, 2);
    const auto bytes = a.save();
    const std::uint64_t at_save = a.hash();
    run(a, 15);
    auto [fresh, same] = make();
    fresh.restore(bytes);
    EXPECT_EQ(fresh.hash(), at_save);
    EXPECT_EQ(fresh.vertex_ids(same), a.vertex_ids(body));
    run(fresh, 15);
    EXPECT_EQ(fresh.hash(), a.hash());
}

}  // namespace
}  // namespace supple
