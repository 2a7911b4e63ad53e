#include "supple/world/body.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/fem/rest.h"
#include "supple/fem/stress.h"
#include "supple/solve/chunked_sum.h"
#include "supple/world/body_materials.h"

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

void size_workspace(Workspace& w, const TemplateData& data) {
    const std::size_t n = data.rest.vertices;
    w.corner.resize(data.rest.blocks() * fem::kBlock * 16);
    for (auto* field : {&w.base_x, &w.base_v, &w.y, &w.v0, &w.v_start, &w.f_ext, &w.b, &w.rhs, &w.free_rhs, &w.dv, &w.residual, &w.product}) {
        field->assign(n, Vec3::Zero());
    }
    w.diagonal.resize(n);
    w.partial.resize(solve::row_chunks(n));
}

}  // namespace

void apply_materials(Body& body, const BodyDef& def, const WorldDef& world, Isa isa) {
    const TemplateData& data = body.data();
    const BodyMaterials materials = resolve_materials(def, data.mesh);
    fem::ElementsDef elements_def;
    elements_def.rest = &data.rest;
    elements_def.corners = &data.corners;
    elements_def.lists = {data.pattern.row_start, data.pattern.column, data.pattern.mirror, data.gather.start, data.gather.pair};
    elements_def.precision = world.solver.precision == Precision::single ? fem::MatrixPrecision::single : fem::MatrixPrecision::double_;
    elements_def.isa = isa;
    elements_def.exact_rotation = world.solver.tangent == Tangent::exact;
    auto elements = fem::make_elements(elements_def, materials.elements);
    auto mass = fem::lumped_mass(data.rest, materials.density_kg_m3);
    auto trace = fem::stiffness_trace(data.rest, fem::make_moduli(data.rest, fem::element_lame(materials.elements, data.rest.elements)));
    auto young = element_young(materials.elements, data.rest.elements);
    BodyDef kept = def;
    std::swap(body.def, kept);
    body.elements = std::move(elements);
    body.mass = std::move(mass);
    body.stiffness_trace = std::move(trace);
    body.young_pa = std::move(young);
    // Plastic strain stays while the body can flow, and is forgotten where it cannot.
    const std::size_t plastic = body.elements->is_plastic() ? data.rest.blocks() * 6 * fem::kBlock : 0;
    for (BodyState* state : {&body.state, &body.start}) {
        if (state->plastic.size() != plastic) state->plastic.assign(plastic, 0.0);
    }
    body.stress.valid = false;
}

std::unique_ptr<Body> make_body(const BodyDef& def, const WorldDef& world, std::size_t index, Isa isa) {
    if (!def.shape) bad_body("shape", "is null; make one with BodyTemplate::build(mesh)");
    if (!def.translation_m.allFinite()) bad_body("translation_m", "is not finite");
    if (!def.velocity_m_s.allFinite()) bad_body("velocity_m_s", "is not finite");

    auto body = std::make_unique<Body>();
    body->name = def.name.empty() ? "body " + std::to_string(index) : def.name;
    body->shape = def.shape;
    const TemplateData& data = body->data();
    const std::size_t n = data.rest.vertices;
    apply_materials(*body, def, world, isa);
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
    s.quaternion.assign(data.rest.blocks() * 4 * fem::kBlock, 0.0);
    for (std::size_t b = 0; b < data.rest.blocks(); ++b) std::fill_n(s.quaternion.begin() + std::ptrdiff_t(b * 4 * fem::kBlock), fem::kBlock, 1.0);
    if (world.solver.integrator == Integrator::bdf2) s.v_previous.assign(n, Vec3::Zero());
    if (world.solver.integrator == Integrator::newmark) s.a.assign(n, Vec3::Zero());
    s.moving.assign(1, 0);
    s.frozen.assign(1, 0);
    body->start = s;

    size_workspace(body->work, data);
    if (world.solver.precision == Precision::single) {
        body->system.emplace<System<float>>(data, isa, world.solver.preconditioner);
    } else {
        body->system.emplace<System<double>>(data, isa, world.solver.preconditioner);
    }
    return body;
}

void update_stress(const Body& body, Team& team) {
    StressCache& s = body.stress;
    if (s.valid) return;
    const TemplateData& data = body.data();
    const std::size_t elements = data.rest.elements, vertices = data.rest.vertices;
    s.element.resize(elements);
    s.element_von_mises.resize(elements);
    s.vertex.resize(vertices);
    s.vertex_von_mises.resize(vertices);
    s.block_stress.resize(data.rest.blocks() * 6 * fem::kBlock);
    s.block_energy.resize(data.rest.blocks() * fem::kBlock);
    s.quaternion = body.state.quaternion;  // a copy: looking at the stress must not change what the next step does

    fem::ElementOutputs outputs;
    outputs.stress = s.block_stress.data();
    outputs.energy = s.block_energy.data();
    outputs.plastic = plastic_strain(body);
    body.elements->evaluate(team, body.state.x.data()->data(), s.quaternion.data(), outputs);
    team.for_range(elements, 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) {
            for (std::size_t c = 0; c < 6; ++c) s.element[e][c] = s.block_stress[(e / fem::kBlock * 6 + c) * fem::kBlock + e % fem::kBlock];
            s.element_von_mises[e] = fem::von_mises(s.element[e]);
        }
    });
    team.for_range(vertices, 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            s.vertex[v] = fem::recover_at_vertex(data.corners, data.rest.volume, s.element, v);
            s.vertex_von_mises[v] = fem::von_mises(s.vertex[v]);
        }
    });
    s.energy_j = 0;
    for (const double w : s.block_energy) s.energy_j += w;
    s.valid = true;
}

}  // namespace supple
