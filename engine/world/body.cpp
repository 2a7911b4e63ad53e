#include "supple/world/body.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/fem/stress.h"
#include "supple/solve/chunked_sum.h"
#include "supple/world/precondition.h"

namespace supple {

namespace {

template <class Real>
std::unique_ptr<solve::Preconditioner<Real>> make_preconditioner(const TemplateData& data, Isa isa, PreconditionerKind kind) {
    if (kind == PreconditionerKind::direct) return std::make_unique<solve::Cholesky<Real>>(data.pattern);
    return std::make_unique<solve::BlockJacobi<Real>>(data.pattern.rows, isa);
}

}  // namespace

template <class Real>
System<Real>::System(const TemplateData& data, Isa isa, PreconditionerKind kind)
    : A{&data.pattern, AlignedVector<Real>(data.pattern.blocks() * 12)},
      preconditioner(make_preconditioner<Real>(data, isa, kind)),
      solver(data.pattern.rows, isa) {}

template struct System<float>;
template struct System<double>;

namespace {

[[noreturn]] void bad_body(const std::string& field, const std::string& message) {
    throw Error(ErrorCode::invalid_argument, "BodyDef." + field, message);
}

/// Materials of the elements, checked; with Lame parameters of their own where the definition has arrays.
fem::ElementMaterials materials_of(const BodyDef& def, std::size_t elements) {
    fem::ElementMaterials result;
    result.materials = {def.material};
    result.materials.insert(result.materials.end(), def.region_materials.begin(), def.region_materials.end());
    for (std::size_t m = 0; m < result.materials.size(); ++m) {
        small_strain(result.materials[m], m == 0 ? "BodyDef.material" : "BodyDef.region_materials[" + std::to_string(m - 1) + "]");
    }
    const auto check = [&](std::size_t size, const char* name) {
        if (size != 0 && size != elements) {
            bad_body(name, "has " + std::to_string(size) + " values, the mesh has " + std::to_string(elements) +
                               " elements; give one per element in mesh order, or none");
        }
    };
    check(def.material_of_element.size(), "material_of_element");
    for (const std::int32_t m : def.material_of_element) {
        if (m < 0 || std::size_t(m) >= result.materials.size()) {
            bad_body("material_of_element", "holds " + std::to_string(m) + "; legal are 0 (BodyDef.material) to " + std::to_string(def.region_materials.size()) +
                                                " (the last of region_materials)");
        }
    }
    result.material_of_element = def.material_of_element;
    if (def.young_pa_per_element.empty() && def.poisson_per_element.empty()) return result;
    check(def.young_pa_per_element.size(), "young_pa_per_element");
    check(def.poisson_per_element.size(), "poisson_per_element");
    result.lame.resize(elements);
    for (std::size_t e = 0; e < elements; ++e) {
        const Material& given = result.of(e);
        Linear material;  // the one shape of young_pa and poisson
        if (const auto* linear = std::get_if<Linear>(&given)) material = *linear;
        if (const auto* corotational = std::get_if<Corotational>(&given)) material = {corotational->young_pa, corotational->poisson, {}, {}, {}};
        if (is_hyperelastic(given)) {
            bad_body("young_pa_per_element", "arrays of young_pa and poisson belong to the linear and corotational laws; this body's law has other parameters");
        }
        result.lame[e] = lame_parameters(def.young_pa_per_element.empty() ? material.young_pa : def.young_pa_per_element[e],
                                         def.poisson_per_element.empty() ? material.poisson : def.poisson_per_element[e],
                                         "BodyDef, element " + std::to_string(e));
    }
    return result;
}

/// True if the template's groups do: no kind of element has two families of laws.
bool one_family_per_kind(const fem::ElementLayout& layout, const std::vector<std::int32_t>& family) {
    for (const fem::ElementGroup& group : layout.groups)
        for (const std::int32_t e : group.element)
            if (family[std::size_t(e)] != family[std::size_t(group.element[0])]) return false;
    return true;
}

/// A layout of the body's own, where its laws ask for it.
void choose_layout(Body& body, const fem::ElementMaterials& materials) {
    const TemplateData& data = body.data();
    const std::vector<std::int32_t> family = materials.families(data.layout.elements);
    if (one_family_per_kind(data.layout, family)) return;
    GroupedLayout own;
    own.layout = fem::make_layout(data.mesh, family);
    own.gather = make_gather_maps(data.mesh, data.pattern, own.layout);
    body.own_layout = std::make_unique<const GroupedLayout>(std::move(own));
}

void size_workspace(Workspace& w, const fem::ElementLayout& layout) {
    const std::size_t n = layout.vertices;
    w.corner.resize(layout.places * 4);
    for (auto* field : {&w.base_x, &w.base_v, &w.y, &w.v0, &w.v_start, &w.f_ext, &w.f_dead, &w.b, &w.rhs, &w.free_rhs, &w.dv, &w.residual, &w.product}) {
        field->assign(n, Vec3::Zero());
    }
    w.diagonal.resize(n);
    w.partial.resize(solve::row_chunks(n));
}

}  // namespace

std::unique_ptr<fem::Elements> make_body_elements(const Body& body, fem::MatrixPrecision precision, Tangent tangent, Isa isa, bool project) {
    const TemplateData& data = body.data();
    fem::ElementsDef def;
    def.layout = &body.layout();
    def.pattern = {data.pattern.row_start, data.pattern.column, data.pattern.mirror};
    for (const solve::GatherMap& map : body.own_layout ? body.own_layout->gather : data.gather) def.contributions.push_back({map.start, map.pair});
    def.precision = precision;
    def.isa = isa;
    def.project = project;
    def.exact_rotation = tangent == Tangent::exact;
    return fem::make_elements(def, materials_of(body.def, data.layout.elements));
}

std::unique_ptr<Body> make_body(const BodyDef& def, const WorldDef& world, std::size_t index, Isa isa) {
    if (!def.shape) bad_body("shape", "is null; make one with BodyTemplate::build(mesh)");
    if (!(std::isfinite(def.density_kg_m3) && def.density_kg_m3 > 0)) {
        bad_body("density_kg_m3", to_text(def.density_kg_m3) + " must be above 0; water and soft tissue have about 1000");
    }
    if (!def.translation_m.allFinite()) bad_body("translation_m", "is not finite");
    if (!def.velocity_m_s.allFinite()) bad_body("velocity_m_s", "is not finite");

    auto body = std::make_unique<Body>();
    body->def = def;
    body->name = def.name.empty() ? "body " + std::to_string(index) : def.name;
    body->shape = def.shape;
    const TemplateData& data = body->data();
    const std::size_t n = data.layout.vertices;
    const fem::ElementMaterials materials = materials_of(def, data.layout.elements);
    choose_layout(*body, materials);
    body->elements = make_body_elements(*body, world.solver.precision == Precision::single ? fem::MatrixPrecision::single : fem::MatrixPrecision::double_,
                                        world.solver.tangent, isa, true);
    std::vector<Lame> lame(data.layout.elements);
    for (std::size_t e = 0; e < lame.size(); ++e) lame[e] = materials.lame_of(e);
    body->stiffness_trace = fem::stiffness_trace(data.layout, lame);
    const std::size_t blocks = body->layout().blocks;
    body->mass = fem::lumped_mass(data.mesh, def.density_kg_m3);
    body->owner.assign(3 * n, kFree);
    for (std::size_t i = 0; i < n; ++i) {
        if (body->mass[i] == 0) std::fill_n(body->owner.begin() + std::ptrdiff_t(3 * i), 3, kHeld);  // a vertex of no element
    }

    BodyState& s = body->state;
    s.x = data.mesh.vertices;
    for (Vec3& x : s.x) x += def.translation_m;
    s.v.assign(n, def.velocity_m_s);
    s.x_previous = s.x;
    for (auto* field : {&s.dv1, &s.dv2, &s.reaction}) field->assign(n, Vec3::Zero());
    s.quaternion.assign(blocks * 4 * fem::kBlock, 0.0);
    for (std::size_t b = 0; b < blocks; ++b) std::fill_n(s.quaternion.begin() + std::ptrdiff_t(b * 4 * fem::kBlock), fem::kBlock, 1.0);
    if (world.solver.integrator == Integrator::bdf2) s.v_previous.assign(n, Vec3::Zero());
    if (world.solver.integrator == Integrator::newmark) s.a.assign(n, Vec3::Zero());
    s.moving.assign(1, 0);
    if (body->elements->is_plastic()) s.plastic.assign(blocks * 6 * fem::kBlock, 0.0);
    s.frozen.assign(1, 0);
    s.hierarchy_x = data.mesh.vertices;
    s.hierarchy_quaternion = s.quaternion;
    s.solver.assign(kMemoryCount, 0);
    body->start = s;

    size_workspace(body->work, body->layout());
    const auto couple = [&](auto& system) {
        using Real = typename std::remove_reference_t<decltype(system)>::Scalar;
        if (!body->elements->is_coupled()) return;
        system.coupling = std::make_unique<ElementCoupling<Real>>(*body);
        system.solver.set_coupling(system.coupling.get());
    };
    if (world.solver.precision == Precision::single) {
        couple(body->system.emplace<System<float>>(data, isa, world.solver.preconditioner));
    } else {
        couple(body->system.emplace<System<double>>(data, isa, world.solver.preconditioner));
    }
    return body;
}

void update_stress(const Body& body, Team& team) {
    StressCache& s = body.stress;
    if (s.valid) return;
    const fem::ElementLayout& layout = body.layout();
    const std::size_t elements = layout.elements, vertices = layout.vertices;
    s.element.resize(elements);
    s.element_von_mises.resize(elements);
    s.element_energy.resize(elements);
    s.vertex.resize(vertices);
    s.vertex_von_mises.resize(vertices);
    s.block_stress.resize(layout.blocks * 6 * fem::kBlock);
    s.block_energy.resize(layout.blocks * fem::kBlock);
    s.quaternion = body.state.quaternion;  // a copy: looking at the stress must not change what the next step does

    fem::ElementOutputs outputs;
    outputs.stress = s.block_stress.data();
    outputs.energy = s.block_energy.data();
    outputs.plastic = plastic_strain(body);
    body.elements->evaluate(team, body.state.x.data()->data(), s.quaternion.data(), outputs);
    team.for_range(elements, 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) {
            s.element[e] = fem::element_stress(layout, s.block_stress.data(), e);
            s.element_von_mises[e] = fem::von_mises(s.element[e]);
            s.element_energy[e] = s.block_energy[layout.slot[e]];
        }
    });
    team.for_range(vertices, 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            s.vertex[v] = fem::recover_at_vertex(layout.corners, layout.volume, s.element, v);
            s.vertex_von_mises[v] = fem::von_mises(s.vertex[v]);
        }
    });
    s.energy_j = 0;
    for (const double w : s.block_energy) s.energy_j += w;
    s.valid = true;
}

}  // namespace supple
