#include "supple/world/body.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/fem/element_groups.h"
#include "supple/fem/stress.h"
#include "supple/solve/chunked_sum.h"
#include "supple/world/body_materials.h"
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

/// True if the template's groups do: no kind of element has two families of laws.
bool one_family_per_kind(const fem::ElementLayout& layout, const std::vector<std::int32_t>& family) {
    for (const fem::ElementGroup& group : layout.groups)
        for (const std::int32_t e : group.element)
            if (family[std::size_t(e)] != family[std::size_t(group.element[0])]) return false;
    return true;
}

/// What apply_materials swaps in.
struct Matter {
    std::unique_ptr<const GroupedLayout> layout;  ///< as Body::own_layout
    std::unique_ptr<fem::Elements> elements;
};

fem::MatrixPrecision matrix_precision(const WorldDef& world) {
    return world.solver.precision == Precision::single ? fem::MatrixPrecision::single : fem::MatrixPrecision::double_;
}

std::unique_ptr<fem::Elements> make_elements(const TemplateData& data, const GroupedLayout* own, const fem::ElementMaterials& materials,
                                             fem::MatrixPrecision precision, Tangent tangent, Isa isa, bool project) {
    fem::ElementsDef def;
    def.layout = own != nullptr ? &own->layout : &data.layout;
    def.pattern = {data.pattern.row_start, data.pattern.column, data.pattern.mirror, data.pattern.row};
    for (const solve::GatherMap& map : own != nullptr ? own->gather : data.gather) def.contributions.push_back({map.start, map.pair});
    def.precision = precision;
    def.isa = isa;
    def.project = project;
    def.exact_rotation = tangent == Tangent::exact;
    return fem::make_elements(def, materials);
}

Matter make_matter(const TemplateData& data, const fem::ElementMaterials& materials, const WorldDef& world, Isa isa) {
    Matter matter;
    const std::vector<std::int32_t> family = materials.families(data.layout.elements);
    if (!one_family_per_kind(data.layout, family)) {
        GroupedLayout own;
        own.layout = fem::make_layout(data.mesh, family, data.pattern.row);
        own.gather = make_gather_maps(data.mesh, data.pattern, own.layout);
        matter.layout = std::make_unique<const GroupedLayout>(std::move(own));
    }
    matter.elements = make_elements(data, matter.layout.get(), materials, matrix_precision(world), world.solver.tangent, isa, true);
    return matter;
}

/// [block][fields][lane] of each element, from its place in one layout to that in another. Free lanes get `filler`, a number per field.
void lay_again(AlignedVector<double>& values, std::span<const double> filler, const fem::ElementLayout& from, const fem::ElementLayout& to) {
    const std::size_t fields = filler.size();
    AlignedVector<double> laid(to.blocks * fields * fem::kBlock);
    for (std::size_t i = 0; i < laid.size(); ++i) laid[i] = filler[i / fem::kBlock % fields];
    const auto place = [&](std::size_t slot, std::size_t k) { return (slot / fem::kBlock * fields + k) * fem::kBlock + slot % fem::kBlock; };
    for (std::size_t e = 0; e < to.elements; ++e) {
        for (std::size_t k = 0; k < fields; ++k) laid[place(to.slot[e], k)] = values[place(from.slot[e], k)];
    }
    values = std::move(laid);
}

/// Element rotations and plastic strains where the new elements look for them. Plastic strain stays while the body can flow, and is forgotten where it cannot.
void lay_state_again(BodyState& state, const fem::ElementLayout& from, const fem::ElementLayout& to, bool is_plastic) {
    constexpr double kNoTurn[4] = {1, 0, 0, 0}, kNoStrain[6] = {};
    if (from.slot != to.slot || from.blocks != to.blocks) {
        lay_again(state.quaternion, kNoTurn, from, to);
        if (!state.plastic.empty()) lay_again(state.plastic, kNoStrain, from, to);
    }
    const std::size_t plastic = is_plastic ? to.blocks * 6 * fem::kBlock : 0;
    if (state.plastic.size() != plastic) state.plastic.assign(plastic, 0.0);
    state.solver.assign(kMemoryCount, 0);
}

void couple_elements(Body& body) {
    const auto couple = [&](auto& system) {
        using Real = typename std::remove_reference_t<decltype(system)>::Scalar;
        system.coupling.reset();
        system.preconditioner->coupling_diagonal = {};  // it lay in the coupling
        if (body.elements->is_coupled()) system.coupling = std::make_unique<ElementCoupling<Real>>(body);
    };
    with_system(body, couple);
}

void size_workspace(Workspace& w, const fem::ElementLayout& layout) {
    const std::size_t n = layout.vertices;
    w.force_parts.resize(layout.places * 4);
    for (auto* field : {&w.base_x, &w.base_v, &w.y, &w.v0, &w.v_start, &w.f_ext, &w.f_dead, &w.b, &w.rhs, &w.free_rhs, &w.dv, &w.residual, &w.product, &w.bare, &w.dv_from, &w.bare_from}) {
        field->assign(n, Vec3::Zero());
    }
    w.diagonal.resize(n);
    w.partial.resize(solve::row_chunks(n));
}

}  // namespace

void apply_materials(Body& body, const BodyDef& def, const WorldDef& world, Isa isa) {
    const TemplateData& data = body.data();
    BodyMaterials materials = resolve_materials(def, data.mesh);
    Matter matter = make_matter(data, materials.elements, world, isa);
    auto mass = fem::lumped_mass(data.mesh, materials.density_kg_m3);
    std::vector<Lame> lame(data.layout.elements);
    for (const fem::ElementGroup& group : data.layout.groups) {
        const std::vector<Lame> own = fem::group_lame(group, materials.elements);
        for (std::size_t i = 0; i < own.size(); ++i) lame[std::size_t(group.element[i])] = own[i];
    }
    auto trace = fem::stiffness_trace(data.layout, lame);
    auto young = young_moduli(lame);
    BodyDef kept = def;

    with_system(body, [&](auto& system) {
        system.next.reset();  // it reads the materials
        if (system.by_elements) {  // what asks for the matrix of the last step finds it still
            Team alone;
            assemble_matrix(alone, body, 0);
        }
    });
    std::swap(body.def, kept);
    body.materials = std::move(materials.elements);
    body.mass = std::move(mass);
    body.stiffness_trace = std::move(trace);
    body.young_pa = std::move(young);
    body.stress.valid = false;
    const bool at_work = body.elements != nullptr;
    const fem::ElementLayout& to = matter.layout ? matter.layout->layout : data.layout;
    if (at_work) {
        for (BodyState* state : {&body.state, &body.start}) lay_state_again(*state, body.layout(), to, matter.elements->is_plastic());
    }
    body.elements = std::move(matter.elements);
    body.own_layout = std::move(matter.layout);
    if (!at_work) return;
    body.work.force_parts.resize(to.places * 4);
    couple_elements(body);
    drop_preconditioner(body);
}

void change_preconditioner(Body& body, PreconditionerKind kind, Isa isa) {
    with_system(body, [&](auto& system) {
        using Real = typename std::remove_reference_t<decltype(system)>::Scalar;
        system.preconditioner = make_preconditioner<Real>(body.data(), isa, kind);
    });
    for (BodyState* state : {&body.state, &body.start}) state->solver.assign(kMemoryCount, 0);
    drop_preconditioner(body);
}

std::unique_ptr<fem::Elements> make_body_elements(const Body& body, fem::MatrixPrecision precision, Tangent tangent, Isa isa, bool project) {
    return make_elements(body.data(), body.own_layout.get(), body.materials, precision, tangent, isa, project);
}

std::unique_ptr<Body> make_body(const BodyDef& def, const WorldDef& world, std::size_t index, Isa isa) {
    if (!def.shape) bad_body("shape", "is null; make one with BodyTemplate::build(mesh)");
    if (!def.translation_m.allFinite()) bad_body("translation_m", "is not finite");
    if (!def.velocity_m_s.allFinite()) bad_body("velocity_m_s", "is not finite");
    require_in_range(def.friction, 0, 10, "BodyDef.friction", "0.3 is usual, 0.01 to 0.1 for wet tissue");
    if (def.skin && def.skin->mesh_vertices() != def.shape->mesh().vertices.size())
        bad_body("skin", "was made for a mesh of " + std::to_string(def.skin->mesh_vertices()) + " vertices, this one has " +
                             std::to_string(def.shape->mesh().vertices.size()) + "; make it with Skin::build(shape->mesh(), surface)");

    auto body = std::make_unique<Body>();
    body->name = def.name.empty() ? "body " + std::to_string(index) : def.name;
    body->shape = def.shape;
    const TemplateData& data = body->data();
    const std::size_t n = data.layout.vertices;
    apply_materials(*body, def, world, isa);
    const std::size_t blocks = body->layout().blocks;
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
    s.next_x = s.hierarchy_x;
    s.hierarchy_held = held_bits(*body);
    s.next_held = s.hierarchy_held;
    s.solver.assign(kMemoryCount, 0);
    body->start = s;

    size_workspace(body->work, body->layout());
    if (world.solver.precision == Precision::single) {
        body->system.emplace<System<float>>(data, isa, world.solver.preconditioner);
    } else {
        body->system.emplace<System<double>>(data, isa, world.solver.preconditioner);
    }
    couple_elements(*body);
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
            s.vertex[v] = fem::recover_at_vertex(layout.around, layout.volume, s.element, v);
            s.vertex_von_mises[v] = fem::von_mises(s.vertex[v]);
        }
    });
    s.energy_j = 0;
    for (const double w : s.block_energy) s.energy_j += w;
    s.valid = true;
}

}  // namespace supple
