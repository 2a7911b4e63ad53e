// A step in the steady state allocates nothing: every form of operator new is counted for this whole executable, on all threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <malloc.h>
#include <cstdlib>
#include <new>

#include "supple/base/aligned.h"
#include "support/bodies.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SUPPLE_OWN_ALLOCATOR 0  // the sanitizers bring their own
#else
#define SUPPLE_OWN_ALLOCATOR 1
#endif

namespace {
std::atomic<bool> counting{false};
std::atomic<long> allocations{0}, releases{0}, live_bytes{0};  // the last of all memory, counted or not
}  // namespace

#if SUPPLE_OWN_ALLOCATOR
namespace {
void* counted(std::size_t size, std::size_t alignment) {
    if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
    const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
    void* p = alignment <= alignof(std::max_align_t) ? std::malloc(size == 0 ? 1 : size) : std::aligned_alloc(alignment, rounded == 0 ? alignment : rounded);
    if (p == nullptr) throw std::bad_alloc();
    live_bytes.fetch_add(long(malloc_usable_size(p)), std::memory_order_relaxed);
    return p;
}
void released(void* p) {
    if (p != nullptr) live_bytes.fetch_sub(long(malloc_usable_size(p)), std::memory_order_relaxed);
    if (p != nullptr && counting.load(std::memory_order_relaxed)) releases.fetch_add(1, std::memory_order_relaxed);
    std::free(p);
}
}  // namespace

void* operator new(std::size_t size) { return counted(size, 1); }
void* operator new[](std::size_t size) { return counted(size, 1); }
void* operator new(std::size_t size, std::align_val_t a) { return counted(size, std::size_t(a)); }
void* operator new[](std::size_t size, std::align_val_t a) { return counted(size, std::size_t(a)); }
void operator delete(void* p) noexcept { released(p); }
void operator delete[](void* p) noexcept { released(p); }
void operator delete(void* p, std::size_t) noexcept { released(p); }
void operator delete[](void* p, std::size_t) noexcept { released(p); }
void operator delete(void* p, std::align_val_t) noexcept { released(p); }
void operator delete[](void* p, std::align_val_t) noexcept { released(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { released(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { released(p); }
#endif

namespace supple {
namespace {

bool skipped() {
    if (SUPPLE_OWN_ALLOCATOR) return false;
    std::printf("skipped: a sanitizer owns operator new; allocations were not counted\n");
    return true;
}

template <class Work>
long allocations_of(Work&& work) {
    allocations = 0;
    releases = 0;
    counting = true;
    work();
    counting = false;
    return allocations + releases;
}

TEST(WorldAllocation, TheCounterCounts) {
    if (skipped()) return;
    EXPECT_EQ(allocations_of([] {}), 0);
    EXPECT_GE(allocations_of([] { delete new std::vector<double>(100); }), 4);
    EXPECT_GE(allocations_of([] { AlignedVector<double> v(100); }), 2);
}

/// A world in which everything is going on: several bodies, supports, prescribed motion, loads, two drags (one at its cap).
struct Busy {
    World world;
    DragId drag;
    Vec3 at;

    explicit Busy(const WorldDef& def) : world(def) {
        const BodyId bar = world.add_body({.shape = test::bar(), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
        world.fix(bar, test::at_x(0));
        world.add_load(bar, {Everything{}, LoadKind::body_force, {{0, 1}, {Vec3(0, 0, 0), Vec3(0, 100, 0)}}});
        Load squeeze{test::at_x(0.4), LoadKind::pressure};
        squeeze.amount.values = {500};
        world.add_load(bar, squeeze);
        squeeze.follower = false;
        world.add_load(bar, squeeze);
        Load twist{test::at_x(0.4), LoadKind::moment};
        twist.amount = {{0, 1}, {0, 0.1}};
        twist.axis = Vec3(1, 0, 0);
        world.add_load(bar, twist);
        const BodyId cube = world.add_body({.shape = test::cube(3, 0.1), .translation_m = {0, 1, 0}});
        Motion motion;
        motion.where = test::at_x(0);
        motion.displacement_m = {{0, 1}, {Vec3::Zero(), Vec3(0.1, 0, 0)}};
        world.prescribe(cube, motion);
        const BodyId hexes = world.add_body({.shape = test::hex_bar({8, 2, 2}), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}, .translation_m = {0, 2, 0}});
        world.fix(hexes, test::at_x(0));
        world.add_body({.shape = test::irregular_hex_cube(2, 0.2, 1), .material = NeoHookean{}, .translation_m = {0, 4, 0}});
        const auto hit = world.pick({{0.35, 0.05, 1}, {0, 0, -1}});
        EXPECT_TRUE(hit.has_value());
        at = hit->position_m;
        drag = world.begin_drag(*hit, {.radius_m = 0.04});
        const auto other = world.pick({{0.1, 1.05, 1}, {-0.01, 0, -1}});
        EXPECT_TRUE(other && other->body == cube);
        const DragId weak = world.begin_drag(*other, {.max_force_n = 1e-3});
        world.move_drag(weak, other->position_m + Vec3(1, 0, 0));
    }
    void step(int n) {
        world.move_drag(drag, at + Vec3(0, 0.001 * n, 0));
        EXPECT_EQ(world.step().flags, StepFlag::none);
    }
};

TEST(WorldAllocation, BodiesThatTouchAllocateNothing) {
    if (skipped()) return;
    for (const Precision precision : {Precision::single, Precision::double_}) {
        WorldDef def;
        def.threads = 1;
        def.solver.precision = precision;
        World world(def);
        world.add_collider({});
        const BodyId low = world.add_body({.shape = test::cube(3, 0.1), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
        world.add_body({.shape = test::cube(2, 0.06), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}, .translation_m = {0.02, 0.1005, 0.02}, .touches_itself = true});
        world.begin_drag(*world.pick({{0.05, 0.05, 1}, {0, 0, -1}}), {.radius_m = 0.04});
        for (int n = 0; n < 200; ++n) world.step();
        EXPECT_TRUE(std::any_of(world.contacts().begin(), world.contacts().end(), [&](const ContactPoint& c) { return c.other == low; }));
        EXPECT_EQ(allocations_of([&] {
                      for (int n = 0; n < 10; ++n) world.step();
                  }),
                  0);
    }
}

void expect_no_allocation(const WorldDef& def, const char* what) {
    Busy busy(def);
    for (int n = 0; n < 3; ++n) busy.step(n);
    EXPECT_EQ(allocations_of([&] {
                  for (int n = 3; n < 13; ++n) busy.step(n);
              }),
              0)
        << what;
    EXPECT_EQ(allocations_of([&] { busy.world.advance(0.05); }), 0) << what << ", advance";
}

TEST(WorldAllocation, AStepAllocatesNothing) {
    if (skipped()) return;
    for (const Precision precision : {Precision::single, Precision::double_}) {
        for (const int threads : {1, 2, 3}) {
            WorldDef def;
            def.time_step_s = 0.01;
            def.threads = threads;
            def.solver.precision = precision;
            expect_no_allocation(def, "one Newton iteration");
            def.solver.newton_iterations = 3;
            def.solver.newton_tolerance = 0.5;
            def.solver.linearise_at = LineariseAt::current;
            def.solver.rayleigh_stiffness_s = 0.001;
            def.stress_each_step = true;
            expect_no_allocation(def, "Newton, damping, stress");
            def.solver.preconditioner = PreconditionerKind::lattice_multigrid;
            expect_no_allocation(def, "multigrid");
            def.solver.preconditioner = PreconditionerKind::scalar_laplacian;
            expect_no_allocation(def, "scalar Laplacian");
        }
    }
}

TEST(WorldAllocation, ReadingAllocatesNothingTheSecondTime) {
    if (skipped()) return;
    WorldDef def;
    def.threads = 1;
    Busy busy(def);
    const BodyId body = busy.world.bodies().front();
    busy.step(0);
    (void)busy.world.von_mises(body);
    const StressDef green{StrainMeasure::green, Recovery::spr, StressAt::vertex, true};
    StressField field = busy.world.stress(body, green);
    busy.step(1);
    double sum = 0;
    EXPECT_EQ(allocations_of([&] {
                  sum += busy.world.von_mises(body)[0] + busy.world.positions(body)[0].x() + busy.world.velocities(body)[0].x();
                  busy.world.stress(body, green, field);
                  sum += busy.world.cauchy_stress(body)[0][0] + field.von_mises_pa[0] + busy.world.drag_state(busy.drag).force_n.x();
              }),
              0)
        << sum;
}

TEST(WorldAllocation, AStepInContactAllocatesOnlyWhenThereAreMoreContactsThanEver) {
    if (skipped()) return;
    WorldDef def;
    def.threads = 1;
    World world(def);
    const BodyId body = world.add_body({.shape = test::cube(4, 0.1), .material = Corotational{.young_pa = 5e4, .poisson = 0.4}});
    world.add_collider({});
    const ColliderId tool = world.add_collider({.shape = BoxShape{Vec3(0.01, 0.02, 0.01)}, .pose = {Vec3(0.05, 0.14, 0.05), {1, 0, 0, 0}}, .motion = ColliderMotion::kinematic});
    world.add_collider({.shape = SphereShape{0.02}, .pose = {Vec3(0.02, 0.13, 0.02), {1, 0, 0, 0}}, .motion = ColliderMotion::dynamic, .mass_kg = 0.1});
    world.attach({.body = body, .vertices = {0, -1, -1, -1}});
    const auto run = [&](int steps) {
        for (int n = 0; n < steps; ++n) {
            world.move_collider(tool, {Vec3(0.05 + 0.01 * std::sin(0.3 * n), 0.115, 0.05), {1, 0, 0, 0}});
            world.step();
        }
    };
    run(120);
    const std::size_t bytes = world.step().contact_bytes;
    const long count = allocations_of([&] { run(40); });
    EXPECT_EQ(world.step().contact_bytes, bytes) << "contact memory grew: choose a longer start";
    EXPECT_EQ(count, 0);
    EXPECT_GT(world.contacts().size(), 20u);
}

/// The most memory in use after any of some cycles.
template <class Cycle>
long most_bytes(int cycles, Cycle&& cycle) {
    long most = 0;
    for (int i = 0; i < cycles; ++i) {
        cycle();
        most = std::max(most, live_bytes.load());
    }
    return most;
}

TEST(WorldMemory, HundredsOfEditsOfABodyTakeNoMoreThanTheFirst) {
    if (skipped()) return;
    World world({.time_step_s = 0.01, .threads = 1});
    const BodyId body = world.add_body({.shape = test::bar({8, 2, 2}), .material = Corotational{.young_pa = 1e5, .poisson = 0.4}});
    world.fix(body, test::at_x(0));
    world.add_collider({.shape = PlaneShape{{0, 1, 0}, -0.002}});
    for (int i = 0; i < 100; ++i) world.step();  // it lies on the plane: the most contacts have been there
    const VolumeMesh original = world.shape(body).mesh();
    const auto settle = [&] {
        for (int i = 0; i < 2; ++i) world.step();
    };
    const auto tip = [&] {  // elements at the far end: their numbers wander as they go and come back
        std::vector<std::int32_t> out;
        const VolumeMesh& m = world.shape(body).mesh();
        for (std::size_t e = 0; e < m.tets.size(); ++e)
            if (std::any_of(m.tets[e].begin(), m.tets[e].end(), [&](std::int32_t v) { return m.vertices[std::size_t(v)].x() > 0.399; })) out.push_back(std::int32_t(e));
        return out;
    };
    const auto erase_and_undo = [&] {
        world.remove_elements(body, tip());
        settle();
        world.undo_edit(body);
        settle();
    };
    const auto erase_and_add = [&] {
        const VolumeMesh before = world.shape(body).mesh();
        const TopologyDelta gone = world.remove_elements(body, tip());
        const auto kept = std::int32_t(world.shape(body).mesh().vertices.size());
        settle();
        AddedElements back;
        std::vector<std::int32_t> number = gone.vertex_to_new;
        for (const std::int32_t e : gone.removed_elements()) {
            Tet t = before.tets[std::size_t(e)];
            for (std::int32_t& v : t) {
                if (number[std::size_t(v)] < 0) {
                    number[std::size_t(v)] = kept + std::int32_t(back.vertices.size());
                    back.vertices.push_back(before.vertices[std::size_t(v)]);
                }
                v = number[std::size_t(v)];
            }
            back.tets.push_back(t);
        }
        back.source = {0};
        world.add_elements(body, back);
        settle();
        ASSERT_EQ(world.shape(body).mesh().tets.size(), original.tets.size());
    };
    const auto cut_and_heal = [&] {
        world.cut(body, swept_blade(std::vector<Vec3>{{0.2, -1, -1}, {0.2, -1, 1}}, std::vector<Vec3>{{0.2, 1, -1}, {0.2, 1, 1}}), {.snap = 0.5});
        settle();
        world.heal(body, {.gap_m = 0.2});
        settle();
        ASSERT_EQ(world.shape(body).mesh().vertices.size(), original.vertices.size());
    };
    const auto check = [&](const char* what, auto&& cycle) {
        SCOPED_TRACE(what);
        most_bytes(20, cycle);  // the steps that can be undone are as many as they may be
        const long early = most_bytes(20, cycle);
        most_bytes(100, cycle);
        const long late = most_bytes(20, cycle);
        std::printf("%s: %ld bytes after 40 cycles, %ld after 160\n", what, early, late);
        EXPECT_LE(late, early + early / 500);
    };
    check("erase and undo", erase_and_undo);
    check("erase and add", erase_and_add);
    check("cut and heal", cut_and_heal);
}

}  // namespace
}  // namespace supple
