// Edits of bodies: what is on them survives, and the engine is one that was built from the resulting mesh.
#include "support/bodies.h"
#include "support/edits.h"
#include "supple/mesh/embedding.h"
#include "supple/mesh/surface_check.h"
#include "supple/world/inspect.h"
#include "supple/world/probe.h"

namespace supple {
namespace {

using test::blade_at_x;
using test::copy;

/// Momenta from the elements, each with a share of its mass at every corner; hexes of one shape.
struct Momenta {
    double mass = 0;
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

Momenta momenta(const World& world, BodyId body, std::span<const std::int32_t> elements) {
    const VolumeMesh& mesh = world.shape(body).mesh();
    const auto x = world.positions(body), v = world.velocities(body);
    Momenta sum;
    for (const std::int32_t e : elements) {
        const auto ids = element_vertices(mesh, e);
        const double mass = 1000 * test::element_volume(mesh, std::size_t(e));
        sum.mass += mass;
        for (const std::int32_t i : ids) {
            sum.linear += mass / double(ids.size()) * v[std::size_t(i)];
            sum.angular += mass / double(ids.size()) * x[std::size_t(i)].cross(v[std::size_t(i)]);
        }
    }
    return sum;
}

Momenta momenta(const World& world, BodyId body) {
    Momenta sum;
    for (std::size_t i = 0; i < world.masses(body).size(); ++i) {
        sum.mass += world.masses(body)[i];
        sum.linear += world.masses(body)[i] * world.velocities(body)[i];
        sum.angular += world.masses(body)[i] * world.positions(body)[i].cross(world.velocities(body)[i]);
    }
    return sum;
}

WorldDef exact_world(Vec3 gravity = Vec3::Zero()) {
    WorldDef def{.gravity_m_s2 = gravity, .time_step_s = 0.01, .threads = 1};
    def.solver.cg_relative_tolerance = 1e-11;
    def.solver.precision = Precision::double_;
    return def;
}

struct Kind {
    bool hexes;
    Material material;
};

std::vector<Kind> kinds() {
    return {{false, Corotational{.young_pa = 2e4, .poisson = 0.4}}, {false, StableNeoHookean{.mu_pa = 1e4, .lambda_pa = 4e4}}, {true, Corotational{.young_pa = 2e4, .poisson = 0.3}}};
}

/// A body that turns and shakes, cut, torn and carved while it does.
void run_random_edits(const Kind& kind, std::uint64_t seed) {
    World world(exact_world());
    const auto shape = kind.hexes ? test::hex_bar({10, 4, 4}) : test::bar({8, 3, 3});
    const BodyId body = world.add_body({.shape = shape, .material = kind.material, .density_kg_m3 = 1000});
    test::Random random(seed);
    std::vector<Vec3> x = copy(world.positions(body)), v = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
        v[i] = Vec3(0.3, -0.2, 0.1) + Vec3(0.5, 2, -1).cross(x[i] - Vec3(0.2, 0.05, 0.05)) + random.vector(0.02);
        x[i].y() *= 1.1;
    }
    world.set_state(body, x, v);
    for (int round = 0; round < 6; ++round) {
        SCOPED_TRACE("seed " + std::to_string(seed) + ", edit " + std::to_string(round));
        for (int i = 0; i < 2; ++i) ASSERT_EQ(world.step().flags, StepFlag::none);
        const VolumeMesh before = world.shape(body).mesh();
        const Momenta whole = momenta(world, body);
        std::vector<std::int32_t> all(before.element_count());
        for (std::size_t e = 0; e < all.size(); ++e) all[e] = std::int32_t(e);
        Momenta gone;
        TopologyDelta delta;
        const Vec3 centre = world.positions(body)[std::size_t(random.uniform(0, double(before.vertices.size())))];
        if (round % 3 == 2) {
            std::vector<std::int32_t> near;
            for (const std::int32_t e : all) {
                Vec3 c = Vec3::Zero();
                for (const std::int32_t i : element_vertices(before, e)) c += world.positions(body)[std::size_t(i)] / double(element_vertices(before, e).size());
                if ((c - centre).norm() < 0.04) near.push_back(e);
            }
            std::vector<Momenta> each(all.size());
            for (const std::int32_t e : all) each[std::size_t(e)] = momenta(world, body, {&e, 1});
            delta = world.remove_elements(body, near);
            for (const std::int32_t e : delta.removed_elements()) {
                gone.mass += each[std::size_t(e)].mass;
                gone.linear += each[std::size_t(e)].linear;
                gone.angular += each[std::size_t(e)].angular;
            }
        } else {
            const Mat3 R = random.rotation();
            const Vec3 u = 0.1 * R.col(0), w = (round == 0 ? 0.5 : 0.06) * R.col(1);
            delta = world.cut(body, swept_blade(std::vector<Vec3>{centre - 5 * u - w, centre + 5 * u - w}, std::vector<Vec3>{centre - 5 * u + w, centre + 5 * u + w}));
        }
        test::expect_consistent(before, {world.shape(body).mesh(), delta});
        test::expect_manifold(world.shape(body).mesh());
        const Momenta now = momenta(world, body);
        EXPECT_NEAR(now.mass + gone.mass, whole.mass, 1e-12 * whole.mass);
        EXPECT_LT((now.linear + gone.linear - whole.linear).norm(), 1e-12 * whole.linear.norm());
        EXPECT_LT((now.angular + gone.angular - whole.angular).norm(), 1e-12 * whole.angular.norm());
        Momenta pieces;
        for (const Piece& piece : world.pieces(body)) {
            const Momenta p = momenta(world, body, piece.elements);
            EXPECT_NEAR(piece.mass_kg, p.mass, 1e-12 * whole.mass);
            pieces.linear += p.linear;
            pieces.angular += p.angular;
        }
        EXPECT_LT((pieces.linear - now.linear).norm(), 1e-12 * whole.linear.norm());

        // A new engine of the mesh as it is now.
        World fresh(exact_world());
        const BodyId same = fresh.add_body({.shape = BodyTemplate::build(world.shape(body).mesh()), .material = kind.material, .density_kg_m3 = 1000});
        fresh.set_state(same, world.positions(body), world.velocities(body));
        const auto stress = world.element_cauchy_stress(body), expected = fresh.element_cauchy_stress(same);
        double largest = 0, off = 0;
        for (std::size_t e = 0; e < expected.size(); ++e)
            for (std::size_t k = 0; k < 6; ++k) {
                largest = std::max(largest, std::abs(expected[e][k]));
                off = std::max(off, std::abs(stress[e][k] - expected[e][k]));
            }
        EXPECT_LT(off, 1e-11 * largest);
        const Eigen::SparseMatrix<double> K = Inspector(world, body).matrix(SystemMatrix::stiffness), fresh_K = Inspector(fresh, same).matrix(SystemMatrix::stiffness);
        EXPECT_LT((K - fresh_K).norm(), 1e-12 * fresh_K.norm());
        World next(exact_world());
        world.step();
        fresh.step();
        EXPECT_LT(test::relative_difference(world.positions(body), fresh.positions(same)), 1e-9);
        EXPECT_LT(test::relative_difference(world.velocities(body), fresh.velocities(same)), 1e-7);
    }
}

TEST(TopologyWorld, RandomEditsConserveMomentaAndEqualAFreshEngine) {
    for (const Kind& kind : kinds())
        for (std::uint64_t seed = 1; seed <= 4; ++seed) run_random_edits(kind, seed);
}

TEST(TopologyWorld, ABarCutInHalfFallsAsTwoBodiesOfTheExactMasses) {
    World world(exact_world({0, -10, 0}));
    const BodyId body = world.add_body({.name = "bar", .shape = test::bar(), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}, .density_kg_m3 = 1000});
    CutReport report;
    world.cut(body, blade_at_x(0.1635), {}, &report);
    EXPECT_GT(report.split_edges, 0u);
    ASSERT_EQ(world.pieces(body).size(), 2u);
    const std::vector<BodyId> others = world.split_off_pieces(body);
    ASSERT_EQ(others.size(), 1u);
    EXPECT_EQ(world.bodies().size(), 2u);
    EXPECT_NEAR(test::total_mass(world, others[0]), 1.635, 1e-12);
    EXPECT_NEAR(test::total_mass(world, body), 4 - 1.635, 1e-12);
    const auto centre = [&](BodyId b) {
        Vec3 c = Vec3::Zero();
        for (std::size_t i = 0; i < world.masses(b).size(); ++i) c += world.masses(b)[i] * world.positions(b)[i];
        return Vec3(c / test::total_mass(world, b));
    };
    const Vec3 start = centre(body), other_start = centre(others[0]);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(world.step().flags, StepFlag::none);
    const Vec3 fall(0, -10 * 0.01 * 0.01 * (20 * 21 / 2), 0);  // implicit Euler
    EXPECT_LT((centre(body) - start - fall).norm(), 1e-9);
    EXPECT_LT((centre(others[0]) - other_start - fall).norm(), 1e-9);
}

TEST(TopologyWorld, ANotchCutOutEqualsAMeshMadeWithTheNotch) {
    WorldDef def{.gravity_m_s2 = Vec3::Zero(), .threads = 1};
    def.solver.integrator = Integrator::quasi_static;
    def.solver.newton_tolerance = 1e-10;
    std::vector<std::int32_t> notch;
    const VolumeMesh whole = test::hex_bar({16, 4, 4})->mesh();
    VolumeMesh made = whole;
    made.hexes.clear();
    for (std::size_t e = 0; e < whole.hexes.size(); ++e) {
        const Vec3 low = whole.vertices[std::size_t(whole.hexes[e][0])];
        if (std::abs(low.x() - 0.2) < 1e-9 && low.y() > 0.04) notch.push_back(std::int32_t(e));
        else made.hexes.push_back(whole.hexes[e]);
    }
    std::vector<std::int32_t> number(whole.vertices.size(), -1);
    made.vertices.clear();
    for (const Hex& h : made.hexes)
        for (const std::int32_t v : h) number[std::size_t(v)] = 0;
    for (std::size_t v = 0; v < number.size(); ++v)
        if (number[v] == 0) {
            number[v] = std::int32_t(made.vertices.size());
            made.vertices.push_back(whole.vertices[v]);
        }
    for (Hex& h : made.hexes)
        for (std::int32_t& v : h) v = number[std::size_t(v)];
    const auto pull = [&](World& world, const std::shared_ptr<const BodyTemplate>& shape, bool carve) {
        const BodyId body = world.add_body({.shape = shape, .material = Corotational{.young_pa = 1e6, .poisson = 0.3}});
        world.fix(body, test::at_x(0));
        world.add_load(body, {.where = test::at_x(0.4), .kind = LoadKind::traction, .value = {.values = {{2e4, 0, 0}}}});
        if (carve) {
            world.step();
            EXPECT_EQ(world.remove_elements(body, notch).removed_elements(), notch);
        }
        EXPECT_EQ(world.step().flags, StepFlag::none);
        EXPECT_LT((world.reaction_n(body) + Vec3(2e4 * 0.01, 0, 0)).norm(), 1e-5);
        return body;
    };
    World carved(def), fresh(def);
    const BodyId a = pull(carved, test::hex_bar({16, 4, 4}), true), b = pull(fresh, BodyTemplate::build(made), false);
    ASSERT_EQ(carved.von_mises(a).size(), fresh.von_mises(b).size());
    double peak = 0;
    for (std::size_t i = 0; i < carved.von_mises(a).size(); ++i) {
        EXPECT_NEAR(carved.von_mises(a)[i], fresh.von_mises(b)[i], 1e-6 * 1e5);
        peak = std::max(peak, carved.von_mises(a)[i]);
    }
    EXPECT_GT(peak, 3.5e4) << "the notch concentrates stress";
}

/// A bar with something of everything on it.
struct Rig {
    World world;
    BodyId body;
    DragId drag;
    AttachmentId attachment;
    explicit Rig(int threads = 1, Integrator integrator = Integrator::implicit_euler, bool hexes = false) : world(make(threads, integrator)) {
        std::vector<Vec3> points{{0.1, 0.11, 0.02}, {0.3, 0.11, 0.02}, {0.2, 0.11, 0.08}};
        const auto shape = hexes ? test::hex_bar({16, 4, 4}) : test::bar();
        BodyDef def{.shape = shape, .material = Corotational{.young_pa = 5e4, .poisson = 0.4}, .density_kg_m3 = 1000};
        def.regions = {{.where = InsideBox{{0.1, -1, -1}, {0.2, 1, 1}}, .material = Corotational{.young_pa = 5e4, .poisson = 0.3, .plasticity = Plasticity{.yield = 0.002}}},
                       {.where = InsideBox{{0.2, -1, -1}, {0.3, 1, 1}}, .rule = ElementRule::centre, .stiffness_factor = 2, .density_kg_m3 = 1500}};
        body = world.add_body(def);
        world.fix(body, test::at_x(0));
        world.prescribe(body, {.where = InsideBox{{0.39, -1, -1}, {1, 0.01, 1}}, .displacement_m = {.times_s = {0, 0.5}, .values = {Vec3::Zero(), Vec3(0.02, 0, 0)}}});
        world.add_load(body, {.where = InsideBox{{0.1, 0.09, -1}, {0.3, 1, 1}}, .kind = LoadKind::total_force, .value = {.values = {{0, -2, 0}}}});
        world.add_load(body, {.where = InsideBox{{0.1, 0.09, -1}, {0.3, 1, 1}}, .kind = LoadKind::traction, .value = {.values = {{50, 0, 0}}}});
        world.add_load(body, {.where = InsideBox{{0.1, -1, -1}, {0.3, 0.001, 1}}, .kind = LoadKind::pressure, .amount = {.values = {100}}});
        world.add_collider({.shape = PlaneShape{{0, 1, 0}, -0.02}, .friction = 0.4});
        drag = world.begin_drag(*world.pick({.origin = {0.25, 1, 0.05}, .direction = {0, -1, 0}}), {.radius_m = 0.04});
        world.move_drag(drag, {0.25, 0.13, 0.05});
        attachment = world.attach({.body = body, .vertices = {40, -1, -1, -1}, .max_force_n = 0});
    }
    static WorldDef make(int threads, Integrator integrator) {
        WorldDef def{.time_step_s = 0.01, .threads = threads};
        def.solver.integrator = integrator;
        return def;
    }
    void run(int steps) {
        for (int i = 0; i < steps; ++i) {
            const StepReport report = world.step();
            EXPECT_TRUE(report.flags == StepFlag::none || report.flags == StepFlag::contact_cap) << "step " << report.step;  // sticking and slipping in turns
        }
    }
    void cut() { world.cut(body, blade_at_x(0.2337, 0.05)); }
    void carve() {
        std::vector<std::int32_t> near;
        const VolumeMesh& m = world.shape(body).mesh();
        for (std::size_t e = 0; e < m.element_count(); ++e)
            if ((m.vertices[std::size_t(element_vertices(m, e)[0])] - Vec3(0.12, 0.08, 0.05)).norm() < 0.03) near.push_back(std::int32_t(e));
        ASSERT_FALSE(near.empty());
        world.remove_elements(body, near);
    }
};

TEST(TopologyWorld, SnapshotsGoAcrossEditsToTheBit) {
    for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2, Integrator::newmark})
        for (const bool hexes : {false, true}) {
            SCOPED_TRACE(std::to_string(int(integrator)) + (hexes ? " hexes" : " tets"));
            Rig a(1, integrator, hexes);
            a.run(5);
            const auto uncut = a.world.save();
            a.cut();
            a.run(4);
            a.carve();
            a.run(3);
            const auto bytes = a.world.save();
            const std::uint64_t at_save = a.world.hash();
            a.run(20);
            const std::uint64_t end = a.world.hash();

            Rig fresh(3, integrator, hexes);  // no edits, other threads
            fresh.world.restore(bytes);
            EXPECT_EQ(fresh.world.hash(), at_save);
            EXPECT_EQ(fresh.world.vertex_ids(fresh.body), a.world.vertex_ids(a.body));
            EXPECT_EQ(fresh.world.element_ids(fresh.body), a.world.element_ids(a.body));
            EXPECT_EQ(fresh.world.start_positions(fresh.body), a.world.start_positions(a.body));
            fresh.run(20);
            EXPECT_EQ(fresh.world.hash(), end);

            Rig other(1, integrator, hexes);  // other edits
            other.run(2);
            other.carve();
            other.run(2);
            other.world.restore(bytes);
            other.run(20);
            EXPECT_EQ(other.world.hash(), end);

            a.world.restore(bytes);  // the same
            a.run(20);
            EXPECT_EQ(a.world.hash(), end);
            a.world.restore(uncut);  // back before the cut
            a.cut();
            a.run(4);
            a.carve();
            a.run(23);
            EXPECT_EQ(a.world.hash(), end);

            auto spoilt = bytes;
            spoilt[spoilt.size() / 2] ^= std::byte{1};
            const std::uint64_t before = fresh.world.hash();
            EXPECT_THROW(fresh.world.restore(spoilt), Error);
            EXPECT_EQ(fresh.world.hash(), before);
        }
}

TEST(TopologyWorld, AnyNumberOfThreadsGivesTheSameBits) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 4}) {
        WorldDef def{.time_step_s = 0.01, .threads = threads};
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar({24, 8, 8}), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
        world.fix(body, test::at_x(0));
        for (int i = 0; i < 3; ++i) world.step();
        world.cut(body, blade_at_x(0.21, 0.04));
        for (int i = 0; i < 20; ++i) world.step();
        hashes.push_back(world.hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(TopologyWorld, SupportsLoadsMatterAndPlasticStrainFollow) {
    Rig rig;
    rig.run(10);
    const VolumeMesh before = rig.world.shape(rig.body).mesh();
    const auto young = std::vector<double>(rig.world.element_young_pa(rig.body).begin(), rig.world.element_young_pa(rig.body).end());
    const auto plastic = rig.world.plastic_strain(rig.body);
    const double mass = test::total_mass(rig.world, rig.body);
    const auto x = copy(rig.world.positions(rig.body)), v = copy(rig.world.velocities(rig.body));
    const double loads_j = rig.world.energy().loads_j;
    const TopologyDelta delta = rig.world.cut(rig.body, blade_at_x(0.1537, 0.05));
    ASSERT_FALSE(delta.is_identity());
    EXPECT_FALSE(delta.cut_elements().empty());
    bool flowed = false;
    for (std::size_t e = 0; e < delta.element_parent.size(); ++e) {
        EXPECT_EQ(rig.world.element_young_pa(rig.body)[e], young[std::size_t(delta.element_parent[e])]);
        EXPECT_EQ(rig.world.plastic_strain(rig.body)[e], plastic[std::size_t(delta.element_parent[e])]);
        flowed = flowed || rig.world.plastic_strain(rig.body)[e][0] != 0;
    }
    EXPECT_TRUE(flowed);
    EXPECT_NEAR(test::total_mass(rig.world, rig.body), mass, 1e-12 * mass);
    for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_GE(delta.vertex_to_new[i], 0);
        EXPECT_EQ(rig.world.positions(rig.body)[std::size_t(delta.vertex_to_new[i])], x[i]);
    }
    EXPECT_NEAR(rig.world.energy().loads_j, loads_j, 0.02 * std::abs(loads_j));
    // Held ends stay held: at rest the supports bear all.
    rig.run(1);
    const auto ids = rig.world.vertex_ids(rig.body);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const Vec3& X = rig.world.shape(rig.body).mesh().vertices[i];
        if (X.x() < 1e-9) {
            EXPECT_EQ(rig.world.positions(rig.body)[i], X);
        }
    }
}

TEST(TopologyWorld, LoadsKeepTheirTotalThroughACutOfTheirVertices) {
    for (const double x : {0.2113, 0.2}) {  // between vertices, and through them
        WorldDef def{.gravity_m_s2 = Vec3::Zero(), .threads = 1};
        def.solver.integrator = Integrator::quasi_static;
        World world(def);
        const BodyId body = world.add_body({.shape = test::bar(), .material = Corotational{.young_pa = 1e6, .poisson = 0.3}});
        world.fix(body, test::at_x(0));
        world.fix(body, test::at_x(0.4));
        const InsideBox top{{0.0999, 0.0999, -1}, {0.3001, 1, 1}};
        world.add_load(body, {.where = top, .kind = LoadKind::total_force, .value = {.values = {{0, 1, 0}}}});
        world.add_load(body, {.where = top, .kind = LoadKind::force_per_vertex, .value = {.values = {{0, 0, 0.01}}}});
        world.add_load(body, {.where = top, .kind = LoadKind::traction, .value = {.values = {{50, 0, 0}}}});
        world.add_load(body, {.where = InsideBox{{0.1, -1, -1}, {0.3, 1, 1}}, .kind = LoadKind::body_force, .value = {.values = {{0, 700, 0}}}});
        world.add_load(body, {.where = top, .kind = LoadKind::pressure, .amount = {.values = {30}}, .follower = false});
        world.step();
        const Vec3 before = world.reaction_n(body);
        EXPECT_NEAR(before.x(), -50 * 0.2 * 0.1, 1e-5);
        world.cut(body, blade_at_x(x, 0.05));
        EXPECT_GT(world.shape(body).mesh().vertices.size(), test::bar()->mesh().vertices.size());
        world.step();
        EXPECT_LT((world.reaction_n(body) - before).norm(), 1e-5 * before.norm());
    }
}

TEST(TopologyWorld, DragsAndAttachmentsLetGoOfWhatIsRemovedAndHoldTheRest) {
    Rig rig;
    rig.run(5);
    const Vec3 anchor = rig.world.drag_state(rig.drag).anchor_m;
    const Vec3 tied = rig.world.attachment_state(rig.attachment).point_m;
    rig.cut();
    EXPECT_LT((rig.world.drag_state(rig.drag).anchor_m - anchor).norm(), 1e-12);
    EXPECT_LT((rig.world.attachment_state(rig.attachment).point_m - tied).norm(), 1e-12);
    rig.run(3);
    EXPECT_GT(rig.world.drag_state(rig.drag).force_n.norm(), 0);
    std::vector<std::int32_t> right;
    const VolumeMesh& m = rig.world.shape(rig.body).mesh();
    for (std::size_t e = 0; e < m.element_count(); ++e)
        if (m.vertices[std::size_t(m.tets[e][0])].x() > 0.15) right.push_back(std::int32_t(e));
    rig.world.release(rig.body, InsideBox{{0.39, -1, -1}, {1, 1, 1}});
    rig.world.remove_elements(rig.body, right);
    supple_test::expect_error(ErrorCode::stale_id, "has ended", [&] { rig.world.drag_state(rig.drag); });
    rig.run(3);
    EXPECT_TRUE(rig.world.contacts().size() < 1000);
}

TEST(TopologyWorld, UndoGivesTheBodyBackAsItStood) {
    Rig rig;
    rig.run(5);
    const auto x = copy(rig.world.positions(rig.body));
    const auto ids = rig.world.vertex_ids(rig.body), elements = rig.world.element_ids(rig.body);
    rig.cut();
    EXPECT_NE(rig.world.vertex_ids(rig.body), ids);
    EXPECT_EQ(rig.world.edit_count(rig.body), 1u);
    rig.run(3);
    rig.carve();
    rig.run(3);
    EXPECT_TRUE(rig.world.undo_edit(rig.body));
    EXPECT_TRUE(rig.world.undo_edit(rig.body));
    EXPECT_FALSE(rig.world.undo_edit(rig.body));
    EXPECT_EQ(rig.world.vertex_ids(rig.body), ids);
    EXPECT_EQ(rig.world.element_ids(rig.body), elements);
    EXPECT_EQ(rig.world.edit_count(rig.body), 4u);
    EXPECT_EQ(copy(rig.world.positions(rig.body)), x);
    rig.run(5);
    const auto bytes = rig.world.save();
    Rig fresh;
    fresh.world.restore(bytes);
    EXPECT_EQ(fresh.world.hash(), rig.world.hash());
}

TEST(TopologyWorld, IdsAreStableAndNeverGivenTwice) {
    Rig rig;
    std::set<std::uint32_t> seen;
    const auto look = [&] {
        const auto ids = rig.world.element_ids(rig.body);
        EXPECT_EQ(std::set<std::uint32_t>(ids.begin(), ids.end()).size(), ids.size());
        EXPECT_EQ(ids.size(), rig.world.shape(rig.body).mesh().element_count());
        return ids;
    };
    const auto first = look();
    const TopologyDelta cut = rig.world.cut(rig.body, blade_at_x(0.2337, 0.05));
    const auto second = look();
    for (std::size_t e = 0; e < second.size(); ++e) {
        const std::int32_t parent = cut.element_parent[e];
        if (cut.element_to_new[std::size_t(parent)] == std::int32_t(e)) {
            EXPECT_EQ(second[e], first[std::size_t(parent)]);
        } else {
            EXPECT_GE(second[e], first.size());
        }
    }
    rig.carve();
    const auto third = look();
    for (const std::uint32_t id : third) EXPECT_TRUE(std::find(second.begin(), second.end(), id) != second.end());
}

TEST(TopologyWorld, SkinsFollowAndGetAnInnerSurface) {
    const auto shape = test::bar();
    BoundarySurface boundary = extract_boundary(shape->mesh());
    const auto skin = Skin::build(shape->mesh(), {shape->mesh().vertices, boundary.triangles});
    World world(exact_world());
    const BodyId body = world.add_body({.shape = shape, .material = Corotational{}, .skin = skin});
    const std::size_t triangles = skin->surface().triangles.size();
    world.cut(body, blade_at_x(0.2337));
    const Skin& now = *world.skin(body);
    EXPECT_GT(now.surface().triangles.size(), triangles);
    const auto x = world.skin_positions(body);
    ASSERT_EQ(x.size(), now.surface().vertices.size());
    EXPECT_LT(test::relative_difference(x, now.surface().vertices), 1e-12) << "at rest it is where it was";
    // Pulled apart by a metre, no triangle bridges the gap.
    std::vector<Vec3> apart = copy(world.positions(body));
    const auto pieces = world.pieces(body);
    ASSERT_EQ(pieces.size(), 2u);
    std::set<std::int32_t> moved;
    for (const std::int32_t e : pieces[1].elements)
        for (const std::int32_t v : element_vertices(world.shape(body).mesh(), e)) moved.insert(v);
    for (const std::int32_t v : moved) apart[std::size_t(v)].x() += 1;
    world.set_state(body, apart, std::vector<Vec3>(apart.size(), Vec3::Zero()));
    const auto pulled = world.skin_positions(body);
    for (const Triangle& t : now.surface().triangles)
        for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((pulled[std::size_t(t[k])] - pulled[std::size_t(t[(k + 1) % 3])]).norm(), 0.2);
    std::vector<std::int32_t> some = pieces[1].elements;
    some.resize(some.size() / 2);
    world.remove_elements(body, some);
    EXPECT_EQ(world.skin_positions(body).size(), world.skin(body)->surface().vertices.size());
    for (int i = 0; i < 3; ++i) EXPECT_EQ(world.step().flags, StepFlag::none);
}

TEST(TopologyWorld, ProbesLookAtWhatIsLeftOfTheirPart) {
    Rig rig;
    Probe box(rig.world, rig.body, {.where = InsideBox{{0.1, -1, -1}, {0.16, 1, 1}}}), list(rig.world, rig.body, {.where = VertexList{{40, 41, 200}}});
    rig.run(5);
    box.read(rig.world);
    list.read(rig.world);
    rig.carve();
    rig.run(3);
    EXPECT_GT(box.read(rig.world).peak_von_mises_pa, 0);
    EXPECT_LT(std::size_t(box.sample().peak_at), rig.world.shape(rig.body).mesh().element_count());
    const std::uint32_t watched[] = {40, 41, 200};
    double farthest = 0;
    const auto ids = rig.world.vertex_ids(rig.body);
    for (std::size_t v = 0; v < ids.size(); ++v)
        if (std::find(std::begin(watched), std::end(watched), ids[v]) != std::end(watched))
            farthest = std::max(farthest, (rig.world.positions(rig.body)[v] - rig.world.start_positions(rig.body)[v]).norm());
    EXPECT_EQ(list.read(rig.world).peak_displacement_m, farthest);
    std::vector<std::int32_t> part;
    const VolumeMesh& m = rig.world.shape(rig.body).mesh();
    for (std::size_t e = 0; e < m.element_count(); ++e)
        if (const double x = m.vertices[std::size_t(m.tets[e][0])].x(); x > 0.07 && x < 0.2) part.push_back(std::int32_t(e));
    rig.world.remove_elements(rig.body, part);
    EXPECT_EQ(box.read(rig.world).peak_von_mises_pa, 0);
}

TEST(TopologyWorld, BadEditsLeaveTheWorldAsItWas) {
    Rig rig;
    rig.run(2);
    const std::uint64_t hash = rig.world.hash();
    const std::int32_t beyond[] = {1 << 20};
    supple_test::expect_error(ErrorCode::invalid_argument, "is outside", [&] { rig.world.remove_elements(rig.body, beyond); });
    supple_test::expect_error(ErrorCode::invalid_argument, "no triangle", [&] { rig.world.cut(rig.body, {}); });
    supple_test::expect_error(ErrorCode::stale_id, "BodyId", [&] { rig.world.cut(BodyId{7, 1}, blade_at_x(0.1)); });
    EXPECT_TRUE(rig.world.cut(rig.body, blade_at_x(70)).is_identity());
    EXPECT_EQ(rig.world.edit_count(rig.body), 0u);
    EXPECT_EQ(rig.world.hash(), hash);
}

}  // namespace
}  // namespace supple
