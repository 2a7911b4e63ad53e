// However a mesh is numbered, a body's matrix and elements lie alike in memory, and everything outside is in the numbering of the mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "supple/mesh/locality.h"
#include "supple/world/inspect.h"
#include "supple/world/response.h"
#include "supple/world/template_data.h"
#include "support/bodies.h"

namespace supple {
namespace {

/// A mesh, the same with its vertices and elements numbered anyhow, and which is which.
struct Shuffled {
    VolumeMesh mesh;
    std::vector<std::int32_t> vertex, element;  ///< [of the given mesh] number in this one

    explicit Shuffled(const VolumeMesh& given, std::uint64_t seed) : vertex(given.vertices.size()), element(given.element_count()) {
        test::Random random(seed);
        const auto shuffle = [&](auto begin, auto end) {
            for (auto i = end - begin - 1; i > 0; --i) std::swap(begin[i], begin[std::ptrdiff_t(random.uniform(0, double(i) + 0.999))]);
        };
        std::iota(vertex.begin(), vertex.end(), 0);
        std::iota(element.begin(), element.end(), 0);
        shuffle(vertex.begin(), vertex.end());
        const auto tets = std::ptrdiff_t(given.tets.size());
        shuffle(element.begin(), element.begin() + tets);
        shuffle(element.begin() + tets, element.end());
        mesh.vertices.resize(given.vertices.size());
        mesh.tets.resize(given.tets.size());
        mesh.hexes.resize(given.hexes.size());
        for (std::size_t v = 0; v < vertex.size(); ++v) mesh.vertices[std::size_t(vertex[v])] = given.vertices[v];
        const auto renumbered = [&](auto corners) {
            for (std::int32_t& v : corners) v = vertex[std::size_t(v)];
            return corners;
        };
        for (std::size_t e = 0; e < given.tets.size(); ++e) mesh.tets[std::size_t(element[e])] = renumbered(given.tets[e]);
        for (std::size_t e = 0; e < given.hexes.size(); ++e) mesh.hexes[std::size_t(element[given.tets.size() + e]) - given.tets.size()] = renumbered(given.hexes[e]);
    }
};

TEST(MeshLocality, EveryPointOnceAndNeighboursNearOneAnother) {
    const VolumeMesh box = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3(0.4, 0.1, 0.1), .cells = {32, 8, 8}});
    const Shuffled shuffled(box, 1);
    const std::vector<std::int32_t> order = locality_order(shuffled.mesh.vertices);
    std::vector<std::int32_t> place(order.size(), -1);
    for (std::size_t i = 0; i < order.size(); ++i) place[std::size_t(order[i])] = std::int32_t(i);
    EXPECT_EQ(std::count(place.begin(), place.end(), -1), 0);
    const auto mean_distance = [&](auto&& at) {
        double sum = 0;
        for (const Tet& t : shuffled.mesh.tets) sum += std::abs(at(t[0]) - at(t[1]));
        return sum / double(shuffled.mesh.tets.size());
    };
    const double before = mean_distance([](std::int32_t v) { return v; }), after = mean_distance([&](std::int32_t v) { return place[std::size_t(v)]; });
    EXPECT_LT(5 * after, before);
    EXPECT_TRUE(locality_order({}).empty());
    EXPECT_EQ(locality_order(std::vector<Vec3>(3, Vec3(1, 2, 3))), (std::vector<std::int32_t>{0, 1, 2}));
}

TEST(WorldOrder, TheMatrixLiesTheSameHoweverTheMeshIsNumbered) {
    for (const bool hexes : {false, true}) {
        const BoxDef box{.min_m = Vec3::Zero(), .max_m = Vec3(0.4, 0.1, 0.1), .cells = {12, 3, 3}};
        const VolumeMesh mesh = hexes ? make_hex_box(box) : make_tet_box(box);
        const Shuffled shuffled(mesh, 2);
        const auto a = BodyTemplate::build(mesh), b = BodyTemplate::build(shuffled.mesh);
        EXPECT_EQ(a->data().pattern.row_start, b->data().pattern.row_start);
        EXPECT_EQ(a->data().pattern.column, b->data().pattern.column);
        EXPECT_NE(a->data().pattern.vertex, b->data().pattern.vertex);
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            EXPECT_EQ(a->data().pattern.row[v], b->data().pattern.row[std::size_t(shuffled.vertex[v])]);
            EXPECT_EQ(b->mesh().vertices[std::size_t(shuffled.vertex[v])], mesh.vertices[v]) << "the mesh keeps its numbering";
        }
        // Elements: those around the same first vertex may be exchanged, no others.
        for (std::size_t e = 0; e < mesh.element_count(); ++e) EXPECT_NEAR(double(a->data().layout.slot[e]), double(b->data().layout.slot[std::size_t(shuffled.element[e])]), 24);
    }
}

/// What a world with everything in it does in some steps.
struct Scene {
    World world;
    BodyId body, other;
    static WorldDef def(PreconditionerKind kind) {
        WorldDef d;
        d.time_step_s = 0.01;
        d.gravity_m_s2 = Vec3(0, -9.81, 0);
        d.solver.preconditioner = kind;
        d.solver.precision = Precision::double_;
        d.solver.cg_relative_tolerance = 1e-11;
        d.solver.contact_iterations = 60;
        return d;
    }
    Scene(const VolumeMesh& mesh, PreconditionerKind kind, bool alone) : world(def(kind)) {
        BodyDef b;
        b.shape = BodyTemplate::build(mesh);
        b.material = Corotational{.young_pa = 5e4, .poisson = 0.4};
        body = world.add_body(b);
        world.fix(body, test::at_x(0));
        Motion sway{.where = InsideBox{Vec3(0.39, -1, -1), Vec3(1, 0.001, 1)}, .axes = {.x = false, .y = false, .z = true}};
        sway.velocity_m_s.values = {Vec3(0, 0, 0.1)};
        world.prescribe(body, sway);
        Load pressure{.where = InsideBox{Vec3(-1, 0.099, -1), Vec3(1, 1, 1)}, .kind = LoadKind::pressure};
        pressure.amount.values = {300.0};
        world.add_load(body, pressure);
        ColliderDef ball;
        ball.shape = SphereShape{0.03};
        ball.pose.position_m = Vec3(0.3, -0.035, 0.05);
        world.add_collider(ball);
        if (alone) return;
        b.translation_m = Vec3(0.1, 0.102, 0);
        other = world.add_body(b);
    }
    void go(int steps) {
        for (int i = 0; i < steps; ++i) EXPECT_EQ(world.step().flags, StepFlag::none);
    }
};

TEST(WorldOrder, AShuffledMeshMovesAsTheOrderedOneInItsOwnNumbering) {
    const VolumeMesh mesh = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3(0.4, 0.1, 0.1), .cells = {12, 3, 3}});
    const Shuffled shuffled(mesh, 3);
    for (const PreconditionerKind kind : {PreconditionerKind::block_jacobi, PreconditionerKind::lattice_multigrid, PreconditionerKind::scalar_laplacian, PreconditionerKind::direct}) {
        for (const bool alone : {true, false}) {
            SCOPED_TRACE(testing::Message() << int(kind) << (alone ? ", alone" : ", two that touch"));
            Scene a(mesh, kind, alone), b(shuffled.mesh, kind, alone);
            a.go(12);
            b.go(12);
            std::vector<Vec3> x, v, reaction;
            std::vector<double> stress;
            for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
                const auto at = std::size_t(shuffled.vertex[i]);
                x.push_back(b.world.positions(b.body)[at]);
                v.push_back(b.world.velocities(b.body)[at]);
                reaction.push_back(b.world.reactions(b.body)[at]);
                stress.push_back(b.world.von_mises(b.body)[at]);
            }
            EXPECT_LT(test::relative_difference(x, a.world.positions(a.body)), 1e-7);
            EXPECT_LT(test::relative_difference(v, a.world.velocities(a.body)), 1e-5);
            EXPECT_LT(test::relative_difference(reaction, a.world.reactions(a.body)), 1e-5);
            double most = 0;
            for (const double s : a.world.von_mises(a.body)) most = std::max(most, s);
            for (std::size_t i = 0; i < stress.size(); ++i) EXPECT_NEAR(stress[i], a.world.von_mises(a.body)[i], 1e-5 * most);
            EXPECT_GT(a.world.contact_force_n().norm(), 0) << "or contact is not in it";
            EXPECT_NEAR(b.world.contact_force_n().norm(), a.world.contact_force_n().norm(), 1e-4 * a.world.contact_force_n().norm());
        }
    }
}

TEST(WorldOrder, MatricesAndResponsesThatAreReadAreInTheNumberingOfTheMesh) {
    const VolumeMesh mesh = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3(0.4, 0.1, 0.1), .cells = {6, 2, 2}});
    const Shuffled shuffled(mesh, 4);
    Scene a(mesh, PreconditionerKind::block_jacobi, true), b(shuffled.mesh, PreconditionerKind::block_jacobi, true);
    a.go(2);
    b.go(2);
    const Eigen::SparseMatrix<double> Ka = Inspector(a.world, a.body).matrix(SystemMatrix::stiffness), Kb = Inspector(b.world, b.body).matrix(SystemMatrix::stiffness);
    const MatX da(Ka), db(Kb);
    double most = 0;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        for (std::size_t j = 0; j < mesh.vertices.size(); ++j)
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c)
                    most = std::max(most, std::abs(da(Eigen::Index(3 * i) + r, Eigen::Index(3 * j) + c) - db(3 * shuffled.vertex[i] + r, 3 * shuffled.vertex[j] + c)));
    EXPECT_LT(most, 1e-6 * da.cwiseAbs().maxCoeff());
    const BodyResponse ra(a.world, a.body, {}), rb(b.world, b.body, {});
    std::vector<Vec3> fa(mesh.vertices.size(), Vec3::Zero()), fb = fa, ua = fa, ub = fa;
    fa[40] = Vec3(0.1, 0.2, 0.3);
    fb[std::size_t(shuffled.vertex[40])] = fa[40];
    ra.solve(fa, ua, 1e-10, 1000);
    rb.solve(fb, ub, 1e-10, 1000);
    std::vector<Vec3> back;
    for (const std::int32_t v : shuffled.vertex) back.push_back(ub[std::size_t(v)]);
    EXPECT_LT(test::relative_difference(back, ua), 1e-6);
}

}  // namespace
}  // namespace supple
