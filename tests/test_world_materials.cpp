// Materials per element and per region, and their change while the world runs.
#include <gtest/gtest.h>

#include "supple/base/error.h"
#include "support/bodies.h"

namespace supple {
namespace {

const InsideBox kRightHalf{Vec3(0.2 - 1e-9, -1, -1), Vec3(1, 1, 1)};

WorldDef world_def(int threads = 2) {
    WorldDef def;
    def.time_step_s = 0.01;
    def.threads = threads;
    def.solver.cg_relative_tolerance = 1e-7;
    return def;
}

struct Bar {
    World world;
    BodyId body;

    explicit Bar(const BodyDef& def) : world(world_def()) {
        body = world.add_body(def);
        world.fix(body, test::at_x(0));
    }
    void run(int steps) {
        for (int n = 0; n < steps; ++n) ASSERT_EQ(world.step().flags, StepFlag::none);
    }
};

BodyDef bar_of(const Material& material, std::array<int, 3> cells = {8, 2, 2}) {
    BodyDef def;
    def.shape = test::bar(cells);
    def.material = material;
    return def;
}

const Corotational kSoft{.young_pa = 1e5, .poisson = 0.3};

TEST(WorldMaterials, RegionsArraysAndFactorsSayTheSame) {
    const BodyDef plain = bar_of(kSoft);
    const VolumeMesh& mesh = plain.shape->mesh();
    const std::size_t n = mesh.element_count();
    const auto right = select_elements(mesh, kRightHalf);
    ASSERT_EQ(right.size(), n / 2);
    BodyDef by_array = plain, by_factor = plain, by_region = plain, by_region_factor = plain, by_material = plain;
    by_array.young_pa_per_element.assign(n, 1e5);
    by_factor.stiffness_factor_per_element.assign(n, 1);
    by_material.material_per_element.assign(n, kSoft);
    for (const std::int32_t e : right) {
        by_array.young_pa_per_element[std::size_t(e)] = 8e5;
        by_factor.stiffness_factor_per_element[std::size_t(e)] = 8;
        by_material.material_per_element[std::size_t(e)] = Corotational{.young_pa = 8e5, .poisson = 0.3};
    }
    by_region.regions = {{.where = kRightHalf, .material = Corotational{.young_pa = 8e5, .poisson = 0.3}}};
    by_region_factor.regions = {{.where = kRightHalf, .stiffness_factor = 2}, {.where = kRightHalf, .stiffness_factor = 4}};
    Bar first(by_array);
    first.run(5);
    EXPECT_NE(first.world.hash(), [&] {
        Bar other(plain);
        other.run(5);
        return other.world.hash();
    }());
    for (const BodyDef& def : {by_factor, by_region, by_region_factor, by_material}) {
        Bar other(def);
        other.run(5);
        for (std::size_t e = 0; e < n; ++e) EXPECT_NEAR(other.world.element_young_pa(other.body)[e], first.world.element_young_pa(first.body)[e], 1e-6);
        EXPECT_LT(test::relative_difference(other.world.positions(other.body), first.world.positions(first.body)), 1e-7);
    }
}

TEST(WorldMaterials, DensityByRegionAndByElement) {
    BodyDef def = bar_of(kSoft);
    Bar plain(def);
    def.regions = {{.where = kRightHalf, .density_kg_m3 = 3000}};
    Bar region(def);
    EXPECT_NEAR(test::total_mass(region.world, region.body), 2 * test::total_mass(plain.world, plain.body), 1e-12);
    def.regions.clear();
    def.density_kg_m3_per_element.assign(def.shape->mesh().element_count(), 500);
    Bar half(def);
    EXPECT_NEAR(test::total_mass(half.world, half.body), 0.5 * test::total_mass(plain.world, plain.body), 1e-12);
}

/// Every hyperelastic law with a stiffness factor is that law with its moduli multiplied, fibres included.
TEST(WorldMaterials, FactorsMultiplyEveryModulusOfEveryLaw) {
    const auto laws = [](double s) -> std::vector<Material> {
        const Fibres f{.fibre = {Vec3(1, 0.3, 0)}, .fibre_stiffness_pa = s * 2e4};
        return {StVenantKirchhoff{s * 4e4, s * 6e4, f}, NeoHookean{s * 4e4, s * 6e4, f},          StableNeoHookean{s * 4e4, s * 6e4, f},
                MooneyRivlin{s * 1.6e4, s * 4e3, s * 1e5, f}, ArrudaBoyce{s * 3.7e4, s * 1e5, f}, VerondaWestman{s * 2e4, 2, s * 1e5, f},
                Ogden{{{s * 5e4, 3}, {s * 2e4, -2}, {s * 1e4, 5}}, s * 1e5, f}, Costa{s * 4e4, s * 6e4, {4, 2, 2, 2, 2, 2}, f}};
    };
    const std::vector<Material> base = laws(1), doubled = laws(2);
    for (std::size_t i = 0; i < base.size(); ++i) {
        BodyDef def = bar_of(base[i], {4, 2, 2});
        def.regions = {{.where = Everything{}, .stiffness_factor = 2}};
        Bar factor(def), direct(bar_of(doubled[i], {4, 2, 2}));
        factor.run(10);
        direct.run(10);
        EXPECT_LT(test::relative_difference(factor.world.positions(factor.body), direct.world.positions(direct.body)), 1e-9) << "law " << i;
    }
}

TEST(WorldMaterials, AChangeGoesOnAsAWorldBuiltWithItFromTheSameState) {
    const Fibres f{.fibre = {Vec3(1, 0, 0)}, .fibre_stiffness_pa = 5e4};
    const std::vector<Material> sequence{kSoft,
                                         Corotational{.young_pa = 4e5, .poisson = 0.4},
                                         NeoHookean{6e4, 9e4},
                                         Costa{4e4, 6e4, {8, 4, 2, 4, 2, 2}, f},
                                         Linear{.young_pa = 2e5},
                                         StableNeoHookean{.fibres = f},
                                         Ogden{}};
    Bar changed(bar_of(sequence[0]));
    for (std::size_t i = 1; i < sequence.size(); ++i) {
        changed.run(4);
        changed.world.set_material(changed.body, sequence[i]);
        Bar built(bar_of(sequence[i]));
        built.world.restore(changed.world.save());
        EXPECT_EQ(built.world.hash(), changed.world.hash());
        const auto before = test::copy(changed.world.velocities(changed.body));
        changed.run(4);
        built.run(4);
        EXPECT_EQ(built.world.hash(), changed.world.hash()) << "law " << i;
        EXPECT_NE(before, test::copy(changed.world.velocities(changed.body)));
        EXPECT_EQ(built.world.energy().elastic_j, changed.world.energy().elastic_j);
    }
}

TEST(WorldMaterials, RegionsAndFactorsChangeWhileRunning) {
    Bar changed(bar_of(kSoft));
    const std::size_t n = changed.world.shape(changed.body).mesh().element_count();
    changed.run(3);
    BodyDef def = bar_of(kSoft);
    def.regions = {{.where = kRightHalf, .stiffness_factor = 20, .density_kg_m3 = 2000}};
    changed.world.set_regions(changed.body, def.regions);
    Bar built(def);
    built.world.restore(changed.world.save());
    changed.run(3);
    built.run(3);
    EXPECT_EQ(built.world.hash(), changed.world.hash());
    EXPECT_EQ(test::copy(built.world.reactions(built.body)), test::copy(changed.world.reactions(changed.body)));

    def.stiffness_factor_per_element.assign(n, 0.5);
    changed.world.set_stiffness_factor(changed.body, def.stiffness_factor_per_element);
    EXPECT_NEAR(changed.world.element_young_pa(changed.body)[0], 5e4, 1e-6);
    Bar again(def);
    again.world.restore(changed.world.save());
    changed.run(3);
    again.run(3);
    EXPECT_EQ(again.world.hash(), changed.world.hash());

    changed.world.set_stiffness_factor(changed.body, {});
    changed.world.set_regions(changed.body, {});
    for (const double young : changed.world.element_young_pa(changed.body)) EXPECT_NEAR(young, 1e5, 1e-6);
}

/// Hexes below, tets above, and laws of other families in regions.
BodyDef body_of_many_laws() {
    VolumeMesh mesh = make_hex_box({.min_m = Vec3::Zero(), .max_m = Vec3::Constant(0.3), .cells = {4, 4, 4}});
    const VolumeMesh tets = make_tet_box({.min_m = Vec3::Zero(), .max_m = Vec3::Constant(0.3), .cells = {4, 4, 4}});
    mesh.hexes.resize(32);
    mesh.tets.assign(tets.tets.begin() + 32 * 6, tets.tets.end());
    BodyDef def;
    def.shape = BodyTemplate::build(std::move(mesh));
    def.material = kSoft;
    const Fibres f{.fibre = {Vec3(1, 0.2, 0)}, .fibre_stiffness_pa = 5e4};
    def.regions = {{.where = InsideBox{Vec3(0.15 - 1e-9, -1, -1), Vec3(1, 1, 1)}, .material = NeoHookean{.fibres = f}},
                   {.where = InsideBox{Vec3(-1, -1, 0.2), Vec3(1, 1, 1)}, .material = Costa{4e4, 6e4, {8, 4, 2, 4, 2, 2}, f}, .stiffness_factor = 2},
                   {.where = InsideBox{Vec3(-1, -1, -1), Vec3(0.1, 0.1, 1)}, .material = Linear{.young_pa = 2e5}, .density_kg_m3 = 1500}};
    return def;
}

TEST(WorldMaterials, LawsOfAllFamiliesMoveTogether) {
    BodyDef def = body_of_many_laws();
    std::uint64_t hash = 0;
    for (const int threads : {1, 3}) {
        World world(world_def(threads));
        const BodyId body = world.add_body(def);
        world.fix(body, test::at_x(0));
        for (int n = 0; n < 100; ++n) ASSERT_EQ(world.step().flags, StepFlag::none) << n;
        EXPECT_TRUE(test::all_finite(world.positions(body)));
        EXPECT_GT(world.element_von_mises(body)[0], 0);
        EXPECT_EQ(threads == 1 ? world.hash() : hash, world.hash());
        hash = world.hash();
    }
}

/// A change of laws that groups the elements anew goes on as a world that was built so, whatever was made for the old groups.
TEST(WorldMaterials, LawsOfRegionsChangeWhileRunning) {
    const BodyDef many = body_of_many_laws();
    BodyDef nodal = many;
    nodal.material = Corotational{.young_pa = 1e5, .poisson = 0.49, .volumetric = Volumetric::nodal};
    BodyDef plain = many;
    plain.regions.clear();
    for (const PreconditionerKind kind : {PreconditionerKind::automatic, PreconditionerKind::lattice_multigrid, PreconditionerKind::scalar_laplacian}) {
        WorldDef w = world_def();
        w.solver.preconditioner = kind;
        const auto build = [&](const BodyDef& def) {
            auto world = std::make_unique<World>(w);
            world->fix(world->add_body(def), test::at_x(0));
            return world;
        };
        const auto changed = build(plain);
        const BodyId body = changed->bodies()[0];
        bool in_regions = false;
        for (const BodyDef* def : std::initializer_list<const BodyDef*>{&many, &plain, &nodal, &many}) {
            if (def == &nodal && kind != PreconditionerKind::automatic) continue;
            for (int n = 0; n < 3; ++n) ASSERT_EQ(changed->step().flags, StepFlag::none);
            const auto before = changed->save();
            changed->set_regions(body, def->regions);
            changed->set_material(body, def->material);
            const auto built = build(*def);
            built->restore(changed->save());
            ASSERT_EQ(built->hash(), changed->hash());
            for (int n = 0; n < 3; ++n) {
                ASSERT_EQ(changed->step().flags, StepFlag::none);
                ASSERT_EQ(built->step().flags, StepFlag::none);
            }
            EXPECT_EQ(built->hash(), changed->hash());
            if (in_regions == def->regions.empty()) {
                EXPECT_THROW(changed->restore(before), Error) << "its elements lie elsewhere";
            }
            in_regions = !def->regions.empty();
            changed->reset();
            const auto fresh = build(*def);
            EXPECT_EQ(fresh->hash(), changed->hash());
        }
    }
}

/// polar and svd are two families of the same matter: what an element has flowed goes along to its new place.
TEST(WorldMaterials, PlasticStrainGoesAlongToTheNewGroups) {
    BodyDef def = bar_of(Corotational{.young_pa = 1e5, .poisson = 0.3, .plasticity = {.yield = 0.01, .creep_1_s = 5}});
    Bar bar(def);
    bar.run(40);
    const auto before = std::vector<Voigt>(bar.world.element_cauchy_stress(bar.body).begin(), bar.world.element_cauchy_stress(bar.body).end());
    Bar elastic(bar_of(kSoft));
    elastic.world.set_state(elastic.body, bar.world.positions(bar.body), bar.world.velocities(bar.body));
    double largest = 0, flowed = 0;
    for (std::size_t e = 0; e < before.size(); ++e) {
        for (std::size_t c = 0; c < 6; ++c) {
            largest = std::max(largest, std::abs(before[e][c]));
            flowed = std::max(flowed, std::abs(before[e][c] - elastic.world.element_cauchy_stress(elastic.body)[e][c]));
        }
    }
    ASSERT_GT(flowed, 0.05 * largest) << "nothing flowed";
    Corotational svd = std::get<Corotational>(def.material);
    svd.rotation = Rotation::svd;
    bar.world.set_regions(bar.body, {{.where = InsideBox{Vec3(0.1 - 1e-9, -1, -1), Vec3(0.2 + 1e-9, 1, 1)}, .material = svd}});
    const auto after = bar.world.element_cauchy_stress(bar.body);
    for (std::size_t e = 0; e < before.size(); ++e) {
        for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(after[e][c], before[e][c], 1e-9 * largest) << e;
    }
}

TEST(WorldMaterials, ResetGoesToTheStartWithTheMaterialsOfTheMoment) {
    Bar changed(bar_of(kSoft));
    changed.run(3);
    changed.world.set_material(changed.body, NeoHookean{});
    changed.run(3);
    changed.world.reset();
    Bar fresh(bar_of(NeoHookean{}));
    EXPECT_EQ(changed.world.hash(), fresh.world.hash());
    changed.run(3);
    fresh.run(3);
    EXPECT_EQ(changed.world.hash(), fresh.world.hash());
}

TEST(WorldMaterials, BadChangesAreRefusedAndChangeNothing) {
    Bar bar(bar_of(kSoft)), twin(bar_of(kSoft));
    bar.run(3);
    twin.run(3);
    World& world = bar.world;
    const auto refused = [](const std::string& word, auto&& change) {
        try {
            change();
            ADD_FAILURE() << word << " was accepted";
        } catch (const Error& e) {
            EXPECT_NE(e.where().find(word), std::string::npos) << e.what();
            EXPECT_FALSE(e.message().empty());
        }
    };
    const std::size_t n = world.shape(bar.body).mesh().element_count();
    refused("material.young_pa", [&] { world.set_material(bar.body, Corotational{.young_pa = -1}); });
    refused("material.mu_pa", [&] { world.set_material(bar.body, NeoHookean{.mu_pa = NAN}); });
    refused("material.fibre", [&] { world.set_material(bar.body, NeoHookean{.fibres = {.fibre = {Vec3::UnitX(), Vec3::UnitX()}, .fibre_stiffness_pa = 1}}); });
    refused("regions[1]", [&] { world.set_regions(bar.body, {{.where = Everything{}, .stiffness_factor = 2}, {.where = VertexList{{0}}, .stiffness_factor = 2}}); });
    refused("regions[0].stiffness_factor", [&] { world.set_regions(bar.body, {{.where = Everything{}, .stiffness_factor = 0}}); });
    refused("regions[0].density_kg_m3", [&] { world.set_regions(bar.body, {{.where = Everything{}, .density_kg_m3 = -1}}); });
    refused("regions[0].material.poisson", [&] { world.set_regions(bar.body, {{.where = Everything{}, .material = Corotational{.poisson = 0.5}}}); });
    refused("stiffness_factor_per_element", [&] { world.set_stiffness_factor(bar.body, std::vector<double>(n + 1, 1.0)); });
    refused("stiffness_factor_per_element[0]", [&] { world.set_stiffness_factor(bar.body, std::vector<double>(n, -1.0)); });
    refused("BodyId", [&] { world.set_material(BodyId{9, 9}, kSoft); });
    bar.run(3);
    twin.run(3);
    EXPECT_EQ(world.hash(), twin.world.hash());
    EXPECT_FALSE(world.is_frozen(bar.body));
}

TEST(WorldMaterials, BadDefinitionsAreNamed) {
    const auto refused = [](const std::string& where, auto&& change) {
        BodyDef def = bar_of(kSoft, {2, 1, 1});
        change(def);
        World world(world_def());
        try {
            world.add_body(def);
            ADD_FAILURE() << where << " was accepted";
        } catch (const Error& e) {
            EXPECT_EQ(e.where(), "BodyDef." + where);
        }
    };
    refused("material_per_element", [](BodyDef& d) { d.material_per_element = {kSoft}; });
    refused("material_per_element[3].young_pa", [](BodyDef& d) {
        d.material_per_element.assign(12, kSoft);
        d.material_per_element[3] = Corotational{.young_pa = 0};
    });
    refused("young_pa_per_element", [](BodyDef& d) {
        d.material = NeoHookean{};
        d.young_pa_per_element.assign(12, 1e5);
    });
    refused("density_kg_m3_per_element[1]", [](BodyDef& d) {
        d.density_kg_m3_per_element.assign(12, 1);
        d.density_kg_m3_per_element[1] = 0;
    });
}

/// Two laws in one body come to the same rest state from any thread count, and a stiff half bends less.
TEST(WorldMaterials, AStiffHalfBendsLess) {
    const auto droop = [](double factor) {
        BodyDef def = bar_of(NeoHookean{});
        def.regions = {{.where = InsideBox{Vec3(-1, -1, -1), Vec3(0.2 + 1e-9, 1, 1)}, .stiffness_factor = factor}};
        WorldDef w = world_def(1);
        w.solver.rayleigh_mass_1_s = 10;
        World world(w);
        const BodyId body = world.add_body(def);
        world.fix(body, test::at_x(0));
        EXPECT_TRUE(test::run_to_rest(world, 1e-5, 2000));
        return 0.05 - test::mean_position(world, body, test::at_x(0.4))[1];
    };
    const double soft = droop(1), stiff = droop(100);
    EXPECT_GT(stiff, 0);
    EXPECT_LT(stiff, 0.3 * soft);
}

}  // namespace
}  // namespace supple
