// Element passes (rotation or singular values, force, record) and assembly, per method or law and instruction set.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>

#include "bodies.h"
#include "kernels.h"
#include "supple/fem/elements.h"
#include "supple/fem/rest.h"
#include "supple/world/template_data.h"

namespace supple::bench {
namespace {

constexpr double kE = 2e5, kNu = 0.4, kMu = kE / (2 * (1 + kNu)), kLambda = kE * kNu / ((1 + kNu) * (1 - 2 * kNu)), kBulk = kLambda + 2 * kMu / 3;

struct NamedMaterial {
    const char* name;
    Material material;
};

std::vector<NamedMaterial> materials_of_tets() {
    const auto corotational = [](Rotation rotation) { return Corotational{.rotation = rotation, .young_pa = kE, .poisson = kNu}; };
    return {{"linear", Linear{.young_pa = kE, .poisson = kNu}},
            {"corotational_large", corotational(Rotation::large)},
            {"corotational_polar", corotational(Rotation::polar)},
            {"corotational_svd", corotational(Rotation::svd)},
            {"st_venant_kirchhoff", StVenantKirchhoff{kMu, kLambda}},
            {"neo_hookean", NeoHookean{kMu, kLambda}},
            {"stable_neo_hookean", StableNeoHookean{kMu, kLambda}},
            {"mooney_rivlin", MooneyRivlin{0.3 * kMu, 0.2 * kMu, kBulk}},
            {"arruda_boyce", ArrudaBoyce{kMu, kBulk}},
            {"veronda_westman", VerondaWestman{kMu / 2, 2, kBulk}},
            {"ogden", Ogden{{{2 * kMu, 3}}, kBulk}},
            {"costa", Costa{kMu, kLambda}}};
}

/// A bar bent to a tenth of a turn and stretched by 2 %, with the rotations of the step before: 1 % behind.
struct Bent {
    std::shared_ptr<const BodyTemplate> shape;
    std::unique_ptr<fem::Elements> elements;
    std::vector<Vec3> x;
    AlignedVector<double> quaternion, warm, force;
    AlignedVector<float> value;
    std::vector<double> mass;
    Team alone;

    Bent(std::shared_ptr<const BodyTemplate> body, const Material& material, Isa isa) : shape(std::move(body)) {
        const TemplateData& data = shape->data();
        fem::ElementsDef def;
        def.layout = &data.layout;
        def.pattern = {data.pattern.row_start, data.pattern.column, data.pattern.mirror};
        for (const solve::GatherMap& map : data.gather) def.contributions.push_back({map.start, map.pair});
        def.precision = fem::MatrixPrecision::single;
        def.isa = isa;
        elements = fem::make_elements(def, fem::ElementMaterials{{material}, {}, {}});
        quaternion.assign(data.layout.blocks * 4 * fem::kBlock, 0.0);
        for (std::size_t i = 0; i < quaternion.size(); ++i) quaternion[i] = i / fem::kBlock % 4 == 0 ? 1 : 0;
        force.assign(data.layout.places * 4, 0.0);
        value.assign(data.pattern.blocks() * 12, 0.0f);
        mass = fem::lumped_mass(data.mesh, std::vector<double>{1000});
        bend(0.62);
        evaluate();
        warm = quaternion;
        bend(0.628);
    }
    void bend(double angle) {
        x = shape->mesh().vertices;
        const double radius = 0.4 / angle;
        for (Vec3& p : x) {
            const double turn = 1.02 * p.x() / radius, r = radius - p.y();
            p = Vec3(r * std::sin(turn), radius - r * std::cos(turn), p.z());
        }
    }
    void evaluate() {
        fem::ElementOutputs outputs;
        outputs.force = force.data();
        outputs.tangent = true;
        elements->evaluate(alone, x.data()->data(), quaternion.data(), outputs);
    }
    std::size_t count() const { return shape->mesh().element_count(); }
};

void per_element(benchmark::State& state, std::size_t elements) {
    state.counters["per_element"] = benchmark::Counter(double(elements), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void element_pass(benchmark::State& state, const std::shared_ptr<const BodyTemplate>& shape, const Material& material, Isa isa) {
    Bent bent(shape, material, isa);
    for (auto _ : state) {
        state.PauseTiming();
        bent.quaternion = bent.warm;
        state.ResumeTiming();
        bent.evaluate();
        benchmark::ClobberMemory();
    }
    per_element(state, bent.count());
}

void assembly(benchmark::State& state, const std::shared_ptr<const BodyTemplate>& shape, const Material& material, Isa isa) {
    Bent bent(shape, material, isa);
    bent.evaluate();
    for (auto _ : state) {
        bent.elements->assemble(bent.alone, 1e-4, bent.mass, bent.value.data());
        benchmark::ClobberMemory();
    }
    per_element(state, bent.count());
}

}  // namespace

void register_element_kernels() {
    const auto tets = test::bar({32, 8, 8});
    const auto hexes = test::hex_bar({32, 8, 8});
    const std::vector<NamedMaterial> materials = materials_of_tets();
    for (const Isa isa : kAllIsas) {
        if (!is_supported(isa)) continue;
        const std::string end = "/" + std::string(name(isa));
        for (const NamedMaterial& m : materials)
            benchmark::RegisterBenchmark(("pass/tets/" + std::string(m.name) + end).c_str(), [=](benchmark::State& s) { element_pass(s, tets, m.material, isa); });
        for (const std::size_t i : {std::size_t(2), std::size_t(5)}) {
            const NamedMaterial& m = materials[i];
            benchmark::RegisterBenchmark(("pass/hexes/" + std::string(m.name) + end).c_str(), [=](benchmark::State& s) { element_pass(s, hexes, m.material, isa); });
            benchmark::RegisterBenchmark(("assembly/tets/" + std::string(m.name) + end).c_str(), [=](benchmark::State& s) { assembly(s, tets, m.material, isa); });
            benchmark::RegisterBenchmark(("assembly/hexes/" + std::string(m.name) + end).c_str(), [=](benchmark::State& s) { assembly(s, hexes, m.material, isa); });
        }
    }
    const auto large = test::bar({64, 16, 16});
    const Material polar = materials[2].material;
    benchmark::RegisterBenchmark("pass/tets_98304/corotational_polar/best", [=](benchmark::State& s) { element_pass(s, large, polar, best_isa()); });
    benchmark::RegisterBenchmark("assembly/tets_98304/corotational_polar/best", [=](benchmark::State& s) { assembly(s, large, polar, best_isa()); });
}

}  // namespace supple::bench
