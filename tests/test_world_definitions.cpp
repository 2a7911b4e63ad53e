// Every bad definition is refused by name, every stale id is an error.
#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple {
namespace {

const double kNaN = std::nan("");

template <class Call>
void expect_error(ErrorCode code, const std::string& where, Call&& call) {
    try {
        call();
        ADD_FAILURE() << "accepted a bad " << where;
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        EXPECT_NE(e.where().find(where), std::string::npos) << e.what();
        EXPECT_FALSE(e.message().empty());
    }
}

template <class Change>
void bad_world(const std::string& field, Change&& change) {
    WorldDef def;
    change(def);
    expect_error(ErrorCode::invalid_argument, "WorldDef." + field, [&] { World world(def); });
}

TEST(WorldDefinitions, EveryFieldOfWorldDefIsChecked) {
    bad_world("gravity_m_s2", [](WorldDef& d) { d.gravity_m_s2.x() = kNaN; });
    for (const double h : {0.0, -0.01, 1.5, kNaN, HUGE_VAL}) bad_world("time_step_s", [&](WorldDef& d) { d.time_step_s = h; });
    for (const int threads : {-1, 257}) bad_world("threads", [&](WorldDef& d) { d.threads = threads; });
    for (const int steps : {0, 1001}) bad_world("max_catch_up_steps", [&](WorldDef& d) { d.max_catch_up_steps = steps; });
    for (const int n : {-1, 1001}) bad_world("solver.newton_iterations", [&](WorldDef& d) { d.solver.newton_iterations = n; });
    for (const double t : {-0.1, 1.0, kNaN}) bad_world("solver.newton_tolerance", [&](WorldDef& d) { d.solver.newton_tolerance = t; });
    for (const double t : {0.0, 1.0, -1e-5, kNaN}) bad_world("solver.cg_relative_tolerance", [&](WorldDef& d) { d.solver.cg_relative_tolerance = t; });
    for (const int n : {0, -5, 1000001}) bad_world("solver.cg_max_iterations", [&](WorldDef& d) { d.solver.cg_max_iterations = n; });
    for (const double a : {-1.0, 1e7, kNaN}) bad_world("solver.rayleigh_mass_1_s", [&](WorldDef& d) { d.solver.rayleigh_mass_1_s = a; });
    for (const double b : {-1.0, 1e4, kNaN}) bad_world("solver.rayleigh_stiffness_s", [&](WorldDef& d) { d.solver.rayleigh_stiffness_s = b; });
    World good;
    expect_error(ErrorCode::invalid_argument, "set_gravity", [&] { good.set_gravity({0, kNaN, 0}); });
}

template <class Change>
void bad_body(const std::string& field, Change&& change) {
    BodyDef def{.shape = test::unit_tet()};
    change(def);
    World world;
    const std::uint64_t before = world.hash();
    expect_error(ErrorCode::invalid_argument, "BodyDef", [&] { world.add_body(def); });
    try {
        world.add_body(def);
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find(field), std::string::npos) << e.what();
    }
    EXPECT_TRUE(world.bodies().empty());
    EXPECT_EQ(world.hash(), before);
}

TEST(WorldDefinitions, EveryFieldOfBodyDefIsChecked) {
    bad_body("shape", [](BodyDef& d) { d.shape = nullptr; });
    for (const double rho : {0.0, -1.0, kNaN, HUGE_VAL}) bad_body("density_kg_m3", [&](BodyDef& d) { d.density_kg_m3 = rho; });
    bad_body("translation_m", [](BodyDef& d) { d.translation_m.y() = HUGE_VAL; });
    bad_body("velocity_m_s", [](BodyDef& d) { d.velocity_m_s.z() = kNaN; });
    bad_body("young_pa", [](BodyDef& d) { d.material = Corotational{.young_pa = -5}; });
    bad_body("poisson", [](BodyDef& d) { d.material = Corotational{.poisson = 0.5}; });
    bad_body("young_pa_per_element", [](BodyDef& d) { d.young_pa_per_element = {1e5, 1e5}; });
    bad_body("poisson_per_element", [](BodyDef& d) { d.poisson_per_element = {0.1, 0.2, 0.3}; });
    bad_body("young_pa", [](BodyDef& d) { d.young_pa_per_element = {0}; });
    bad_body("element 0", [](BodyDef& d) { d.young_pa_per_element = {kNaN}; });
    bad_body("poisson", [](BodyDef& d) { d.poisson_per_element = {0.5}; });
}

TEST(WorldDefinitions, ShapesAreChecked) {
    VolumeMesh mesh = test::unit_tet()->mesh();
    for (const double scale : {0.0, -1.0, kNaN, HUGE_VAL}) {
        expect_error(ErrorCode::invalid_argument, "", [&] { BodyTemplate::build(mesh, scale); });
    }
    EXPECT_NEAR(BodyTemplate::build(mesh, 0.01)->report().volume_m3, 1e-6 / 6, 1e-20);
    VolumeMesh surface;
    surface.vertices = mesh.vertices;
    expect_error(ErrorCode::surface_mesh, "", [&] { BodyTemplate::build(surface); });
    EXPECT_NEAR(BodyTemplate::build(make_hex_box({}))->report().volume_m3, 1, 1e-15);
    VolumeMesh folded = make_hex_box({});
    std::swap(folded.vertices[6], folded.vertices[7]);
    expect_error(ErrorCode::invalid_argument, "", [&] { BodyTemplate::build(folded); });
}

struct OneTet {
    World world;
    BodyId body = world.add_body({.shape = test::unit_tet()});
};

TEST(WorldDefinitions, SelectionsMustHoldSomething) {
    OneTet w;
    const InsideBox nowhere{{5, 5, 5}, {6, 6, 6}};
    expect_error(ErrorCode::invalid_argument, "World::fix", [&] { w.world.fix(w.body, nowhere); });
    expect_error(ErrorCode::invalid_argument, "World::release", [&] { w.world.release(w.body, nowhere); });
    expect_error(ErrorCode::invalid_argument, "Load.where", [&] { w.world.add_load(w.body, {nowhere, LoadKind::total_force, {{}, {Vec3::Zero()}}}); });
    expect_error(ErrorCode::invalid_argument, "", [&] { w.world.fix(w.body, VertexList{{4}}); });
    expect_error(ErrorCode::invalid_argument, "", [&] { w.world.fix(w.body, InGroup{"ligament"}); });
    // A traction needs a triangle, a body force an element.
    expect_error(ErrorCode::invalid_argument, "Load.where", [&] { w.world.add_load(w.body, {VertexList{{1}}, LoadKind::traction, {{}, {Vec3::UnitX()}}}); });
    expect_error(ErrorCode::invalid_argument, "Load.where", [&] { w.world.add_load(w.body, {VertexList{{1}}, LoadKind::body_force, {{}, {Vec3::UnitX()}}}); });
    try {
        w.world.fix(w.body, nowhere);
    } catch (const Error& e) {
        EXPECT_NE(e.message().find("(1, 1, 1)"), std::string::npos) << "says where the body is: " << e.message();
    }
}

TEST(WorldDefinitions, TimelinesAreChecked) {
    OneTet w;
    const auto load = [&](const Timeline<Vec3>& line) {
        expect_error(ErrorCode::invalid_argument, "Load.value", [&] { w.world.add_load(w.body, {Everything{}, LoadKind::total_force, line}); });
    };
    load({});
    load({{0, 1}, {Vec3::Zero()}});
    load({{0}, {Vec3::Zero(), Vec3::Zero()}});
    load({{1, 1}, {Vec3::Zero(), Vec3::Zero()}});
    load({{2, 1}, {Vec3::Zero(), Vec3::Zero()}});
    load({{0, kNaN}, {Vec3::Zero(), Vec3::Zero()}});
    load({{}, {Vec3(0, HUGE_VAL, 0)}});
    const auto motion = [&](const Motion& m, const char* where) {
        expect_error(ErrorCode::invalid_argument, where, [&] { w.world.prescribe(w.body, m); });
    };
    Motion none;
    motion(none, "Motion");
    Motion two;
    two.displacement_m.values = two.velocity_m_s.values = {Vec3::Zero()};
    motion(two, "Motion");
    Motion bad;
    bad.displacement_m = {{1, 0}, {Vec3::Zero(), Vec3::Zero()}};
    motion(bad, "Motion.displacement_m");
    bad = {};
    bad.velocity_m_s = {{}, {Vec3(kNaN, 0, 0)}};
    motion(bad, "Motion.velocity_m_s");
    bad = {};
    bad.affine.values = {Mat34::Constant(kNaN)};
    motion(bad, "Motion.affine");
    EXPECT_EQ(w.world.step().flags, StepFlag::none) << "nothing of it was kept";
}

TEST(WorldDefinitions, StatesAreChecked) {
    OneTet w;
    const auto x = test::copy(w.world.positions(w.body)), v = test::copy(w.world.velocities(w.body));
    const std::uint64_t before = w.world.hash();
    auto bad = x;
    bad[1].x() = kNaN;
    expect_error(ErrorCode::invalid_argument, "set_state", [&] { w.world.set_state(w.body, std::span(x).first(3), v); });
    expect_error(ErrorCode::invalid_argument, "set_state", [&] { w.world.set_state(w.body, x, std::span(v).first(3)); });
    expect_error(ErrorCode::invalid_argument, "set_state", [&] { w.world.set_state(w.body, bad, v); });
    expect_error(ErrorCode::invalid_argument, "set_state", [&] { w.world.set_state(w.body, x, bad); });
    EXPECT_EQ(w.world.hash(), before);
}

TEST(WorldDefinitions, DragsAreChecked) {
    OneTet w;
    const auto hit = w.world.pick({{0.2, 0.2, 5}, {0, 0, -1}});
    ASSERT_TRUE(hit.has_value());
    for (const double bad : {-1.0, kNaN, HUGE_VAL}) {
        expect_error(ErrorCode::invalid_argument, "DragDef.radius_m", [&] { w.world.begin_drag(*hit, {.radius_m = bad}); });
        expect_error(ErrorCode::invalid_argument, "DragDef.stiffness_n_m", [&] { w.world.begin_drag(*hit, {.stiffness_n_m = bad}); });
        expect_error(ErrorCode::invalid_argument, "DragDef.max_force_n", [&] { w.world.begin_drag(*hit, {.max_force_n = bad}); });
    }
    for (const std::int32_t triangle : {-1, 4}) {
        PickHit wrong = *hit;
        wrong.triangle = triangle;
        expect_error(ErrorCode::invalid_argument, "PickHit.triangle", [&] { w.world.begin_drag(wrong); });
    }
    PickHit wrong = *hit;
    wrong.position_m.x() = kNaN;
    expect_error(ErrorCode::invalid_argument, "PickHit", [&] { w.world.begin_drag(wrong); });
    wrong = *hit;
    wrong.barycentric = {0, 0, 0};
    expect_error(ErrorCode::invalid_argument, "PickHit", [&] { w.world.begin_drag(wrong); });
    const DragId drag = w.world.begin_drag(*hit);
    expect_error(ErrorCode::invalid_argument, "move_drag", [&] { w.world.move_drag(drag, {0, kNaN, 0}); });
    expect_error(ErrorCode::invalid_argument, "", [&] { (void)w.world.pick({Vec3::Zero(), Vec3::Zero()}); });
}

// -- ids ---------------------------------------------------------------------------------------------

void expect_stale(World& world, BodyId id) {
    const Motion motion;
    const std::vector<Vec3> field(4, Vec3::Zero());
    const auto stale = [&](auto&& call) { expect_error(ErrorCode::stale_id, "BodyId", call); };
    stale([&] { world.remove_body(id); });
    stale([&] { (void)world.shape(id); });
    stale([&] { (void)world.name(id); });
    stale([&] { world.fix(id, Everything{}); });
    stale([&] { world.release(id, Everything{}); });
    stale([&] { world.prescribe(id, motion); });
    stale([&] { world.add_load(id, {}); });
    stale([&] { world.clear_loads(id); });
    stale([&] { world.set_state(id, field, field); });
    stale([&] { (void)world.positions(id); });
    stale([&] { (void)world.previous_positions(id); });
    stale([&] { (void)world.velocities(id); });
    stale([&] { (void)world.masses(id); });
    stale([&] { (void)world.von_mises(id); });
    stale([&] { (void)world.cauchy_stress(id); });
    stale([&] { (void)world.element_von_mises(id); });
    stale([&] { (void)world.element_cauchy_stress(id); });
    stale([&] { (void)world.reaction_n(id); });
    stale([&] { (void)world.reactions(id); });
    stale([&] { (void)world.is_frozen(id); });
    stale([&] { world.unfreeze(id); });
    stale([&] { world.begin_drag({.body = id, .triangle = 0}); });
}

TEST(WorldIds, StaleBodiesAreErrorsEverywhere) {
    World world;
    expect_stale(world, {});
    expect_stale(world, {7, 1});
    const BodyId first = world.add_body({.shape = test::unit_tet()});
    const BodyId second = world.add_body({.shape = test::unit_tet()});
    EXPECT_EQ(world.bodies(), (std::vector<BodyId>{first, second}));
    world.remove_body(first);
    expect_stale(world, first);
    EXPECT_EQ(world.bodies(), std::vector<BodyId>{second});
    const BodyId third = world.add_body({.shape = test::unit_tet()});
    EXPECT_EQ(third.index, first.index) << "slots are used again";
    EXPECT_NE(third, first);
    expect_stale(world, first);
    EXPECT_EQ(world.bodies(), (std::vector<BodyId>{second, third}));
    EXPECT_EQ(world.step().flags, StepFlag::none);
}

TEST(WorldIds, StaleDragsAreErrors) {
    World world;
    const BodyId body = world.add_body({.shape = test::unit_tet()});
    const auto stale = [&](DragId id) {
        expect_error(ErrorCode::stale_id, "DragId", [&] { world.move_drag(id, Vec3::Zero()); });
        expect_error(ErrorCode::stale_id, "DragId", [&] { (void)world.drag_state(id); });
        expect_error(ErrorCode::stale_id, "DragId", [&] { world.end_drag(id); });
    };
    stale({});
    stale({3, 1});
    const auto hit = world.pick({{0.2, 0.2, 5}, {0, 0, -1}});
    ASSERT_TRUE(hit.has_value());
    const DragId drag = world.begin_drag(*hit);
    world.end_drag(drag);
    stale(drag);
    const DragId next = world.begin_drag(*hit);
    stale(drag);
    world.remove_body(body);
    stale(next);
    EXPECT_EQ(world.step().flags, StepFlag::none);
}

TEST(WorldIds, NamesAndMessages) {
    World world;
    EXPECT_EQ(world.name(world.add_body({.name = "liver", .shape = test::unit_tet()})), "liver");
    EXPECT_EQ(world.name(world.add_body({.shape = test::unit_tet()})), "body 1");
    std::vector<std::string> messages;
    WorldDef def;
    def.log = [&](LogLevel level, std::string_view text) {
        EXPECT_EQ(level, LogLevel::warning);
        messages.emplace_back(text);
    };
    World talking(def);
    VolumeMesh mesh = test::unit_tet()->mesh();
    mesh.tets = {{0, 2, 1, 3}};
    talking.add_body({.name = "turned", .shape = BodyTemplate::build(mesh), .material = Corotational{.poisson = 0.49}});
    ASSERT_EQ(messages.size(), 2u);
    for (const std::string& text : messages) EXPECT_EQ(text.rfind("turned: ", 0), 0u) << text;
}

TEST(WorldIds, MessagesNameWhatAMaterialWillNotDo) {
    std::vector<std::string> messages;
    WorldDef def;
    def.log = [&](LogLevel, std::string_view text) { messages.emplace_back(text); };
    def.solver.tangent = Tangent::exact;
    World world(def);
    const BoxDef box{.min_m = Vec3::Zero(), .max_m = Vec3::Ones(), .cells = {1, 1, 1}};
    const auto hexes = BodyTemplate::build(make_hex_box(box)), tets = BodyTemplate::build(make_tet_box(box));
    world.add_body({.shape = hexes, .material = Linear{}});
    world.add_body({.shape = tets, .material = Corotational{}});
    world.add_body({.shape = tets, .material = Corotational{.poisson = 0.49, .volumetric = Volumetric::nodal}});
    world.add_body({.shape = hexes, .material = Corotational{.poisson = 0.49}});
    EXPECT_TRUE(messages.empty());
    world.add_body({.shape = tets, .poisson_per_element = std::vector<double>(6, 0.49)});
    ASSERT_EQ(messages.size(), 1u);
    EXPECT_NE(messages[0].find("nodal"), std::string::npos) << messages[0];
}

TEST(WorldIds, AWorldCanBeMoved) {
    World first;
    const BodyId body = first.add_body({.shape = test::unit_tet()});
    first.step();
    const std::uint64_t hash = first.hash();
    World second(std::move(first));
    EXPECT_EQ(second.hash(), hash);
    World third;
    third = std::move(second);
    EXPECT_EQ(third.positions(body).size(), 4u);
    EXPECT_EQ(third.step().step, 2u);
}

}  // namespace
}  // namespace supple
