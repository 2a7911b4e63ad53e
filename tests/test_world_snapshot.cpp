// Saving and restoring: the same bits, also in a fresh process; nothing broken is taken in.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/bodies.h"

namespace supple {
namespace {

namespace fs = std::filesystem;

/// Two bodies, a support, a motion over time, loads and two drags: all that a snapshot must carry or find again.
struct Scene {
    World world;
    BodyId bar, cube;
    DragId strong, weak;

    explicit Scene(Precision precision, int threads = 2) : world(make(precision, threads)) {
        bar = world.add_body({.shape = test::bar(), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
        cube = world.add_body({.shape = test::cube(2, 0.1), .translation_m = {0, 1, 0}, .velocity_m_s = {0, 0, 0.1}});
        world.fix(bar, test::at_x(0));
        Motion motion;
        motion.where = test::at_x(0);
        motion.displacement_m = {{0, 0.2}, {Vec3::Zero(), Vec3(0, 0.05, 0)}};
        world.prescribe(cube, motion);
        world.add_load(bar, {test::at_x(0.4), LoadKind::total_force, {{0, 0.1, 0.2}, {Vec3::Zero(), Vec3(0, 0, 1), Vec3::Zero()}}});
    }
    static WorldDef make(Precision precision, int threads) {
        WorldDef def;
        def.time_step_s = 0.01;
        def.threads = threads;
        def.solver.precision = precision;
        return def;
    }
    void begin_drags() {
        const auto hit = world.pick({{0.35, 0.05, 1}, {0, 0, -1}});
        ASSERT_TRUE(hit && hit->body == bar);
        strong = world.begin_drag(*hit, {.radius_m = 0.03});
        weak = world.begin_drag(*hit, {.max_force_n = 0.01});
        world.move_drag(strong, hit->position_m + Vec3(0, 0.02, 0));
        world.move_drag(weak, hit->position_m + Vec3(0, 0, 1));
    }
    void run(int steps) {
        for (int n = 0; n < steps; ++n) ASSERT_EQ(world.step().flags, StepFlag::none);
    }
};

void expect_corrupt(World& world, std::span<const std::byte> snapshot, const std::string& what) {
    const std::uint64_t before = world.hash();
    try {
        world.restore(snapshot);
        ADD_FAILURE() << "took in " << what;
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::corrupt_snapshot) << what << ": " << e.what();
        EXPECT_FALSE(e.message().empty());
    }
    EXPECT_EQ(world.hash(), before) << what << " changed the world";
}

TEST(WorldSnapshot, ARunGoesOnWithTheSameBits) {
    for (const Precision precision : {Precision::single, Precision::double_}) {
        Scene scene(precision);
        scene.run(5);
        scene.begin_drags();
        scene.run(5);
        const std::vector<std::byte> saved = scene.world.save();
        const std::uint64_t at_save = scene.world.hash();
        scene.run(10);
        const std::uint64_t end = scene.world.hash();
        EXPECT_NE(end, at_save);

        scene.world.restore(saved);
        EXPECT_EQ(scene.world.hash(), at_save);
        EXPECT_EQ(scene.world.step_count(), 10u);
        EXPECT_NEAR(scene.world.time_s(), 0.1, 1e-15);
        EXPECT_EQ(scene.world.save(), saved);
        scene.run(10);
        EXPECT_EQ(scene.world.hash(), end);

        Scene other(precision, 1);  // built by the same calls, with another number of threads
        other.world.restore(saved);
        EXPECT_EQ(other.world.hash(), at_save);
        EXPECT_GT(other.world.drag_state(scene.strong).force_n.norm(), 0) << "drags come back under their ids";
        other.run(10);
        EXPECT_EQ(other.world.hash(), end);
    }
}

TEST(WorldSnapshot, GravityAndTheClockComeBack) {
    Scene scene(Precision::single);
    scene.world.set_gravity({1, 2, 3});
    scene.world.advance(0.0253);
    const std::vector<std::byte> saved = scene.world.save();
    scene.world.set_gravity({0, 0, 0});
    scene.world.advance(0.033);
    scene.world.restore(saved);
    EXPECT_EQ(scene.world.def().gravity_m_s2, Vec3(1, 2, 3));
    EXPECT_EQ(scene.world.step_count(), 2u);
    EXPECT_NEAR(scene.world.advance(0).alpha, 0.53, 1e-9);
}

TEST(WorldSnapshot, DerivedResultsFollowTheRestoredState) {
    Scene scene(Precision::single);
    scene.run(3);
    const std::vector<std::byte> saved = scene.world.save();
    const double stress = scene.world.von_mises(scene.bar)[40], energy = scene.world.energy().elastic_j;
    const Vec3 reaction = scene.world.reaction_n();
    scene.run(20);
    EXPECT_NE(scene.world.von_mises(scene.bar)[40], stress);
    scene.world.restore(saved);
    EXPECT_EQ(scene.world.von_mises(scene.bar)[40], stress);
    EXPECT_EQ(scene.world.energy().elastic_j, energy);
    EXPECT_EQ(scene.world.reaction_n(), reaction);
}

TEST(WorldSnapshot, AFrozenBodyStaysFrozen) {
    Scene scene(Precision::single);
    scene.world.add_load(scene.cube, {Everything{}, LoadKind::total_force, {{}, {Vec3(1e300, 0, 0)}}});
    scene.world.step();
    ASSERT_TRUE(scene.world.is_frozen(scene.cube));
    const std::vector<std::byte> saved = scene.world.save();
    scene.world.unfreeze(scene.cube);
    scene.world.restore(saved);
    EXPECT_TRUE(scene.world.is_frozen(scene.cube));
    EXPECT_FALSE(scene.world.is_frozen(scene.bar));
}

TEST(WorldSnapshot, DragsBegunAfterTheSaveAreGone) {
    Scene scene(Precision::single);
    scene.run(2);
    const std::vector<std::byte> saved = scene.world.save();
    scene.begin_drags();
    scene.run(1);
    scene.world.restore(saved);
    EXPECT_THROW(scene.world.drag_state(scene.strong), Error);
    const DragId old = scene.strong;
    scene.begin_drags();
    EXPECT_NE(scene.strong, old);
    EXPECT_THROW(scene.world.end_drag(old), Error) << "an old handle must not take hold of a new drag";
}

/// Runs this test again in a fresh process, told what to do by the environment; returns its hash.
std::string continued_by_a_fresh_process(const fs::path& folder, const std::string& precision) {
    const std::string executable = fs::read_symlink("/proc/self/exe").string();
    const std::string command = "SUPPLE_TEST_CONTINUE='" + folder.string() + "' SUPPLE_TEST_PRECISION=" + precision + " '" + executable +
                                "' --gtest_filter=WorldSnapshot.AFreshProcessGoesOnWithTheSameBits > '" + (folder / "log.txt").string() + "' 2>&1";
    if (std::system(command.c_str()) != 0) {
        std::ifstream log(folder / "log.txt");
        return "failed:\n" + std::string(std::istreambuf_iterator<char>(log), {});
    }
    std::ifstream in(folder / "hash.txt");
    std::string hash;
    in >> hash;
    return hash;
}

void continue_in(const fs::path& folder, Precision precision) {
    std::ifstream in(folder / "snapshot.bin", std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    Scene scene(precision, 3);
    scene.world.restore(std::as_bytes(std::span(bytes)));
    scene.run(10);
    std::ofstream(folder / "hash.txt") << scene.world.hash();
}

TEST(WorldSnapshot, AFreshProcessGoesOnWithTheSameBits) {
    if (const char* folder = std::getenv("SUPPLE_TEST_CONTINUE")) {  // the fresh process
        continue_in(folder, std::getenv("SUPPLE_TEST_PRECISION") == std::string("single") ? Precision::single : Precision::double_);
        return;
    }
    for (const bool single : {true, false}) {
        const fs::path folder = fs::temp_directory_path() / ("supple_snapshot_" + std::to_string(::getpid()));
        fs::create_directories(folder);
        Scene scene(single ? Precision::single : Precision::double_);
        scene.run(4);
        scene.begin_drags();
        scene.run(4);
        const std::vector<std::byte> saved = scene.world.save();
        std::ofstream(folder / "snapshot.bin", std::ios::binary).write(reinterpret_cast<const char*>(saved.data()), std::streamsize(saved.size()));
        scene.run(10);
        EXPECT_EQ(continued_by_a_fresh_process(folder, single ? "single" : "double"), std::to_string(scene.world.hash()));
        fs::remove_all(folder);
    }
}

struct Small {
    World world;
    BodyId body;
    Small() : world(Scene::make(Precision::single, 1)), body(world.add_body({.shape = test::unit_tet()})) {
        world.fix(body, VertexList{{0}});
        const auto hit = world.pick({{0.2, 0.2, 5}, {0, 0, -1}});
        EXPECT_TRUE(hit.has_value());
        world.begin_drag(*hit);
        for (int n = 0; n < 3; ++n) world.step();
    }
};

TEST(WorldSnapshot, EveryTruncationIsRefused) {
    Small small;
    const std::vector<std::byte> saved = small.world.save();
    for (std::size_t size = 0; size < saved.size(); ++size) expect_corrupt(small.world, std::span(saved).first(size), std::to_string(size) + " bytes");
    auto longer = saved;
    longer.push_back(std::byte(0));
    expect_corrupt(small.world, longer, "one byte too many");
    small.world.restore(saved);
}

TEST(WorldSnapshot, EveryChangedByteIsRefused) {
    Small small;
    const std::vector<std::byte> saved = small.world.save();
    small.world.step();
    for (std::size_t i = 0; i < saved.size(); ++i) {
        auto bad = saved;
        bad[i] ^= std::byte(1u << (i % 8));
        expect_corrupt(small.world, bad, "byte " + std::to_string(i));
    }
}

TEST(WorldSnapshot, AnotherSceneIsRefusedAndTheReasonNamed) {
    Scene scene(Precision::single);
    const std::vector<std::byte> saved = scene.world.save();
    const auto refused = [&](World& world, const char* word) {
        expect_corrupt(world, saved, word);
        try {
            world.restore(saved);
        } catch (const Error& e) {
            EXPECT_NE(e.message().find(word), std::string::npos) << e.message();
        }
    };
    Scene other(Precision::double_);
    refused(other.world, "precision");
    WorldDef def = Scene::make(Precision::single, 1);
    def.time_step_s = 0.02;
    World step(def);
    refused(step, "time_step_s");
    World empty(Scene::make(Precision::single, 1));
    refused(empty, "bodies");
    World shapes(Scene::make(Precision::single, 1));
    shapes.add_body({.shape = test::bar({4, 1, 1})});
    shapes.add_body({.shape = test::cube(2)});
    refused(shapes, "entries");
    Scene removed(Precision::single);
    removed.world.remove_body(removed.cube);
    removed.world.add_body({.shape = test::cube(2, 0.1)});
    refused(removed.world, "ids");
    expect_corrupt(scene.world, std::as_bytes(std::span("this is not a snapshot, only some text")), "text");
    expect_corrupt(scene.world, {}, "nothing");
}

// -- reset -------------------------------------------------------------------------------------------

TEST(WorldReset, GoesBackToTheStartForGood) {
    Scene fresh(Precision::single), scene(Precision::single);
    scene.run(5);
    scene.begin_drags();
    scene.run(5);
    scene.world.advance(0.005);
    scene.world.reset();
    EXPECT_EQ(scene.world.hash(), fresh.world.hash());
    EXPECT_EQ(scene.world.step_count(), 0u);
    EXPECT_EQ(scene.world.time_s(), 0);
    EXPECT_EQ(scene.world.advance(0).alpha, 0);
    EXPECT_THROW(scene.world.drag_state(scene.strong), Error);
    EXPECT_EQ(test::copy(scene.world.previous_positions(scene.bar)), test::copy(fresh.world.previous_positions(fresh.bar)));
    scene.run(10);
    fresh.run(10);
    EXPECT_EQ(scene.world.hash(), fresh.world.hash());
}

}  // namespace
}  // namespace supple
